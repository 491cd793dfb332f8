"""What the checker costs a script of one's own: with plain frames, and with traci over its socket.

    python benches/scripts.py FOLDER

FOLDER contains the scenes of benches/detector.rs (`cargo bench --bench detector -- --scenes FOLDER`), whose road users
go to and fro in the same steps here. A figure is the median of the steps. Reading a frame is what one takes that is
refused at its last row. traci's scripts run to the end of the grid and of the town, with a checker and without.
"""

from __future__ import annotations

import csv
import statistics
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import closecall
import numpy as np
from scenarios import end, grid

TIMES = [0.0, 0.1, 0.2, 0.3, 0.2, 0.1]
"""Times of the steps in s, to and fro, as in benches/scenes/mod.rs."""
ROUNDS = 10

TRACI = """
import sys, time, traci
from sumo import SUMO_HOME
end, checked, *words = sys.argv[1:]
traci.start([f"{SUMO_HOME}/bin/sumo", *words, "--no-step-log", "--no-warnings"], stdout=open("/dev/null", "w"))
if checked == "checked":
    import closecall
    checker = closecall.Checker(traci)
    traci.addStepListener(checker)
started = time.perf_counter()
while traci.simulation.getTime() < float(end) and traci.simulation.getMinExpectedNumber() > 0:
    traci.simulationStep()
print(time.perf_counter() - started)
traci.close()
"""


def frames(path: Path) -> tuple[float, float]:
    """The time of a step with a frame, and of reading the frame alone, in s."""
    with path.open() as file:
        rows = list(csv.DictReader(file))
    x, y, heading, length, speed = (
        np.array([float(row[name]) for row in rows]) for name in ("x", "y", "heading", "length", "speed")
    )
    ahead = np.cos(heading), np.sin(heading)
    x, y = x + ahead[0] * length / 2, y + ahead[1] * length / 2
    ids = [str(number) for number in range(len(rows))]
    steps, refusals = [], []
    checker = closecall.Checker(keep=0)
    for number, moved in enumerate(TIMES * ROUNDS):
        frame = {
            "id": ids,
            "x": x + ahead[0] * speed * moved,
            "y": y + ahead[1] * speed * moved,
            "heading": heading,
            "speed": speed,
        }
        refused = {**frame, "id": [*ids[:-1], ids[0]]}
        started = time.perf_counter()
        checker.step(number * 0.1, frame)
        ended = time.perf_counter()
        with suppress(ValueError):
            checker.step(number * 0.1 + 0.01, refused)
        steps.append(ended - started)
        refusals.append(time.perf_counter() - ended)
    checker.close()
    return statistics.median(steps), statistics.median(refusals)


def seconds(config: Path, how: str) -> float:
    """The wall time of the steps of traci's script: to connect it waits for a second."""
    command = [sys.executable, "-c", TRACI, end(config), how, "-c", str(config)]
    return float(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.split()[-1])


def main() -> None:
    """Print a line per scene."""
    print("what,scene,method,size,value,unit")
    for path in sorted(Path(sys.argv[1]).glob("*-*.csv")):
        scene, size = path.stem.split("-")
        for method, taken in zip(("frames", "frames read"), frames(path)):
            print(f"step,{scene},{method},{size},{taken / int(size) * 1e9:.1f},ns per road user", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for scene, config in {"grid": grid(Path(folder)), "town": Path("sumo_nets/town/town.sumocfg")}.items():
            ratio = seconds(config, "checked") / seconds(config, "alone")
            print(f"over plain,{scene},traci,{end(config)},{ratio:.3f},times", flush=True)


if __name__ == "__main__":
    main()
