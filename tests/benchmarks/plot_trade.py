#!/usr/bin/env python3
"""Draws the curves of docs/benchmarks/trade.md from the JSON that `tests/bench ... --json FILE trade` wrote.

Usage: plot_trade.py FILE.json SCENE MAP OUT.svg (needs python3-matplotlib)
"""

import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

CHOICES = ["spacing", "level", "rays", "uniform", "uniform-coarse"]
ESTIMATORS = ["samples-mis", "samples-paper", "samples-cache"]


def points(data, series):
    """The measured points of one series, in the order of measuring."""
    return [p for _, p in sorted(data.get(series, {}).items())]


def draw(axes, data, names, x, label, marked=None, y="relmse"):
    for name in names:
        found = points(data, name)
        axes.plot([p[x] for p in found], [p[y] for p in found], "o-", ms=3, lw=1,
                  label=name.replace("samples-", ""))
    if marked:
        axes.plot(marked[x], marked[y], "k*", ms=10, label="default")
    axes.set(xscale="log", yscale="log", xlabel=label, ylabel="p99" if y == "p99" else "relMSE")
    axes.grid(True, which="major", lw=0.3)
    axes.legend(fontsize=7)


def main():
    file, scene, sky, out = sys.argv[1:]
    with open(file, encoding="utf-8") as stream:
        data = json.load(stream)[scene][sky]
    default = next(p for p in points(data, "rays") if p["choice"] == 16)
    figure, axes = plt.subplots(2, 3, figsize=(12, 6.4))
    draw(axes[0][0], data, CHOICES, "bake_rays", "rays of the bake", default, y="p99")
    draw(axes[0][1], data, CHOICES, "bake_seconds", "seconds of the bake", default, y="p99")
    draw(axes[0][2], data, CHOICES, "file_bytes", "cache file [bytes]", default, y="p99")
    draw(axes[1][0], data, ESTIMATORS, "choice", "samples a pixel")
    draw(axes[1][1], data, ESTIMATORS, "choice", "samples a pixel", y="p99")
    draw(axes[1][2], data, ESTIMATORS, "seconds", "seconds of the render")
    figure.suptitle(f"{scene} under {sky}: what accuracy costs")
    figure.tight_layout()
    figure.savefig(out)


if __name__ == "__main__":
    main()
