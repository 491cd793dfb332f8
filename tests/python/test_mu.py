"""μ against an independent model with 60 digits: the motion itself, with its extrema found piece by piece."""

from __future__ import annotations

import json
import math
import random
from typing import Any

import closecall as cc
import mpmath as mp
import numpy as np
import pytest
from conftest import closecall

mp.mp.dps = 60

Piece = tuple[mp.mpf, list[mp.mpf]]


def motion(speed: float, response: float, build_up: float, decel: float) -> list[Piece]:
    """Travel of a braking road user, as pieces: begin, and coefficients of a cubic in the time since then."""
    v, r, t3, a = map(mp.mpf, (speed, response, build_up, decel))
    pieces = [(mp.mpf(0), [mp.mpf(0), v, mp.mpf(0), mp.mpf(0)])]
    distance, now = v * r, r
    ramp = t3
    if t3 > 0:
        ramp = min(t3, mp.sqrt(2 * v * t3 / a))
        pieces.append((now, [distance, v, mp.mpf(0), -a / (6 * t3)]))
        distance += v * ramp - a / (6 * t3) * ramp**3
        now += ramp
    left = v - a * ramp**2 / (2 * t3) if t3 > 0 else v
    if ramp == t3 and left > 0:
        pieces.append((now, [distance, left, -a / 2, mp.mpf(0)]))
        distance += left**2 / (2 * a)
        now += left / a
    return [*pieces, (now, [distance, mp.mpf(0), mp.mpf(0), mp.mpf(0)])]


def shifted(coefficients: list[mp.mpf], by: mp.mpf) -> list[mp.mpf]:
    """The same cubic, in the time since a moment `by` later."""
    a, b, c, d = coefficients
    return [a + by * (b + by * (c + by * d)), b + by * (2 * c + 3 * d * by), c + 3 * d * by, d]


def minimal(ego: list[Piece], foe: list[Piece], sigma: mp.mpf, epsilon: float) -> mp.mpf:
    """max over t ≥ 0 of travel_ego − σ travel_foe, plus ε, at least ε."""
    moments = sorted({begin for begin, _ in ego + foe})
    most = mp.mpf(0)
    for begin, end in zip(moments, [*moments[1:], moments[-1] + 1]):
        own, other = (
            shifted(cubic, begin - start)
            for start, cubic in ([p for p in pieces if p[0] <= begin][-1] for pieces in (ego, foe))
        )
        a, b, c, d = (x - sigma * y for x, y in zip(own, other))
        roots = [mp.mpf(0), end - begin]
        if d != 0:
            inside = c * c - 3 * b * d
            if inside >= 0:
                roots += [(-c + mp.sqrt(inside)) / (3 * d), (-c - mp.sqrt(inside)) / (3 * d)]
        elif c != 0:
            roots.append(-b / (2 * c))
        most = max([most, *(a + t * (b + t * (c + t * d)) for t in roots if 0 <= t <= end - begin)])
    return most + mp.mpf(epsilon)


def reference(case: dict[str, float], sigma: mp.mpf, model: str) -> mp.mpf:
    """μ of a case with 60 digits."""
    own = motion(case["speed"], case["response_time"], case["build_up"], case["decel"])
    late = (case["response_time"], case["build_up"]) if sigma <= 0 else (0.0, 0.0)
    other = motion(case["foe_speed"], *late, case["foe_decel"])
    if model == "minimal":
        return minimal(own, other, sigma, case["epsilon"])
    if model == "at_rest":
        return max(own[-1][1][0] - sigma * other[-1][1][0], mp.mpf(0)) + mp.mpf(case["epsilon"])
    v, vi, a, ai = (mp.mpf(case[name]) for name in ("speed", "foe_speed", "decel", "foe_decel"))
    delay = mp.mpf(case["response_time"]) + mp.mpf(case["build_up"])
    return v * delay + v * v / (2 * a) - vi * vi / (2 * ai) + mp.mpf(case["epsilon"])


def cases(count: int, seed: int) -> list[dict[str, Any]]:
    """Random cases, stiff ones, ones in which S − Sᵢ cancels, and ones with extreme speeds."""
    chance = random.Random(seed)
    found = []
    for number in range(count):
        case = {
            "speed": chance.uniform(0, 70),
            "foe_speed": chance.uniform(0, 70),
            "decel": chance.uniform(0.5, 12),
            "foe_decel": chance.uniform(0.5, 12),
            "response_time": chance.choice([0.0, chance.uniform(0, 3)]),
            "build_up": chance.choice([0.0, 0.1, chance.uniform(0, 3)]),
            "epsilon": chance.choice([0.0, 0.5]),
        }
        if number % 4 == 1:  # stiff
            case["decel"], case["foe_decel"] = (10 ** chance.uniform(-2, 3) for _ in range(2))
            case["build_up"] = 10 ** chance.uniform(-6, 2)
        if number % 4 == 2:  # nearly equal
            case["foe_speed"] = case["speed"] * (1 + chance.choice([0.0, 1e-15, 1e-12, 1e-6]))
            case["foe_decel"] = case["decel"] * (1 + chance.choice([0.0, -1e-15, 1e-12]))
            case["response_time"] = chance.choice([0.0, 1e-12, 1e-6])
            case["build_up"] = chance.choice([0.0, 1e-9])
        if number % 4 == 3:
            case["speed"] = chance.choice([0.0, 1e-100, 1e-9, 300.0])
        found.append(case)
    return found


