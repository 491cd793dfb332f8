"""The cost of the checker in an attached run: SUMO with closecall, or with its device.ssm, over plain SUMO in libsumo.

    python benches/attached.py [--runs N] [CONFIG ...]

Measures the bench's simulations, or 600 s of each CONFIG. closecall is also compared with the program `sumo`, which is
faster than libsumo.

Times are those of whole processes, start-up included. Each run is compared with a plain run beside it: the two run in
alternate slices of 50 ms, so that whatever slows the machine down slows both. The figure is the median over N pairs,
over a third as many for the program and for the slow device.ssm. In twelve pairs of plain runs the two
differed by 2 % in the median and 13 % at worst.
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

from scenarios import attached, end, plain, program, scenarios, ssm

SLICE = 0.05
"""Length of a slice in s."""


class Stopped:
    """A process that runs, with all its threads, only in its own slices."""

    def __init__(self, command: list[str]) -> None:
        """Start the process and stop it at once."""
        self.seconds = 0.0
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        self.process.send_signal(signal.SIGSTOP)
        self.descriptor = os.pidfd_open(self.process.pid)
        self.end = select.poll()
        self.end.register(self.descriptor)

    def run(self) -> bool:
        """Run the process for a slice; returns whether it is still alive."""
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
        """Kill the process if it has not ended."""
        self.process.kill()
        self.process.wait()
        os.close(self.descriptor)


def in_turns(*commands: list[str]) -> list[float]:
    """The wall time of each command in s, all run in alternate slices."""
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
    """Print one line per scenario and comparison."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument(
        "configs", metavar="CONFIG", nargs="*", type=Path, help="SUMO configurations to measure instead of the bench's"
    )
    options = parser.parse_args()
    runs = options.runs
    print("what,scene,method,size,value,unit")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        own = {str(config): config for config in options.configs}
        for scene, config in (own or scenarios(folder)).items():
            alone, checked = plain(config), attached(config, folder / "out")
            comparisons = [
                ("over plain", "closecall", alone, checked, runs),
                ("over program", "closecall", program(config), checked, (runs + 2) // 3),
                ("over plain", "device.ssm", alone, ssm(config, folder / "ssm.xml"), (runs + 2) // 3),
            ]
            for what, method, base, command, turns in comparisons:
                pairs = [in_turns(base, command) for _ in range(turns)]
                if (what, method) == ("over plain", "closecall"):
                    seconds = statistics.median(plainly for plainly, _ in pairs)
                    print(f"run,{scene},plain,{end(config)},{seconds:.3f},s")
                ratio = statistics.median(longer / shorter for shorter, longer in pairs)
                print(f"{what},{scene},{method},{end(config)},{ratio:.3f},times", flush=True)


if __name__ == "__main__":
    main()
