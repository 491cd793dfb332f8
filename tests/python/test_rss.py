"""μ and the RSS distances against ad-rss, Intel's library of the RSS model."""

from __future__ import annotations

import math
import random
import warnings
from typing import Any

import closecall as cc
import pytest

with warnings.catch_warnings():
    # ad-rss's modules register one converter twice.
    warnings.simplefilter("ignore", RuntimeWarning)
    rss = pytest.importorskip("ad_rss").rss


def like(example: Any, value: float) -> Any:
    """A value of the same physical type."""
    return type(example)(value)


def fill(target: Any, **values: float) -> None:
    """Set members of ad-rss's structs, each of its own physical type."""
    for name, value in values.items():
        setattr(target, name, like(getattr(target, name), value))


def road_user(speed: float, decel: float, response: float) -> Any:
    """A road user that brakes with `decel` m/s² after `response` s."""
    state = rss.core.RelativeObjectState()
    state.object_type = rss.world.ObjectType.OtherVehicle
    structured = state.structured_object_state
    structured.is_in_correct_lane = True
    fill(structured.velocity, speed_lon_min=speed, speed_lon_max=speed, speed_lat_min=0.0, speed_lat_max=0.0)
    fill(structured, distance_to_enter_intersection=1e3, distance_to_leave_intersection=1e3)
    dynamics = state.dynamics
    fill(dynamics.alpha_lon, accel_max=0.0, brake_max=-decel, brake_min=-decel, brake_min_correct=-decel)
    fill(dynamics.alpha_lat, accel_max=0.2, brake_min=-0.8)
    fill(dynamics, lateral_fluctuation_margin=0.0, response_time=response, max_speed_on_acceleration=100.0)
    fill(dynamics, min_longitudinal_safety_distance=0.0)
    # The unstructured part has no effect here but must be valid.
    settings = dynamics.unstructured_settings
    fill(settings, pedestrian_turning_radius=2.0, drive_away_max_angle=2.4, vehicle_yaw_rate_change=0.3)
    fill(settings, vehicle_min_radius=3.5, vehicle_trajectory_calculation_step=0.2)
    unstructured = state.unstructured_object_state
    fill(unstructured, yaw=0.0, yaw_rate=0.0, steering_angle=0.0)
    fill(unstructured.dimension, length=5.0, width=2.0)
    fill(unstructured.center_point, x=0.0, y=0.0)
    fill(unstructured.speed_range, minimum=speed, maximum=speed)
    return state


def safe_distance(function: Any, first: Any, second: Any) -> float:
    """The safe distance by ad-rss, in m."""
    distance = like(first.dynamics.min_longitudinal_safety_distance, 0.0)
    assert function(first, second, distance)
    return float(distance.mDistance)


@pytest.mark.parametrize(
    ("kind", "model", "name"),
    [
        ("rear_end", "at_rest", "calculateSafeLongitudinalDistanceSameDirection"),
        ("frontal", "minimal", "calculateSafeLongitudinalDistanceOppositeDirection"),
    ],
)
def test_mu_equals_the_rss_safe_distance(kind: str, model: str, name: str) -> None:
    chance = random.Random(7)
    for _ in range(300):
        speed, foe_speed = chance.uniform(0.1, 50), chance.uniform(0.1, 50)
        decel, foe_decel = chance.uniform(2, 10), chance.uniform(2, 10)
        response = chance.uniform(0.2, 2)
        ego, foe = road_user(speed, decel, response), road_user(foe_speed, foe_decel, response)
        same = kind == "rear_end"
        function = getattr(rss.structured, name)
        wanted = safe_distance(function, foe if same else ego, ego if same else foe)
        found = cc.mu(
            speed,
            foe_speed,
            decel=decel,
            foe_decel=foe_decel,
            response_time=response,
            build_up=0.0,
            epsilon=0.0,
            kind=kind,
            model=model,
        )
        assert float(found) == pytest.approx(wanted, rel=1e-9, abs=1e-9)


def by_the_values_of_closecall(speed: float, aside: float = 0.0) -> Any:
    """A road user with the accelerations that closecall's RSS distances assume; `aside` is its speed to the right."""
    state = road_user(speed, 4.0, 1.0)
    fill(state.dynamics.alpha_lon, accel_max=3.5, brake_max=-8.0)
    fill(state.dynamics, lateral_fluctuation_margin=0.1)
    fill(state.structured_object_state.velocity, speed_lat_min=aside, speed_lat_max=aside)
    return state


