"""Painting in real sumo-gui, under Xvfb: colours and rings while a conflict lasts, and none afterwards."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Callable

import numpy as np
import pytest
from conftest import closecall, python, rows
from PIL import Image

Copy = Callable[[str], Path]

RINGS = {"rear_end": (60, 120, 255), "frontal": (230, 0, 230), "side": (0, 205, 205)}
SEVERITIES = {"caution": (255, 225, 0), "serious": (255, 140, 0), "critical": (235, 0, 0)}

# A package of the system, which .ci/run installs.
needs_xvfb = pytest.mark.skipif(shutil.which("Xvfb") is None, reason="Xvfb is not installed: apt install xvfb")

WATCH = """
import json, signal, sys
from closecall import _sumo, Checker

config, shot = sys.argv[1:3]
sumo = _sumo.start(["-c", config, "--no-warnings", "--window-size", "900,500"], gui=True)
checker = Checker(sumo)
states, before = [], {}
while sumo.simulation.getMinExpectedNumber() > 0:
    sumo.simulationStep()
    for vehicle in sumo.vehicle.getIDList():
        before.setdefault(vehicle, sumo.vehicle.getColor(vehicle))
    checker.step()
    rings = [polygon for polygon in sumo.polygon.getIDList() if polygon.endswith("_hl0")]
    colours = {vehicle: sumo.vehicle.getColor(vehicle) for vehicle in sumo.vehicle.getIDList()}
    states.append({"time": sumo.simulation.getTime(), "rings": rings, "colours": colours})
    if rings and len([state for state in states if state["rings"]]) == 6:
        places = [sumo.vehicle.getPosition(ring[: -len("_hl0")]) for ring in rings]
        x, y = (sum(place[axis] for place in places) / len(places) for axis in (0, 1))
        sumo.gui.setBoundary("View #0", x - 45, y - 25, x + 45, y + 25)
        sumo.gui.screenshot("View #0", shot)
checker.close()
left = [polygon for polygon in sumo.polygon.getIDList() if polygon.endswith("_hl0")]
conflicts = [[conflict.ego, conflict.foe, conflict.kind, conflict.begin, conflict.end]
             for conflict in checker.conflicts]
print(json.dumps({"states": states, "before": before, "left": left, "conflicts": conflicts}), flush=True)
signal.alarm(10)  # sumo-gui 1.28 does not always close; the system then ends the process
_sumo.close(gui=True)
"""


@pytest.fixture
def display(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An X server for this test alone, named in DISPLAY."""
    # Xvfb chooses a free number and prints it once it accepts clients.
    command = ["Xvfb", "-displayfd", "1", "-screen", "0", "1000x700x24"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as server:
        assert server.stdout
        try:
            number = server.stdout.readline().strip()
            assert number
            monkeypatch.setenv("DISPLAY", f":{number}")
            yield
        finally:
            server.kill()


def pixels_like(picture: Path, colour: tuple[int, int, int]) -> int:
    """The number of pixels of about this colour: rings are drawn half transparent over the road."""
    pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    return int((np.abs(pixels - colour).max(-1) < 25).sum())


@needs_xvfb
@pytest.mark.usefixtures("display")
@pytest.mark.parametrize("kind", ["frontal", "rear_end", "side"])
def test_a_conflict_is_painted_while_it_lasts(kind: str, scenario: Copy, tmp_path: Path) -> None:
    shot = tmp_path / f"{kind}.png"
    done = python(WATCH, scenario(kind), shot)
    assert done.returncode in (0, -signal.SIGALRM), done.stderr
    seen = json.loads(done.stdout.splitlines()[-1])
    ((ego, foe, found, begin, end),) = seen["conflicts"]
    assert found == kind
    during = [state for state in seen["states"] if state["rings"]]
    assert begin <= during[0]["time"] - 0.05 <= begin + 0.2
    assert during[-1]["time"] <= end + 1.2
    assert set(during[0]["rings"]) == {f"{ego}_hl0", f"{foe}_hl0"}
    severities = [list(colour) for colour in SEVERITIES.values()]
    assert all(list(state["colours"][ego])[:3] in severities for state in during if ego in state["colours"])
    assert seen["left"] == []
    for state in seen["states"]:
        if not state["rings"]:
            assert all(state["colours"][vehicle] == seen["before"][vehicle] for vehicle in state["colours"])
    assert shot.exists()
    assert sum(pixels_like(shot, colour) for colour in SEVERITIES.values()) > 20
    assert pixels_like(shot, RINGS[kind]) > 20
    if pictures := os.environ.get("CLOSECALL_PICTURES"):
        shutil.copy(shot, pictures)


@needs_xvfb
@pytest.mark.usefixtures("display")
def test_the_command_shows_the_run_and_logs_the_same(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("side")
    done = closecall("run", config, "--gui", "--end", "8", "--out", tmp_path / "shown")
    assert done.returncode == 0 or "sumo-gui does not close" in done.stderr, done.stderr
    assert closecall("run", config, "--end", "8", "--out", tmp_path / "unseen").returncode == 0
    assert rows(tmp_path / "shown" / "conflicts.csv") == rows(tmp_path / "unseen" / "conflicts.csv")


def test_a_missing_display_is_reported(scenario: Copy, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    done = closecall("run", scenario("side"), "--gui")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "needs a display" in done.stderr
