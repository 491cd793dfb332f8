"""μ against ad-rss, Intel's library of the RSS model, without acceleration during the response, build-up and ε."""

from __future__ import annotations

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
