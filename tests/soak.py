"""A soak: many vehicle-steps through one checker, as in a simulated week; memory and open files must stay flat.

    python tests/soak.py [--vehicle-steps 1e8]

Vehicles drive in platoons that close up and spread again. Each leaves after a while, and one with a new id takes its
place, so that whatever is kept of those that are gone shows up.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

import closecall
import numpy as np

VEHICLES = 1000
STEP = 0.5
"""In s."""
LIFE = 400
"""Steps that a vehicle stays."""
PARTS = 10
MOST = 1.05
"""Memory at the end, relative to that after the first two tenths: what is allocated once is there by then."""


def memory() -> float:
    """Resident memory of this process in MB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6


def main() -> int:
    """Print memory, open files and speed, tenth by tenth; returns 1 if they grow."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--vehicle-steps", type=float, default=1e8)
    steps = int(parser.parse_args().vehicle_steps / VEHICLES)
    place = np.arange(VEHICLES)
    lane, row = place % 20, place // 20
    phase = place * 0.7
    ids = [f"v{number}" for number in place]
    entered = VEHICLES
    found: list[tuple[float, int]] = []
    with tempfile.TemporaryDirectory() as folder:
        checker = closecall.Checker(out=Path(folder, "log"))
        begun = time.perf_counter()
        print("share  vehicle-steps  simulated h  vehicles  conflicts  memory MB  open files  vehicle-steps/s")
        for step in range(steps):
            for slot in range(step % LIFE, VEHICLES, LIFE):
                ids[slot] = f"v{entered}"
                entered += 1
            now = step * STEP
            swing = np.sin(0.05 * now + phase)
            frame = {
                "id": ids,
                "x": row * 25.0 + 4.3 * swing + (13.0 * now) % 1e4,
                "y": lane * 3.5,
                "heading": np.zeros(VEHICLES),
                "speed": 13.0 + 4.3 * 0.05 * np.cos(0.05 * now + phase),
            }
            checker.step(now, frame)
            if (step + 1) % (steps // PARTS) == 0:
                found.append((memory(), len(list(Path("/proc/self/fd").iterdir()))))
                done = (step + 1) * VEHICLES
                rows = Path(folder, "log", "conflicts.csv").read_bytes().count(b"\n") - 1
                print(
                    f"{(step + 1) / steps:5.0%}  {done:13,}  {now / 3600:11.1f}  {entered:8,}  {rows:9,}  "
                    f"{found[-1][0]:9.1f}  {found[-1][1]:10}  {done / (time.perf_counter() - begun):15,.0f}",
                    flush=True,
                )
        checker.close()
    (early, files), (late, files_late) = found[1], found[-1]
    if late > MOST * early or files_late > files:
        print(f"grew from {early:.1f} MB and {files} files to {late:.1f} MB and {files_late} files")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
