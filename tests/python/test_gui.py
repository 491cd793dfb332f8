"""Painting in real sumo-gui, under Xvfb: what is seen while a conflict lasts, and that nothing is left afterwards."""

from __future__ import annotations

import gzip
import json
import os
import pty
import select
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
from conftest import closecall, closecall_apart, python, rows
from PIL import Image

Copy = Callable[[str], Path]

SEVERITIES = {"caution": (0x6F, 0xA8, 0xDC), "serious": (0xFF, 0xAB, 0x40), "critical": (0xFF, 0x5C, 0x6C)}
ROAD = (70, 75, 81)

# A package of the system, which .ci/run installs.
needs_xvfb = pytest.mark.skipif(shutil.which("Xvfb") is None, reason="Xvfb is not installed: apt install xvfb")

# Takes a picture in the sixth step of a conflict, from near and from far away.
WATCH = """
import json, signal, sys
from closecall import _sumo, Checker

config, near, far = sys.argv[1:4]
sumo = _sumo.start(["-c", config, "--no-warnings", "--window-size", "620,520"], gui=True)
checker = Checker(sumo)
states, before = [], {}
while sumo.simulation.getMinExpectedNumber() > 0:
    sumo.simulationStep()
    for vehicle in sumo.vehicle.getIDList():
        before.setdefault(vehicle, sumo.vehicle.getColor(vehicle))
    checker.step()
    painted = [polygon for polygon in sumo.polygon.getIDList() if sumo.polygon.getType(polygon) == "closecall"]
    colours = {vehicle: sumo.vehicle.getColor(vehicle) for vehicle in sumo.vehicle.getIDList()}
    states.append({"time": sumo.simulation.getTime(), "painted": painted, "colours": colours})
    number = len([state for state in states if state["painted"]])
    if painted and number in (5, 7):
        (x0, y0), (x1, y1) = map(sumo.vehicle.getPosition, (checker.active[0].ego, checker.active[0].foe))
        x, y = (x0 + x1) / 2, (y0 + y1) / 2
        # The view is twice as wide as high.
        half = {5: 10 + max(abs(x1 - x0) / 4, abs(y1 - y0) / 2), 7: 1500}[number]
        sumo.gui.setBoundary("View #0", x - half, y - half, x + half, y + half)
    if painted and number in (6, 8):
        sumo.gui.screenshot("View #0", {6: near, 8: far}[number])
checker.close()
left = [*sumo.polygon.getIDList(), *sumo.poi.getIDList()]
conflicts = [[conflict.ego, conflict.foe, conflict.kind, conflict.begin, conflict.end]
             for conflict in checker.conflicts]
print(json.dumps({"states": states, "before": before, "left": left, "conflicts": conflicts}), flush=True)
signal.alarm(2)  # sumo-gui 1.28 does not always close; the system then ends the process
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


def pixels_like(picture: Path, colour: tuple[int, int, int], within: int = 25) -> int:
    """The number of pixels of about this colour, without those of the legend in the left quarter."""
    pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    pixels = pixels[:, pixels.shape[1] // 4 :]
    return int((np.abs(pixels - colour).max(-1) < within).sum())


def rings(picture: Path, within: int = 25) -> int:
    """The pixels of rings and lines, which have the colours of the severities."""
    return sum(pixels_like(picture, colour, within) for colour in SEVERITIES.values())


def legend(picture: Path, colour: tuple[int, int, int]) -> int:
    """The pixels of the legend, in the upper left corner, of about this colour."""
    pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    pixels = pixels[: pixels.shape[0] // 2, : pixels.shape[1] // 4]
    return int((np.abs(pixels - colour).max(-1) < 25).sum())


def path_colour(colour: tuple[int, int, int]) -> tuple[int, int, int]:
    """A severity's colour as the ego's path has it, mixed with the road's."""
    share = 0.6
    red, green, blue = (round(share * own + (1 - share) * road) for own, road in zip(colour, ROAD))
    return red, green, blue


