"""What `closecall replay` reports for each pair of a recording in each step.

Only the public command is used. The condition keeps every step in which one of the two would reach the other within
10 s, would have to respond within 5 s, or has a negative margin: the steps of the default condition are among them.
"""

from __future__ import annotations

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

from tracks import COLUMNS, TICK

CONDITION = "ttc < 10 or response_left < 5 or margin < 0"
ADDED_MEASURES = "act,mttc"
PATHS = ("driven", "arc")

# The steps of a pair: the tick, and the row of the series.
Steps = dict[int, dict[str, str]]


def replay(recording: Path, path: str, smooth: bool, condition: str = CONDITION) -> dict[frozenset[str], Steps]:
    """The steps of each pair that meets the condition."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "closecall", "replay", str(recording), "--path", path, "--log", condition]
        command += [*columns_of(recording), "--log-series", "--log-clips", "none", "--quiet"]
        command += ["--measures", ADDED_MEASURES, "--out", folder, *(["--smooth"] if smooth else [])]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{recording}: {done.stderr.strip()}")
        with (Path(folder) / "conflicts.csv").open(newline="") as lines:
            conflicts = {row["id"]: row for row in csv.DictReader(lines)}
        found: dict[frozenset[str], Steps] = {}
        with (Path(folder) / "series.csv").open(newline="") as lines:
            for row in csv.DictReader(lines):
                of_event = conflicts[row["conflict"]]
                pair = frozenset((of_event["ego"], of_event["foe"]))
                artefact = {"artefact": of_event["artefact"]} if "artefact" in of_event else {}
                found.setdefault(pair, {})[round(float(row["time"]) / TICK)] = row | artefact
    return found


def columns_of(recording: Path) -> list[str]:
    """What tells the command the columns of a table; it knows those of INTERACTION."""
    with recording.open(newline="") as lines:
        header = next(csv.reader(lines))
    named = [("time" if name == "t" else name, name) for name in COLUMNS if name in header]
    return ["--columns", ",".join(f"{what}={name}" for what, name in named)] if "heading" in header else []
