"""Compiles with clang++-14, with the release preset's flags and for its warnings alone, each of our files that
BUILD/compile_commands.json names.

Usage: clang_warnings.py BUILD
"""
import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from plain_commands import plain_commands

# What has a value of its own in the next word, or names what only a build needs.
WITH_VALUE, ALONE = {"-o", "-MF", "-MT"}, {"-c", "-MD", "/usr/bin/ccache", "-Wno-restrict",
                     "-Wno-stringop-overflow", "-Wno-subobject-linkage"}


def warnings(entry):
    """What clang says of a file."""
    words = [word for word in shlex.split(entry["command"]) if word not in ALONE]
    for option in WITH_VALUE & set(words):
        at = words.index(option)
        del words[at:at + 2]
    words[0] = "clang++-14"
    return subprocess.run([*words, "-fsyntax-only", "-Wno-sign-conversion"], cwd=entry["directory"],
                          capture_output=True, text=True).stderr


def main():
    entries = plain_commands(Path(sys.argv[1]))
    said = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for text in pool.map(warnings, entries):
            said += bool(text)
            print(text, end="", flush=True)
    print(f"clang++-14: {len(entries)} files, {said} with warnings")
    return 1 if said else 0


if __name__ == "__main__":
    sys.exit(main())
