"""What the checker costs an attached run: plain SUMO, SUMO with the checker, SUMO with its own device.ssm.

    python benches/attached.py [--runs N]

Whole processes, start-up included, in turns. Each is compared with the plain run of its own turn, so that what slows
the machine down for minutes slows both; the figure is the median of the turns. device.ssm, which takes minutes, has a
turn in every third.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from scenarios import attached, end, plain, scenarios, ssm


def seconds(command: list[str]) -> float:
    """Wall time of a process."""
    started = time.perf_counter()
    ended = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if ended.returncode:
        sys.exit(f"{' '.join(command)}: exit status {ended.returncode}\n{ended.stderr}")
    return time.perf_counter() - started


def main() -> None:
    """Print one line per scenario and way to run it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=6)
    runs = parser.parse_args().runs
    print("what,scene,method,size,value,unit")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for scene, config in scenarios(folder).items():
            commands = {
                "closecall": attached(config, folder / "out"),
                "device.ssm": ssm(config, folder / "ssm.xml"),
            }
            alone: list[float] = []
            ratios: dict[str, list[float]] = {method: [] for method in commands}
            for run in range(runs):
                alone.append(seconds(plain(config)))
                for method, command in commands.items():
                    if method == "closecall" or run % 3 == 0:
                        ratios[method].append(seconds(command) / alone[-1])
            print(f"run,{scene},plain,{end(config)},{statistics.median(alone):.3f},s")
            for method, turns in ratios.items():
                ratio = statistics.median(turns)
                print(f"over plain,{scene},{method},{end(config)},{ratio:.3f},times", flush=True)


if __name__ == "__main__":
    main()
