"""The experiments of the study. Each takes a Stage and returns what docs/paper.md tells of it."""

import json

from runner import SEEDS, errors_of

PAPER_SAMPLES = 165
PIXEL_MAPS = ("100x50", "150x75", "180x90", "200x100")


class Stage:
    """The views that the experiments share; made when first asked for."""

    def __init__(self, runner, maps, make_view, shadow_camera, picture_size, plane):
        self.runner, self.maps = runner, maps
        self.make_view, self.shadow_camera = make_view, shadow_camera
        self.picture_size, self.plane = picture_size, plane
        self.views = {}

    def view(self, name, shadow=False, size=None):
        key = (name, shadow, size)
        if key not in self.views:
            self.views[key] = self.make_view(name, self.shadow_camera if shadow else None, size)
        return self.views[key]


def table1(stage):
    """Table 1: pixel-based importance against triangles, 165 samples."""
    rows = []
    for name in ("grace", "circus", "lamps", "shop"):
        view = stage.view(name)
        for estimator, size, options in (
                *((e, s, ["--pixel-map", s]) for s in PIXEL_MAPS for e in ("pixel-printed", "pixel")),
                ("paper", "5000", []), ("paper-image", "5000", []),
                ("paper", "5000, linear", ["--order", 1])):
            rows.append({"map": name, "estimator": estimator, "size": size,
                         **view.error(estimator, PAPER_SAMPLES, *options)})
            if name == "grace":
                # What is spent before the first pixel, to be taken off the time.
                fixed = view.render(estimator, 1, *options, "--size", "8x8", judged=False)
                rows[-1]["per_picture"] = rows[-1]["seconds"] - fixed["seconds"]
    return rows


METHODS = {"pixels": ("pixel", "--pixel-map", "200x100"), "triangles": ("paper",),
           "level 7": ("paper", "--max-level", 7, "--triangles", 20000),
           "linear": ("paper", "--order", 1)}


def lamp_inputs(stage):
    """Maps in three variants each: other places of the lamps, or turned."""
    import lamp_maps  # numpy, which the quick mode does without
    files = {}
    for label, make in (
            *((f"60 lamps of {d}°", lambda seed, d=d: lamp_maps.turned_lamps(60, d, seed))
              for d in (0.5, 2, 8)),
            ("shop", lamp_maps.shop),
            ("shop, 320 × 160 texels",
             lambda seed: lamp_maps.reduced(lamp_maps.shop(seed), 320, 160)),
            ("60 lamps, each one rectangle",
             lambda seed: lamp_maps.aligned_lamps(60, 200, 100, seed))):
        for seed in (1, 2, 3):
            path = stage.runner.path(f"map-{len(files)}.hdr")
            stage.runner.make(path, lambda p, m=make, s=seed: lamp_maps.write(p, m(s)))
            files[label, seed] = (path, 0)
    for name in ("grace", "circus", "lamps", "sun"):
        for seed, turn in ((1, 0), (2, 7.3), (3, 14.9)):
            files[name, seed] = (stage.maps[name]["file"], turn)
    return files


def conditions(stage):
    """When triangles win: 165 samples on a bare plane, for which the truth is known."""
    inputs = lamp_inputs(stage)
    rows = []
    for label in dict.fromkeys(label for label, _ in inputs):
        runs = {}
        for seed in (1, 2, 3):
            path, turn = inputs[label, seed]
            view = stage.plane(f"plane-{list(inputs).index((label, seed))}", path, turn)
            for sequence in ("random", "larcher-xor"):
                for method, (estimator, *options) in METHODS.items():
                    if sequence == "random" and method not in ("pixels", "triangles"):
                        continue
                    runs.setdefault((sequence, method), []).append(
                        view.render(estimator, PAPER_SAMPLES, *options, "--sequence", sequence,
                                    seed=seed))
            noise = stage.runner.run("shadowcache-study-noise",
                                     [path, turn, 5000, 200, 100])
            runs.setdefault("noise", []).append(json.loads(noise["out"]))
        rows.append({"label": label, "noise": runs.pop("noise"),
                     "runs": [{"sequence": s, "method": m, **errors_of(r)}
                              for (s, m), r in runs.items()]})
    return rows


