"""What the benchmarks of whole programs share: their processor seconds, and the pictures that they write."""
import resource
import subprocess
import sys

import numpy as np


def seconds_of(*command, **options):
    """Processor seconds of a program, with what it starts. Ends this program, with the other's words, if that one fails."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode:
        sys.exit(f"{command[0]} ended with {done.returncode}:\n{done.stdout}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def read_colour(picture):
    """(height, width, 3)"""
    import shadowcache

    return np.asarray(shadowcache.read_exr(picture)["color"], float)[..., :3]


def errors_of(first, second, reference):
    """Of one of two pictures of different seeds: half their squared difference over the squared reference, of each pixel, sorted."""
    floor = 0.01 * reference.mean() ** 2
    return np.sort(((first - second) ** 2 / (reference**2 + floor)).mean(axis=2).ravel() / 2)
