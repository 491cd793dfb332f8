"""Conflicts drawn at random from each severity of a log, in random order and without severity, for a reader to judge.

python tests/accuracy/reading.py LOG [--each 25] [--seed 2] [--key]

LOG needs clips (`closecall run --log-clips serious`, or `caution`). A line has the number of the conflict, the kind,
the manoeuvre and both types, and then, every 0.5 s from 1 s before to 2 s after the worst step (*): the distance
between the two rectangles in m (! where they overlap), the foe's place ahead and to the left of the ego's front in m,
and the speeds of both in m/s. `--key` prints severity, crash probability, time to brake and collision instead.
"""

from __future__ import annotations

import argparse
import csv
import gzip
import json
import math
import random
from pathlib import Path
from typing import Any

from shapely.geometry import Polygon

SEVERITIES = ("critical", "serious", "caution")
BEFORE, AFTER, EVERY = 1.0, 2.0, 0.5
# Less overlap, in m², is rounding.
OVERLAP = 0.02


def rectangle(user: dict[str, Any], step: int) -> Polygon:
    """Where a road user stands; its x and y are its front's."""
    x, y, heading = (user[name][step] for name in ("x", "y", "heading"))
    cosine, sine, half = math.cos(heading), math.sin(heading), user["width"] / 2
    corners = ((0, half), (0, -half), (-user["length"], -half), (-user["length"], half))
    return Polygon([(x + a * cosine - b * sine, y + a * sine + b * cosine) for a, b in corners])


def moment(ego: dict[str, Any], foe: dict[str, Any], step: int) -> str:
    """The pair in a step."""
    if ego["x"][step] is None or foe["x"][step] is None:
        return "absent"
    rectangles = [rectangle(user, step) for user in (ego, foe)]
    touch = "!" if rectangles[0].intersection(rectangles[1]).area > OVERLAP else ""
    to = [foe[name][step] - ego[name][step] for name in ("x", "y")]
    cosine, sine = math.cos(ego["heading"][step]), math.sin(ego["heading"][step])
    ahead, left = to[0] * cosine + to[1] * sine, to[1] * cosine - to[0] * sine
    distance = rectangles[0].distance(rectangles[1])
    return f"{distance:.1f}{touch} ({ahead:.0f}, {left:.1f}) {ego['speed'][step]:.1f}/{foe['speed'][step]:.1f}"


def trace(row: dict[str, str], clip: dict[str, Any]) -> str:
    """The seconds around a conflict."""
    users = {user["id"]: user for user in clip["users"]}
    times, worst = clip["times"], float(row["time"])
    shown = []
    for number in range(round(-BEFORE / EVERY), round(AFTER / EVERY) + 1):
        step = min(range(len(times)), key=lambda index: abs(times[index] - worst - number * EVERY))
        if abs(times[step] - worst - number * EVERY) < EVERY / 2:
            shown.append(("*" if number == 0 else "") + moment(users[row["ego"]], users[row["foe"]], step))
    return " | ".join(shown)


def main() -> None:
    """Print a line for each conflict."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("log", type=Path)
    parser.add_argument("--each", type=int, default=25, help="conflicts of each severity")
    parser.add_argument("--seed", type=int, default=2)
    parser.add_argument("--key", action="store_true", help="print what closecall says instead")
    options = parser.parse_args()
    with (options.log / "conflicts.csv").open(newline="") as file:
        rows = {int(row["id"]): row for row in csv.DictReader(file)}
    with gzip.open(options.log / "clips.jsonl.gz", "rt") as file:
        clips = {clip["conflict"]: clip for clip in map(json.loads, file)}
    chance = random.Random(options.seed)
    chosen = []
    for severity in SEVERITIES:
        known = sorted(number for number in clips if rows[number]["severity"] == severity)
        chosen += chance.sample(known, min(options.each, len(known)))
    chance.shuffle(chosen)
    for number in chosen:
        row = rows[number]
        if options.key:
            print(number, *(row[name] for name in ("severity", "crash_probability", "ttb", "collision")))
        else:
            words = (row[name] for name in ("kind", "manoeuvre", "ego_type", "foe_type"))
            print(number, *words, trace(row, clips[number]))


if __name__ == "__main__":
    main()
