"""Which test program each file of tests is part of, as tests/CMakeLists.txt has it."""
import fnmatch
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
CALL = re.compile(r"^shadowcache_test\((\w+)/(\w+)\s+([\w-]+)([^)]*)\)", re.M)
TEST = re.compile(r"^TEST(?:_[FP])?\((\w+),\s*(\w+)\)", re.M)


@dataclass
class TestFile:
    name: str
    label: str
    program: str
    sources: list

    def read(self):
        return "".join(path.read_text(encoding="utf-8") for path in self.sources)


def test_files():
    """All files of tests by name."""
    found = {}
    for folder, name, label, rest in CALL.findall((TESTS / "CMakeLists.txt").read_text(encoding="utf-8")):
        words, _, more = rest.partition(" WITH ")
        alone = {"ALONE", "ONE_PROCESS"} & set(words.split())
        program = name if alone else f"{folder}_{label}_tests".replace("-", "_")
        found[name] = TestFile(name, label, program,
                               [TESTS / folder / f"{name}.cpp", *(TESTS / path for path in more.split())])
    return found


def kind(test):
    """Suite.Name of a test, without the names of its instance."""
    suite, name = test.split(".", 1)
    return f"{suite.split('/')[-1]}.{name.split('/')[0]}"


def listed(program):
    """Names of a program's tests, those of instances each."""
    if not program.exists():
        sys.exit(f"{program} is missing: build it")
    listing = subprocess.run([program, "--gtest_list_tests"], check=True, capture_output=True, text=True).stdout
    suite, names = "", []
    for line in listing.splitlines():
        word = line.split("#")[0].strip()
        if line.startswith(" "):
            names.append(suite + word)
        elif word.endswith("."):
            suite = word
    return names


def tests_of(file, program, wanted="*"):
    """Names of the tests in a program that come from a file and that a filter of GoogleTest takes."""
    own = {f"{suite}.{name}" for suite, name in TEST.findall(file.read())}
    return [test for test in listed(program) if kind(test) in own
            and any(fnmatch.fnmatchcase(test, pattern) for pattern in wanted.split(":"))]
