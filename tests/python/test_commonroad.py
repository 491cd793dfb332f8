"""TTC against commonroad-crime's, on the trajectories that leader and follower of `rear_end` drove."""

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


def their_ttc(ego: tuple[float, float], foe: tuple[float, float]) -> float:
    """commonroad-crime's TTC of two cars, each given by its front position and its speed."""
    from commonroad.scenario.lanelet import Lanelet
    from commonroad.scenario.scenario import Scenario
    from commonroad_crime.data_structure.configuration import CriMeConfiguration
    from commonroad_crime.measure import TTC

    scenario = Scenario(STEP)
    line = np.linspace(-100.0, 1000.0, 200)
    right, centre, left = (np.column_stack([line, np.full_like(line, y)]) for y in (-1.6, 0.0, 1.6))
    scenario.add_objects(Lanelet(left, centre, right, LANELET))
    scenario.add_objects([car(EGO, *ego), car(FOE, *foe)])
    configuration = CriMeConfiguration()
    configuration.update(ego_id=EGO, sce=scenario)
    return float(TTC(configuration).compute(FOE, 0, verbose=False))


def test_a_followers_ttc_equals_commonroad_crimes(tmp_path: Path) -> None:
    fcd = tmp_path / "fcd.xml"
    words = ("--align", "never", "--log-series", "--", "--no-warnings", "--fcd-output", fcd, "--precision", "6")
    done = closecall("run", NETS / "rear_end" / "rear_end.sumocfg", "--out", tmp_path, *words)
    assert done.returncode == 0, done.stderr
    driven: dict[tuple[float, str], tuple[float, float]] = {}
    for step in ET.parse(fcd).getroot():
        for vehicle in step.findall("vehicle"):
            x, speed = (float(vehicle.get(name, "nan")) for name in ("x", "speed"))
            driven[float(step.get("time", "nan")), vehicle.get("id", "")] = x, speed
    compared = [row for row in rows(tmp_path / "series.csv") if row["ttc"]][::6]
    assert len(compared) > 10
    for row in compared:
        ego, foe = (driven[float(row["time"]), row[name]] for name in ("ego", "foe"))
        # commonroad-crime measures along a polyline and rounds.
        assert math.isclose(their_ttc(ego, foe), float(row["ttc"]), abs_tol=0.01), row
