"""Runs the programs for the study: once each, whatever happens in between."""

import hashlib
import json
import os
import shlex
import statistics
import subprocess
import sys
import time

SEEDS = (1, 2, 3)


class Progress:
    """What is done of what is to do, in units of work that foretell the time."""

    def __init__(self, runs=0, work=0.0):
        self.runs, self.work = runs, work
        self.done = self.reused = 0
        self.seen = set()
        self.worked = 0.0
        self.start = time.time()

    def reuse(self, key, work):
        if key not in self.seen:
            self.reused += 1
            self.work -= work
        self.seen.add(key)

    def add(self, key, work):
        self.seen.add(key)
        self.done += 1
        self.worked += work

    def text(self):
        passed = time.time() - self.start
        if not self.runs:
            return f"{self.done + self.reused:4d}"
        left = (self.work - self.worked) * passed / self.worked if self.worked else 0.0
        return (f"{self.done + self.reused:4d} of {self.runs}, {passed / 60:.0f} min passed, "
                f"{max(left, 0) / 60:.0f} left")


def work_of(program, arguments):
    """Roughly in proportion to the time of a run."""
    if not program.endswith("-render"):
        return 5e6
    value = lambda name: str(arguments[len(arguments) - 1 - arguments[::-1].index(name) + 1])
    width, height = map(int, value("--size").split("x"))
    return 2e6 + width * height * (60 + int(value("--samples")))


class Runner:
    """Results of program runs by their command line, kept in `work`/runs; a run that is there is
    not run again."""

    def __init__(self, build, work, progress=None):
        self.build, self.work = build, work
        self.progress = progress or Progress()
        self.runs = os.path.join(work, "runs")
        os.makedirs(self.runs, exist_ok=True)

    def program(self, name):
        folder = {"shadowcache-bake": "bake", "shadowcache-render": "render",
                  "shadowcache-make-set": "scenes"}.get(name, "tests")
        return os.path.join(self.build, folder, name)

    def path(self, name):
        return os.path.join(self.work, name)

    def make(self, path, maker):
        """Makes a file, if it is not there yet."""
        if not os.path.exists(path):
            maker(path + ".part")
            os.replace(path + ".part", path)

    def run(self, program, arguments, outputs=()):
        """Runs a program, if its result is not there yet.

        Returns a dictionary: command, seconds of processor time, standard output, and `stats`,
        what --stats wrote, for the programs that know it."""
        if program == "shadowcache-render":  # the paper's light is direct
            arguments = [*arguments, "--bounces", 0]
        command = shlex.join([program, *map(str, arguments)])
        key = hashlib.sha1(command.encode()).hexdigest()[:16]
        record = os.path.join(self.runs, key + ".json")
        if os.path.exists(record) and all(os.path.exists(o) for o in outputs):
            with open(record, encoding="utf-8") as file:
                self.progress.reuse(key, work_of(program, arguments))
                return json.load(file)
        stats = os.path.join(self.runs, key + ".stats.json")
        line = [self.program(program), *map(str, arguments)]
        if program in ("shadowcache-bake", "shadowcache-render", "shadowcache-study-render"):
            line += ["--stats", stats]
        result = self.measure(line, command)
        if os.path.exists(stats):
            with open(stats, encoding="utf-8") as file:
                result["stats"] = json.load(file)
            os.remove(stats)
        with open(record + ".part", "w", encoding="utf-8") as file:
            json.dump(result, file)
        os.replace(record + ".part", record)
        self.progress.add(key, work_of(program, arguments))
        print(f"  {self.progress.text()} | {result['seconds']:.1f} s {command[:120]}", flush=True)
        return result

    @staticmethod
    def measure(line, command):
        start = time.time()
        child = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        out, err = child.stdout.read(), child.stderr.read()
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            sys.exit(f"shadowcache-study: {command}\nexit status {child.returncode}\n{err or out}")
        return {"command": command, "seconds": usage.ru_utime + usage.ru_stime,
                "wall": time.time() - start, "out": out}


class Planner(Runner):
    """Runs nothing: counts what there is to do. What it returns has the form of results."""

    def __init__(self, work):
        super().__init__("", work)
        self.seen = {}

    def make(self, path, maker):
        pass

    def run(self, program, arguments, outputs=()):
        self.seen[shlex.join([program, *map(str, arguments)])] = work_of(program, arguments)
        error = {"l2": 1.0, "relmse": 1.0, "p99": 1.0}
        return {"command": "", "seconds": 0.0, "out": "{}",
                "stats": {"error": error, "bias": "", "rays": {"shadow": 0}}}

    def progress_to_make(self):
        return Progress(len(self.seen), sum(self.seen.values()))


class View:
    """A set with its cache under a map, seen by one camera."""

    def __init__(self, runner, name, mesh, cache, env, camera, size, reference=("cache", 2048),
                 albedo="0.5"):
        self.runner, self.name, self.size = runner, name, size
        self.base = [mesh, "--env", env, *camera, "--size", size, "--albedo", albedo]
        self.cache = cache
        self.reference = runner.path(f"{name}-reference.exr")
        estimator, samples = reference
        self.render(estimator, samples, cached=estimator == "cache", seed=1001,
                    keep=self.reference, judged=False)

    def render(self, estimator, samples, *options, cached=False, seed=1, keep=None, judged=True,
               png=None):
        """One picture; its statistics hold the error against the reference."""
        output = keep or (os.path.splitext(png)[0] + ".exr" if png
                          else self.runner.path("picture.exr"))
        line = [*self.base, "--estimator", estimator, "--samples", samples, *options, "--seed",
                seed, "-o", output]
        if cached:
            line += ["--cache", self.cache]
        if judged:
            line += ["--reference", self.reference]
        if png:
            line += ["--png"]
        return self.runner.run("shadowcache-study-render", line,
                               [p for p in (keep, png) if p])

    def error(self, estimator, samples, *options, cached=False, seeds=SEEDS):
        """Errors and processor time over the seeds."""
        return errors_of([self.render(estimator, samples, *options, cached=cached, seed=s)
                          for s in seeds])


def errors_of(runs):
    """Means over runs; of the L2 error also its standard error."""
    mean = lambda value: statistics.fmean(map(value, runs))
    each = [r["stats"]["error"]["l2"] for r in runs]
    return {"l2": statistics.fmean(each), "each": each,
            "l2_error": statistics.stdev(each) / len(each) ** 0.5 if len(each) > 1 else 0.0,
            "relmse": mean(lambda r: r["stats"]["error"]["relmse"]),
            "p99": mean(lambda r: r["stats"]["error"]["p99"]),
            "seconds": mean(lambda r: r["seconds"]),
            "rays": mean(lambda r: r["stats"]["rays"]["shadow"]),
            "bias": runs[0]["stats"]["bias"], "command": runs[0]["command"]}
