"""Does crash_probability say what roll-outs say? The tables and the picture of docs/whatif.md.

python tests/calibration/calibrate.py FOLDER SCENARIO… [--conflicts N] [--rollouts N] [--picture FILE.svg]

Each scenario is run, conflicts are drawn evenly over the range of their crash probabilities, and rolled out from the
moment at which the probability is highest. What was done already is not done again.
"""

from __future__ import annotations

import argparse
import csv
import random
import subprocess
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

BINS = (0.0, 0.02, 0.1, 0.25, 0.5, 0.75, 0.9, 1.000001)
"""Limits of the crash probabilities that are counted together."""


class Rolled(NamedTuple):
    """A conflict: its formula, its roll-outs with a contact, all of them, and what it is."""

    formula: float
    contacts: int
    all: int
    manoeuvre: str
    remark: str

    @property
    def share(self) -> float:
        return self.contacts / self.all


def chosen(log: Path, count: int) -> list[str]:
    """Ids of conflicts that are traffic's, the same number in each bin as far as there are any."""
    by_bin: dict[int, list[str]] = defaultdict(list)
    with (log / "conflicts.csv").open() as file:
        for row in csv.DictReader(file):
            if not row["artefact"] and row["crash_probability"] and float(row["begin"]) > 20.0:
                by_bin[bin_of(float(row["crash_probability"]))].append(row["id"])
    draw = random.Random(1)
    each = max(1, count // len(BINS))
    return [id for ids in by_bin.values() for id in draw.sample(ids, min(each, len(ids)))]


def bin_of(probability: float) -> int:
    """The number of its bin."""
    return next(number for number, limit in enumerate(BINS[1:]) if probability < limit)


def rolled(scenario: Path, asked: argparse.Namespace) -> Iterable[Rolled]:
    """The conflicts of a scenario that happen in their baselines."""
    log, out = asked.folder / scenario.stem / "log", asked.folder / scenario.stem / "whatif"
    if not (log / "run.json").exists():
        subprocess.run(["closecall", "run", scenario, "--quiet", "--out", log, "--", "--no-warnings"], check=True)
    ids = chosen(log, asked.conflicts)
    if not ids:
        return
    words = ["--rollouts", str(asked.rollouts), "--from", "worst", "--quiet", "--out", str(out)]
    status = subprocess.run(["closecall", "whatif", log, *ids, *words], check=False).returncode
    ended = f"{scenario}: closecall whatif ended with {status}"
    if status not in (0, 1):
        raise SystemExit(ended)
    with (out / "whatif.csv").open() as file:
        rows = list(csv.DictReader(file))
    # 1 says that single roll-outs failed, which then are lost.
    if status == 1 and not any(int(row["lost"]) for row in rows):
        raise SystemExit(ended)
    for row in rows:
        if int(row["roll_outs"]):
            numbers = float(row["crash_probability"] or 0.0), int(row["contacts"]), int(row["roll_outs"])
            yield Rolled(*numbers, row["manoeuvre"], row["remark"])


def brier(pairs: list[Rolled]) -> tuple[float, float, float, float]:
    """The Brier score of single roll-outs and its reliability, resolution and uncertainty (Murphy 1973)."""
    count = sum(one.all for one in pairs)
    base = sum(one.contacts for one in pairs) / count
    score = (
        sum(one.contacts * (1 - one.formula) ** 2 + (one.all - one.contacts) * one.formula**2 for one in pairs) / count
    )
    reliability = resolution = 0.0
    for of_bin in binned(pairs).values():
        weight = sum(one.all for one in of_bin)
        observed = sum(one.contacts for one in of_bin) / weight
        said = sum(one.formula * one.all for one in of_bin) / weight
        reliability += weight / count * (said - observed) ** 2
        resolution += weight / count * (observed - base) ** 2
    return score, reliability, resolution, base * (1 - base)


def binned(pairs: Iterable[Rolled]) -> dict[int, list[Rolled]]:
    """The conflicts of each bin."""
    found: dict[int, list[Rolled]] = defaultdict(list)
    for one in pairs:
        found[bin_of(one.formula)].append(one)
    return dict(sorted(found.items()))


def interval(pairs: list[Rolled]) -> tuple[float, float]:
    """The 95 % interval of the mean share, over conflicts: a bootstrap."""
    draw = random.Random(1)
    means = sorted(mean(draw.choices(pairs, k=len(pairs))) for _ in range(1000))
    return means[25], means[974]


def mean(pairs: list[Rolled]) -> float:
    """The mean share."""
    return sum(one.share for one in pairs) / len(pairs)


def said(pairs: list[Rolled]) -> float:
    """The mean of the formula."""
    return sum(one.formula for one in pairs) / len(pairs)


def line(name: str, pairs: list[Rolled]) -> str:
    """A row of a table: conflicts, the mean formula, the mean share with its interval."""
    low, high = interval(pairs)
    return f"| {name} | {len(pairs)} | {said(pairs):.2f} | {mean(pairs):.2f} ({low:.2f}–{high:.2f}) |"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("scenarios", type=Path, nargs="+")
    parser.add_argument("--conflicts", type=int, default=24)
    parser.add_argument("--rollouts", type=int, default=20)
    parser.add_argument("--picture", type=Path)
    asked = parser.parse_args()
    by_net = {path.stem: list(rolled(path, asked)) for path in asked.scenarios}
    pairs = [one for of_net in by_net.values() for one in of_net]
    print("| crash probability | conflicts | formula | roll-outs |\n|---|---|---|---|")
    for number, of_bin in binned(pairs).items():
        print(line(f"{BINS[number]:g} to {min(BINS[number + 1], 1.0):g}", of_bin))
    print("\n| manoeuvre | conflicts | formula | roll-outs |\n|---|---|---|---|")
    by_manoeuvre: dict[str, list[Rolled]] = defaultdict(list)
    for one in pairs:
        by_manoeuvre[one.manoeuvre or "unknown"].append(one)
    for name, of_one in sorted(by_manoeuvre.items()):
        print(line(f"`{name}`", of_one))
    print("\n| net | conflicts | formula | roll-outs |\n|---|---|---|---|")
    for name, of_net in by_net.items():
        if of_net:
            print(line(name, of_net))
    if asked.picture:
        # matplotlib is not needed for the tables.
        from diagram import Point, draw

        bins = binned(pairs).values()
        draw([Point(said(one), mean(one), *interval(one), len(one)) for one in bins], asked.picture)
    score, reliability, resolution, uncertainty = brier(pairs)
    parts = f"reliability {reliability:.3f} − resolution {resolution:.3f} + uncertainty {uncertainty:.3f}"
    print(f"\nBrier {score:.3f} = {parts}")


if __name__ == "__main__":
    main()
