"""Reads the programs' protections from their files: hardened.py COMPILER PROGRAM...

Each must be position-independent, with a stack that cannot run, all addresses linked before main() and read-only from
then on, no search path for libraries, a stack protector, and checked calls of the C library (_FORTIFY_SOURCE). Control:
a program that the compiler makes without any of these lacks all.
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

CHECKED = re.compile(r" __\w+_chk(?:@|$)", re.M)


def missing(program):
    """What a program lacks."""
    text = subprocess.run(["readelf", "-W", "-h", "-l", "-d", "--dyn-syms", program], check=True, capture_output=True,
                          text=True, env={"LC_ALL": "C"}).stdout
    has = {
        "position-independent": re.search(r"^ *Type: *DYN", text, re.M),
        "stack that cannot run": re.search(r"^ *GNU_STACK .* RW ", text, re.M),
        "read-only relocations": re.search(r"^ *GNU_RELRO ", text, re.M) and "BIND_NOW" in text,
        "no search path": not re.search(r"\((RPATH|RUNPATH)\)", text),
        "stack protector": "__stack_chk_fail" in text,
        "checked calls": CHECKED.search(text.replace("__stack_chk_fail", ""))}
    return [name for name, found in has.items() if not found]


def control(compiler):
    with tempfile.TemporaryDirectory() as folder:
        source, program = Path(folder, "plain.cpp"), Path(folder, "plain")
        source.write_text("#include <cstdio>\nint main(int n, char** v) { char a[99]; sprintf(a, \"%s\", v[n - 1]); puts(a); }\n")
        subprocess.run([compiler, "-O2", "-w", "-no-pie", "-fno-pie", "-fno-stack-protector", "-U_FORTIFY_SOURCE", "-z",
                        "norelro", "-z", "execstack", "-Wl,-z,lazy,-rpath,/nowhere,-z,execstack", source, "-o", program],
                       check=True)
        return missing(program)


def main():
    found = {program: missing(program) for program in sys.argv[2:]}
    for program, lacks in found.items():
        if lacks:
            print(f"{program}: without {', '.join(lacks)}")
    seen = control(sys.argv[1])
    if len(seen) != 6:
        print(f"control: a plain program lacks only {', '.join(seen)}")
    return 1 if len(seen) != 6 or any(found.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