@needs_xvfb
@pytest.mark.usefixtures("display")
@pytest.mark.parametrize("kind", ["frontal", "rear_end", "side"])
def test_a_conflict_is_painted_while_it_lasts(kind: str, scenario: Copy, tmp_path: Path) -> None:
    near, far = tmp_path / f"{kind}.png", tmp_path / f"{kind}_far.png"
    done = python(WATCH, scenario(kind), near, far)
    assert done.returncode in (0, -signal.SIGALRM), done.stderr
    seen = json.loads(done.stdout.splitlines()[-1])
    ((ego, foe, found, begin, end),) = seen["conflicts"]
    assert found == kind
    during = [state for state in seen["states"] if state["painted"]]
    assert begin <= during[0]["time"] - 0.05 <= begin + 0.2
    assert during[-1]["time"] <= end + 1.2
    parts = {name.rpartition(".")[2] for state in during for name in state["painted"]}
    assert parts >= {"ego_ring", "foe_ring", "ego_line", "foe_line", "point", "ego_path"}
    severities = [list(colour) for colour in SEVERITIES.values()]
    for user in (ego, foe):
        assert all(state["colours"][user][:3] in severities for state in during if user in state["colours"])
    assert seen["left"] == []
    for state in seen["states"]:
        if not state["painted"]:
            assert all(state["colours"][vehicle] == seen["before"][vehicle] for vehicle in state["colours"])
    assert sum(pixels_like(near, path_colour(colour), 6) for colour in SEVERITIES.values()) > 20
    assert rings(near) > 400
    # 3 km across, where a car is a third of a pixel wide.
    assert rings(far, 60) > 60
    if pictures := os.environ.get("CLOSECALL_PICTURES"):
        shutil.copy(near, pictures)
        shutil.copy(far, pictures)