def triangles(stage):
    """Figure 8: error against the number of triangles M."""
    return [{"map": name, "M": m, **stage.view(name).error("paper", PAPER_SAMPLES,
                                                           "--triangles", m)}
            for name in ("grace", "lamps")
            for m in (320, 1280, 2200, 3500, 5000, 8000)]


def order(stage):
    """Section 7: importance linear over a triangle instead of constant, equal samples."""
    rows = []
    for name in ("grace", "lamps", "shop", "sun", "soft"):
        for degree in (0, 1):
            view = stage.view(name)
            rows.append({"map": name, "order": degree,
                         **view.error("paper", PAPER_SAMPLES, "--order", degree, cached=True)})
    return rows


def defensive(stage):
    """Figure 10: error against the defensive share beta."""
    return [{"map": name, "beta": b, **stage.view(name).error("paper", PAPER_SAMPLES, "--beta", b)}
            for name in ("grace", "lamps") for b in (0, 0.02, 0.05, 0.1, 0.3, 0.5)]


def shadow(stage):
    """Figure 6: what the shadow cache gains where there is shadow, at equal samples."""
    rows = []
    for name in ("grace", "lamps"):
        for where in (True, False):
            view = stage.view(name, where)
            # Equal samples in every pixel: no adaptive budget.
            for label, estimator, options, cached in (
                    ("no cache", "paper", [], False),
                    ("image-space cache", "paper-image", [], False),
                    ("baked cache", "paper", [], True),
                    ("`cache`", "cache", ["--budget", "uniform"], True)):
                rows.append({"map": name, "shadow": where, "label": label,
                             **view.error(estimator, PAPER_SAMPLES, *options, cached=cached)})
    return rows


def samples(stage):
    """Section 5: how many samples of `cosine` have the noise of `paper`."""
    rows = []
    for name, count in (("lamps", 256), ("sun", 200), ("soft", 128), ("grace", 165)):
        view = stage.view(name)
        paper = view.error("paper", count)
        curve = [{"samples": n, **view.error("cosine", n, "--sequence", "larcher-xor")}
                 for n in (count, 3 * count, 9 * count)]
        rows.append({"map": name, "samples": count, "paper": paper, "cosine": curve})
    return rows


def cache_options(stage):
    """Section 4.3: alpha, threshold, and a cache coarser in direction than the triangulation."""
    view = stage.view("grace", True)
    rows = []
    for option, values in (("--alpha", (0, 0.4, 0.7, 0.99)),
                           ("--threshold", (0, 3, 30, 300)),
                           ("--cache-level", (0, 1, 2, 3))):
        for value in values:
            for estimator, cached in (("paper", True), ("paper-image", False)):
                rows.append({"option": option[2:], "value": value, "estimator": estimator,
                             **view.error(estimator, PAPER_SAMPLES, option, value,
                                          cached=cached)})
    return rows


def sequences(stage):
    """Section 3.2: the numbers of randomised quasi-Monte Carlo."""
    return [{"map": name, "sequence": sequence,
             **stage.view(name).error("cosine", 64, "--sequence", sequence)}
            for name in ("white", "grace")
            for sequence in ("random", "larcher-shift", "larcher-xor", "sobol")]


def techniques(stage):
    """All techniques side by side at 64 samples."""
    view = stage.view("grace")
    without_chance = ("preconvolved", "ambient-occlusion-cached", "lights")
    return [{"label": label,
             **view.error(estimator, 64, *options, cached=cached,
                          seeds=SEEDS[:1] if estimator in without_chance else SEEDS)}
            for label, estimator, options, cached in (
                ("preconvolved", "preconvolved", [], False),
                ("ambient-occlusion", "ambient-occlusion", [], False),
                ("ambient-occlusion-cached", "ambient-occlusion-cached", [], True),
                ("lights, K = 40", "lights", [], False),
                ("lights, K = 300", "lights", ["--lights", 300], False),
                ("uniform", "uniform", [], False),
                ("cosine, larcher-xor", "cosine", ["--sequence", "larcher-xor"], False),
                ("cosine", "cosine", [], False),
                ("environment", "environment", [], False),
                ("mis", "mis", [], False),
                ("pixel-printed", "pixel-printed", [], False),
                ("pixel", "pixel", [], False),
                ("paper, no cache", "paper", [], False),
                ("paper-image", "paper-image", [], False),
                ("paper, baked cache", "paper", [], True),
                ("paper, table-free", "paper", ["--convolution", "exact"], True),
                ("paper, β = 0.1", "paper", ["--beta", 0.1], True),
                ("paper, linear", "paper", ["--order", 1], True),
                ("cache, uniform budget", "cache", ["--budget", "uniform"], True),
                ("cache", "cache", [], True))]