@pytest.mark.parametrize("model", ["minimal", "at_rest", "paper"])
@pytest.mark.parametrize("kind", ["rear_end", "side", "frontal"])
def test_mu_has_twelve_correct_digits(kind: str, model: str) -> None:
    sigma = {"rear_end": mp.mpf(1), "side": mp.mpf(0), "frontal": mp.mpf(-1)}[kind]
    some = cases(1500, seed=3)
    columns = {name: np.array([case[name] for case in some]) for name in some[0]}
    speed, foe_speed = columns.pop("speed"), columns.pop("foe_speed")
    found = cc.mu(speed, foe_speed, kind=kind, model=model, **columns)
    worst = mp.mpf(0)
    for case, value in zip(some, found):
        wanted = reference(case, sigma, model)
        error = abs(mp.mpf(float(value)) - wanted)
        if wanted == 0:
            assert value == 0, case
        elif abs(wanted) > 1e-290:
            worst = max(worst, error / abs(wanted))
            assert error / abs(wanted) < 1e-12, (case, value, wanted)
    assert worst < 1e-12


def test_mu_at_any_angle_has_twelve_correct_digits() -> None:
    chance = random.Random(5)
    for case in cases(400, seed=4):
        angle = chance.uniform(0, math.pi)
        found = float(cc.mu(angle=angle, **case))
        wanted = reference(case, mp.mpf(math.cos(angle)), "minimal")
        assert abs(found - wanted) <= 1e-12 * abs(wanted) + 1e-290, (case, angle)


def test_arrays_broadcast_as_in_numpy() -> None:
    found = cc.mu(np.array([[10.0], [20.0]]), np.array([0.0, 5.0, 10.0]))
    assert found.shape == (2, 3)
    assert found[1, 2] == cc.mu(20.0, 10.0)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"decel": 0.0}, "decel is 0"),
        ({"speed": -1.0}, "speed is -1"),
        ({"speed": math.nan}, "speed is NaN"),
        ({"speed": 1e308}, "speed is 1e308, it must be 0 to 1000 m/s"),
        ({"angle": [0.0, math.nan]}, "angle is NaN"),
        ({"angle": -1.0}, "angle is -1"),
        ({"kind": "sideways"}, "rear_end, frontal or side"),
        ({"model": "best"}, "minimal, at_rest, paper or rss"),
    ],
)
def test_a_value_out_of_its_range_is_named(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        values: dict[str, Any] = {"speed": 10.0, "foe_speed": 5.0, **changed}
        cc.mu(**values)


def test_the_command_prints_every_model() -> None:
    speeds = ["--speed", "30", "--foe-speed", "25", "--decel", "8", "--foe-decel", "4"]
    words = [*speeds, "--response-time", "1", "--build-up", "0", "--epsilon", "0"]
    found = json.loads(closecall("mu", *words, "--json").stdout)
    assert (found["minimal"], found["at_rest"], found["paper"]) == (17.125, 8.125, 8.125)
    assert found["rss"] == cc.mu(30.0, 25.0, model="rss", epsilon=0.0)
    assert "minimal  17.125 m" in closecall("mu", *words).stdout


def test_published_stopping_distances_are_met() -> None:
    """ad-rss-lib's tests: 64.3 m from 100 km/h at 6 m/s²; UK Highway Code, rule 126: 12, 23, 36, 53, 73, 96 m."""
    stop: dict[str, Any] = {"kind": "side", "build_up": 0.0, "epsilon": 0.0, "foe_speed": 0.0}
    assert round(float(cc.mu(100 / 3.6, decel=6.0, response_time=0.0, **stop)), 1) == 64.3
    mile_per_hour = 0.44704
    speeds = np.arange(20, 71, 10) * mile_per_hour
    found = cc.mu(speeds, decel=6.5, response_time=0.67, **stop)
    # The table rounds thinking and braking distance separately: 11.98 and 24.59 m to 12 and 24 m.
    assert np.all(np.abs(found - [12, 23, 36, 53, 73, 96]) < 0.6), found


def test_the_german_rule_of_thumb_is_reproduced() -> None:
    """Hazard braking from 100 km/h takes 80 m: 30 m of response (V/10 · 3) and 50 m of braking ((V/10)² / 2)."""
    speed = 100 / 3.6
    decel = speed**2 / (2 * 50.0)
    stop: dict[str, Any] = {"kind": "side", "build_up": 0.0, "epsilon": 0.0, "foe_speed": 0.0}
    assert 7.5 < decel < 8.0, "what brakes do on a dry road"
    found = float(cc.mu(speed, decel=decel, response_time=30.0 / speed, **stop))
    assert abs(found - 80.0) < 1e-9
