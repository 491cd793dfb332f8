"""The checker as a step listener of libsumo and traci, and with plain frames."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Callable

import closecall as cc
import numpy as np
import pytest
from conftest import NETS, Once, closecall, python, rows

Copy = Callable[[str], Path]

LISTEN = """
import json, sys
import {module} as sumo
import closecall
sumo.start(["sumo", "-c", sys.argv[1], "--no-warnings"])
checker = closecall.Checker(sumo)
sumo.addStepListener(checker)
while sumo.simulation.getMinExpectedNumber() > 0 and sumo.simulation.getTime() < 60:
    sumo.simulationStep()
conflicts = checker.conflicts
sumo.close()
print(json.dumps([[conflict.foe, conflict.cause] for conflict in conflicts]))
"""


@pytest.mark.parametrize("module", ["libsumo", "traci"])
def test_a_listener_knows_which_vehicle_stopped(module: str, scenario: Copy) -> None:
    config = scenario("obstacles")
    demand = config.with_suffix(".rou.xml")
    on_the_lane = 'lane="road_0" startPos="552" endPos="560"'
    demand.write_text(demand.read_text().replace('parkingArea="in_lane"', on_the_lane))
    done = python(LISTEN.replace("{module}", module), config)
    assert done.returncode == 0, done.stderr
    assert ["parked_in_lane", "stood"] in json.loads(done.stdout.splitlines()[-1])


NOT_STARTED = """
import {module} as sumo
import closecall
try:
    closecall.Checker(sumo)
except RuntimeError as error:
    print(error)
"""


@pytest.mark.parametrize("module", ["libsumo", "traci"])
def test_a_checker_needs_a_started_simulation(module: str) -> None:
    done = python(NOT_STARTED.replace("{module}", module))
    assert "is a simulation started?" in done.stdout, (done.stdout, done.stderr)


LOGGED = """
import json, sys
import {module} as sumo
import closecall
sumo.start(["sumo", "-c", sys.argv[1], "--seed", "7", "--no-warnings"])
with closecall.Checker(sumo, out=sys.argv[2]) as checker:
    sumo.addStepListener(checker)
    while sumo.simulation.getTime() < 60:
        sumo.simulationStep()
sumo.close()
print(json.dumps([[getattr(conflict, field) for field in sys.argv[3:]] for conflict in checker.conflicts]))
"""

FIELDS = ("ego", "foe", "kind", "severity", "begin", "margin", "ttc", "drac", "lane", "cause")


@pytest.mark.parametrize("module", ["libsumo", "traci"])
def test_a_checkers_conflicts_and_log_are_the_commands(module: str, once: Once, tmp_path: Path) -> None:
    config, own = NETS / "reckless" / "reckless.sumocfg", tmp_path / "own"

    def fill(folder: Path) -> None:
        assert closecall("run", config, "--seed", "7", "--end", "60", "--out", folder / "log").returncode == 0

    ran = once("listened", fill) / "log"
    done = python(LOGGED.replace("{module}", module), config, own, *FIELDS)
    assert done.returncode == 0, done.stderr
    assert (own / "conflicts.csv").read_bytes() == (ran / "conflicts.csv").read_bytes()
    found, logged = json.loads(done.stdout.splitlines()[-1]), rows(ran / "conflicts.csv")
    assert len(found) == len(logged) > 10
    for conflict, row in zip(found, logged):
        for value, cell in zip(conflict, (row[name] for name in FIELDS)):
            assert (
                value == cell if isinstance(value, str) else (value or 0) == pytest.approx(float(cell or 0), abs=1e-6)
            )
    one, other = (json.loads((log / "run.json").read_text()) for log in (own, ran))
    for key in ("versions", "scenario", "seed", "step_length", "sublane", "options", "inputs", "complete"):
        assert one[key] == other[key], key
    for key in ("begin", "end", "steps", "conflicts", "collisions"):
        assert one["summary"][key] == other["summary"][key], key
    # The sums run over the road users in different orders.
    assert one["summary"]["exposure"] == pytest.approx(other["summary"]["exposure"], rel=1e-12)
    assert one["complete"]
    done = closecall("stats", own, "--format", "json")
    assert (done.returncode, done.stderr) == (0, "")
    worst = json.loads(done.stdout)["worst"]
    commands = [conflict["command"] for conflict in worst]
    assert commands and all(command is None or command.startswith("closecall show ") for command in commands), (
        "SUMO's options are the script's, unknown to closecall"
    )
    assert closecall("report", own, "-o", tmp_path / "report.html").returncode == 0


MESOSCOPIC = """
import sys
import {module} as sumo
import closecall
sumo.start(["sumo", "-c", sys.argv[1], "--mesosim", "--no-warnings"])
try:
    closecall.Checker(sumo, out=sys.argv[2])
