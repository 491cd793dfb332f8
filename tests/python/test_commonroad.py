"""TTC and the steer threat number against commonroad-crime's, on what leader and follower of `rear_end` drove."""

from __future__ import annotations

import importlib.util
import math
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import NETS, closecall, rows

# commonroad is imported inside the functions: its 6 s would else delay every worker that collects this file.
pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("commonroad_crime") is None, reason="commonroad-crime has no wheel for this Python"
)

LENGTH, WIDTH = 5.0, 1.8
STEP = 0.1
EGO, FOE, LANELET = 10, 11, 1
# What the brakes and tyres of the cars in `rear_end` can do, in m/s².
BRAKES = 9.0
# commonroad-crime rounds accelerations to centimetres, and measures along a polyline.
TOLERANCES = {"ttc": 0.01, "a_lat_req": 0.02, "stn": 0.003}


def car(number: int, front: float, speed: float) -> Any:
    """A car on the x axis that keeps its speed, as TTC assumes; commonroad-crime would extrapolate its acceleration."""
    from commonroad.geometry.shape import Rectangle
    from commonroad.prediction.prediction import TrajectoryPrediction
    from commonroad.scenario.obstacle import DynamicObstacle, ObstacleType
    from commonroad.scenario.state import CustomState, InitialState
    from commonroad.scenario.trajectory import Trajectory

    def state(step: int) -> dict[str, Any]:
        place = np.array([front - LENGTH / 2 + speed * STEP * step, 0.0])
        return {"position": place, "velocity": speed, "orientation": 0.0, "time_step": step, "acceleration": 0.0}

    shape = Rectangle(LENGTH, WIDTH)
    lanes = {step: {LANELET} for step in range(5)}
    later = [CustomState(**state(step), velocity_y=0.0, acceleration_y=0.0) for step in range(1, 5)]
    prediction = TrajectoryPrediction(
        Trajectory(1, later), shape, center_lanelet_assignment=lanes, shape_lanelet_assignment=lanes
    )
    first = InitialState(**state(0), yaw_rate=0.0, slip_angle=0.0)
    return DynamicObstacle(number, ObstacleType.CAR, shape, first, prediction, {LANELET}, {LANELET})


def theirs(ego: tuple[float, float], foe: tuple[float, float]) -> dict[str, float]:
    """commonroad-crime's measures of two cars, each given by its front position and its speed."""
    from commonroad.scenario.lanelet import Lanelet
    from commonroad.scenario.scenario import Scenario
    from commonroad_crime.data_structure.configuration import CriMeConfiguration
    from commonroad_crime.measure import STN, TTC, ALatReq

    scenario = Scenario(STEP)
    line = np.linspace(-100.0, 1000.0, 200)
    right, centre, left = (np.column_stack([line, np.full_like(line, y)]) for y in (-1.6, 0.0, 1.6))
    scenario.add_objects(Lanelet(left, centre, right, LANELET))
    scenario.add_objects([car(EGO, *ego), car(FOE, *foe)])
    configuration = CriMeConfiguration()
    configuration.update(ego_id=EGO, sce=scenario)
    configuration.vehicle.curvilinear.a_lat_max = BRAKES
    # Its required deceleration cannot be compared: its headway moves both fronts sideways by half a length.
    measures = {"ttc": TTC, "a_lat_req": ALatReq, "stn": STN}
    return {name: float(of(configuration).compute(FOE, 0, verbose=False)) for name, of in measures.items()}


def test_a_followers_measures_equal_commonroad_crimes(tmp_path: Path) -> None:
    fcd = tmp_path / "fcd.xml"
    words = (
        "--align",
        "never",
        "--log-series",
        "--measures",
        "a_lat_req,stn",
        "--",
        "--no-warnings",
        "--fcd-output",
        fcd,
        "--precision",
        "6",
    )
    done = closecall("run", NETS / "rear_end" / "rear_end.sumocfg", "--out", tmp_path, *words)
    assert done.returncode == 0, done.stderr
    driven: dict[tuple[float, str], tuple[float, float]] = {}
    for step in ET.parse(fcd).getroot():
        for vehicle in step.findall("vehicle"):
            x, speed = (float(vehicle.get(name, "nan")) for name in ("x", "speed"))
            driven[float(step.get("time", "nan")), vehicle.get("id", "")] = x, speed
    compared = [row for row in rows(tmp_path / "series.csv") if row["ttc"]][::12]
    assert len(compared) > 5
    for row in compared:
        ego, foe = (driven[float(row["time"]), row[name]] for name in ("ego", "foe"))
        for name, value in theirs(ego, foe).items():
            # Ours ends at 12.68 m/s².
            if name == "ttc" or value < 12.0 / (BRAKES if name == "stn" else 1.0):
                assert math.isclose(value, float(row[name]), abs_tol=TOLERANCES[name], rel_tol=2e-3), (name, value, row)
