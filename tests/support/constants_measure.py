"""Measures what half and twice the value of each tuned constant costs.

Error: mean over pixels of |x - ref| / (ref + 0.1 mean(ref)), luminance, squared. Unlike relMSE it is not ruled by a
few pixels, and like it, it falls as 1 / samples. Cost: processor seconds of the program without its start. Both are
ratios to the present value, same seeds, geometric means over the cases.
"""
import csv
import json
import math
import os
import statistics
import struct
import subprocess
import threading
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from constants_sources import FIGURES, SOURCE, constants

SIZE = "160x90"
MAPS = SOURCE / "scenes/maps"
# Set, spacing, map, turn, frame.
VIEWS = {"sunrise": ("courtyard", 1.6, "sunrise", 120, 1), "interior": ("courtyard", 1.6, "interior", 30, 18),
         "scatter": ("scatter", 1.6, "courtyard", 90, 1)}
SAMPLES, REFERENCE = 32, 1024
LIGHT = ["--samples", SAMPLES]
# A view with other options, which, and its samples.
OTHERS = {"glossy": ("interior", lambda bench: ["--material", "roughness=0.3,metallic=1"], SAMPLES)}
SEEDS = (1,)
BASE_SEEDS = (1, 2, 3, 4)  # where one picture's error says little
COLUMNS = ["name", "value", "tried", "case", "error", "cost", "rays", "bytes"]


