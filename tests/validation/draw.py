"""Severe conflicts drawn at random, as positions alone, for two readers.

python tests/validation/draw.py OUT LOG ... [--count 50] [--seed 1]

Each LOG is a folder of `closecall run --log-clips serious`. Drawn are conflicts that are serious or critical, without
an artefact. Each scenario gives the same number, or all that it has, so that one with many conflicts does not outweigh
the others; logs of one scenario, as with several seeds, are drawn from together. A conflict whose clip begins only
after it has begun is left out, and counted, for readers would not see how it came about. OUT gets cases/NN.csv in
random order, a sheet for the answers of each reader, what they are asked (READ_ME.txt), and, not for them, key.csv.
Which of the two is A is drawn, too.
"""

from __future__ import annotations

import argparse
import csv
import gzip
import json
import math
import random
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

SEVERE = ("serious", "critical")
# The worst first: agreement.py takes their order for a scale.
ANSWERS = ("crash", "near miss", "borderline", "not")
# The log, its row and its clip.
Case = tuple[Path, dict[str, str], dict[str, Any]]
COLUMNS = ("user", "t", "x", "y", "heading", "speed", "length", "width")
QUESTION = """Each file in cases/ has two road users, A and B, ten times a second: t in s, the middle of each as x and y
in m, its heading in rad counter-clockwise from +x, its speed in m/s, its length and width in m. A row is missing
where one is absent. Judge each case by itself, from these alone. Write one of these into your sheet:

crash       they touched, in a way in which road users really could
near miss   it would have ended in a crash but for hard braking or swerving, or for luck
borderline  close enough to be uneasy, but nobody had to do more than one does every day
not         ordinary traffic, or nothing that road users could really do
"""


def severe(log: Path) -> Iterator[tuple[dict[str, str], dict[str, Any]]]:
    """The severe conflicts of a log, each with its clip."""
    clips_file = log / "clips.jsonl.gz"
    if not clips_file.exists():
        sys.exit(f"{log}: it has no clips; run closecall with --log-clips serious")
    with gzip.open(clips_file, "rt") as lines:
        clips = {str(clip["conflict"]): clip for clip in map(json.loads, lines)}
    with (log / "conflicts.csv").open(newline="") as lines:
        for row in csv.DictReader(lines):
            if row["severity"] in SEVERE and not row.get("artefact") and row["id"] in clips:
                yield row, clips[row["id"]]


def shows_how_it_began(case: Case) -> bool:
    """Whether the clip was running when the conflict began."""
    _, row, clip = case
    return bool(clip["times"][0] <= float(row["begin"]))


def scenario(log: Path) -> str:
    """The scenario of a log, or the log's folder where nothing tells it."""
    run = log / "run.json"
    return str(json.loads(run.read_text())["scenario"]) if run.exists() else str(log)


def shares(sizes: list[int], count: int) -> list[int]:
    """How many to take of each scenario: one more of those with the fewest so far, until there are `count`."""
    taken = [0] * len(sizes)
    for _ in range(min(count, sum(sizes))):
        left = (number for number, size in enumerate(sizes) if taken[number] < size)
        taken[min(left, key=taken.__getitem__)] += 1
    return taken


def drawn(found: dict[str, list[Case]], count: int, chance: random.Random) -> list[Case]:
    """Cases of all scenarios, in random order; which scenarios give one more than others is drawn, too."""
    names = sorted(found)
    chance.shuffle(names)
    numbers = shares([len(found[name]) for name in names], count)
    cases = [case for name, number in zip(names, numbers) for case in chance.sample(found[name], number)]
    chance.shuffle(cases)
    return cases


def positions(clip: dict[str, Any], names: tuple[str, str]) -> Iterator[list[str]]:
    """The rows of a case; a clip has its ego and foe first, and the places of their fronts."""
    for name, user in sorted(zip(names, clip["users"])):
        half = user["length"] / 2
        for time, x, y, heading, speed in zip(clip["times"], *(user[key] for key in ("x", "y", "heading", "speed"))):
            if x is not None:
                middle = (x - half * math.cos(heading), y - half * math.sin(heading))
                numbers = (time - clip["times"][0], *middle, heading, speed, user["length"], user["width"])
                yield [name, *(f"{number:.3f}" for number in numbers)]


def write(file: Path, header: tuple[str, ...], rows: Iterator[list[str]] | list[list[str]]) -> None:
    """A table."""
    with file.open("w", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)


def main() -> None:
    """Draw, and write what the readers get and what they do not."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, metavar="OUT")
    parser.add_argument("logs", type=Path, nargs="+", metavar="LOG")
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    chance = random.Random(arguments.seed)
    found: dict[str, list[Case]] = {}
    for log in arguments.logs:
        rows = [(log, *both) for both in severe(log) if "outlines" not in both[1]["users"][1]]
        found.setdefault(scenario(log), []).extend(rows)
    shown = {name: list(filter(shows_how_it_began, cases)) for name, cases in found.items()}
    chosen = drawn(shown, arguments.count, chance)
    cases = arguments.out / "cases"
    cases.mkdir(parents=True)
    key = []
    for number, (log, row, clip) in enumerate(chosen, 1):
        names = ("A", "B") if chance.random() < 0.5 else ("B", "A")
        write(cases / f"{number:02}.csv", COLUMNS, positions(clip, names))
        key.append([f"{number:02}", str(log), row["id"], row["severity"], row["kind"]])
    write(arguments.out / "key.csv", ("case", "log", "conflict", "severity", "kind"), key)
    for reader in (1, 2):
        write(arguments.out / f"answers_{reader}.csv", ("case", "answer"), [[row[0], ""] for row in key])
    (arguments.out / "READ_ME.txt").write_text(QUESTION)
    of, kept = (sum(map(len, cases.values())) for cases in (found, shown))
    print(f"{len(chosen)} of {of} severe conflicts drawn into {arguments.out}; scenarios: {len(found)}")
    if kept < of:
        print(f"left out because their clips begin too late: {of - kept}")


if __name__ == "__main__":
    main()
