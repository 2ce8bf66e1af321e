"""Runs the programs for the study: once each, whatever happens in between."""

import hashlib
import json
import os
import shlex
import subprocess
import sys
import time


class Runner:
    """Results of program runs by their command line, kept in `work`/runs; a run that is there is
    not run again."""

    def __init__(self, build, work):
        self.build, self.work = build, work
        self.done = self.reused = 0
        self.runs = os.path.join(work, "runs")
        os.makedirs(self.runs, exist_ok=True)

    def program(self, name):
        folder = {"shadowcache-bake": "bake", "shadowcache-render": "render",
                  "shadowcache-make-set": "scenes"}.get(name, "tests")
        return os.path.join(self.build, folder, name)

    def path(self, name):
        return os.path.join(self.work, name)

    def run(self, program, arguments, outputs=()):
        """Runs a program, if its result is not there yet.

        Returns a dictionary: command, seconds of processor time, standard output, and `stats`,
        what --stats wrote, for the programs that know it."""
        command = shlex.join([program, *map(str, arguments)])
        key = hashlib.sha1(command.encode()).hexdigest()[:16]
        record = os.path.join(self.runs, key + ".json")
        if os.path.exists(record) and all(os.path.exists(o) for o in outputs):
            with open(record, encoding="utf-8") as file:
                self.reused += 1
                return json.load(file)
        stats = os.path.join(self.runs, key + ".stats.json")
        line = [self.program(program), *map(str, arguments)]
        if program in ("shadowcache-bake", "shadowcache-render"):
            line += ["--stats", stats]
        result = self.measure(line, command)
        if os.path.exists(stats):
            with open(stats, encoding="utf-8") as file:
                result["stats"] = json.load(file)
            os.remove(stats)
        with open(record + ".part", "w", encoding="utf-8") as file:
            json.dump(result, file)
        os.replace(record + ".part", record)
        self.done += 1
        print(f"  {self.done + self.reused:4d} {result['seconds']:7.1f} s  {command[:150]}",
              flush=True)
        return result

    @staticmethod
    def measure(line, command):
        start = time.time()
        child = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        out, err = child.stdout.read(), child.stderr.read()
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            sys.exit(f"shadowcache-study: {command}\n{err or out}")
        return {"command": command, "seconds": usage.ru_utime + usage.ru_stime,
                "wall": time.time() - start, "out": out}


class View:
    """A set with its cache under a map, seen by one camera."""

    def __init__(self, runner, name, mesh, cache, env, camera, size, albedo="0.5",
                 reference_samples=1024):
        self.runner, self.name, self.size = runner, name, size
        self.base = [mesh, "--env", env, *camera, "--size", size, "--albedo", albedo]
        self.cache = cache
        self.reference = runner.path(f"{name}-reference.exr")
        self.render("cache", reference_samples, cached=True, seed=1001, keep=self.reference,
                    judged=False)

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
        return self.runner.run("shadowcache-render", line,
                               [p for p in (keep, png) if p])

    def error(self, estimator, samples, *options, cached=False, seeds=(1,)):
        """Errors and processor time, the mean over the seeds."""
        runs = [self.render(estimator, samples, *options, cached=cached, seed=s) for s in seeds]
        mean = lambda value: sum(map(value, runs)) / len(runs)
        # The root of the mean square, so that one bad seed is not hidden.
        return {"l2": mean(lambda r: r["stats"]["error"]["l2"] ** 2) ** 0.5,
                "relmse": mean(lambda r: r["stats"]["error"]["relmse"]),
                "p99": mean(lambda r: r["stats"]["error"]["p99"]),
                "each": [r["stats"]["error"]["l2"] for r in runs],
                "seconds": mean(lambda r: r["seconds"]),
                "rays": mean(lambda r: r["stats"]["rays"]["shadow"]),
                "bias": runs[0]["stats"]["bias"], "command": runs[0]["command"]}