@pytest.mark.parametrize("kind", ["rear_end", "frontal"])
def test_mu_by_rss_is_the_safe_distance(kind: str) -> None:
    ahead = math.pi if kind == "frontal" else 0.0
    chance = random.Random(5)
    compared = 0
    for _ in range(20):
        speed, foe_speed = chance.uniform(5, 40), chance.uniform(0.1, 30)
        frame = {"id": ["ego", "foe"], "x": [0, 80], "y": [0, 0], "heading": [0, ahead], "speed": [speed, foe_speed]}
        with cc.Checker(path="straight", mu="rss", measures="rss_distance", log="gap < 200") as checker:
            checker.step(0.0, frame)
        for conflict in checker.conflicts:
            own, other = (speed, foe_speed) if conflict.ego == "ego" else (foe_speed, speed)
            wanted = float(cc.mu(own, other, kind=kind, model="rss"))
            assert conflict.mu == pytest.approx(wanted, rel=1e-12)
            assert conflict.rss_distance is not None
            assert conflict.mu == pytest.approx(conflict.rss_distance + 0.5, rel=1e-9)
            left = conflict.response_left
            assert (left is not None and left < 1.0) == (conflict.margin < 0.0)
            compared += 1
    # The others do not meet before both stand.
    assert compared > 10


def test_mu_by_rss_finds_a_follower_far_behind() -> None:
    # RSS asks for 90.78125 m at 20 m/s behind a standing car; the follower's own brakes stop it after 44 m.
    frame = {"id": ["ego", "foe"], "x": [0, 70], "y": [0, 0], "heading": [0, 0], "speed": [20, 0]}
    found = {}
    for model in ("rss", "minimal"):
        with cc.Checker(mu=model) as checker:
            checker.step(0.0, frame)
            found[model] = [round(conflict.margin, 3) for conflict in checker.conflicts]
    assert found == {"rss": [round(65 - 90.78125 - 0.5, 3)], "minimal": []}


@pytest.mark.parametrize("kind", ["rear_end", "frontal"])
def test_the_safe_distances_are_those_of_ad_rss(kind: str) -> None:
    chance = random.Random(3)
    pairs = 200
    speeds = [(chance.uniform(5, 40), chance.uniform(0, 30)) for _ in range(pairs)]
    turned = [chance.uniform(-0.3, 0.3) for _ in range(pairs)]
    # Each pair is by itself; the foe is ahead, a little to the left.
    frame: dict[str, list[Any]] = {name: [] for name in ("id", "x", "y", "heading", "speed")}
    for number, ((speed, foe_speed), turn) in enumerate(zip(speeds, turned)):
        ahead = turn if kind == "rear_end" else math.pi + turn
        for who, x, y, heading, v in (("ego", 0, 0, 0, speed), ("foe", 25, 0.3, ahead, foe_speed)):
            values = {"id": f"{who}{number}", "x": x, "y": y + 1e3 * number, "heading": heading, "speed": v}
            for name, value in values.items():
                frame[name].append(value)
    with cc.Checker(path="straight", measures="rss_distance,rss_lateral_distance", log="gap < 50") as checker:
        checker.step(0.0, frame)
        found = {int(one.ego[3:]): one for one in checker.conflicts if one.ego.startswith("ego") and one.kind == kind}
    assert len(found) > pairs / 4
    for number, conflict in found.items():
        (speed, foe_speed), turn = speeds[number], turned[number]
        ego, foe = by_the_values_of_closecall(speed), by_the_values_of_closecall(foe_speed)
        same = kind == "rear_end"
        name = "SameDirection" if same else "OppositeDirection"
        function = getattr(rss.structured, f"calculateSafeLongitudinalDistance{name}")
        wanted = safe_distance(function, foe if same else ego, ego if same else foe)
        assert conflict.rss_distance == pytest.approx(wanted, rel=1e-9, abs=1e-9)
        # The foe on the left; mirrored where its centre, 2.5 m behind its front, is on the right.
        to_the_left = foe_speed * math.sin(turn) * (1 if same else -1)
        side = math.copysign(1, 0.3 - 2.5 * math.sin(turn) * (1 if same else -1))
        beside = by_the_values_of_closecall(foe_speed, -side * to_the_left)
        lateral = safe_distance(rss.structured.calculateSafeLateralDistance, beside, ego)
        assert conflict.rss_lateral_distance == pytest.approx(lateral, rel=1e-9, abs=1e-9)
