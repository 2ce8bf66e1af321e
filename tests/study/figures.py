"""Plots and contact sheets of the study, from the results that shadowcache-study wrote."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.image
import matplotlib.pyplot as plt
import numpy

COLORS = {"grace": "tab:blue", "lamps": "tab:orange"}
plt.rcParams.update({"font.size": 9, "figure.dpi": 100, "savefig.dpi": 100,
                     "axes.grid": True, "grid.alpha": 0.3})


def save(figure, folder, name, dpi=100):
    path = f"{folder}/{name}.png"
    figure.savefig(path, bbox_inches="tight", dpi=dpi)
    plt.close(figure)
    # A palette of 256 colours is enough for plots, and a third of the size.
    shrink(path)
    return path


def shrink(path):
    from PIL import Image
    Image.open(path).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(path, optimize=True)


def contact_sheet(rows, folder, name):
    figure, axes = plt.subplots(2, 4, figsize=(9.6, 5.4))
    for axis, row in zip(axes.flat, rows):
        axis.imshow(matplotlib.image.imread(row["png"]), interpolation="nearest")
        axis.set_title(row["label"], fontsize=8)
        axis.axis("off")
    figure.subplots_adjust(wspace=0.03, hspace=0.1)
    figure.savefig(f"{folder}/{name}.png", bbox_inches="tight")
    plt.close(figure)


def error_curve(axis, rows, x, **style):
    axis.errorbar([r[x] for r in rows], [r["l2"] for r in rows],
                  [r["l2_error"] for r in rows], marker="o", markersize=3, capsize=2, **style)


def by_triangles(rows, folder):
    figure, axis = plt.subplots(figsize=(5, 3))
    for name, color in COLORS.items():
        error_curve(axis, [r for r in rows if r["map"] == name], "M", color=color, label=name)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("triangles M")
    axis.set_ylabel("L2 error")
    ticks = [320, 1280, 2200, 3500, 5000, 8000]
    axis.set_xticks(ticks, map(str, ticks), rotation=45)
    axis.minorticks_off()
    axis.legend()
    save(figure, folder, "figure8")


def by_share(rows, folder):
    """Linear to 0.5 and enlarged to 0.1, as in the paper."""
    figure, axes = plt.subplots(1, 2, figsize=(8, 2.8))
    for axis, limit in zip(axes, (0.5, 0.1)):
        for name, color in COLORS.items():
            chosen = [r for r in rows if r["map"] == name and r["beta"] <= limit]
            first = chosen[0]["l2"]
            axis.errorbar([r["beta"] for r in chosen], [r["l2"] / first for r in chosen],
                          [r["l2_error"] / first for r in chosen], marker="o", markersize=3,
                          capsize=2, color=color, label=name)
        axis.set_xlabel("β")
        axis.set_ylabel("L2 error, 1 = β = 0")
        axis.legend()
        if limit < 0.5:
            axis.set_yscale("log")
            axis.yaxis.set_major_formatter("{x:.2f}")
            axis.yaxis.set_minor_formatter("{x:.2f}")
    figure.tight_layout()
    save(figure, folder, "figure10")


def samples(rows, folder):
    figure, axis = plt.subplots(figsize=(6, 3.6))
    for row in rows:
        axis.plot([c["samples"] for c in row["cosine"]],
                  [c["l2"] / row["paper"]["l2"] for c in row["cosine"]], "o-", markersize=3,
                  label=f"{row['map']} ({row['samples']})")
    axis.axhline(1, color="black", linewidth=1)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("samples of cosine")
    axis.set_ylabel("L2 error over that of paper")
    axis.set_xticks([128, 512, 2048], ["128", "512", "2048"])
    axis.minorticks_off()
    axis.legend(title="map (samples of paper)", fontsize=7, title_fontsize=7,
                loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, folder, "samples")


def conditions(rows, folder):
    """How much more error pixels make than triangles: predicted from the map, and measured."""
    figure, axis = plt.subplots(figsize=(8, 0.36 * len(rows) + 0.9))
    places = numpy.arange(len(rows))[::-1]
    ratio = lambda row, sequence: [a / b for a, b in zip(
        *(next(r["each"] for r in row["runs"] if (r["sequence"], r["method"]) == (sequence, m))
          for m in ("pixels", "triangles")))]
    predicted = [[n["pixels"] / n["triangles"] for n in row["noise"]] for row in rows]
    for values, mark, color, label in (
            (predicted, "|", "black", "predicted, independent samples"),
            ([ratio(r, "random") for r in rows], "o", "tab:blue", "measured, independent samples"),
            ([ratio(r, "larcher-xor") for r in rows], "s", "tab:orange",
             "measured, randomised QMC")):
        for place, row in zip(places, values):
            axis.plot(row, [place] * len(row), mark, color=color, label=label, markersize=4,
                      markeredgewidth=1.5, alpha=0.8, linestyle="none")
            label = None
    axis.axvline(1, color="black", linewidth=1)
    axis.set_xscale("log")
    axis.set_xlim(0.1, 3.5)
    axis.set_xticks([0.1, 0.2, 0.5, 1, 2, 3], ["0.1", "0.2", "0.5", "1", "2", "3"])
    axis.minorticks_off()
    axis.set_yticks(places, [row["label"] for row in rows])
    axis.set_xlabel("L2 error of 200 × 100 pixels over that of 5000 triangles")
    axis.legend(fontsize=7, loc="lower left")
    save(figure, folder, "conditions")


def triangle_picture(row):
    return numpy.array(row["triangle_of"]).reshape(row["height"], row["width"])


def triangulations(rows, folder):
    figure, axes = plt.subplots(1, 2, figsize=(9.6, 2.9))
    for axis, row in zip(axes, (r for r in rows if r["map"] in ("grace", "shop"))):
        level = numpy.array(row["level"])[triangle_picture(row)]
        shown = axis.imshow(level, cmap=plt.get_cmap("viridis", 4), vmin=2.5, vmax=6.5,
                            interpolation="nearest")
        axis.set_title(f"{row['map']}: {len(row['level'])} triangles", fontsize=8)
        axis.axis("off")
    figure.colorbar(shown, ax=axes, ticks=[3, 4, 5, 6], label="level", fraction=0.012)
    save(figure, folder, "figure7", dpi=170)


def importance(row, folder):
    value = numpy.array(row["importance"])[triangle_picture(row)]
    figure, axes = plt.subplots(1, 3, figsize=(9.6, 2))
    for axis, factor, title in zip(axes[:2], (1, 32), ("Ĥ at a normal that points up",
                                                       "the same, 32 times darker")):
        axis.imshow(numpy.clip(value / numpy.percentile(value, 90) / factor, 0, 1) ** (1 / 2.2),
                    cmap="gray", interpolation="nearest")
        axis.set_title(title, fontsize=8)
    directions = numpy.array(row["directions"])
    turn = ((numpy.pi - numpy.arctan2(directions[:, 0], directions[:, 2])) / (2 * numpy.pi)) % 1
    down = numpy.arccos(numpy.clip(directions[:, 1], -1, 1)) / numpy.pi
    axes[2].plot(turn, down, ".", markersize=1.2, color="black")
    axes[2].set_xlim(0, 1)
    axes[2].set_ylim(1, 0)
    axes[2].set_aspect(0.5)
    axes[2].set_title(f"{len(directions)} samples drawn from it", fontsize=8)
    for axis in axes:
        axis.set_xticks([])
        axis.set_yticks([])
    figure.subplots_adjust(wspace=0.03)
    save(figure, folder, "figure3", dpi=150)


def cache_options(rows, folder):
    figure, axes = plt.subplots(1, 3, figsize=(9.6, 2.8), sharey=True)
    for axis, option in zip(axes, ("alpha", "threshold", "cache-level")):
        for estimator, label, color in (("paper", "baked", "tab:green"),
                                        ("paper-image", "image space", "tab:purple")):
            chosen = [r for r in rows if r["option"] == option and r["estimator"] == estimator]
            places = range(len(chosen))
            axis.errorbar(places, [r["l2"] for r in chosen], [r["l2_error"] for r in chosen],
                          marker="o", markersize=3, capsize=2, color=color, label=label)
            axis.set_xticks(places, [str(r["value"]) for r in chosen])
        axis.set_xlabel("--" + option)
    axes[0].set_ylabel("L2 error")
    axes[0].legend()
    figure.tight_layout()
    save(figure, folder, "cache-options")


DRAWINGS = {
    "pictures": lambda rows, folder: contact_sheet(rows, folder, "figure1"),
    "pairs": lambda rows, folder: contact_sheet(rows, folder, "figure11"),
    "triangles": by_triangles,
    "defensive": by_share,
    "conditions": conditions,
    "samples": samples,
    "importance": lambda rows, folder: (triangulations(rows, folder),
                                        importance(rows[0], folder)),
    "cache_options": cache_options}


def draw(results, folder):
    """Draws what there are results for."""
    for name, drawing in DRAWINGS.items():
        if name in results:
            drawing(results[name]["rows"], folder)
