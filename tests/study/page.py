"""Writes docs/paper.md from the results: the words are in page.md beside this file, the numbers in
the work folder. `{{name}}` in the words becomes the table of that name; what stands between
<!-- name --> and <!-- end --> is left out where that experiment has no results."""

import argparse
import json
import os
import re

import figures
from experiments import EXPERIMENTS

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.dirname(os.path.dirname(HERE))


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows])


def number(value):
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def techniques(rows):
    return table(["technique", "L2 error", "relMSE", "p99", "processor s", "bias"],
                 [[r["label"], number(r["l2"]), number(r["relmse"]), number(r["p99"]),
                   f"{r['seconds']:.1f}", r["bias"]] for r in rows])


def table1(rows):
    def cell(name, estimator, size, key="l2"):
        return next(r for r in rows if (r["map"], r["estimator"], r["size"]) ==
                    (name, estimator, size))[key]

    def seconds(name, estimator, size):
        return cell(name, estimator, size, "seconds") - cell(name, estimator, size, "fixed")

    paper = {"100x50": (177, 0.963, 1.745), "150x75": (283, 0.809, 1.463),
             "180x90": (379, 0.781, 1.290), "200x100": (449, 0.622, 1.136)}
    lines = [[size, *paper[size],
              f"{seconds('grace', 'pixel', size):.1f}",
              number(cell("grace", "pixel-printed", size)), number(cell("grace", "pixel", size)),
              number(cell("lamps", "pixel-printed", size)), number(cell("lamps", "pixel", size))]
             for size in paper]
    lines.append(["5000 triangles", 390, 0.582, 0.367,
                  f"{seconds('grace', 'paper', '5000'):.1f}",
                  number(cell("grace", "paper", "5000")), "",
                  number(cell("lamps", "paper", "5000")), ""])
    lines.append(["the same with the image-space cache", "", "", "",
                  f"{seconds('grace', 'paper-image', '5000'):.1f}",
                  number(cell("grace", "paper-image", "5000")), "",
                  number(cell("lamps", "paper-image", "5000")), ""])
    return table(["importance", "paper: s", "grace", "video store", "ours: processor s",
                  "grace, as printed", "grace, unbiased", "lamps, as printed", "lamps, unbiased"],
                 lines)


def by_map(rows, key, label):
    values = list(dict.fromkeys(r[key] for r in rows))
    maps = list(dict.fromkeys(r["map"] for r in rows))
    find = lambda m, v: next(r for r in rows if r["map"] == m and r[key] == v)
    return table([label, *maps], [[v, *[number(find(m, v)["l2"]) for m in maps]] for v in values])


def shadow(rows):
    lines = []
    for name in ("grace", "lamps"):
        for where in (True, False):
            chosen = [r for r in rows if r["map"] == name and r["shadow"] == where]
            first = chosen[0]["l2"]
            lines.append([name, "shadow" if where else "whole", number(first),
                          *[f"{100 * (1 - r['l2'] / first):+.0f} %" for r in chosen[1:]]])
    return table(["map", "view", "L2, no cache", "image-space cache: less error by",
                  "`paper`, baked cache", "`cache`"], lines)


def equal_noise(row):
    """Samples at which the error of `cosine` would be that of `paper`, from its longest run: the
    variance of independent samples falls as their number."""
    last = row["cosine"][-1]
    return last["samples"] * (last["l2"] / row["paper"]["l2"]) ** 2


def samples(rows):
    return table(["map", "samples of `paper`", "its L2", "L2 of `cosine` at as many",
                  "at 16 times", "samples of `cosine` for the same L2", "times"],
                 [[r["map"], r["samples"], number(r["paper"]["l2"]),
                   number(r["cosine"][0]["l2"]), number(r["cosine"][-1]["l2"]),
                   number(equal_noise(r)), f"{equal_noise(r) / r['samples']:.0f}"] for r in rows])


def options(rows):
    lines = []
    for r in rows:
        if r["estimator"] == "paper":
            image = next(q for q in rows if q["estimator"] == "paper-image" and
                         (q["option"], q["value"]) == (r["option"], r["value"]))
            lines.append([f"`--{r['option']} {r['value']}`", number(r["l2"]), number(image["l2"])])
    return table(["option", "baked cache", "image-space cache"], lines)


def precomputation(rows):
    return table(["map", "triangulation, s", "tables, s", "importance misplaced: mean", "most",
                  "tables, µs a place", "exact, µs a place"],
                 [[r["map"], f"{r['triangulation']['seconds']:.2f}",
                   f"{r['table']['seconds']:.2f}",
                   f"{100 * sum(r['table']['misplaced']) / len(r['table']['misplaced']):.2f} %",
                   f"{100 * max(r['table']['misplaced']):.1f} %",
                   f"{r['table']['microseconds']:.0f}", f"{r['table']['exact_microseconds']:.0f}"]
                  for r in rows])


def picture_list(rows):
    return table(["picture", "L2 error", "bias"],
                 [[r["label"], number(r["l2"]), r["bias"]] for r in rows])


TABLES = {"techniques": techniques, "pictures": picture_list, "table1": table1,
          "triangles": lambda r: by_map(r, "M", "M"),
          "defensive": lambda r: by_map(r, "beta", "β"), "shadow": shadow, "samples": samples,
          "cache_options": options, "sequences": lambda r: by_map(r, "sequence", "numbers"),
          "importance": precomputation}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
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
    for key in ("date", "machine", "size"):
        text = text.replace("{{" + key + "}}", any_result[key])
    with open(os.path.join(arguments.docs, "paper.md"), "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main()
