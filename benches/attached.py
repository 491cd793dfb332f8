"""What the checker costs an attached run: plain SUMO, SUMO with the checker, SUMO with its own device.ssm.

    python benches/attached.py [--runs N] [CONFIG ...]

On the bench's own simulations, or on those of these configurations, until 600 s.

Whole processes, start-up included. Each is compared with a plain run beside it: in slices of 50 ms one of the two runs
while the other is stopped, so that what slows the machine down slows both. The figure is the median of the runs;
device.ssm, which takes long, has one. Of twelve pairs of plain runs the two differed by 2 % (median), 13 % at worst.
"""

from __future__ import annotations

import argparse
import os
import select
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from scenarios import attached, end, plain, scenarios, ssm

SLICE = 0.05
"""How long one runs before the other does, in s."""


class Stopped:
    """A process that runs when it is its turn, with all its threads."""

    def __init__(self, command: list[str]) -> None:
        """Start it, and stop it at once."""
        self.seconds = 0.0
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        self.process.send_signal(signal.SIGSTOP)
        self.descriptor = os.pidfd_open(self.process.pid)
        self.end = select.poll()
        self.end.register(self.descriptor)

    def run(self) -> bool:
        """Let it run for a slice; whether there is more to do."""
        started = time.perf_counter()
        self.process.send_signal(signal.SIGCONT)
        has_ended = bool(self.end.poll(SLICE * 1000))
        if not has_ended:
            self.process.send_signal(signal.SIGSTOP)
        self.seconds += time.perf_counter() - started
        if has_ended and self.process.wait():
            sys.exit(f"{self.process.args!r}: exit status {self.process.returncode}")
        return not has_ended

    def close(self) -> None:
        """Kill it if it has not ended."""
        self.process.kill()
        self.process.wait()
        os.close(self.descriptor)


def in_turns(*commands: list[str]) -> list[float]:
    """Wall time of each of these, slice after slice until all have ended."""
    processes = [Stopped(command) for command in commands]
    try:
        running = processes
        while running:
            running = [each for each in running if each.run()]
    finally:
        for each in processes:
            each.close()
    return [each.seconds for each in processes]


def main() -> None:
    """Print one line per scenario and way to run it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument(
        "configs", metavar="CONFIG", nargs="*", type=Path, help="SUMO configurations to measure instead"
    )
    options = parser.parse_args()
    runs = options.runs
    print("what,scene,method,size,value,unit")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        own = {str(config): config for config in options.configs}
        for scene, config in (own or scenarios(folder)).items():
            ways = {
                "closecall": (attached(config, folder / "out"), runs),
                "device.ssm": (ssm(config, folder / "ssm.xml"), 1),
            }
            alone: list[float] = []
            ratios: dict[str, list[float]] = {method: [] for method in ways}
            for method, (command, turns) in ways.items():
                for _ in range(turns):
                    plainly, seconds = in_turns(plain(config), command)
                    alone.append(plainly)
                    ratios[method].append(seconds / plainly)
            print(f"run,{scene},plain,{end(config)},{statistics.median(alone):.3f},s")
            for method, compared in ratios.items():
                ratio = statistics.median(compared)
                print(f"over plain,{scene},{method},{end(config)},{ratio:.3f},times", flush=True)


if __name__ == "__main__":
    main()