def pictures(stage):
    """Figure 1: the eight pictures."""
    rows = []
    for label, name, estimator, count, options in (
            ("(a) preconvolved", "grace", "preconvolved", 1, []),
            ("(b) ambient occlusion", "grace", "ambient-occlusion", 256, []),
            ("(c) 40 directional lights", "grace", "lights", 1, []),
            ("(d) cosine, 64, uniform light", "white", "cosine", 64,
             ["--sequence", "larcher-xor"]),
            ("(e) cosine, 64 samples", "grace", "cosine", 64, ["--sequence", "larcher-xor"]),
            ("(f) paper-image, 64 samples", "grace", "paper-image", 64, []),
            ("(g) paper-image, 165 samples", "grace", "paper-image", 165, []),
            ("(h) paper-image, 64, uniform light", "white", "paper-image", 64, [])):
        png = stage.runner.path(f"figure1-{len(rows)}.png")
        exposure = stage.maps[name]["exposure"]
        view = stage.view(name, size=stage.picture_size)
        run = view.render(estimator, count, *options, "--exposure", exposure, png=png)
        rows.append({"label": label, "png": png, "command": run["command"],
                     "bias": run["stats"]["bias"], "l2": run["stats"]["error"]["l2"]})
    return rows


def pairs(stage):
    """Figure 11: pixels and triangles side by side, 165 samples, and the reference."""
    rows = []
    for name in ("grace", "shop"):
        view = stage.view(name, size=stage.picture_size)
        for label, estimator, count, options in (
                ("pixels 200x100", "pixel", PAPER_SAMPLES, ["--pixel-map", "200x100"]),
                ("5000 triangles", "paper", PAPER_SAMPLES, []),
                ("cosine", "cosine", PAPER_SAMPLES, ["--sequence", "larcher-xor"]),
                ("reference", "cache", 1024, [])):
            png = stage.runner.path(f"figure11-{len(rows)}.png")
            run = view.render(estimator, count, *options, "--exposure",
                              stage.maps[name]["exposure"], cached=estimator == "cache", png=png)
            rows.append({"label": f"{name}: {label}", "png": png, "command": run["command"]})
    return rows


def importance(stage):
    """Figures 3 and 7 and the cost of precomputation."""
    rows = []
    for name in ("grace", "lamps", "shop"):
        run = stage.runner.run("shadowcache-study-importance",
                               [stage.maps[name]["file"], 5000, 0, 1, 0])
        rows.append({"map": name, **json.loads(run["out"]), "command": run["command"]})
    view = stage.view("grace")
    size = int(view.size.split("x")[0])
    # A place of the ground in front, whose normal is that of the plot.
    run = stage.runner.run("shadowcache-render",
                           [*view.base, "--estimator", "paper", "--samples", 1000, "--debug",
                            f"{size // 8},{size - 4}", "-o", stage.runner.path("unused.exr")])
    directions = []
    for line in run["out"].splitlines():
        if "direction " in line:
            directions.append([float(x) for x in
                               line.split("direction ")[1].split(", cosine")[0].split(",")])
    rows[0].update({"directions": directions, "debug_command": run["command"]})
    return rows


EXPERIMENTS = {f.__name__: f for f in (importance, table1, order, conditions, pictures, pairs,
                                       techniques, shadow, samples, triangles, defensive,
                                       cache_options, sequences)}
