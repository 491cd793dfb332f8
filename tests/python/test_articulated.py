"""A tram of several carriages on a bend, in SUMO: what it meets, and where its ring is."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

from conftest import python

DRIVE = """
import json, sys
from closecall import _sumo, Checker

config, lanes = sys.argv[1:]
sumo = _sumo.start(["-c", config, "--no-warnings", "--collision.action", "none"], gui=False)
checker = Checker(sumo, paint=True, align="never")
rings = []
while sumo.simulation.getTime() < 40:
    sumo.simulationStep()
    if sumo.simulation.getTime() == 1:
        for name, lane, place in [(f"stands_{lane}_{place}", lane, place) for lane in lanes for place in (105, 118)]:
            sumo.vehicle.add(name, "road", "car", departLane=lane, departPos=str(place), departSpeed="0")
            sumo.vehicle.setSpeed(name, 0)
            sumo.vehicle.setLaneChangeMode(name, 0)
        sumo.vehicle.add("tram", "road", "tram", departLane="1", departPos="46", departSpeed="8")
        sumo.vehicle.setSpeedMode("tram", 32)
        sumo.vehicle.setLaneChangeMode("tram", 0)
        sumo.vehicle.setSpeed("tram", 8)
    if sumo.simulation.getTime() == 14:
        sumo.vehicle.setSpeed("tram", 0)
        sumo.vehicle.add("rams", "road", "car", departLane="1", departPos="40", departSpeed="10")
        sumo.vehicle.setSpeedMode("rams", 32)
        sumo.vehicle.setSpeed("rams", 10)
        sumo.vehicle.setLaneChangeMode("rams", 0)
    checker.step()
    around_the_tram = [ring for ring in sumo.polygon.getIDList() if ring.endswith(".foe_ring")]
    if around_the_tram:
        places = {name: sumo.vehicle.getPosition(name) for name in sumo.vehicle.getIDList()}
        shape = sumo.polygon.getShape(around_the_tram[0])
        middle = [sum(point[axis] for point in shape) / len(shape) for axis in (0, 1)]
        rings.append({"time": sumo.simulation.getTime(), "middle": middle, **places})
checker.close()
conflicts = [[conflict.ego, conflict.foe, conflict.kind, conflict.collision] for conflict in checker.conflicts]
print(json.dumps({"conflicts": conflicts, "rings": rings, "left": list(sumo.polygon.getIDList())}))
"""


def bend(folder: Path) -> Path:
    """A road of three lanes, 100 m straight, round a quarter circle of 20 m to the left, and on."""
    angles = [math.radians(degrees) for degrees in range(0, 91, 5)]
    circle = [(100 + 20 * math.sin(angle), 20 - 20 * math.cos(angle)) for angle in angles]
    shape = " ".join(f"{x:.2f},{y:.2f}" for x, y in [(0.0, 0.0), *circle, (120.0, 160.0)])
    nodes, edges, net = (folder / f"bend.{kind}.xml" for kind in ("nod", "edg", "net"))
    nodes.write_text('<nodes><node id="w" x="0" y="0"/><node id="n" x="120" y="160"/></nodes>')
    edges.write_text(f'<edges><edge id="e" from="w" to="n" numLanes="3" speed="14" shape="{shape}"/></edges>')
    netconvert = Path(sys.executable).with_name("netconvert")
    subprocess.run([netconvert, "-n", nodes, "-e", edges, "-o", net, "--no-turnarounds"], check=True)
    types = '<vType id="car"/><vType id="tram" vClass="tram" length="45"/>'
    (folder / "bend.rou.xml").write_text(f'<routes>{types}<route id="road" edges="e"/></routes>')
    config = folder / "bend.sumocfg"
    files = '<net-file value="bend.net.xml"/><route-files value="bend.rou.xml"/>'
    config.write_text(f"<configuration><input>{files}</input></configuration>")
    return config


def drive(config: Path, lanes: str) -> Any:
    """What is seen while a tram drives on the middle lane, cars stand on these, and a car runs into the tram's tail."""
    done = python(DRIVE, config, lanes)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_a_tram_passes_what_stands_beside_it_on_a_bend(tmp_path: Path) -> None:
    seen = drive(bend(tmp_path), "02")
    assert seen["conflicts"] == [["rams", "tram", "rear_end", True]]


def test_a_tram_runs_into_what_stands_in_its_way(tmp_path: Path) -> None:
    seen = drive(bend(tmp_path), "1")
    assert ["tram", "stands_1_105", "rear_end", True] in seen["conflicts"]


def test_the_ring_of_a_tram_is_where_its_conflict_is(tmp_path: Path) -> None:
    seen = drive(bend(tmp_path), "")
    assert ["rams", "tram", "rear_end", True] in seen["conflicts"]
    at_first = seen["rings"][0]
    assert math.dist(at_first["tram"], at_first["middle"]) > 30
    # From there on it drives through the tram.
    assert len(seen["rings"]) > 3
    for ring in seen["rings"]:
        assert math.dist(ring["rams"], ring["middle"]) < 20
    assert min(math.dist(ring["rams"], ring["middle"]) for ring in seen["rings"]) < 0.5
    assert seen["left"] == []
