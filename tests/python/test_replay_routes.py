"""A replay knows the routes of the live run: with turnarounds, short edges, lengths unlike
shapes, long steps, and beyond the recording."""

from __future__ import annotations

import random
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Callable

import pytest
from conftest import closecall, rows
from recordings import record, replay, same

RANDOM = ("--rand", "--rand.iterations", "60", "--rand.min-distance", "12", "--rand.max-distance", "120")
NET = (*RANDOM, "--opposites.guess")
"""Has turnarounds, as netgenerate draws them by default, and edges of 0.1 to 14 m between longer ones."""
SHORT = 13.9
"""A vehicle drives over an edge shorter than this within a step of 1 s, in m."""

TYPES = """
    <vType id="blind" length="4.6" jmIgnoreFoeProb="1" jmIgnoreFoeSpeed="100" jmIgnoreJunctionFoeProb="1"/>
    <vType id="slow" length="8" maxSpeed="7"/>
    <vType id="hasty" length="4.4" speedFactor="1.3" lcOpposite="10" lcSpeedGain="100" lcAssertive="5" tau="0.5"/>
    <vType id="bus" vClass="bus" length="12"/>"""


def drawn(folder: Path, seed: str, *words: str) -> None:
    """A net drawn at random, with two-way overtaking and lengths unlike shapes, and vehicles that turn at random."""
    net = folder / "drawn.net.xml"
    netgenerate = Path(sys.executable).with_name("netgenerate")
    subprocess.run([netgenerate, *NET, *words, "--seed", seed, "-o", net], check=True, capture_output=True)
    tree = ET.parse(net)
    root = tree.getroot()
    lengths = []
    for edge in root.iter("edge"):
        # Both directions of a road have to be equally long.
        stretch = random.Random("".join(sorted([edge.get("from", ""), edge.get("to", "")]))).choice([0.7, 1, 1, 1.4])
        for lane in edge if edge.get("function") is None else ():
            lengths.append(float(lane.get("length", "")) * stretch)
            lane.set("length", f"{lengths[-1]:.2f}")
    tree.write(net)
    assert min(lengths) < SHORT and any(link.get("dir") in ("t", "T") for link in root.iter("connection"))
    ahead: dict[str, set[str]] = {}
    for link in root.iter("connection"):
        ahead.setdefault(link.get("from", ""), set()).add(link.get("to", ""))
    chance = random.Random(seed)
    vehicles = []
    for number in range(90):
        route = [chance.choice(sorted(edge for edge in ahead if not edge.startswith(":")))]
        while len(route) < 15 and route[-1] in ahead:
            route.append(chance.choice(sorted(ahead[route[-1]])))
        kind = chance.choice(["blind", "slow", "hasty", "hasty", "bus"])
        its = f'id="v{number}" type="{kind}" depart="{number}" departSpeed="max"'
        vehicles.append(f'<vehicle {its}><route edges="{" ".join(route)}"/></vehicle>')
    (folder / "drawn.rou.xml").write_text(f"<routes>{TYPES}{''.join(vehicles)}</routes>")
    inputs = '<net-file value="drawn.net.xml"/><route-files value="drawn.rou.xml"/>'
    (folder / "drawn.sumocfg").write_text(f"<configuration><input>{inputs}</input></configuration>")


@pytest.mark.parametrize(
    ("recording", "step", "net"),
    [
        ("fcd.xml", "1", ("3",)),
        ("fcd.csv", "0.5", ("4", "--lefthand")),
        ("fcd.parquet", "1", ("5", "--no-internal-links")),
    ],
)
def test_a_replay_knows_the_routes_on_any_net(recording: str, step: str, net: tuple[str, ...], tmp_path: Path) -> None:
    drawn(tmp_path, *net)
    config = tmp_path / "drawn.sumocfg"
    # The vehicles still drive when the recording ends.
    fcd = record(config, recording, "--step-length", step, "--end", "100")
    assert replay(config, fcd, tmp_path / "out") == (0, "")
    live = rows(tmp_path / "live" / "conflicts.csv")
    assert len(live) > 100 and any(row["kind"] == "frontal" for row in live)
    same(live, rows(tmp_path / "out" / "conflicts.csv"))


def test_places_where_nothing_tells_the_route_are_counted(scenario: Callable[[str], Path], tmp_path: Path) -> None:
    config = scenario("reckless")
    row = '<timestep time="{}"><vehicle id="a" x="{}" y="{}" angle="0" speed="1" pos="9" lane="{}"/></timestep>'
    recording = tmp_path / "fcd.xml"
    steps = row.format(0, 201.6, 344, "d_dn_0") + row.format(1, -171, -1.6, "aw_a_0")
    recording.write_text(f"<fcd-export>{steps}</fcd-export>")
    done = closecall("replay", recording, "--net", config.with_suffix(".net.xml"), "--out", tmp_path / "out")
    assert "routes: at 1 place no step shows" in done.stdout, done
