"""The simulations of the benches for attached runs, the commands that run them with the checker and without, and what
those take.

grid: 10 by 10 signalised junctions with up to 1,700 vehicles. town: sumo_nets/town. motorway: SUMO's A10, with its own
configuration, which disables teleporting. The town ends after 300 s, because device.ssm is slow there.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import sumo
from sumolib.miscutils import parseTime

BIN = Path(sys.executable).parent
GRID = ["--grid", "--grid.number", "10", "--grid.length", "200", "-L", "2", "-j", "traffic_light"]

PLAIN = """
import sys
from closecall._sumo import import_libsumo
libsumo = import_libsumo()
libsumo.start(["sumo", *sys.argv[1:]])
end = libsumo.simulation.getEndTime()
while libsumo.simulation.getMinExpectedNumber() > 0 and libsumo.simulation.getTime() < end:
    libsumo.simulationStep()
libsumo.close()
"""


def scenarios(folder: Path) -> dict[str, Path]:
    """The configurations; those that have to be generated are written to the folder."""
    return {"grid": grid(folder), "town": Path("sumo_nets/town/town.sumocfg"), "motorway": motorway(folder)}


def grid(folder: Path) -> Path:
    """Generate the grid and its demand."""
    net, routes, config = folder / "grid.net.xml", folder / "grid.rou.xml", folder / "grid.sumocfg"
    tools = Path(sumo.SUMO_HOME) / "tools"
    environment = {**os.environ, "SUMO_HOME": str(sumo.SUMO_HOME), "PATH": f"{BIN}:{os.environ['PATH']}"}
    trips = [sys.executable, str(tools / "randomTrips.py"), "-n", str(net), "-o", str(folder / "trips.xml")]
    trips += ["-r", str(routes), "-e", "600", "-p", "0.2", "--seed", "1"]
    for command in [[str(BIN / "netgenerate"), *GRID, "-o", str(net)], trips]:
        subprocess.run(command, env=environment, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    config.write_text(
        f'<configuration><net-file value="{net}"/><route-files value="{routes}"/>'
        '<begin value="0"/><end value="600"/><no-step-log value="true"/></configuration>'
    )
    return config


def motorway(folder: Path) -> Path:
    """Copy the motorway of the installed SUMO, whose configuration writes files beside itself."""
    shutil.copytree(Path(sumo.SUMO_HOME) / "tools" / "game", folder / "game")
    return folder / "game" / "A10KW.sumocfg"


def end(config: Path) -> str:
    """The end of a run in s: 600 s after its begin, or 300 s in the town."""
    begin = ET.parse(config).getroot().find(".//begin")
    return f"{parseTime('0' if begin is None else begin.attrib['value']) + (300 if config.stem == 'town' else 600):g}"


def plain(config: Path) -> list[str]:
    """SUMO alone in libsumo, imported as closecall imports it: without numpy and lxml, which saves 0.1 s."""
    return [sys.executable, "-c", PLAIN, "-c", str(config), "--end", end(config), "--no-warnings"]


def program(config: Path) -> list[str]:
    """SUMO alone as a program: the binary itself, not the Python script that starts it."""
    binary = str(Path(sumo.SUMO_HOME) / "bin" / "sumo")
    return [binary, "-c", str(config), "--end", end(config), "--no-warnings", "--no-step-log"]


def attached(config: Path, out: Path, *options: str) -> list[str]:
    """SUMO with closecall: every road user checked in every step, and the conflicts logged."""
    checked = [sys.executable, "-m", "closecall", "run", str(config), "--end", end(config)]
    return [*checked, "--quiet", "--out", str(out), *options, "--", "--no-warnings"]


def ssm(config: Path, out: Path) -> list[str]:
    """SUMO with device.ssm on all vehicles, for TTC alone."""
    device = ["--device.ssm.probability", "1", "--device.ssm.measures", "TTC", "--device.ssm.file", str(out)]
    return [*plain(config), *device]


def measured(command: list[str]) -> tuple[float, float]:
    """The time of a command in s and its memory in MB."""
    started = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"{command}: status {status}")
    return time.perf_counter() - started, usage.ru_maxrss / 1000
