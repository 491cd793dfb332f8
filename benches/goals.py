"""The goals of the benches, each with the figure that the benches' lines give for it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

SCENARIOS = ["grid", "town", "motorway"]
DENSE = ["jam", "platoons"]
SCENES = [*DENSE, "uniform"]


class Lines:
    """The lines that the benches printed."""

    def __init__(self, rows: list[dict[str, str]]) -> None:
        self.rows = rows

    def __call__(self, what: str, scene: str, method: str, size: int | None = None) -> float:
        """The value of a line; `size` is needed only where several lines differ by it.

        Raises:
            LookupError: no line matches.
        """
        for row in self.rows:
            is_it = (row["what"], row["scene"], row["method"]) == (what, scene, method)
            if is_it and size in (None, int(row["size"] or 0)):
                return float(row["value"])
        raise LookupError(what, scene, method, size)

    def longer(self, scene: str, method: str, size: int) -> float:
        """The time of a step with another method over the detector's: from the same rounds where both have rounds, else
        the fastest of one over the fastest of the other.
        """
        try:
            return self("longer", scene, method, size)
        except LookupError:
            return self("step", scene, method, size) / self("step", scene, "closecall", size)


@dataclass
class Goal:
    """A row of the table; a goal is held if every value is within the limits."""

    name: str
    values: Callable[[Lines], dict[str, float]]
    at_most: float = math.inf
    at_least: float = -math.inf
    form: str = ".2f"
    beside: Callable[[Lines], str] | None = None

    def row(self, lines: Lines) -> list[str]:
        """The cells of the row: goal, measured, limit, held."""
        limit = f"≤ {self.at_most:,g}" if self.at_most < math.inf else f"≥ {self.at_least:,g}"
        try:
            values = self.values(lines)
            beside = f" ({self.beside(lines)})" if self.beside else ""
        except LookupError:
            return [self.name, "not measured", limit, "**no**"]
        measured = ", ".join(f"{name} {value:{self.form}}".strip() for name, value in values.items())
        held = all(self.at_least <= value <= self.at_most for value in values.values())
        return [self.name, measured + beside, limit, "yes" if held else "**no**"]


def steps(method: str, *sizes: int) -> Callable[[Lines], dict[str, float]]:
    """The time of a step with another method over the detector's: the smallest ratio of these sizes."""
    return lambda lines: {scene: min(lines.longer(scene, method, size) for size in sizes) for scene in SCENES}


def saving(lines: Lines, exclusion: str) -> dict[str, float]:
    """The time of a step without an exclusion over the time with it, per scene, the largest ratio first."""
    kept = {
        row["scene"]: float(row["value"])
        for row in lines.rows
        if (row["what"], row["method"]) == ("longer", f"keep {exclusion}")
    }
    if not kept:
        raise LookupError(exclusion)
    return dict(sorted(kept.items(), key=lambda entry: -entry[1]))


def left_out(name: str, exclusion: str) -> Goal:
    """The row of an exclusion: one that saves nothing in any scene should be removed."""
    return Goal(
        f"times slower without leaving out {name}",
        lambda lines: dict([*saving(lines, exclusion).items()][:1]),
        at_least=1.05,
        beside=lambda lines: ", ".join(
            f"{scene} {ratio:.2f}" for scene, ratio in [*saving(lines, exclusion).items()][1:]
        ),
    )


def growth(lines: Lines, scene: str) -> float:
    """The exponent with which the time of a step grows between 10³ and 10⁶ road users."""
    few, many = (lines("step", scene, "closecall", size) * size for size in (10**3, 10**6))
    return math.log10(many / few) / 3


def cheaper(lines: Lines, scenario: str) -> float:
    """The time that device.ssm adds to a run over the time that closecall adds; infinite if closecall adds none."""
    ssm, closecall = (lines("over plain", scenario, method) - 1 for method in ("device.ssm", "closecall"))
    return ssm / closecall if closecall > 0 else math.inf


def reading(lines: Lines, scene: str) -> float:
    """The time of a step with a frame over the same time without reading the frame."""
    step, read = (lines("step", scene, method, 10**4) for method in ("frames", "frames read"))
    return step / (step - read)


def peaks(lines: Lines) -> dict[str, float]:
    """The peak memory of the replay of the largest recording over that of the smallest."""
    sizes = sorted(
        (row["scene"] for row in lines.rows if row["what"] == "peak"), key=lambda size: float(size.split()[0])
    )
    return {form: lines("peak", sizes[-1], form) / lines("peak", sizes[0], form) for form in ("CSV", "XML")}


def of_statistics(name: str, what: str, at_most: float, form: str) -> Goal:
    """A row on `closecall stats`, beside two libraries that compute the same."""
    methods = {"by kind": "closecall", "by edge": "closecall --by edge"}
    return Goal(
        name,
        lambda lines: {by: lines(what, "town", method) for by, method in methods.items()},
        at_most=at_most,
        form=form,
        beside=lambda lines: ", ".join(f"{it} {lines(what, 'town', it):{form}}" for it in ("DuckDB", "Polars")),
    )


