"""The experiments of the study. Each takes a Stage and returns what docs/paper.md tells of it."""

import json

PAPER_SAMPLES = 165


class Stage:
    """The views that the experiments share; made when first asked for."""

    def __init__(self, runner, maps, make_view, shadow_camera):
        self.runner, self.maps = runner, maps
        self.make_view, self.shadow_camera = make_view, shadow_camera
        self.views = {}

    def view(self, name, shadow=False):
        key = (name, shadow)
        if key not in self.views:
            self.views[key] = self.make_view(name, self.shadow_camera if shadow else None)
        return self.views[key]


def table1(stage):
    """Table 1: pixel-based importance against triangles, 165 samples."""
    rows = []
    for name in ("grace", "lamps"):
        view = stage.view(name)
        for size in ("100x50", "150x75", "180x90", "200x100"):
            for estimator in ("pixel-printed", "pixel"):
                rows.append({"map": name, "estimator": estimator, "size": size,
                             **view.error(estimator, PAPER_SAMPLES, "--pixel-map", size)})
        rows.append({"map": name, "estimator": "paper", "size": "5000",
                     **view.error("paper", PAPER_SAMPLES)})
        rows.append({"map": name, "estimator": "paper-image", "size": "5000",
                     **view.error("paper-image", PAPER_SAMPLES)})
        # What is spent before the first pixel, to be taken off the time.
        for row in rows:
            if row["map"] == name:
                option = ["--pixel-map", row["size"]] if "x" in row["size"] else []
                row["fixed"] = fixed_cost(view, row["estimator"], *option)
    return rows


def fixed_cost(view, estimator, *options):
    """Processor time of loading and precomputation: that of a picture of 8 x 8 pixels."""
    return view.render(estimator, 1, *options, "--size", "8x8", judged=False)["seconds"]


def triangles(stage):
    """Figure 8: error against the number of triangles M."""
    return [{"map": name, "M": m, **stage.view(name).error("paper", PAPER_SAMPLES,
                                                           "--triangles", m)}
            for name in ("grace", "lamps")
            for m in (320, 1280, 2200, 3500, 5000, 8000)]


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
            for label, estimator, cached in (("no cache", "paper", False),
                                             ("image-space cache", "paper-image", False),
                                             ("baked cache", "paper", True),
                                             ("`cache`", "cache", True)):
                rows.append({"map": name, "shadow": where, "label": label,
                             **view.error(estimator, PAPER_SAMPLES, cached=cached)})
    return rows


def samples(stage):
    """Section 5: how many samples of `cosine` have the noise of `paper`."""
    rows = []
    for name, count in (("lamps", 256), ("sun", 200), ("soft", 128), ("grace", 165)):
        view = stage.view(name)
        paper = view.error("paper", count)
        curve = [{"samples": n, **view.error("cosine", n, "--sequence", "larcher-xor")}
                 for n in (count, 4 * count, 16 * count)]
        rows.append({"map": name, "samples": count, "paper": paper, "cosine": curve})
    return rows


def cache_options(stage):
    """Section 4.3: alpha, threshold, and a cache coarser in direction than the triangulation."""
    view = stage.view("grace", True)
    rows = []
    for option, values in (("--alpha", (0, 0.3, 0.7, 0.9, 0.99)),
                           ("--threshold", (0, 3, 10, 100)),
                           ("--cache-level", (0, 1, 3, 5))):
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
    rows = []
    view = stage.view("grace")
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
            ("cache", "cache", [], True)):
        rows.append({"label": label,
                     **view.error(estimator, 64, *options, cached=cached)})
    return rows


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
        run = stage.view(name).render(estimator, count, *options, "--exposure", exposure, png=png)
        rows.append({"label": label, "png": png, "command": run["command"],
                     "bias": run["stats"]["bias"], "l2": run["stats"]["error"]["l2"]})
    return rows


def importance(stage):
    """Figures 3 and 7 and the cost of precomputation."""
    rows = []
    normal = (0, 1, 0)
    for name in ("grace", "lamps"):
        run = stage.runner.run("shadowcache-study-importance",
                               [stage.maps[name]["file"], 5000, *normal])
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
    normals = [line for line in run["out"].splitlines() if "normal:" in line]
    rows[0].update({"directions": directions, "debug_command": run["command"],
                    "normal": normals[0].split("normal:")[1].strip() if normals else ""})
    return rows


EXPERIMENTS = {f.__name__: f for f in (importance, table1, samples, shadow, triangles, defensive,
                                       techniques, pictures, sequences, cache_options)}
