"""TTC against commonroad-crime's, on what the leader and the follower of `rear_end` really drove."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
from conftest import NETS, closecall, rows

pytest.importorskip("commonroad_crime", reason="there is no wheel of commonroad-crime for this Python")

import numpy as np
from commonroad.geometry.shape import Rectangle
from commonroad.prediction.prediction import TrajectoryPrediction
from commonroad.scenario.lanelet import Lanelet
from commonroad.scenario.obstacle import DynamicObstacle, ObstacleType
from commonroad.scenario.scenario import Scenario
from commonroad.scenario.state import CustomState, InitialState
from commonroad.scenario.trajectory import Trajectory
from commonroad_crime.data_structure.configuration import CriMeConfiguration
from commonroad_crime.measure import TTC

LENGTH, WIDTH = 5.0, 1.8
EGO, FOE, LANELET = 10, 11, 1


def car(number: int, driven: list[tuple[float, float]]) -> Any:
    """A car on the x axis, from its front's place and its speed in each step; accelerations are not to count."""
    states = [
        {
            "position": np.array([x - LENGTH / 2, 0.0]),
            "velocity": speed,
            "orientation": 0.0,
            "time_step": step,
            "acceleration": 0.0,
        }
        for step, (x, speed) in enumerate(driven)
    ]
    shape = Rectangle(LENGTH, WIDTH)
    lanes = {step: {LANELET} for step in range(len(states))}
    trajectory = Trajectory(1, [CustomState(**state, velocity_y=0.0, acceleration_y=0.0) for state in states[1:]])
    prediction = TrajectoryPrediction(
        trajectory, shape, center_lanelet_assignment=lanes, shape_lanelet_assignment=lanes
    )
    first = InitialState(**states[0], yaw_rate=0.0, slip_angle=0.0)
    return DynamicObstacle(number, ObstacleType.CAR, shape, first, prediction, {LANELET}, {LANELET})


def test_ttc_of_a_follower_is_that_of_commonroad_crime(tmp_path: Path) -> None:
    fcd = tmp_path / "fcd.xml"
    words = ("--log-encounters", "--", "--no-warnings", "--fcd-output", fcd, "--precision", "6")
    done = closecall("run", NETS / "rear_end" / "rear_end.sumocfg", "--out", tmp_path, *words)
    assert done.returncode == 0, done.stderr
    times: list[float] = []
    driven: dict[str, list[tuple[float, float]]] = {"follower": [], "leader": []}
    for step in ET.parse(fcd).getroot():
        vehicles = {vehicle.get("id", ""): vehicle for vehicle in step.findall("vehicle")}
        if vehicles.keys() >= driven.keys():
            times.append(float(step.get("time", "nan")))
            for name, states in driven.items():
                states.append((float(vehicles[name].get("x", "nan")), float(vehicles[name].get("speed", "nan"))))
    scenario = Scenario(0.1)
    line = np.linspace(-100.0, 2000.0, 400)
    sides = (np.column_stack([line, np.full_like(line, y)]) for y in (1.6, 0.0, -1.6))
    scenario.add_objects(Lanelet(*sides, LANELET))
    scenario.add_objects([car(EGO, driven["follower"]), car(FOE, driven["leader"])])
    configuration = CriMeConfiguration()
    configuration.update(ego_id=EGO, sce=scenario)
    ttc = TTC(configuration)
    compared = 0
    for row in rows(tmp_path / "encounters.csv"):
        if row["ttc"]:
            theirs = ttc.compute(FOE, times.index(float(row["time"])), verbose=False)
            # Theirs is rounded to two decimals.
            assert math.isclose(theirs, float(row["ttc"]), abs_tol=0.0051), row
            compared += 1
    assert compared > 70
