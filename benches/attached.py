"""What the checker costs an attached run: plain SUMO, SUMO with the checker, SUMO with its own device.ssm.

    python benches/attached.py [--runs N]

Whole processes, start-up included, in turns, so that what slows the machine down slows all of them; each figure is the
smallest of its runs. device.ssm, which takes minutes, has a turn in every third.
"""

from __future__ import annotations

import argparse
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
                "plain": plain(config),
                "closecall": attached(config, folder / "out"),
                "device.ssm": ssm(config, folder / "ssm.xml"),
            }
            least = dict.fromkeys(commands, float("inf"))
            for run in range(runs):
                for method, command in commands.items():
                    if method == "device.ssm" and run % 3 > 0:
                        continue
                    least[method] = min(least[method], seconds(command))
            for method, wall in least.items():
                print(f"run,{scene},{method},{end(config)},{wall:.3f},s", flush=True)


if __name__ == "__main__":
    main()
