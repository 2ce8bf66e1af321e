"""Plots and contact sheets of the study, from the results that shadowcache-study wrote."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.image
import matplotlib.pyplot as plt
import numpy

COLORS = {"grace": "tab:blue", "lamps": "tab:orange"}
plt.rcParams.update({"font.size": 9, "figure.dpi": 100, "savefig.dpi": 100,
                     "axes.grid": True, "grid.alpha": 0.3})


def save(figure, folder, name):
    path = f"{folder}/{name}.png"
    figure.savefig(path, bbox_inches="tight")
    plt.close(figure)
    # A palette of 256 colours is enough for plots, and a third of the size.
    shrink(path)
    return path


def shrink(path):
    from PIL import Image
    Image.open(path).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(path, optimize=True)


def pictures(rows, folder):
    figure, axes = plt.subplots(2, 4, figsize=(9.6, 5.4))
    for axis, row in zip(axes.flat, rows):
        axis.imshow(matplotlib.image.imread(row["png"]), interpolation="nearest")
        axis.set_title(row["label"], fontsize=7)
        axis.axis("off")
    figure.subplots_adjust(wspace=0.03, hspace=0.1)
    figure.savefig(f"{folder}/figure1.png", bbox_inches="tight")
    plt.close(figure)


def curve(rows, folder, name, x, label, log=False):
    figure, axes = plt.subplots(1, 2, figsize=(8, 2.8))
    for axis, scale in zip(axes, ("linear", "log")):
        for map_name, color in COLORS.items():
            chosen = [r for r in rows if r["map"] == map_name]
            first = chosen[0]["l2"] if x == "beta" else chosen[-1]["l2"]
            xs, ys = [r[x] for r in chosen], [r["l2"] / first for r in chosen]
            axis.plot(xs, ys, "o-", color=color, label=map_name, markersize=3)
            for r in chosen:
                axis.plot([r[x]] * len(r["each"]), [e / first for e in r["each"]], "_", color=color,
                          alpha=0.6)
        axis.set_xlabel(label)
        axis.set_ylabel("L2 error, 1 = " + ("β = 0" if x == "beta" else "most triangles"))
        if scale == "log":
            if x == "beta":
                axis.set_yscale("log")
                axis.set_xlim(-0.003, 0.105)
                axis.set_ylim(0.9, 1.2)
                axis.set_yticks([0.9, 1.0, 1.1, 1.2], ["0.9", "1.0", "1.1", "1.2"])
                axis.minorticks_off()
            else:
                axis.set_xscale("log")
                axis.set_yscale("log")
        axis.legend()
    figure.tight_layout()
    save(figure, folder, name)


def samples(rows, folder):
    figure, axis = plt.subplots(figsize=(5, 3))
    for row, color in zip(rows, ("tab:orange", "tab:red", "tab:green", "tab:blue")):
        xs = [c["samples"] for c in row["cosine"]]
        axis.plot(xs, [c["l2"] / row["paper"]["l2"] for c in row["cosine"]], "o-", color=color,
                  markersize=3, label=f"{row['map']} ({row['samples']})")
    axis.axhline(1, color="black", linewidth=1)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("samples of cosine")
    axis.set_ylabel("L2 error over that of paper")
    axis.set_xticks([128, 512, 2048, 8192], ["128", "512", "2048", "8192"])
    axis.set_ylim(0.1, None)
    axis.legend(title="map (samples of paper)", fontsize=7, title_fontsize=7, loc="lower left",
                ncol=2)
    save(figure, folder, "samples")


def triangle_picture(row):
    return numpy.array(row["triangle_of"]).reshape(row["height"], row["width"])


def triangulations(rows, folder):
    figure, axes = plt.subplots(1, 2, figsize=(9.6, 2.9))
    for axis, row in zip(axes, rows):
        level = numpy.array(row["level"])[triangle_picture(row)]
        shown = axis.imshow(level, cmap=plt.get_cmap("viridis", 4), vmin=2.5, vmax=6.5,
                            interpolation="nearest")
        axis.set_title(f"{row['map']}: {len(row['level'])} triangles", fontsize=8)
        axis.axis("off")
    figure.colorbar(shown, ax=axes, ticks=[3, 4, 5, 6], label="level", fraction=0.012)
    save(figure, folder, "figure7")


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
    save(figure, folder, "figure3")


def cache_options(rows, folder):
    figure, axes = plt.subplots(1, 3, figsize=(9.6, 2.6), sharey=True)
    for axis, option in zip(axes, ("alpha", "threshold", "cache-level")):
        for estimator, label, color in (("paper", "baked", "tab:green"),
                                        ("paper-image", "image space", "tab:purple")):
            chosen = [r for r in rows if r["option"] == option and r["estimator"] == estimator]
            axis.plot(range(len(chosen)), [r["l2"] for r in chosen], "o-", color=color,
                      label=label, markersize=3)
            axis.set_xticks(range(len(chosen)), [str(r["value"]) for r in chosen])
        axis.set_xlabel("--" + option)
    axes[0].set_ylabel("L2 error")
    axes[0].legend()
    figure.tight_layout()
    save(figure, folder, "cache-options")


DRAWINGS = {
    "pictures": pictures,
    "triangles": lambda rows, folder: curve(rows, folder, "figure8", "M", "triangles M"),
    "defensive": lambda rows, folder: curve(rows, folder, "figure10", "beta", "β"),
    "samples": samples,
    "importance": lambda rows, folder: (triangulations(rows, folder),
                                        importance(rows[0], folder)),
    "cache_options": cache_options}


def draw(results, folder):
    """Draws what there are results for."""
    for name, drawing in DRAWINGS.items():
        if name in results:
            drawing(results[name]["rows"], folder)
