"""Writes BUILD/plain/compile_commands.json: the commands of BUILD without precompiled headers, which only the
compiler that made them can read, and file by file what BUILD compiles in batches. So each file is seen with nothing
but what it includes.

Usage: plain_commands.py BUILD
"""
import json
import re
import shlex
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]


def plain(command):
    """A command's words without those that name a precompiled header."""
    words, found = iter(shlex.split(command)), []
    for word in words:
        if word == "-include":
            next(words)
        elif word not in ("-Winvalid-pch", "-fpch-preprocess"):
            found.append(word)
    return found


def apart(entry):
    """An entry for each file of a batch; any other entry as it is."""
    file = Path(entry["file"])
    if file.parent.name != "Unity":
        return [entry]
    return [{**entry, "file": each, "command": entry["command"].replace(str(file), each)}
            for each in re.findall(r'^#include "(.*)"$', file.read_text(), re.MULTILINE)]


def plain_commands(build):
    """The entries of our own files."""
    entries = [each for entry in json.loads((build / "compile_commands.json").read_text()) for each in apart(entry)]
    return [{**entry, "command": shlex.join(plain(entry["command"]))} for entry in entries
            if entry["file"].startswith(str(SOURCE)) and "/build/" not in entry["file"].removeprefix(str(SOURCE))]


def main():
    build = Path(sys.argv[1])
    (build / "plain").mkdir(exist_ok=True)
    (build / "plain" / "compile_commands.json").write_text(json.dumps(plain_commands(build), indent=1))


if __name__ == "__main__":
    main()
