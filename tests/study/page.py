"""Writes docs/paper.md from the results: the words are in page.md beside this file, the numbers in
the work folder. `{{name}}` in the words becomes the table of that name; what stands between
<!-- name --> and <!-- end --> is left out where that experiment has no results."""

import argparse
import json
import math
import os
import re
import statistics

import figures
from experiments import EXPERIMENTS

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.dirname(os.path.dirname(HERE))


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows])


def number(value):
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def error(row):
    """The mean over the seeds and its standard error, to two digits of the latter."""
    mean, deviation = row["l2"], row["l2_error"]
    if not deviation:
        return number(mean)
    digits = max(0, 1 - math.floor(math.log10(deviation)))
    return f"{mean:.{digits}f} ± {deviation:.{digits}f}"


def techniques(rows):
    return table(["technique", "L2 error", "relMSE", "p99", "processor s", "bias"],
                 [[r["label"], error(r), number(r["relmse"]), number(r["p99"]),
                   f"{r['seconds']:.1f}", r["bias"]] for r in rows])


def table1(rows):
    paper = {"100x50": (177, 0.963, 1.745), "150x75": (283, 0.809, 1.463),
             "180x90": (379, 0.781, 1.290), "200x100": (449, 0.622, 1.136),
             "5000": (390, 0.582, 0.367)}
    names = {("pixel-printed", None): "{} pixels, as printed", ("pixel", None): "{} pixels",
             ("paper", "5000"): "**5000 triangles**",
             ("paper-image", "5000"): "the same, image-space cache",
             ("paper", "5000, linear"): "the same, linear"}
    maps = list(dict.fromkeys(r["map"] for r in rows))
    lines = []
    for estimator, size in dict.fromkeys((r["estimator"], r["size"]) for r in rows):
        chosen = [next(r for r in rows if (r["map"], r["estimator"], r["size"]) ==
                       (m, estimator, size)) for m in maps]
        name = names.get((estimator, size)) or names[estimator, None].format(size)
        theirs = paper[size] if size in paper and estimator in ("pixel-printed", "paper") else (
            "", "", "")
        lines.append([name, *theirs, f"{chosen[0]['per_picture']:.2f}", *map(error, chosen)])
    return table(["importance", "paper: s", "grace", "video store", "ours: s", *maps], lines)


def conditions(rows):
    def of(row, method, sequence):
        return next(r for r in row["runs"] if (r["method"], r["sequence"]) == (method, sequence))

    def relative(row, method):
        """On a plane of one brightness relMSE is over 1.01 of its square."""
        return 100 * math.sqrt(1.01 * of(row, method, "random")["relmse"])

    def predicted(row, method):
        return 100 * statistics.fmean(n[method] for n in row["noise"]) / 165 ** 0.5

    def gain(row, sequence, over):
        return of(row, "pixels", sequence)["l2"] / of(row, over, sequence)["l2"]

    return table(["map", "predicted: pixels", "triangles", "measured: pixels", "triangles",
                  "triangles win by", "with QMC by", "20,000 of level 7 by", "linear by"],
                 [[r["label"], *(f"{predicted(r, m):.1f} %" for m in ("pixels", "triangles")),
                   *(f"{relative(r, m):.1f} %" for m in ("pixels", "triangles")),
                   *(f"{gain(r, s, m):.2f}" for s, m in (
                       ("random", "triangles"), ("larcher-xor", "triangles"),
                       ("larcher-xor", "level 7"), ("larcher-xor", "linear")))] for r in rows])


def order(rows):
    lines = []
    for constant, linear in zip(rows[::2], rows[1::2]):
        gain = (constant["l2"] / linear["l2"]) ** 2
        lines.append([constant["map"], error(constant), error(linear), f"{gain:.2f}",
                      f"{constant['seconds']:.1f}", f"{linear['seconds']:.1f}",
                      f"{gain * constant['seconds'] / linear['seconds']:.2f}"])
    return table(["map", "L2, constant", "L2, linear", "variance less, times",
                  "constant: s", "linear: s", "efficiency, times"], lines)


def by_map(rows, key, label):
    values = list(dict.fromkeys(r[key] for r in rows))
    maps = list(dict.fromkeys(r["map"] for r in rows))
    find = lambda m, v: next(r for r in rows if r["map"] == m and r[key] == v)
    return table([label, *maps], [[v, *[error(find(m, v)) for m in maps]] for v in values])


