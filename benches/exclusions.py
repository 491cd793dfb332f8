"""The time that each exclusion saves: runs that keep one exclusion's work, against runs that leave all of it out.

    python benches/exclusions.py [--runs N] [--town S] [--motorway S]

Runs the town of sumo_nets and SUMO's motorway (tools/game/A10KW), attached, on one thread, headless, in turns. Each
figure is the fastest run: the time of all parts but SUMO's, in ns per road user and step.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from scenarios import motorway

NETS = Path(__file__).parents[1] / "sumo_nets"
EXCLUSIONS = ["areas-apart", "paths-apart", "in-line", "known-paths", "known-chances"]
PART = re.compile(r"([a-z0-9 ]+?) ([0-9.]+) s")


def nanoseconds(config: Path, end: float, out: Path, keep: str | None) -> float:
    """The time of all parts but SUMO's, in ns per road user and step."""
    words = [
        "run",
        config,
        "--end",
        end,
        "--out",
        out,
        "--threads",
        1,
        "--explain",
        *([f"--no-shortcuts={keep}"] if keep else []),
    ]
    command = [sys.executable, "-m", "closecall", *map(str, words), "--", "--no-warnings"]
    output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    parts = dict(PART.findall(output.rsplit("time:", 1)[1].splitlines()[0]))
    spent = sum(float(seconds) for part, seconds in parts.items() if part.strip(" ,") != "SUMO")
    summary = json.loads((out / "run.json").read_text())["summary"]
    step = (summary["end"] - summary["begin"]) / (summary["steps"] - 1)
    rows: float = summary["exposure"]["vehicle_hours"] * 3600 / step
    return spent * 1e9 / rows


def main() -> None:
    """Print a row per exclusion and scene."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=2)
    parser.add_argument("--town", type=float, default=40, help="end of the town, in s")
    parser.add_argument("--motorway", type=float, default=60, help="end of the motorway, in s")
    options = parser.parse_args()
    print("what,scene,method,size,value,unit")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        ends = {"town": options.town, "motorway": options.motorway}
        configs = {"town": NETS / "town" / "town.sumocfg", "motorway": motorway(folder)}
        for scene, config in configs.items():
            best = dict.fromkeys([None, *EXCLUSIONS], float("inf"))
            for _ in range(options.runs):
                for keep in best:
                    best[keep] = min(best[keep], nanoseconds(config, ends[scene], folder / "out", keep))
            for keep, least in best.items():
                method = f"keep {keep}" if keep else "closecall"
                print(f"kept,{scene},{method},{ends[scene]:.0f},{least:.0f},ns per road user", flush=True)
                if keep:
                    print(
                        f"longer,{scene},{method},{ends[scene]:.0f},{least / best[None]:.4f},times closecall",
                        flush=True,
                    )


if __name__ == "__main__":
    main()
