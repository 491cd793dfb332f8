"""Conflicts on the paths that were driven, compared with those on the lanes' paths.

    python tests/accuracy/driven.py [SCENARIO ...]

Each scenario of sumo_nets/ is recorded once, in steps of 0.1 s, and replayed with `--path lanes` and `--path driven`. Two
conflicts are the same if they are of the same two road users, of the same kind, and overlap in time. What is left is counted by
what the two did within 10 s of the conflict: one changed lanes, or one stood.
"""

from __future__ import annotations

import csv
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from pathlib import Path

NETS = Path(__file__).parents[2] / "sumo_nets"
SCENARIOS = ["left_turn", "roundabout", "reckless", "priority", "town"]
BIN = Path(sys.executable).parent
WITHIN = 10.0
"""Seconds after a conflict's beginning that its explanation is looked for."""
Row = dict[str, str]


def record(name: str, file: Path) -> Path:
    words = ["--step-length", "0.1", "--fcd-output", file, "--fcd-output.attributes", "all", "--precision", "6"]
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


def lanes_of(recording: Path) -> dict[str, list[tuple[float, str, float]]]:
    """By road user: each step's time, lane and speed."""
    found: dict[str, list[tuple[float, str, float]]] = defaultdict(list)
    time = 0.0
    with recording.open() as file:
        for row in csv.DictReader(file, delimiter=";"):
            time = float(row["timestep_time"])
            if row["vehicle_id"]:
                found[row["vehicle_id"]].append((time, row["vehicle_lane"], float(row["vehicle_speed"])))
    return found


def same(a: Row, b: Row) -> bool:
    return (
        {a["ego"], a["foe"]} == {b["ego"], b["foe"]}
        and a["kind"] == b["kind"]
        and float(a["begin"]) <= float(b["end"])
        and float(b["begin"]) <= float(a["end"])
    )


def why(row: Row, lanes: dict[str, list[tuple[float, str, float]]]) -> str:
    """What the two did that may explain a conflict that only one of the paths has."""
    begin = float(row["begin"])
    reasons = set()
    for user in (row["ego"], row["foe"]):
        steps = [step for step in lanes.get(user, []) if begin - 1 <= step[0] <= float(row["end"]) + WITHIN]
        for (_, before, _), (_, after, _) in zip(steps, steps[1:]):
            if before != after and before.rpartition("_")[0] == after.rpartition("_")[0]:
                reasons.add("changed lanes")
        if steps and min(speed for _, _, speed in steps) < 0.1:
            reasons.add("stood")
    return next((reason for reason in ("changed lanes", "stood") if reason in reasons), "neither")


def main() -> None:
    print("scenario     lanes driven  same   only lanes / only driven")
    for name in sys.argv[1:] or SCENARIOS:
        with tempfile.TemporaryDirectory() as folder:
            recording = record(name, Path(folder) / f"{name}.csv")
            conflicts = {
                path: replay(name, recording, Path(folder) / path, "--path", path) for path in ("lanes", "driven")
            }
            lanes = lanes_of(recording)
            left = {}
            for path, other in (("lanes", "driven"), ("driven", "lanes")):
                left[path] = [one for one in conflicts[path] if not any(same(one, it) for it in conflicts[other])]
            counts = {path: Counter(why(one, lanes) for one in left[path]) for path in left}
            total = {path: len(rows) for path, rows in conflicts.items()}
            both = total["lanes"] - len(left["lanes"])
            told = " / ".join(f"{len(left[path])} {dict(counts[path])}" for path in left)
            print(f"{name:12} {total['lanes']:5} {total['driven']:6} {both:5}   {told}")
            if "-v" in sys.argv or len(sys.argv) == 2:
                for path, rows in left.items():
                    for one in rows:
                        keys = ("kind", "ego", "foe", "begin", "end", "margin", "ego_speed", "foe_speed", "manoeuvre")
                        print(f"   only {path}:", *(one.get(key, "") for key in keys), why(one, lanes))


if __name__ == "__main__":
    main()