except ValueError as error:
    print(error)
sumo.close()
"""


@pytest.mark.parametrize("module", ["libsumo", "traci"])
def test_a_mesoscopic_simulation_is_refused_without_a_log(module: str, scenario: Copy, tmp_path: Path) -> None:
    done = python(MESOSCOPIC.replace("{module}", module), scenario("rear_end"), tmp_path / "out")
    assert "needs the microscopic one" in done.stdout, (done.stdout, done.stderr)
    assert not (tmp_path / "out").exists()


AGAIN = """
import sys
import libsumo
import closecall
checkers = []
for round in range(2):
    libsumo.start(["sumo", "-c", sys.argv[1], "--no-warnings"])
    checkers.append(closecall.Checker(libsumo))
    libsumo.addStepListener(checkers[-1])
    while libsumo.simulation.getTime() < 40:
        libsumo.simulationStep()
    {end}
    libsumo.close()
first, second = ([(conflict.ego, conflict.foe, conflict.margin) for conflict in each.conflicts] for each in checkers)
assert first == second and len(first) > 5, (first, second)
"""


@pytest.mark.parametrize("end", ["checkers[-1].close()", "pass"])
def test_each_of_consecutive_simulations_has_its_own_checker(scenario: Copy, end: str) -> None:
    done = python(AGAIN.replace("{end}", end), scenario("reckless"))
    assert done.returncode == 0, done.stderr


REMOVE = """
import sys
import {module} as sumo
import closecall
sumo.start(["sumo", "-c", sys.argv[1], "--no-warnings"])
checker = closecall.Checker(sumo)
sumo.addStepListener(checker)
for step in range(120):
    sumo.simulationStep()
    if step == 60:
        gone = sumo.vehicle.getIDList()[0]
        sumo.vehicle.remove(gone)
assert all(conflict.begin < 61 * 0.5 for conflict in checker.conflicts if gone in (conflict.ego, conflict.foe))
print(gone, len(checker.conflicts), checker.summary["steps"])
sumo.close()
"""


def test_a_vehicle_removed_by_the_script_leaves_the_scene(scenario: Copy) -> None:
    config = scenario("left_turn")
    with_libsumo, with_traci = (python(REMOVE.replace("{module}", module), config) for module in ("libsumo", "traci"))
    assert (with_libsumo.returncode, with_traci.returncode) == (0, 0), with_libsumo.stderr + with_traci.stderr
    outputs = [done.stdout.splitlines()[-1] for done in (with_libsumo, with_traci)]
    assert outputs[0] == outputs[1] and outputs[0].endswith(" 120"), outputs


ANOTHER = """
import sys
import {module} as sumo
import closecall
sumo.start(["sumo", "-c", sys.argv[1], "--no-warnings"])
checker = closecall.Checker(sumo)
while not sumo.vehicle.getIDList():
    sumo.simulationStep()
checker.step()
vehicle = sumo.vehicle.getIDList()[0]
before = checker.summary["exposure"]
route = sumo.vehicle.getRouteID(vehicle)
sumo.vehicle.remove(vehicle)
sumo.simulationStep()
sumo.vehicle.add(vehicle, route, departSpeed="max")
departed = 0
for _ in range(8):
    sumo.simulationStep()
    departed += len(sumo.simulation.getDepartedIDList())
