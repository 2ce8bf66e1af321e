"""The tuned constants of the sources."""
import re
from dataclasses import dataclass
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
FIGURES = SOURCE / "docs/benchmarks/constants.csv"
MARK = re.compile(r"^[ \w]*SHADOWCACHE_TUNED\((?P<type>[\w:]+), (?P<name>k\w+), (?P<value>[^)]+)\);")
# Shares and cosines whose distance to 1 is halved and doubled, as twice the value would be out of their range.
NEAR_ONE = {"kMostlyVisible", "kLeastCutAgreement"}


@dataclass
class Constant:
    name: str
    type: str
    value: float
    text: str  # the value as the source has it, without suffix
    comment: str
    file: str

    def steps(self):
        """Half and twice the value: of a level or of bits one less and one more."""
        if self.name.endswith(("Level", "Bits")):
            return [self.value - 1, self.value + 1]
        if self.name in NEAR_ONE:
            return [1 - 2 * (1 - self.value), 1 - (1 - self.value) / 2]
        return [self.value / 2, self.value * 2]


def constants(source=SOURCE):
    """All of them, in the order of their files, and lines about what is wrong with them."""
    found, errors = [], []
    for folder in ("common", "bake", "render"):
        for path in sorted((source / folder).rglob("*")):
            if path.suffix not in (".h", ".cpp") or path.name == "tuned.h":
                continue
            lines = path.read_text().split("\n")
            file = str(path.relative_to(source))
            for at, line in enumerate(lines):
                if "SHADOWCACHE_TUNED(" not in line:
                    continue
                match = MARK.match(line)
                if not match:
                    errors.append(f"{file}:{at + 1}: expected SHADOWCACHE_TUNED(type, name, number); on one line")
                    continue
                comment = []
                while at > 0 and lines[at - 1].lstrip().startswith("///"):
                    at -= 1
                    comment.insert(0, lines[at].strip()[3:].strip())
                text = re.sub(r"(?<=[\d.])f$", "", match["value"])
                constant = Constant(match["name"], match["type"], float(text), text, " ".join(comment), file)
                if not comment:
                    errors.append(f"{file}: {constant.name}: expected a comment of its own")
                if any(c.name == constant.name for c in found):
                    errors.append(f"{file}: {constant.name}: a second constant of this name")
                found.append(constant)
    return found, errors
