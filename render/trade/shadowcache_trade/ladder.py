"""Which bakes are tried, what their frames cost in all, and which of them to use."""
from dataclasses import dataclass
from typing import List, Optional

# The options' defaults, as shadowcache-bake has them.
LEVEL, RAYS = 5, 16
# Whole costs that differ by less are the same to a user; the smaller cache is taken.
TIE = 0.05


@dataclass(frozen=True)
class Choice:
    """Options of one bake. The spacing is relative to the one that the bake chooses itself."""
    spacing: float = 1.0
    level: int = LEVEL
    rays: int = RAYS
    series: str = "default"

    @property
    def options(self):
        return self.spacing, self.level, self.rays

    @property
    def name(self):
        value = {"spacing": f"{self.spacing:g} x", "level": self.level, "rays": self.rays}.get(self.series)
        return f"{self.series} {value}" if value is not None else self.series

    def work(self):
        """Rays of the bake over those of the default, roughly: for the time left alone."""
        return self.spacing ** -1.7 * min(1.0, 0.1 + 0.3 * self.level) * (0.5 + 0.5 * self.rays / RAYS)


@dataclass
class Error:
    """Mean over renders of several seeds, and the standard error of that mean."""
    mean: float
    deviation: float

    @staticmethod
    def of(values):
        count = len(values)
        mean = sum(values) / count
        squares = sum((value - mean) ** 2 for value in values)
        return Error(mean, (squares / (count - 1) / count) ** 0.5 if count > 1 else 0.0)


@dataclass
class Frame:
    """A picture: its errors, and processor seconds over the number of threads."""
    relmse: Error
    p99: Error
    seconds: float


@dataclass
class Point:
    """A bake and what was measured with it."""
    choice: Choice
    spacing: float  # [m]
    bake_seconds: float
    bytes: int
    frame: Frame
    preview: float  # relMSE of the prediction alone
    whole: float = 0.0  # seconds, see price()
    whole_deviation: float = 0.0


def ladder(spacings, levels, rays):
    """The default, then one option changed at a time."""
    choices = [Choice()]
    choices += [Choice(spacing=value, series="spacing") for value in spacings]
    choices += [Choice(level=value, series="level") for value in levels]
    choices += [Choice(rays=value, series="rays") for value in rays]
    return [choice for i, choice in enumerate(choices)
            if choice.options not in [before.options for before in choices[:i]]]


def price(points, frames, pixels):
    """Sets the whole cost of each point: its bake, and `frames` frames until they have the error of the default's.

    Error falls as 1 / samples, so frames of twice the error take twice the seconds. The error is p99, which a few
    pixels do not rule. `pixels` is the size of a delivered frame over that of the measured one.
    """
    wanted = points[0].frame.p99.mean
    for point in points:
        per_error = frames * pixels * point.frame.seconds / wanted if wanted > 0 else 0.0
        point.whole = point.bake_seconds + per_error * point.frame.p99.mean
        point.whole_deviation = per_error * point.frame.p99.deviation


def choose(points: List[Point]) -> Point:
    """The knee: of the points whose whole cost is the least, within TIE or its noise, that of the smallest cache."""
    least = min(points, key=lambda point: point.whole)
    margin = max(TIE * least.whole, 2 * least.whole_deviation)
    return min((point for point in points if point.whole <= least.whole + margin),
               key=lambda point: (point.bytes, point.whole))


def combine(points: List[Point]) -> Optional[Choice]:
    """The best of each series in one bake, if that is none of the points."""
    best = {name: choose([point for point in points if point.choice.series in ("default", name)]).choice
            for name in ("spacing", "level", "rays")}
    choice = Choice(best["spacing"].spacing, best["level"].level, best["rays"].rays, "combined")
    return choice if choice.options not in [point.choice.options for point in points] else None


def frames_that_pay(bake, cache, mis):
    """From how many frames on bake + n cache < n mis; None: never."""
    return bake / (mis - cache) if mis > cache else None
