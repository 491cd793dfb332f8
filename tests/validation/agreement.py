"""What two readers answered: confusion table and Cohen's kappa.

python tests/validation/agreement.py answers_1.csv answers_2.csv [--key key.csv]

Kappa is given for the four answers, weighted by how far apart they are on the scale from not to crash, and with a crash
counted as a near miss. With `--key`, also how many of each severity each reader holds for a near miss or a crash, or at
least for borderline.
"""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path

import numpy as np
from draw import ANSWERS
from scores import share

NEAR_MISS, BORDERLINE = ANSWERS.index("near miss"), ANSWERS.index("borderline")
RESAMPLES = 10_000
SEED = 1


def answers(sheet: Path) -> dict[str, int]:
    """The answer of each case, as its place among those allowed."""
    found = {}
    with sheet.open(newline="") as lines:
        for line, row in enumerate(csv.DictReader(lines), 2):
            answer = row["answer"].strip().lower()
            if answer not in ANSWERS:
                sys.exit(f'{sheet}, line {line}: "{answer}" is none of {", ".join(ANSWERS)}')
            found[row["case"]] = ANSWERS.index(answer)
    return found


def kappa(one: np.ndarray, other: np.ndarray, weighted: bool = False) -> float:
    """Cohen's kappa (1960); weighted by how far apart two answers are (1968). 1 where all answers are the same."""
    places = np.arange(len(ANSWERS))
    table = np.histogram2d(one, other, bins=[np.append(places, len(places)) - 0.5] * 2)[0] / len(one)
    apart = np.abs(places[:, None] - places)
    weights = apart if weighted else apart > 0
    by_chance = (weights * np.outer(table.sum(1), table.sum(0))).sum()
    return 1.0 if by_chance == 0 else float(1 - (weights * table).sum() / by_chance)


def interval(one: np.ndarray, other: np.ndarray, weighted: bool = False) -> str:
    """Kappa with the percentiles of resamples of the cases."""
    chance = np.random.default_rng(SEED)
    chosen = (chance.integers(len(one), size=len(one)) for _ in range(RESAMPLES))
    low, high = np.percentile([kappa(one[at], other[at], weighted) for at in chosen], [2.5, 97.5])
    return f"{kappa(one, other, weighted):.2f} [{low:.2f}, {high:.2f}]"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sheets", type=Path, nargs=2, metavar="SHEET")
    parser.add_argument("--key", type=Path, default=None)
    arguments = parser.parse_args()
    first, second = (answers(sheet) for sheet in arguments.sheets)
    if set(first) != set(second):
        sys.exit(f"{arguments.sheets[1]}: its cases are not those of {arguments.sheets[0]}")
    cases = sorted(first)
    one, other = (np.array([reader[case] for case in cases]) for reader in (first, second))
    print(f"| first reader, second reader → | {' | '.join(ANSWERS)} |\n|---{'|---' * len(ANSWERS)}|")
    for index, name in enumerate(ANSWERS):
        counts = (int(((one == index) & (other == to)).sum()) for to in range(len(ANSWERS)))
        print(f"| {name} | {' | '.join(map(str, counts))} |")
    print(f"\nkappa {interval(one, other)}, weighted {interval(one, other, True)}, {len(cases)} cases")
    first_joined, second_joined = (np.maximum(reader, NEAR_MISS) for reader in (one, other))
    joined = [interval(first_joined, second_joined, weighted) for weighted in (False, True)]
    print(f"a crash counted as a near miss: kappa {joined[0]}, weighted {joined[1]}")
    if arguments.key:
        by_severity(arguments.key, cases, (one, other))


def by_severity(key: Path, cases: list[str], readers: tuple[np.ndarray, np.ndarray]) -> None:
    """The shares of near misses by severity and reader."""
    with key.open(newline="") as lines:
        severities = {row["case"]: row["severity"] for row in csv.DictReader(lines)}
    print("\n| severity | reader | near miss or crash | at least borderline |\n|---|---|---|---|")
    for severity in (*dict.fromkeys(sorted(severities.values())), "all"):
        kept = np.array([severity in ("all", severities[case]) for case in cases])
        for number, reader in enumerate(readers, 1):
            cells = [share(int((reader[kept] <= most).sum()), int(kept.sum())) for most in (NEAR_MISS, BORDERLINE)]
            of = (f"{100 * cell.value:.0f} % [{100 * cell.low:.0f}, {100 * cell.high:.0f}]" for cell in cells)
            print(f"| {severity} ({int(kept.sum())}) | {number} | {' | '.join(of)} |")


if __name__ == "__main__":
    main()
