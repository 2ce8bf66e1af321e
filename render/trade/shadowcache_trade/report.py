"""What was measured, as text and as JSON."""
import os
import shlex
from dataclasses import asdict

from .ladder import LEVEL, RAYS, Choice, choose, frames_that_pay, price
from .measure import SPLITS

# Bounces of shadowcache-render, unless it is told.
BOUNCES = 4
# Frames that a bake may be paid by.
SHARING = (1, 10, 100, 1000)


def best_split(frames):
    """The split of the greatest efficiency by p99, and its frame."""
    return min(frames, key=lambda entry: entry[1].p99.mean * entry[1].seconds)


def seconds_of_mis(result, shot, error):
    """Seconds of a delivered frame until `mis` has an error (p99), at its best split."""
    frame = best_split(result.mis)[1]
    return shot.pixels * frame.seconds * frame.p99.mean / error


def seconds_of_rival(rival, shot, error):
    """Of Cycles, without loading."""
    frame = best_split(rival.frames)[1]
    return shot.pixels * frame.seconds * frame.p99.mean / error


def seconds_of_cache(point, shot, error):
    """Of a frame of a point, until it has an error."""
    return shot.pixels * point.frame.seconds * point.frame.p99.mean / error


def option_line(point, shot, names):
    """The command that bakes the choice; options at their defaults are left out."""
    choice = point.choice
    words = ["shadowcache-bake", *shot.files, *shot.set_options]
    if choice.spacing != 1:
        words += ["--spacing", f"{point.spacing:.4g}"]
    if choice.level != LEVEL:
        words += ["--level", str(choice.level)]
    if choice.rays != RAYS:
        words += ["--rays", str(choice.rays)]
    if not shot.whole_set:
        words += [*shot.camera_options, "--size", f"{shot.delivered[0]}x{shot.delivered[1]}"]
    return shlex.join(words + ["-o", names])


def render_line(result, shot, names):
    """The command that renders the shot as it was measured, in the size that is delivered."""
    rays, samples = best_split(result.cache)[0]
    bounces = [] if shot.bounces == BOUNCES else ["--bounces", str(shot.bounces)]
    turn = [] if shot.sky.rotation == 0 else ["--env-rotate", repr(shot.sky.rotation)]
    return shlex.join(["shadowcache-render", *shot.files, *shot.set_options, "--cache", names, "--env", shot.environment, *turn,
                       *shot.camera_options, "--size", f"{shot.delivered[0]}x{shot.delivered[1]}", "--camera-rays", str(rays),
                       "--samples", str(samples), *bounces, "-o", os.path.splitext(names)[0] + ".####.exr"])


def table(result, shot):
    """Markdown: a row for each bake."""
    lines = ["| bake | spacing, m | level | rays | bake, s | MB | relMSE | p99 | frame, s | prediction, relMSE |"
             f" whole, s ({shot.frames} frame{'s' if shot.frames > 1 else ''}) |", "|---|---|---|---|---|---|---|---|---|---|---|"]
    for point in result.points:
        frame, choice = point.frame, point.choice
        mark = " **knee**" if point is result.best else ""
        lines.append(f"| {choice.name}{mark} | {point.spacing:.4g} | {choice.level} | {choice.rays} "
                     f"| {point.bake_seconds:.1f} | {point.bytes / 1e6:.1f} | {error_text(frame.relmse)} "
                     f"| {error_text(frame.p99)} | {frame.seconds:.2f} | {point.preview:.3g} "
                     f"| {point.whole:.0f} ± {point.whole_deviation:.0f} |")
    return "\n".join(lines)


def knees(points, frames, pixels):
    """Markdown: the knee if as many frames as in each row share the bake. Leaves the points priced for `frames`."""
    lines = ["| frames that share a bake | knee | spacing, m | level | rays | MB | whole cost over that of the default |",
             "|---|---|---|---|---|---|---|"]
    for count in SHARING:
        price(points, count, pixels)
        best = choose(points)
        lines.append(f"| {count} | {best.choice.name} | {best.spacing:.4g} | {best.choice.level} | {best.choice.rays} "
                     f"| {best.bytes / 1e6:.1f} | {best.whole / points[0].whole:.2f} x |")
    price(points, frames, pixels)
    return "\n".join(lines)


