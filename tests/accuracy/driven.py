"""Conflicts on the paths that were driven, compared with those on the lanes' paths.

    python tests/accuracy/driven.py [SCENARIO ...]

Each scenario of sumo_nets/ is recorded once, in steps of 0.1 s, and replayed with `--path lanes` and `--path driven`.
Two conflicts are the same if they are of the same two road users and the same kind, and overlap in time. What is left
is counted by what may explain it: the other path gives them another kind at that time; or within 10 s one of the two
jumped to another lane; or one stood.
"""

from __future__ import annotations

import csv
import math
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from pathlib import Path
from typing import NamedTuple

NETS = Path(__file__).parents[2] / "sumo_nets"
SCENARIOS = ["left_turn", "roundabout", "reckless", "priority", "signals", "motorway"]
BIN = Path(sys.executable).parent
ASIDE = 1.0
"""Metres to the side within one step that are a change of lanes."""
WITHIN = 10.0
"""Seconds after a conflict's beginning that its explanation is looked for."""
Row = dict[str, str]


def record(name: str, file: Path, step: str = "0.1") -> Path:
    words = ["--step-length", step, "--fcd-output", file, "--fcd-output.attributes", "all", "--precision", "6"]
    config = NETS / name / f"{name}.sumocfg"
    subprocess.run([BIN / "sumo", "-c", config, *words], check=True, capture_output=True)
    return file


def replay(name: str, recording: Path, out: Path, *words: str) -> list[Row]:
    net, routes = (NETS / name / f"{name}.{ending}" for ending in ("net.xml", "rou.xml"))
    config = NETS / name / "closecall.toml"
    files: list[str | Path] = ["--net", net, "--route-files", routes]
    if config.is_file():
        files += ["--config", config]
    words = ("--quiet", "--out", str(out), *words)
    subprocess.run([BIN / "closecall", "replay", recording, *files, *words], check=True)
    with (out / "conflicts.csv").open() as file:
        return list(csv.DictReader(file))


class Step(NamedTuple):
    time: float
    x: float
    y: float
    angle: float
    speed: float


def steps_of(recording: Path) -> dict[str, list[Step]]:
    """By vehicle: its steps."""
    found: dict[str, list[Step]] = defaultdict(list)
    with recording.open() as file:
        for row in csv.DictReader(file, delimiter=";"):
            if row["vehicle_id"]:
                values = (float(row[f"vehicle_{name}"]) for name in ("x", "y", "angle", "speed"))
                found[row["vehicle_id"]].append(Step(float(row["timestep_time"]), *values))
    return found


def overlap(a: Row, b: Row) -> bool:
    return (
        {a["ego"], a["foe"]} == {b["ego"], b["foe"]}
        and float(a["begin"]) <= float(b["end"])
        and float(b["begin"]) <= float(a["end"])
    )


def same(a: Row, b: Row) -> bool:
    return overlap(a, b) and a["kind"] == b["kind"]


def jumps(before: Step, after: Step) -> bool:
    """Whether a vehicle is put on another lane."""
    course = math.radians(90 - before.angle)
    east, north = after.x - before.x, after.y - before.y
    return abs(north * math.cos(course) - east * math.sin(course)) > ASIDE


def why(row: Row, others: list[Row], steps_of: dict[str, list[Step]]) -> str:
    """What may explain a conflict that only one of the paths has."""
    if any(overlap(row, other) for other in others):
        return "other kind"
    first, last = float(row["begin"]) - 1, float(row["end"]) + WITHIN
    steps = [[step for step in steps_of.get(row[who], []) if first <= step.time <= last] for who in ("ego", "foe")]
    if any(jumps(*pair) for of in steps for pair in zip(of, of[1:])):
        return "changed lanes"
    return "stood" if any(step.speed < 0.1 for of in steps for step in of) else "neither"


def main() -> None:
    print("scenario     lanes driven  same   only lanes / only driven")
    others = {"lanes": "driven", "driven": "lanes"}
    for name in sys.argv[1:] or SCENARIOS:
        with tempfile.TemporaryDirectory() as folder:
            recording = record(name, Path(folder) / f"{name}.csv")
            found = {path: replay(name, recording, Path(folder) / path, "--path", path) for path in others}
            steps = steps_of(recording)
        told, left = [], {}
        for path, other in others.items():
            left[path] = [one for one in found[path] if not any(same(one, it) for it in found[other])]
            counts = Counter(why(one, found[other], steps) for one in left[path]).most_common()
            told.append(f"{len(left[path])} ({', '.join(f'{count} {reason}' for reason, count in counts)})")
        both = len(found["lanes"]) - len(left["lanes"])
        print(f"{name:12} {len(found['lanes']):5} {len(found['driven']):6} {both:5}   {' / '.join(told)}")
        for path, other in others.items():
            for one in left[path] if len(sys.argv) == 2 else []:
                values = (one[key] for key in ("kind", "ego", "foe", "begin", "end", "margin", "manoeuvre"))
                print(f"   only {path}:", *values, why(one, found[other], steps))


if __name__ == "__main__":
    main()