checker.step()
sumo.simulationStep()
departed += len(sumo.simulation.getDepartedIDList())
checker.step()
sumo.simulationStep()
departed += len(sumo.simulation.getDepartedIDList())
checker.step()
after = checker.summary["exposure"]
print(after["vehicles"] - before["vehicles"] - departed, after["vehicle_kilometres"] > before["vehicle_kilometres"])
"""


@pytest.mark.parametrize("module", ["libsumo", "traci"])
def test_a_reused_id_is_a_new_road_user(module: str, scenario: Copy) -> None:
    done = python(ANOTHER.replace("{module}", module), scenario("curves"))
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "0 True"


def test_plain_frames_refuse_a_time_that_goes_back() -> None:
    checker = cc.Checker()
    checker.step(1.0, {**CAR, "x": [0.0, 20.0]})
    with pytest.raises(ValueError, match=r"time is 0\.5, after 1"):
        checker.step(0.5, {**CAR, "x": [0.0, 20.0]})


CAR = {"id": ["a", "b"], "heading": [0.0, 0.0], "speed": [20.0, 5.0], "y": [0.0, 0.0]}


def test_plain_frames_give_one_conflict_per_pair_and_episode() -> None:
    with cc.Checker(epsilon=1.0) as checker:
        for step in range(30):
            time = step / 10
            checker.step(time, {**CAR, "x": np.array([0.0, 40.0]) + np.array([20.0, 5.0]) * time})
        assert [conflict.kind for conflict in checker.conflicts] == ["rear_end"]
    (conflict,) = checker.conflicts
    assert (conflict.ego, conflict.foe, conflict.begin) == ("a", "b", 0.0)
    assert conflict.collision == (conflict.severity == "critical")
    assert conflict.ttc is not None and conflict.pet is None
    assert checker.summary["exposure"]["vehicles"] == 2
    with pytest.raises(RuntimeError, match="closed"):
        checker.step(9.9, {**CAR, "x": [0.0, 40.0]})


@pytest.mark.parametrize(
    ("states", "message"),
    [
        ({"x": [0.0]}, '"x" has 1 values, "id" has 2'),
        ({"x": [0.0, 9.0], "length": [-5.0, 5.0]}, '"a": length is -5, it must be above 0 and at most 10000 m'),
        ({"x": [0.0, 9.0], "width": [1.8, 0.0]}, '"b": width is 0, it must be above 0 and at most 200 m'),
        ({"x": [0.0, 9.0], "lenght": [5.0, 5.0]}, 'unknown column "lenght"; did you mean "length"'),
        ({"x": [0.0, 9.0], "category": ["car", "person"]}, 'category is "car": vehicle, bicycle, person or obstacle'),
        ({"x": [0.0, 9.0], "category": ["person"]}, '"category" has 1 values, "id" has 2'),
        (
            {"x": [0.0, 9.0], "category": ["vehicle", "obstacle"]},
            '"b" is an obstacle, which needs "length" and "width"',
        ),
        ({}, 'column "x" is missing'),
        ({"x": [0.0, 9.0], "id": ["a", "a"]}, '"a" is there twice'),
    ],
)
def test_impossible_frames_are_refused(states: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        cc.Checker().step(0.0, {**CAR, **states})


def encounter(category: str, **foe: Any) -> list[cc.Conflict]:
    """The conflicts of a car that drives at 15 m/s towards a standing road user."""
    with cc.Checker() as checker:
        for step in range(10):
            sizes = {name: [5.0 if name == "length" else 1.8, size] for name, size in foe.items()}
            front = 15.0 * step / 10
            frame = {
                "id": ["car", "foe"],
                "x": [front, 30.0],
                "y": [0.0, 0.0],
                "heading": [0.0, 0.0],
                "speed": [15.0, 0.0],
            }
            checker.step(step / 10, {**frame, "category": ["vehicle", category], **sizes})
        return checker.conflicts


def test_every_category_can_be_given_in_plain_frames() -> None:
    lengths = {"vehicle": 5.0, "bicycle": 1.6, "person": 0.215}
    for category, length in lengths.items():
        (conflict,) = encounter(category)
        assert (conflict.ego, conflict.foe) == ("car", "foe")
        assert (conflict.foe_length, conflict.kind) == (length, "rear_end")
    (conflict,) = encounter("obstacle", length=2.0, width=1.0)
    assert (conflict.ego, conflict.foe, conflict.foe_type) == ("car", "foe", "polygon:obstacle")
    # From the obstacle's front at 30 m its rear is 2 m nearer.
    assert conflict.gap == pytest.approx(28.0 - 15.0 * conflict.time, abs=1e-3)


def test_two_persons_are_no_pair_and_no_vehicles() -> None:
    with cc.Checker() as checker:
        for step in range(5):
            place = 1.4 * step / 10
            frame = {"id": ["a", "b"], "x": [place, place], "y": [0.0, 0.1], "heading": [0.0, 0.0], "speed": [1.4, 1.4]}
            checker.step(step / 10, {**frame, "category": ["person", "person"]})
        assert checker.conflicts == []
    exposure = checker.summary["exposure"]
    assert (exposure["vehicles"], exposure["persons"], exposure["vehicle_hours"]) == (0, 2, 0)


def test_an_earlier_log_is_kept_unless_it_is_to_be_replaced(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    cc.Checker(out=tmp_path).close()
    first = (tmp_path / "run.json").read_text()
    assert capfd.readouterr().err == ""
    cc.Checker(out=tmp_path, epsilon=1.0).close()
    assert capfd.readouterr().err == f"closecall: the earlier log is kept in {tmp_path}/earlier/1\n"
    assert (tmp_path / "earlier" / "1" / "run.json").read_text() == first
    cc.Checker(out=tmp_path, force=True).close()
    assert capfd.readouterr().err == ""
    assert [path.name for path in (tmp_path / "earlier").iterdir()] == ["1"]


def test_an_unknown_option_is_named() -> None:
    for value in ("red", False):
        with pytest.raises(ValueError, match='unknown option "colour"'):
            cc.Checker(colour=value)
    with pytest.raises(ValueError, match='"serious_tcc"; did you mean "serious_ttc"'):
        cc.Checker(serious_tcc=1.5)


def test_an_error_names_the_keyword_not_the_long_option() -> None:
    with pytest.raises(
        ValueError, match=r'^invalid value \'big\' for "mu"; possible values: minimal, at-rest, paper, rss$'
    ):
        cc.Checker(mu="big")
    with pytest.raises(ValueError, match=r'^invalid value \'-1\' for "serious_ttc": '):
        cc.Checker(serious_ttc=-1)


@pytest.mark.parametrize("spelling", ["at_rest", "at-rest"])
def test_a_value_of_two_words_has_both_spellings(spelling: str, tmp_path: Path) -> None:
    cc.Checker(out=tmp_path, mu=spelling).close()
    assert json.loads((tmp_path / "run.json").read_text())["options"]["mu"] == "at-rest"


def test_a_missing_net_raises_file_not_found(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        cc.Checker(net=tmp_path / "none.net.xml")


def test_a_failed_scripts_log_records_the_error(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), cc.Checker(out=tmp_path) as checker:
        checker.step(1 / 2, {**CAR, "x": [0.0, 20.0]})
        checker.step(1 / 0, {**CAR, "x": [0.0, 20.0]})
    record = json.loads((tmp_path / "run.json").read_text())
    assert not record["complete"] and record["error"] == "ZeroDivisionError: division by zero"
    assert record["summary"]["steps"] == len(rows(tmp_path / "conflicts.csv")) == 1


def test_the_log_is_written_on_request(tmp_path: Path) -> None:
    with cc.Checker(out=tmp_path, log_series=True) as checker:
        checker.step(0.0, {**CAR, "x": [0.0, 20.0]})
    assert [row["ego"] for row in rows(tmp_path / "conflicts.csv")] == ["a"]
    assert len(rows(tmp_path / "series.csv")) == 1
    record = json.loads((tmp_path / "run.json").read_text())
    assert record["complete"] and record["summary"]["steps"] == 1
    assert record["summary"]["conflicts"] == checker.summary["conflicts"] != []


def test_an_old_keyword_is_accepted_and_said_once() -> None:
    done = python("import closecall\nfor _ in range(3):\n    closecall.Checker(keep_all=True, mu='rss')")
    said = "closecall: keep_all is now no_shortcuts; the old name still works\n"
    assert (done.returncode, done.stderr) == (0, said)