def rival_text(result, shot):
    """Markdown: a row for each number of samples of Cycles, or why it is left out."""
    rival = result.rival
    if rival is None:
        return "Cycles: not measured."
    if rival.reason:
        return f"Cycles is left out: {rival.reason}."
    lines = ["| Cycles, samples | relMSE | p99 | frame, s | loading, s |", "|---|---|---|---|---|"]
    for samples, frame in rival.frames:
        lines.append(f"| {samples} | {error_text(frame.relmse)} | {error_text(frame.p99)} | {frame.seconds:.2f} "
                     f"| {rival.load_seconds:.1f} |")
    seconds = seconds_of_rival(rival, shot, result.points[0].frame.p99.mean)
    return "\n".join([*lines, "", f"Its errors are against its own reference, whose light differs by "
                      f"{100 * rival.difference:+.2f} %. To the p99 of the default it takes {seconds:.0f} s a frame."])


def error_text(error):
    return f"{error.mean:.3g} ± {error.deviation:.1g}"


def split_table(result):
    """Markdown: a row for each split of camera rays and samples."""
    lines = ["| camera rays × samples | relMSE: `mis` | `cache` | p99: `mis` | `cache` | frame, s: `mis` | `cache` |",
             "|---|---|---|---|---|---|---|"]
    for (split, mis), (_, cache) in zip(result.mis, result.cache):
        lines.append(f"| {split[0]} × {split[1]} | {error_text(mis.relmse)} | {error_text(cache.relmse)} "
                     f"| {error_text(mis.p99)} | {error_text(cache.p99)} | {mis.seconds:.2f} | {cache.seconds:.2f} |")
    return "\n".join(lines)


def summary(result, shot, cache_name):
    """What to use, and what it is worth."""
    usual, best = result.points[0], result.best
    error = usual.frame.p99.mean
    width, height = shot.delivered
    lines = [table(result, shot), "", knees(result.points, shot.frames, shot.pixels), "", split_table(result), "",
             rival_text(result, shot), ""]
    least = min(point.frame.relmse.mean for point in result.points)
    lines.append(f"The reference's own relMSE is {result.reference_noise:.2g}, {100 * result.reference_noise / least:.0f} "
                 "% of the least that was measured"
                 + ("; raise --reference-rays." if result.reference_noise > 0.25 * least else "."))
    difference, deviation = result.difference
    lines.append(f"`mis` has {100 * difference:+.2f} ± {100 * deviation:.2f} % more radiance than the reference.")
    mis, own = seconds_of_mis(result, shot, error), seconds_of_cache(best, shot, error)
    pays = frames_that_pay(best.bake_seconds, own, mis)
    lines.append(f"At {width}x{height}, to the p99 that the default has with {SPLITS[0][0]} camera rays x {SPLITS[0][1]}:"
                 f" `mis` takes {mis:.0f} s a frame, the knee {own:.0f} s and a bake of {best.bake_seconds:.0f} s, which "
                 + (f"pays from frame {max(1, -(-pays // 1)):.0f} on." if pays is not None else "never pays."))
    saved = 1 - best.bytes / usual.bytes
    lines += ["", "The default bake is the one to use:" if best.choice.options == Choice().options else
              f"The one to use ({100 * abs(saved):.0f} % {'fewer' if saved > 0 else 'more'} bytes, "
              f"{100 * (best.whole / usual.whole - 1):+.0f} % whole cost than the default):",
              "", "    " + option_line(best, shot, cache_name), "    " + render_line(result, shot, cache_name)]
    return "\n".join(lines)


def record(result, shot, command):
    """All that was measured, for a JSON file."""
    return {"command": command, "size": shot.size, "delivered": shot.delivered, "frames": shot.frames,
            "threads": shot.threads, "cores": os.cpu_count(), "bounces": shot.bounces,
            "reference_relmse": result.reference_noise, "difference": result.difference,
            "points": [asdict(point) for point in result.points], "knee": result.points.index(result.best),
            "cache": [[split, asdict(frame)] for split, frame in result.cache],
            "cycles": asdict(result.rival) if result.rival else None,
            "mis": [[split, asdict(frame)] for split, frame in result.mis]}