def less(row, first):
    """By how much the error is less, with the standard error of that from pairs of seeds."""
    each = [100 * (1 - a / b) for a, b in zip(row["each"], first["each"])]
    return f"{statistics.fmean(each):+.1f} ± {statistics.stdev(each) / len(each) ** 0.5:.1f} %"


def shadow(rows):
    lines = []
    for name in ("grace", "lamps"):
        for where in (True, False):
            first, *others = [r for r in rows if r["map"] == name and r["shadow"] == where]
            lines.append([name, "shadow" if where else "whole", error(first),
                          *[less(r, first) for r in others]])
    return table(["map", "view", "L2, no cache", "image-space cache: less error by",
                  "`paper`, baked cache", "`cache`"], lines)


def root_mean_square(row):
    return statistics.fmean(e * e for e in row["each"]) ** 0.5


def equal_noise(row):
    """Samples at which the error of `cosine` would be that of `paper`, from its longest run: the
    variance of independent samples falls as their number."""
    last = row["cosine"][-1]
    return last["samples"] * (root_mean_square(last) / root_mean_square(row["paper"])) ** 2


def samples(rows):
    return table(["map", "samples of `paper`", "its L2", "L2 of `cosine` at as many",
                  "at 9 times", "samples of `cosine` for the same L2", "times"],
                 [[r["map"], r["samples"], error(r["paper"]),
                   error(r["cosine"][0]), error(r["cosine"][-1]),
                   number(equal_noise(r)), number(equal_noise(r) / r["samples"])] for r in rows])


def options(rows):
    lines = []
    for r in rows:
        if r["estimator"] == "paper":
            image = next(q for q in rows if q["estimator"] == "paper-image" and
                         (q["option"], q["value"]) == (r["option"], r["value"]))
            lines.append([f"`--{r['option']} {r['value']}`", error(r), error(image)])
    return table(["option", "baked cache", "image-space cache"], lines)


def precomputation(rows):
    share = lambda values, choose: f"{100 * choose(values):.2g} %"
    return table(["map", "triangulation, s", "tables, s", "importance misplaced: mean", "most",
                  "tables, µs a place", "exact, µs a place", "irradiance table, s",
                  "its error: mean", "most"],
                 [[r["map"], f"{r['triangulation']['seconds']:.2f}",
                   f"{r['table']['seconds']:.2f}", share(r["table"]["misplaced"], statistics.fmean),
                   share(r["table"]["misplaced"], max),
                   f"{r['table']['microseconds']:.0f}", f"{r['table']['exact_microseconds']:.0f}",
                   f"{r['irradiance']['seconds']:.2f}",
                   share(r["irradiance"]["errors"], statistics.fmean),
                   share(r["irradiance"]["errors"], max)] for r in rows])


def picture_list(rows):
    return table(["picture", "L2 error", "bias"],
                 [[r["label"], number(r["l2"]), r["bias"]] for r in rows])


TABLES = {"techniques": techniques, "pictures": picture_list, "table1": table1,
          "triangles": lambda r: by_map(r, "M", "M"),
          "defensive": lambda r: by_map(r, "beta", "β"), "shadow": shadow, "samples": samples,
          "cache_options": options, "sequences": lambda r: by_map(r, "sequence", "numbers"),
          "importance": precomputation, "conditions": conditions, "order": order,
          "pairs": lambda _: ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--work", default=os.path.join(SOURCE, "out", "study"))
    parser.add_argument("--docs", default=os.path.join(SOURCE, "docs"))
    arguments = parser.parse_args()
    results = {}
    for name in EXPERIMENTS:
        path = os.path.join(arguments.work, name + ".json")
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                results[name] = json.load(file)
    folder = os.path.join(arguments.docs, "images", "paper")
    os.makedirs(folder, exist_ok=True)
    figures.draw(results, folder)
    with open(os.path.join(HERE, "page.md"), encoding="utf-8") as file:
        text = file.read()
    for name, make in TABLES.items():
        section = re.compile(rf"<!-- {name} -->\n(.*?)<!-- end -->\n", re.DOTALL)
        text = section.sub(r"\1" if name in results else "", text)
        if name in results:
            text = text.replace("{{" + name + "}}", make(results[name]["rows"]))
    any_result = next(iter(results.values()))
    for key in ("date", "commit", "machine", "size", "picture_size"):
        text = text.replace("{{" + key + "}}", any_result[key])
    with open(os.path.join(arguments.docs, "paper.md"), "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main()
