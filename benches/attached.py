"""What the checker costs: plain SUMO, SUMO with the checker attached and logging, SUMO with its own device.ssm.

    python benches/attached.py [--runs N] [--scenario FILE.sumocfg --end S]

Without a scenario: a grid of 10 by 10 signalised junctions with some 1,700 vehicles. Whole processes, interleaved;
each figure is the smallest of its runs, start-up included.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

BIN = Path(sys.executable).parent
GRID = ["--grid", "--grid.number", "10", "--grid.length", "200", "-L", "2", "-j", "traffic_light"]


def grid(folder: Path) -> Path:
    """Make the grid and its demand."""
    import sumo

    net, trips = folder / "grid.net.xml", folder / "grid.rou.xml"
    tools = Path(sumo.SUMO_HOME) / "tools"
    quiet = {"check": True, "stdout": subprocess.DEVNULL}
    subprocess.run([BIN / "netgenerate", *GRID, "-o", net], **quiet)
    trip = [sys.executable, tools / "randomTrips.py", "-n", net, "-o", folder / "trips.xml", "-r", trips]
    environment = {**os.environ, "SUMO_HOME": str(sumo.SUMO_HOME), "PATH": f"{BIN}:{os.environ['PATH']}"}
    subprocess.run([*trip, "-e", "600", "-p", "0.2", "--seed", "1"], env=environment, cwd=folder, **quiet)
    config = folder / "grid.sumocfg"
    config.write_text(
        f'<configuration><net-file value="{net}"/><route-files value="{trips}"/>'
        '<begin value="0"/><end value="600"/><no-warnings value="true"/><no-step-log value="true"/></configuration>'
    )
    return config


def seconds(command: list[str]) -> float:
    """Wall time of a process."""
    started = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - started


LOOP = """
import sys, libsumo
libsumo.start(["sumo", *sys.argv[1:]])
end = libsumo.simulation.getEndTime()
while libsumo.simulation.getMinExpectedNumber() > 0 and (end < 0 or libsumo.simulation.getTime() < end):
    libsumo.simulationStep()
libsumo.close()
"""


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--scenario", type=Path)
    parser.add_argument("--end", type=float)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        config = options.scenario or grid(folder)
        end = ["--end", str(options.end)] if options.end else []
        plain = [sys.executable, "-c", LOOP, "-c", str(config), *end, "--no-warnings"]
        checked = [sys.executable, "-m", "closecall", "run", str(config), *end, "--quiet", "--out", name + "/out"]
        ssm = ["--device.ssm.probability", "1", "--device.ssm.file", name + "/ssm.xml", "--device.ssm.measures", "TTC"]
        commands = {
            "plain SUMO": plain,
            "closecall attached": [*checked, "--", "--no-warnings"],
            "device.ssm, TTC alone": [*plain, *ssm],
        }
        best = dict.fromkeys(commands, float("inf"))
        for _ in range(options.runs):
            for what, command in commands.items():
                best[what] = min(best[what], seconds(command))
        print(f"{config.stem} on {platform.node()}, {platform.processor() or platform.machine()}")
        for what, least in best.items():
            print(f"{what:<24} {least:7.2f} s {least / best['plain SUMO']:6.2f} x")


if __name__ == "__main__":
    main()