@needs_xvfb
@pytest.mark.usefixtures("display")
def test_the_command_shows_the_run_and_logs_the_same(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("side")
    done = closecall_apart(
        "run", config, "--gui", "--label", "--quit-on-end", "--end", "8", "--out", tmp_path / "shown"
    )
    assert done.returncode == 0 or "sumo-gui does not close" in done.stderr, done.stderr
    assert closecall("run", config, "--end", "8", "--out", tmp_path / "unseen").returncode == 0
    assert rows(tmp_path / "shown" / "conflicts.csv") == rows(tmp_path / "unseen" / "conflicts.csv")


@needs_xvfb
@pytest.mark.usefixtures("display")
def test_a_run_halts_once_at_each_severe_conflict(scenario: Copy, tmp_path: Path) -> None:
    colours = json.dumps({name: list(colour) for name, colour in SEVERITIES.items()})
    done = python(HALT, scenario("side"), tmp_path / "log", colours)
    assert done.returncode in (0, -signal.SIGALRM), done.stderr
    halts, most = json.loads(done.stdout.splitlines()[-1])
    # Without a terminal it goes on after a while; the only conflict is no more than a caution.
    assert (halts, most) == (1, 0)


@needs_xvfb
@pytest.mark.usefixtures("display")
def test_a_halt_lasts_until_enter_is_pressed(scenario: Copy, tmp_path: Path) -> None:
    words = ["--gui", "--pause-at", "critical", "--quit-on-end", "--end", "8", "--out", str(tmp_path / "log")]
    command = [sys.executable, "-m", "closecall", "run", str(scenario("unregulated")), *words]
    terminal, own = pty.openpty()
    with subprocess.Popen(command, stdin=own, stdout=own, stderr=own, start_new_session=True) as process:
        os.close(own)
        said, has_asked = b"", False
        with suppress(OSError):  # the terminal is gone with the process
            while some := os.read(terminal, 65536):
                said += some
                if said.endswith(b"Enter goes on: ") and not has_asked:
                    has_asked = True
                    assert not select.select([terminal], [], [], 2.0)[0], "it does not wait"
                    os.write(terminal, b"\n")
    os.close(terminal)
    assert has_asked and b"\n5.5 s: a critical side conflict of northward (ego)" in said, said
    assert process.returncode == 0 or b"sumo-gui does not close" in said
    assert len(rows(tmp_path / "log/conflicts.csv")) == 1


def test_a_missing_display_is_reported(scenario: Copy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    config = scenario("side")
    assert closecall("run", config, "--quiet", "--out", tmp_path, "--log-clips", "caution").returncode == 0
    for words in (("run", str(config), "--gui"), ("show", str(tmp_path), "--worst", "1")):
        done = closecall(*words)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert "needs a display" in done.stderr


# Runs in sumo-gui, and counts the halts at cautions, and at more.
HALT = """
import json, signal, sys, time
from closecall import _paint, _sumo, Checker

sumo = _sumo.start(["-c", sys.argv[1], "--no-warnings"], gui=True)
checker = Checker(sumo, paint=False)
_paint.HALTS = 0.0
halts = {"caution": 0, "critical": 0}
painters = {least: _paint.Painter(sumo, json.loads(sys.argv[3])) for least in halts}
wait = _paint.time.sleep


def paint(least):
    def halted(seconds):
        halts[least] += seconds == 0.0
        wait(seconds)

    _paint.time.sleep = halted
    user = lambda name: _paint.User(name, "vehicle", 5.0, 1.8, False, [])
    pairs = [_paint.Pair(user(a.ego), user(a.foe), a.severity, a.kind, (a.x, a.y), None) for a in checker.active]
    painters[least].halt(pairs, least)


while sumo.simulation.getMinExpectedNumber() > 0:
    sumo.simulationStep()
    checker.step()
    for least in halts:
        paint(least)
print(json.dumps(list(halts.values())), flush=True)
signal.alarm(2)
_sumo.close(gui=True)
"""


# Plays a clip, takes a picture at the worst step, and says where the two were then.
PLAY = """
import json, signal, sys
from closecall import _show, _sumo

scene, colours = json.loads(sys.argv[1]), json.loads(sys.argv[2])
player = _show.Player(scene, colours, True, False)
_show.SLOWER = 0.0
seen = []


def halt():
    ids = [user["id"] for user in scene["clip"]["users"][:2]]
    seen.extend(player.sumo.vehicle.getPosition(name) for name in ids)
    player.sumo.gui.screenshot("View #0", sys.argv[3])


player._halt = halt
player._play()
player.sumo.simulationStep()
player.painter.clear()
left = [*player.sumo.polygon.getIDList(), *player.sumo.poi.getIDList()]
print(json.dumps({"seen": seen, "left": left}), flush=True)
signal.alarm(2)
_sumo.close(gui=True)
"""


def scene_of(log: Path, net: Path) -> dict[str, Any]:
    """What `closecall show` plays of the only conflict of a log."""
    (row,) = rows(log / "conflicts.csv")
    with gzip.open(log / "clips.jsonl.gz", "rt") as file:
        (clip,) = map(json.loads, file)
    paths = []
    for user in ("ego", "foe"):
        numbers = [float(number) for number in row[f"{user}_path"].split()]
        points = [list(point) for point in zip(numbers[::2], numbers[1::2])]
        paths.append([[float(row[f"{user}_x"]), float(row[f"{user}_y"])], *points] if points else [])
    at = [float(row["x"]), float(row["y"])]
    return {
        "net": str(net), "clip": clip, "kind": row["kind"], "severity": row["severity"], "time": float(row["time"]),
        "at": at, "paths": paths,
    }  # fmt: skip


@needs_xvfb
@pytest.mark.usefixtures("display")
def test_show_plays_a_clip_where_the_conflict_was(scenario: Copy, tmp_path: Path) -> None:
    config, log, shot = scenario("side"), tmp_path / "log", tmp_path / "worst.png"
    assert closecall("run", config, "--quiet", "--out", log, "--log-clips", "caution").returncode == 0
    scene = scene_of(log, config.with_name("side.net.xml"))
    done = python(PLAY, json.dumps(scene), json.dumps(SEVERITIES), shot)
    assert done.returncode in (0, -signal.SIGALRM), done.stderr
    seen = json.loads(done.stdout.splitlines()[-1])
    (row,) = rows(log / "conflicts.csv")
    for user, place in zip(("ego", "foe"), seen["seen"]):
        assert place == pytest.approx((float(row[f"{user}_x"]), float(row[f"{user}_y"])), abs=0.02)
    assert seen["left"] == []
    assert rings(shot) > 400
    assert all(legend(shot, colour) > 60 for colour in SEVERITIES.values())
    if pictures := os.environ.get("CLOSECALL_PICTURES"):
        shutil.copy(shot, pictures)
    done = closecall_apart("show", log, "--worst", "1", "--quit-on-end")
    assert done.returncode == 0 or "sumo-gui does not close" in done.stderr, done.stderr
