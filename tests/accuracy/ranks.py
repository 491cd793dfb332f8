"""How crash probabilities rank conflicts, against the aggregated crash index and the time to brake.

python tests/accuracy/ranks.py CONFLICTS.csv ... [--at-least RHO]

Each file is a log, and all together are one more. Spearman's rank correlations:

- `braking ~ ACI`: `crash_probability_braking` and ACI, over rear-end conflicts;
- `crash ~ ACI`: `crash_probability` and ACI, over the same;
- `crash ~ ttb`: `crash_probability` and the time to brake, over the conflicts on a collision course.

ACI (Kuang, Qu and Wang 2015) is computed here by its tree: the leader is disturbed and brakes; it stands before the
follower reacts, or not; the follower's brakes suffice until the speeds are equal and until both stand, or not. The
leaves that end in a crash add up. The reaction time and both decelerations are random. Speeds and room are those of the
step with the smallest margin.
"""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path

import numpy as np
from scipy.stats import spearmanr

DRAWS = 4000
# The reaction time, lognormal, in s; decelerations, normal and cut, in m/s².
REACTION, REACTION_SD = 0.92, 0.28
BRAKING, BRAKING_SD, WEAKEST, STRONGEST = 8.45, 1.42, 4.23, 12.68
FEWEST = 10


def draws() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Reaction times, and decelerations of followers and of leaders."""
    chance = np.random.default_rng(1)
    spread = np.log1p((REACTION_SD / REACTION) ** 2)
    reactions = np.exp(np.log(REACTION) - spread / 2 + np.sqrt(spread) * chance.standard_normal(DRAWS))
    normal = chance.normal(BRAKING, BRAKING_SD, 4 * DRAWS)
    cut = normal[(normal >= WEAKEST) & (normal <= STRONGEST)]
    return reactions, cut[:DRAWS], cut[DRAWS : 2 * DRAWS]


def aci(speed: float, leader: float, room: float) -> float:
    """The sum of the tree's leaves that end in a crash."""
    reaction, own, other = DRAWN
    stands = leader / other
    leader_way = leader**2 / (2 * other)
    at_rest = room + leader_way - speed * reaction - speed**2 / (2 * own)
    # The speeds are equal while both still brake, if the follower is faster then and brakes harder.
    with np.errstate(divide="ignore", invalid="ignore"):
        equal = (speed - leader + own * reaction) / (own - other)
        ways = [leader * equal - other * equal**2 / 2, speed * equal - own * (equal - reaction) ** 2 / 2]
    while_moving = np.where((equal > reaction) & (equal < stands) & (own > other), room + ways[0] - ways[1], np.inf)
    return float(np.mean((at_rest < 0) | (while_moving < 0)))


DRAWN = draws()


def correlation(pairs: list[tuple[float, float]]) -> str:
    """Spearman's, if both values vary and there are enough."""
    first, second = ({value[side] for value in pairs} for side in (0, 1))
    if len(pairs) < FEWEST or len(first) == 1 or len(second) == 1:
        return f"- ({len(pairs)})"
    return f"{spearmanr(*zip(*pairs, strict=True)).statistic:.2f} ({len(pairs)})"


def columns(rows: list[dict[str, str]]) -> dict[str, list[tuple[float, float]]]:
    """The pairs of values of each correlation."""
    following = [row for row in rows if row["kind"] == "rear_end" and row["collision"] == "false"]
    index = [aci(float(row["ego_speed"]), float(row["foe_speed"]), float(row["gap"])) for row in following]
    of = [[float(row[name]) for row in following] for name in ("crash_probability_braking", "crash_probability")]
    on_course = [row for row in rows if row["ttb"]]
    return {
        "braking ~ ACI": list(zip(of[0], index, strict=True)),
        "crash ~ ACI": list(zip(of[1], index, strict=True)),
        "crash ~ ttb": [(float(row["crash_probability"]), -float(row["ttb"])) for row in on_course],
    }


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("logs", nargs="+", type=Path)
    parser.add_argument("--at-least", type=float, default=-1.0, help="of the first and the last, over all logs")
    arguments = parser.parse_args()
    every: list[dict[str, str]] = []
    print("| log | braking ~ ACI | crash ~ ACI | crash ~ ttb |\n|---|---|---|---|")
    for log in arguments.logs:
        with log.open(newline="") as file:
            rows = list(csv.DictReader(file))
        every += rows
        print(f"| {log.parent.parent.name} | {' | '.join(correlation(pairs) for pairs in columns(rows).values())} |")
    overall = columns(every)
    print(f"| all | {' | '.join(correlation(pairs) for pairs in overall.values())} |")
    found = [spearmanr(*zip(*overall[name], strict=True)).statistic for name in ("braking ~ ACI", "crash ~ ttb")]
    return int(min(found) < arguments.at_least)


if __name__ == "__main__":
    sys.exit(main())
