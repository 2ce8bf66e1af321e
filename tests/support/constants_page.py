"""docs/constants.md: written from the sources and docs/benchmarks/constants.csv, and checked against them."""
import csv
import math

from constants_sources import FIGURES, SOURCE, constants

PAGE = SOURCE / "docs/constants.md"
WHAT = ["constant", "value", "what it does", "half", "twice", "chosen on"]
NONE = "–"
FIRST = "## `"


def figures():
    """By constant: rows of the file."""
    found = {}
    with open(FIGURES, newline="") as file:
        for row in csv.DictReader(file):
            found.setdefault(row["name"], []).append(row)
    return found


def mean(rows, column):
    values = [float(row[column]) for row in rows if row[column]]
    return math.exp(sum(map(math.log, values)) / len(values)) if values else None


def effects(constant, rows):
    """What half and twice the value cost: the last two cells but one."""
    cells = []
    for tried in sorted({float(row["tried"]) for row in rows}):
        these = [row for row in rows if float(row["tried"]) == tried]
        shown = [row for row in these if row["case"].startswith("preview") or row["case"].endswith("preview")]
        drawn = [row for row in these if row not in shown]
        error = mean(drawn, "error") if "many" not in these[0]["case"] else None
        preview, size = mean(shown, "error"), mean(these, "bytes")
        parts = [f"error {error:.2f}"] if error is not None else []
        parts += [f"preview {preview:.2f}"] if preview is not None else []
        parts.append(f"cost {mean(drawn or shown, 'cost'):.2f}")
        parts += [f"file {size:.2f}"] if size is not None else []
        old = "" if all(float(r["value"]) == constant.value for r in these) else f" (for {these[0]['value']})"
        cells.append(", ".join(parts) + old)
    return cells or [NONE, NONE]


def table(header, rows):
    line = "| {} |".format
    return [line(" | ".join(header)), "|" + "---|" * len(header), *(line(" | ".join(row)) for row in rows)]


def make(old, found, measured):
    """The page: what `old` says before its first room, and its origins, with tables made anew."""
    lead = old.split("\n" + FIRST)[0].rstrip("\n")
    origins = origins_of(old)
    lines = [lead, ""]
    for room in sorted({c.file.rsplit("/", 1)[0] for c in found}):
        here = [c for c in found if c.file.rsplit("/", 1)[0] == room]
        lines += [f"{FIRST}{room}`", ""]
        lines += table(WHAT, [[f"`{c.name}`", c.text, c.comment.replace("|", "\\|"),
                               *effects(c, measured.get(c.name, [])), origins.get(c.name, "")] for c in here])
        lines.append("")
    return "\n".join(lines)


def origins_of(page):
    origins = {}
    for line in page.split("\n"):
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if len(cells) == len(WHAT) and cells[0].startswith("`k"):
            origins[cells[0].strip("`")] = cells[-1]
    return origins


def write():
    found, errors = constants()
    if errors:
        raise SystemExit("\n".join(errors))
    PAGE.write_text(make(PAGE.read_text(), found, figures()))


def problems(page, found, measured):
    """What is wrong with a page, line by line."""
    errors = []
    origins = origins_of(page)
    names = {c.name for c in found}
    for c in found:
        if not origins.get(c.name):
            errors.append(f"docs/constants.md: {c.name}: expected a line with its origin")
    errors += [f"docs/constants.md: {name}: no such tuned constant" for name in origins if name not in names]
    errors += [f"docs/benchmarks/constants.csv: {name}: no such tuned constant"
               for name in measured if name not in names]
    wanted, given = make(page, found, measured).split("\n"), page.split("\n")
    if not errors and wanted != given:
        for line in range(max(len(wanted), len(given))):
            a = wanted[line] if line < len(wanted) else ""
            b = given[line] if line < len(given) else ""
            if a != b:
                errors.append(f"docs/constants.md:{line + 1}: found\n  {b}\nexpected (tests/constants --write)\n  {a}")
                break
    return errors


def check():
    found, errors = constants()
    errors += problems(PAGE.read_text(), found, figures())
    print("\n".join(errors) or f"{len(found)} tuned constants, as docs/constants.md has them")
    return 1 if errors else 0


def control():
    """Plants errors, each of which must be found, in a page that has none."""
    found, _ = constants()
    measured, page = figures(), PAGE.read_text()
    line = next(line for line in page.split("\n") if line.startswith(f"| `{found[0].name}`"))
    cells = line.split(" | ")
    shown = next(iter(measured))
    effect = next(x for x in page.split("\n") if x.startswith(f"| `{shown}`"))

    def changed(k, text):
        return page.replace(line, " | ".join([*cells[:k], text, *cells[k + 1:]]))

    planted = {
        "another value": (changed(1, "12345"), found, measured),
        "another meaning": (changed(2, "Nothing."), found, measured),
        "no origin": (changed(len(WHAT) - 1, " |"), found, measured),
        "a line that is missing": (page.replace(line + "\n", ""), found, measured),
        "a constant that is gone": (page, found[1:], measured),
        "another figure": (page.replace(effect, effect.replace("cost ", "cost 9", 1)), found, measured),
        "figures of no constant": (page, found, {**measured, "kNone": measured[shown]}),
        "figures that are missing": (page, found, {k: v for k, v in measured.items() if k != shown}),
    }
    missed = [name for name, case in planted.items() if not problems(*case)]
    if problems(page, found, measured):
        missed.append("the page as it is must be sound")
    print("\n".join(f"not found: {name}" for name in missed) or f"{len(planted)} planted errors found")
    return 1 if missed else 0