def luminance(path):
    """Rows of 0.2126 R + 0.7152 G + 0.0722 B of an EXR of scan lines, 32 bits, ZIP."""
    data = path.read_bytes()
    at, header = 8, {}
    while data[at]:
        end = data.index(b"\0", at)
        type_end = data.index(b"\0", end + 1)
        (size,) = struct.unpack_from("<i", data, type_end + 1)
        header[data[at:end]] = data[type_end + 5 : type_end + 5 + size]
        at = type_end + 5 + size
    left, top, right, bottom = struct.unpack("<4i", header[b"dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    names = [name for name in header[b"channels"].split(b"\0") if name in (b"R", b"G", b"B")]
    if header[b"compression"] != b"\3" or names != [b"B", b"G", b"R"] or len(header[b"channels"]) != 3 * 18 + 1:
        raise SystemExit(f"{path}: expected B, G, R in 32 bits, ZIP")
    chunks = (height + 15) // 16
    values = []
    for offset in struct.unpack_from(f"<{chunks}Q", data, at + 1):
        line, size = struct.unpack_from("<ii", data, offset)
        lines = min(16, bottom + 1 - line)
        raw = data[offset + 8 : offset + 8 + size]
        if size < lines * width * 12:
            raw = bytearray(zlib.decompress(raw))
            for i in range(1, len(raw)):
                raw[i] = (raw[i - 1] + raw[i] - 128) & 255
            half = (len(raw) + 1) // 2
            mixed = bytearray(len(raw))
            mixed[0::2], mixed[1::2] = raw[:half], raw[half:]
            raw = bytes(mixed)
        for k in range(lines):
            row = struct.unpack_from(f"<{3 * width}f", raw, 12 * width * k)
            values.extend(0.0722 * row[x] + 0.7152 * row[width + x] + 0.2126 * row[2 * width + x]
                          for x in range(width))
    return values


def error_of(image, reference):
    floor = 0.1 * sum(reference) / len(reference)  # a control variate leaves dark pixels below 0, too
    return (sum(abs(a - b) / (max(b, 0) + floor) for a, b in zip(image, reference)) / len(image)) ** 2


class Bench:
    def __init__(self, build, work, jobs):
        self.build, self.work, self.lock, self.jobs = build, work, threading.Lock(), jobs
        self.number = 0
        self.references, self.starts = {}, {}

    def run(self, program, arguments, values=None):
        """Processor seconds and --stats of a run."""
        with self.lock:
            self.number += 1
            stats = self.work / f"{self.number}.json"
        environment = dict(os.environ, **{f"SHADOWCACHE_{k}": repr(v) for k, v in (values or {}).items()})
        command = [self.build / program, *map(str, arguments)]
        if "make-set" not in program:
            command += ["--stats", stats, "--threads", "1"]
        with open(self.work / f"{self.number}.log", "w") as log:
            child = subprocess.Popen(command, env=environment, stdout=log, stderr=log)
            _, status, use = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode:
            raise SystemExit(f"{' '.join(map(str, command))} with {values}\n{Path(log.name).read_text()}")
        Path(log.name).unlink()
        found = json.loads(stats.read_text()) if stats.exists() else {}
        stats.unlink(missing_ok=True)
        return use.ru_utime + use.ru_stime, found

    def path(self, name):
        return self.work / name

    def bake(self, set_, spacing, output, values=None):
        return self.run("bake/shadowcache-bake",
                        [self.path(f"{set_}.ply"), "-o", output, "--spacing", spacing], values)

    def scene(self, view, cache=None):
        set_, _, map_, turn, frame = VIEWS[view]
        return [self.path(f"{set_}.ply"), "--env", MAPS / f"{map_}.exr", "--env-rotate", turn,
                "--camera", self.path(f"{set_}.json"), "--frames", frame, "--size", SIZE,
                "--cache", cache or self.path(f"{set_}.vdb")]

    def picture(self, view, arguments, values=None, cache=None, reference=None):
        """Error, processor seconds without the start, and shadow rays of one rendering."""
        with self.lock:
            self.number += 1
            output = self.work / f"{self.number}.exr"
        seconds, stats = self.run("render/shadowcache-render",
                                  [*self.scene(view, cache), "--bounces", 0, "-o", output, *arguments], values)
        error = error_of(luminance(output), self.references[reference or view])
        output.unlink()
        rays = stats["rays"]["shadow"]
        return {"error": error, "cost": max(seconds - self.starts[view], 0.01), "rays": rays}

    def prepare(self):
        make = "scenes/shadowcache-make-set"
        self.run(make, ["courtyard", "-o", self.path("courtyard.ply"), "--camera", self.path("courtyard.json")])
        self.run(make, ["scatter", "--triangles", 20000, "-o", self.path("scatter.ply"),
                        "--camera", self.path("scatter.json")])
        self.run(make, ["scatter", "--triangles", 400000, "-o", self.path("many.ply"),
                        "--camera", self.path("many.json")])
        with ThreadPoolExecutor(self.jobs) as pool:
            list(pool.map(lambda s: self.path(f"{s}.vdb").exists()
                          or self.bake(s, 1.6, self.path(f"{s}.vdb")), ("courtyard", "scatter", "many")))
            list(pool.map(self.refer, [*VIEWS, *OTHERS]))

    def refer(self, name):
        """The reference of a view, and what the program's start takes."""
        view, more, samples = name, [], SAMPLES
        if name in OTHERS:
            view, make, samples = OTHERS[name]
            more = make(self)
        output = self.path(f"reference-{name}.exr")
        if not output.exists():
            self.run("render/shadowcache-render",
                     [*self.scene(view), "-o", output, "--seed", 99, *more,
                      "--samples", REFERENCE // SAMPLES * samples])
        self.references[name] = luminance(output)
        if name in VIEWS:
            self.starts[name] = statistics.median(
                self.run("render/shadowcache-render", [*self.scene(view), "-o", self.path(f"start-{name}.exr"),
                                                       "--preview", "--samples", 0, "--size", "8x8"])[0] for _ in range(3))


def pictures(views, arguments, **more):
    def case(bench, values, seed):
        return {view: bench.picture(view, [*arguments, "--seed", seed], values, **more) for view in views}
    return case


def other(name):
    def case(bench, values, seed):
        view, more, samples = OTHERS[name]
        return {name: bench.picture(view, ["--samples", samples, "--seed", seed, *more(bench)], values,
                                    reference=name)}
    return case


def baked(bench, values, seed):
    """A bake of each set, and what its cache is worth: without samples, and, of the cheaper one, with."""
    result = {}
    for set_, width, view in (("courtyard", 6, "interior"), ("scatter", 1.6, "scatter")):
        with bench.lock:
            bench.number += 1
            cache = bench.work / f"{bench.number}.vdb"
        seconds, stats = bench.bake(set_, width, cache, values)
        cost = {"cost": seconds, "rays": stats["rays"]["bake"], "bytes": stats["cache"]["bytes"]}
        shown = bench.picture(view, ["--preview", "--samples", 0, "--camera-rays", 16], None, cache)
        result[f"{view}, preview"] = {"error": shown["error"], **cost}
        if view == "scatter":
            drawn = bench.picture(view, [*LIGHT, "--seed", seed], None, cache)
            result[view] = {"error": drawn["error"], **cost}
        cache.unlink()
    return result


def spacing(bench, values, seed):
    """A bake at the default spacing: of coarse directions, since it has many items."""
    with bench.lock:
        bench.number += 1
        cache = bench.work / f"{bench.number}.vdb"
    seconds, stats = bench.run("bake/shadowcache-bake", [bench.path("scatter.ply"), "-o", cache, "--level", 2,
                                                         "--rays", 4], values)
    drawn = bench.picture("scatter", [*LIGHT, "--seed", seed], None, cache)
    cache.unlink()
    return {"default spacing": {"error": drawn["error"], "cost": seconds, "rays": stats["rays"]["bake"],
                                      "bytes": stats["cache"]["bytes"]}}


def many(bench, values, seed):
    result = {}
    for set_, map_, turn in (("courtyard", "sunrise", 120), ("many", "courtyard", 90)):
        output = bench.path(f"many-{threading.get_ident()}.exr")
        seconds, stats = bench.run("render/shadowcache-render", [
            bench.path(f"{set_}.ply"), "--env", MAPS / f"{map_}.exr", "--env-rotate", turn,
            "--camera", bench.path(f"{set_}.json"), "--size", SIZE, "-o", output, "--seed", seed,
            "--cache", bench.path(f"{set_}.vdb"), *LIGHT], values)
        result[set_] = {"error": 1, "cost": seconds, "rays": stats["rays"]["shadow"]}
    return result


ALL = tuple(VIEWS)
CASES = {
    "render": (pictures(ALL, LIGHT), SEEDS),
    "filtered": (pictures(ALL, ["--preview"]), SEEDS),
    "glossy": (other("glossy"), BASE_SEEDS),
    "target": (pictures(ALL, ["--target-error", "0.05"]), SEEDS),
    "bake": (baked, (1,)),
    "spacing": (spacing, (1,)),
    "many": (many, (1,)),
}
SPECIAL = {"kGlossyGroupPerFind": "glossy", "kManyTriangles": "many", "kMostItems": "spacing"}


def case_of(constant):
    if constant.name in SPECIAL:
        return SPECIAL[constant.name]
    if constant.file == "render/frame/target_error.cpp":
        return "target"
    if constant.file == "render/frame/residual_filter.cpp":
        return "filtered"
    if constant.file.startswith(("render/regions/lobe", "render/cached/lobe")):
        return "glossy"
    return "bake" if constant.file.startswith("bake/") else "render"


def measure(build, work, jobs, names):
    chosen = [c for c in constants()[0] if not names or c.name in names]
    missing = set(names) - {c.name for c in chosen}
    if missing:
        raise SystemExit(f"tests/constants: no tuned constant {', '.join(sorted(missing))}")
    bench = Bench(build, work, jobs)
    bench.prepare()
    needed = sorted({case_of(c) for c in chosen})
    # The present values several times, in between the others, as processors do not always run alike.
    tasks = [(case, None, None, seed) for case in needed for seed in CASES[case][1]]
    tried = [(case_of(c), c.name, int(v) if "int" in c.type or "size" in c.type else v, seed)
             for c in chosen for v in c.steps() for seed in CASES[case_of(c)][1]]
    for i, task in enumerate(tried):
        if i % 40 == 20:
            tasks += [(case, None, None, seed) for case in needed for seed in CASES[case][1]
                      if case == "render"]
        tasks.append(task)
    tasks += [("render", None, None, seed) for seed in BASE_SEEDS if seed not in SEEDS and "render" in needed]

    # What an earlier run in this folder measured is not measured again.
    log = work / "results.jsonl"
    results = [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []
    done = {tuple(task) for task, _ in results}

    def do(task):
        case, name, value, seed = task
        result = CASES[case][0](bench, {name: value} if name else None, seed)
        with bench.lock, open(log, "a") as file:
            print(json.dumps([task, result]), file=file)
        return task, result

    with ThreadPoolExecutor(jobs) as pool:
        results += pool.map(do, [task for task in tasks if task not in done])
    wanted = {c.name for c in chosen} | {None}
    write(chosen, [(task, result) for task, result in results if task[1] in wanted], names)


def write(chosen, results, names):
    base, other = {}, {}
    for (case, name, value, seed), result in results:
        for part, found in result.items():
            if name is None:
                base.setdefault((case, part, seed), []).append(found)
            else:
                other.setdefault((name, value, case, part), []).append((seed, found))
    rows = []
    texts = {c.name: c.text for c in chosen}
    for (name, value, case, part), found in other.items():
        row = {"name": name, "value": texts[name], "tried": f"{value:.6g}", "case": f"{case}: {part}"}
        for column in ("error", "cost", "rays", "bytes"):
            logs = [math.log(f[column] / statistics.median(b[column] for b in base[case, part, seed]))
                    for seed, f in found if f.get(column)]
            row[column] = f"{math.exp(sum(logs) / len(logs)):.4f}" if logs else ""
        rows.append(row)
    seeds = {}
    for (case, part, seed), found in base.items():
        seeds.setdefault((case, part), []).append(statistics.median(f["error"] for f in found))
        costs = [f["cost"] for f in found]
        if len(costs) > 2:
            print(f"{case}, {part}, seed {seed}: cost {statistics.mean(costs):.2f} s, "
                  f"deviation {statistics.stdev(costs) / statistics.mean(costs):.3f}")
    for (case, part), errors in seeds.items():
        if len(errors) > 1:
            print(f"{case}, {part}: error {statistics.mean(errors):.4g}, "
                  f"deviation over seeds {statistics.stdev(errors) / statistics.mean(errors):.3f}")
    if FIGURES.exists() and names:
        with open(FIGURES, newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["name"] not in names] + rows
    order = {c.name: i for i, c in enumerate(constants()[0])}
    rows.sort(key=lambda row: order.get(row["name"], len(order)))
    with open(FIGURES, "w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(row for row in rows if row["name"] in order)
