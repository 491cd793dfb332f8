"""The crash rate of a scenario with drivers that respond late now and then, by plain simulation: for `closecall rare`.

python tests/calibration/plain.py FOLDER SCENARIO --share Q --seeds N [--workers N] [-- SUMO OPTIONS]
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HORIZON = 8.0
"""A contact at most this long after the error counts, in s, as in a roll-out."""


def crashes(folder: Path) -> tuple[int, float]:
    """The crashes of a run that follow from errors, each once, also where both erred, and its simulated hours."""
    errors = json.loads((folder / "roll-out.json").read_text())["drivers"]
    with (folder / "conflicts.csv").open() as file:
        collisions = [row for row in csv.DictReader(file) if row["collision"] == "true" and not row["artefact"]]
    count, struck = 0, set[str]()
    for error in sorted((error for error in errors if error["from"] is not None), key=lambda error: error["from"]):
        within = error["from"] - 1.0, error["from"] + HORIZON
        hit = [row for row in collisions if error["id"] in (row["ego"], row["foe"])]
        hit = [row for row in hit if within[0] <= float(row["time"]) <= within[1]]
        involved = {name for row in hit for name in (row["ego"], row["foe"])}
        count += bool(hit) and not involved & struck
        struck |= involved
    summary = json.loads((folder / "run.json").read_text())["summary"]
    return count, (summary["end"] - summary["begin"]) / 3600.0


def main() -> None:
    """Print the rate."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("scenario", type=Path)
    parser.add_argument("--share", type=float, required=True)
    parser.add_argument("--seeds", type=int, required=True)
    parser.add_argument("--workers", type=int, default=2)
    asked, sumo = parser.parse_known_args()

    def run(seed: int) -> tuple[int, float]:
        out = asked.folder / f"seed-{seed}"
        lapses = json.dumps({"lapses": {"share": asked.share, "seed": seed}})
        words = [
            "closecall",
            "run",
            asked.scenario,
            "--seed",
            str(seed),
            "--threads",
            "1",
            "--log-clips",
            "none",
            "--quiet",
        ]
        words += ["--roll-out", lapses, "--force", "--out", out, "--", "--collision.action", "none", *sumo]
        subprocess.run(words, check=True)
        return crashes(out)

    begun = time.perf_counter()
    with ThreadPoolExecutor(asked.workers) as pool:
        found = list(pool.map(run, range(1, asked.seeds + 1)))
    count, hours = sum(one[0] for one in found), sum(one[1] for one in found)
    spent = time.perf_counter() - begun
    rate, half = count / hours, 1.96 * math.sqrt(max(count, 1)) / hours
    print(f"{count} crashes in {hours:.2f} h: {rate:.3f} per hour ± {half:.3f}, {spent:.0f} s")


if __name__ == "__main__":
    main()
