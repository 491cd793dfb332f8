"""Another simulation, or another state, in the place of the one that a checker follows."""

from __future__ import annotations

from pathlib import Path
from typing import Callable

import pytest
from conftest import python

Copy = Callable[[str], Path]

LOADED = """
import os, sys, tempfile, warnings
import {module} as sumo
import closecall
config = ["-c", sys.argv[1], "--no-warnings", "--step-length", "0.5"]
state = os.path.join(tempfile.mkdtemp(), "state.xml")
def steps(count):
    for _ in range(count): sumo.simulationStep()
def at_the_begin(): sumo.load(config)
def at_the_next_time(): sumo.load([*config, "--begin", "15.5", "--seed", "9"])
def at_a_later_time(): sumo.load([*config, "--begin", "40", "--seed", "9"])
def a_later_state(): sumo.simulation.loadState(state)
def after_a_jump(): sumo.load([*config, "--seed", "9"]); sumo.simulationStep(60.0)
sumo.start(["sumo", *config, "--seed", "9"])
steps(60)
sumo.simulation.saveState(state)
for another in (at_the_begin, at_the_next_time, at_a_later_time, a_later_state, after_a_jump):
    sumo.load(config)
    steps(1)
    checker = closecall.Checker(sumo)
    sumo.addStepListener(checker)
    steps(30)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        another()
        steps(3)
    assert checker.summary["steps"] == 30, (another, checker.summary)
    (warning,) = caught
    assert warning.category is RuntimeWarning, warning
    why = "'s time went back" if another is at_the_begin else ""
    assert str(warning.message).startswith(f"this checker has stopped: the simulation{why}"), (another, warning)
sumo.close()
"""


@pytest.mark.parametrize("module", ["libsumo", "traci"])
def test_another_simulation_ends_the_checker(module: str, scenario: Copy) -> None:
    done = python(LOADED.replace("{module}", module), scenario("reckless"))
    assert done.returncode == 0, done.stderr


GOES_ON = """
import sys, warnings
import {module} as sumo
import closecall
warnings.simplefilter("error")
sumo.start(["sumo", "-c", sys.argv[1], "--no-warnings", "--step-length", "0.5"])
checker = closecall.Checker(sumo)
number = sumo.addStepListener(checker)
steps = 0
def step(until=0.0, new=1):
    global steps
    sumo.simulationStep(until)
    steps += new
for _ in range(20): step()
step(30.0)
step(30.0, new=0)
step(33.3)
vehicle = sumo.vehicle.getIDList()[0]
sumo.vehicle.add("added", sumo.vehicle.getRouteID(vehicle))
step(), step()
sumo.vehicle.remove(sumo.vehicle.getIDList()[0])
step(), step()
sumo.removeStepListener(number)
for _ in range(9): sumo.simulationStep()
sumo.addStepListener(checker)
step(), step()
for _ in range(9): sumo.simulationStep()
sumo.removeStepListener(number + 1)
sumo.simulationStep(), sumo.simulationStep()
checker.step()
assert checker.summary["steps"] == steps + 10, checker.summary
try:
    checker.step()
except ValueError as error:
    assert "again" in str(error)
else:
    raise SystemExit("the same step was checked twice")
sumo.close()
"""


@pytest.mark.parametrize("module", ["libsumo", "traci"])
def test_jumps_added_and_removed_vehicles_are_the_same_simulation(module: str, scenario: Copy) -> None:
    done = python(GOES_ON.replace("{module}", module), scenario("reckless"))
    assert done.returncode == 0, done.stderr


TWICE = """
import sys
import {module} as sumo
import closecall
sumo.start(["sumo", "-c", sys.argv[1], "--no-warnings"])
checker = closecall.Checker(sumo)
sumo.addStepListener(checker)
try:
    sumo.addStepListener(checker)
except ValueError as error:
    print(error)
sumo.simulationStep()
assert checker.summary["steps"] == 1
sumo.close()
"""


@pytest.mark.parametrize("module", ["libsumo", "traci"])
def test_a_listener_is_added_once(module: str, scenario: Copy) -> None:
    done = python(TWICE.replace("{module}", module), scenario("curves"))
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "this checker is a step listener already"
