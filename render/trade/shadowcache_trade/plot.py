"""The curves: error against what a bake costs, error against seconds, and the whole cost with its knee."""
import numpy as np

from .report import best_split, seconds_of_cache, seconds_of_mis, seconds_of_rival

SERIES = {"spacing": "tab:blue", "level": "tab:orange", "rays": "tab:green", "combined": "tab:purple"}


def value_of(choice):
    return {"spacing": f"{choice.spacing:g} x", "level": f"{choice.level}", "rays": f"{choice.rays}"}.get(choice.series, "")


def curves(axes, result, x, y, deviation=None):
    """A curve for each option, through the default; a star marks the default, a circle the knee."""
    default = result.points[0]
    for name, color in SERIES.items():
        points = [point for point in result.points if point.choice.series == name]
        if not points:
            continue
        line = points if name == "combined" else sorted(points + [default], key=x)
        axes.errorbar([x(point) for point in line], [y(point) for point in line],
                      [deviation(point) for point in line] if deviation else None,
                      fmt="o-", markersize=3.5, linewidth=1, capsize=2, color=color, label=name)
        for point in points:
            axes.annotate(value_of(point.choice), (x(point), y(point)), xytext=(4, 3), textcoords="offset points",
                          fontsize=6.5, color=color)
    axes.plot(x(default), y(default), "k*", markersize=10, label="default", zorder=4)
    axes.plot(x(result.best), y(result.best), "o", markersize=13, fillstyle="none", color="red", label="knee", zorder=5)
    axes.set(xscale="log", yscale="log")


def by_seconds(axes, result):
    rival = result.rival.frames if result.rival else []
    for name, frames, color in (("mis", result.mis, "tab:gray"), ("cache", result.cache, "tab:red"),
                                ("Cycles", rival, "tab:olive")):
        if not frames:
            continue
        ordered = sorted(frames, key=lambda entry: entry[1].seconds)
        for kind, style in (("p99", "o-"), ("relmse", "s--")):
            errors = [getattr(frame, kind) for _, frame in ordered]
            axes.errorbar([frame.seconds for _, frame in ordered], [error.mean for error in errors],
                          [error.deviation for error in errors], fmt=style, markersize=3.5, linewidth=1, capsize=2,
                          color=color, label=f"{name}, {'relMSE' if kind == 'relmse' else kind}")
        for split, frame in ordered:
            text = "{} × {}".format(*split) if isinstance(split, tuple) else split
            axes.annotate(text, (frame.seconds, frame.p99.mean), xytext=(4, 3), textcoords="offset points", fontsize=6.5,
                          color=color)
    axes.set(xscale="log", yscale="log")


def by_frames(axes, result, shot):
    error = result.points[0].frame.p99.mean
    frames = np.geomspace(1, max(1000, 4 * shot.frames), 60)
    axes.plot(frames, frames * seconds_of_mis(result, shot, error), color="tab:gray",
              label=f"mis, {'{} × {}'.format(*best_split(result.mis)[0])}")
    if result.rival and result.rival.frames:
        axes.plot(frames, result.rival.load_seconds + frames * seconds_of_rival(result.rival, shot, error), color="tab:olive",
                  label=f"Cycles, {best_split(result.rival.frames)[0]}")
    axes.plot(frames, result.points[0].bake_seconds + frames * seconds_of_cache(result.points[0], shot, error), "k",
              label="default")
    axes.plot(frames, result.best.bake_seconds + frames * seconds_of_cache(result.best, shot, error), color="red",
              linestyle="--", label="knee")
    axes.axvline(shot.frames, color="tab:gray", linewidth=0.5)
    axes.set(xscale="log", yscale="log")


def plain_ticks(axes):
    """1, 2, 5, 10, ... in place of powers of ten."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axis.set_minor_formatter(NullFormatter())
        axis.set_tick_params(labelsize=7)


def draw(result, shot, title):
    """A figure of matplotlib."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(12, 7), dpi=100)
    axes = figure.subplots(2, 3)
    error, spread = (lambda point: point.frame.p99.mean), (lambda point: point.frame.p99.deviation)
    curves(axes[0][0], result, lambda point: point.bake_seconds, error, spread)
    curves(axes[0][1], result, lambda point: point.bytes / 1e6, error, spread)
    curves(axes[0][2], result, lambda point: point.bytes / 1e6, lambda point: point.preview)
    by_seconds(axes[1][0], result)
    curves(axes[1][1], result, lambda point: point.bytes / 1e6, lambda point: point.whole,
           lambda point: point.whole_deviation)
    by_frames(axes[1][2], result, shot)
    size = "{}x{}".format(*shot.delivered)
    for axis, x, y in ((axes[0][0], "bake [s]", "p99 of a frame"), (axes[0][1], "cache [MB]", "p99 of a frame"),
                       (axes[0][2], "cache [MB]", "relMSE of the prediction alone"),
                       (axes[1][0], f"frame of {shot.size[0]}x{shot.size[1]} [s]", "error"),
                       (axes[1][1], "cache [MB]", f"bake + {shot.frames} × {size} [s]"),
                       (axes[1][2], "frames", f"bake + frames of {size} [s]")):
        axis.set(xlabel=x, ylabel=y)
        axis.grid(True, which="major", linewidth=0.3)
        plain_ticks(axis)
    for axis in (axes[0][0], axes[1][0], axes[1][2]):
        axis.legend(fontsize=7)
    figure.suptitle(title)
    figure.tight_layout()
    return figure