GOALS = [
    Goal(
        "attached run over plain SUMO, both through libsumo",
        lambda lines: {scene: lines("over plain", scene, "closecall") for scene in SCENARIOS},
        at_most=1.2,
        beside=lambda lines: (
            "device.ssm, TTC alone: "
            + ", ".join(f"{lines('over plain', scene, 'device.ssm'):.2f}" for scene in SCENARIOS)
            + "; closecall over the program `sumo`, which is faster than libsumo: "
            + ", ".join(f"{lines('over program', scene, 'closecall'):.2f}" for scene in SCENARIOS)
        ),
    ),
    Goal(
        "time that device.ssm adds to a run over time that closecall adds",
        lambda lines: {scenario: cheaper(lines, scenario) for scenario in SCENARIOS},
        at_least=20,
        form=".0f",
    ),
    Goal(
        "detector, ns per road user and step in dense traffic, 10⁵ road users",
        lambda lines: {scene: lines("step", scene, "closecall", 10**5) for scene in DENSE},
        at_most=150,
        form=".0f",
        beside=lambda lines: f"uniform, not realistic traffic: {lines('step', 'uniform', 'closecall', 10**5):.0f}",
    ),
    Goal(
        "growth exponent of that time, 10³ to 10⁶ road users",
        lambda lines: {scene: growth(lines, scene) for scene in SCENES},
        at_most=1.1,
    ),
    Goal(
        "times faster than parry2d's tests with its tree rebuilt in each step, 10⁴ and 10⁵",
        steps("parry2d", 10**4, 10**5),
        at_least=3,
    ),
    Goal("the same, with the tree kept between steps", steps("parry2d (kept)", 10**4, 10**5), at_least=3),
    Goal(
        "the same, with all paths also known to be straight",
        steps("parry2d (kept; straight)", 10**4, 10**5),
        at_least=3,
    ),
    Goal("times faster than parry2d's test of all pairs, 10⁵", steps("all tested", 10**5), at_least=1000, form=",.0f"),
    Goal(
        "times faster than a vectorised test of all pairs by two circles, 10⁵",
        steps("all pairs", 10**5),
        at_least=1000,
        form=".0f",
    ),
    Goal(
        "times faster than commonroad-drivability-checker, 10³ and 10⁴", steps("commonroad", 10**3, 10**4), at_least=1
    ),
    Goal(
        "detector with two threads, times faster, 10⁵",
        lambda lines: {scene: lines("gain", scene, "step with 2 threads", 10**5) for scene in SCENES},
        at_least=1.7,
        beside=lambda lines: (
            "two detectors at once, each on its own thread: "
            + ", ".join(f"{lines('gain', scene, '2 at once', 10**5):.2f}" for scene in SCENES)
            + " times the work of one"
        ),
    ),
    left_out("pairs too far apart", "areas-apart"),
    left_out("tests of paths whose bounding boxes are apart", "paths-apart"),
    left_out("sweeps of road users that drive in line", "in-line"),
    left_out("lane lookups of vehicles still on their predicted path", "known-paths"),
    left_out("crash probabilities that decide nothing", "known-chances"),
    Goal(
        "replay from CSV, 10⁶ vehicle-steps per s",
        lambda lines: {scene: lines("replay", scene, "CSV") / 1e6 for scene in ("sparse", "platoons")},
        at_least=3,
    ),
    Goal(
        "replay from XML, 10⁶ vehicle-steps per s",
        lambda lines: {scene: lines("replay", scene, "XML") / 1e6 for scene in ("sparse", "platoons")},
        at_least=1.5,
    ),
    Goal(
        "replay with two threads over one, times faster",
        lambda lines: {scene: lines("gain of two threads", scene, "replay") for scene in ("grid", "town")},
        at_least=1.7,
    ),
    Goal(
        "replay of a gzipped file, times as fast as of a plain one",
        lambda lines: {scene: lines("gzipped over plain", scene, "replay") for scene in ("grid", "town")},
        at_least=0.8,
    ),
    Goal(
        "step with a frame from Python over the same without reading the frame, 10⁴ road users",
        lambda lines: {scene: reading(lines, scene) for scene in SCENES},
        at_most=1.5,
    ),
    of_statistics("statistics of 10⁷ conflicts in Parquet, s", "statistics", at_most=5, form=".1f"),
    of_statistics("their memory, MB", "statistics memory", at_most=500, form=".0f"),
    # The system accounts for a few pages more or less.
    Goal("memory of a replay of a file 100 times larger over that of the small file", peaks, at_most=1.05),
    Goal(
        "bytes per road user, in addition to SUMO's",
        lambda lines: {scene: lines("held", scene, "closecall") for scene in SCENARIOS},
        at_most=1000,
        form=",.0f",
    ),
    Goal(
        "memory after a day of traffic over that after an hour",
        lambda lines: {"": lines("held", "day", "after hour 24") / lines("held", "day", "after hour 1")},
        at_most=1,
        form=".3f",
    ),
]
