"""Contact and distance of rectangles, against shapely and rational arithmetic."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import numpy as np
import pytest
import shapely
from closecall import geometry
from numpy.typing import NDArray

Rows = NDArray[np.float64]


def rectangles(count: int, seed: int) -> Rows:
    """Random cars and trucks in a square of 20 m."""
    chance = np.random.default_rng(seed)
    low, high = [0, 0, -np.pi, 0.5, 0.3], [20, 20, np.pi, 15, 3]
    return chance.uniform(low, high, (count, 5))


def polygons(rows: Rows) -> NDArray[np.object_]:
    """The same rectangles as shapely polygons."""
    x, y, heading, length, width = rows.T
    along = np.stack([np.cos(heading), np.sin(heading)], -1) * (length / 2)[:, None]
    across = np.stack([-np.sin(heading), np.cos(heading)], -1) * (width / 2)[:, None]
    centre = np.stack([x, y], -1)
    corners = [centre + along + across, centre - along + across, centre - along - across, centre + along - across]
    shapes: NDArray[np.object_] = shapely.polygons(np.stack(corners, 1))
    return shapes


def test_contact_and_distance_equal_shapelys() -> None:
    a, b = rectangles(100_000, 1), rectangles(100_000, 2)
    ours = geometry.distance(a, b)
    theirs = shapely.distance(polygons(a), polygons(b))
    assert np.abs(ours - theirs).max() < 1e-9
    clear = np.abs(theirs) > 1e-9
    overlap = shapely.intersects(polygons(a), polygons(b))
    assert np.array_equal(geometry.touches(a, b)[clear], overlap[clear])
    assert 0.05 < overlap.mean() < 0.95


def test_touching_counts_as_contact() -> None:
    first = [[0.0, 0.0, 0.0, 4.0, 2.0]]
    assert geometry.touches(first, [[4.0, 0.0, 0.0, 4.0, 2.0]]).tolist() == [True]
    assert geometry.touches(first, [[4.0 + 1e-12, 0.0, 0.0, 4.0, 2.0]]).tolist() == [False]


Row = list[float]


def exactly_touch(a: Row, b: Row) -> bool:
    """The definition of contact in rational arithmetic, for the corners given by the f64 cosine and sine."""
    first, second = (
        [Fraction(value) for value in (x, y, math.cos(h), math.sin(h), *size)] for x, y, h, *size in (a, b)
    )
    sides = [((c, s), (-s, c), length / 2, width / 2) for _, _, c, s, length, width in (first, second)]
    for axis in [side for along, across, _, _ in sides for side in (along, across)]:

        def onto(vector: tuple[Fraction, Fraction], axis: tuple[Fraction, Fraction] = axis) -> Fraction:
            return abs(vector[0] * axis[0] + vector[1] * axis[1])

        reach = sum(onto(along) * half + onto(across) * other for along, across, half, other in sides)
        if onto((second[0] - first[0], second[1] - first[1])) > reach:
            return False
    return True


def test_contact_agrees_with_rational_arithmetic() -> None:
    chance = random.Random(3)
    pairs: list[tuple[Row, Row]] = []
    for _ in range(4000):
        heading = chance.choice([chance.uniform(-4, 4), math.pi / 2, math.pi, 0.0])
        first = [chance.uniform(-9, 9), chance.uniform(-9, 9), heading, chance.uniform(0, 9), chance.uniform(0, 3)]
        turn = chance.choice([0.0, 1e-16, math.pi / 2, chance.uniform(-4, 4)])
        length = chance.choice([0.001, 4.0, 100.0])
        # One rectangle behind the other, touching to within a few units in the last place.
        offset = first[3] / 2 + length / 2 * abs(math.cos(turn)) + abs(math.sin(turn))
        x, y = first[0] + math.cos(heading) * offset, first[1] + math.sin(heading) * offset
        nudged = x * (1 + chance.randint(-3, 3) * 2**-52)
        pairs.append((first, [nudged, y, heading + turn, length, 2.0]))
    found = geometry.touches([a for a, _ in pairs], [b for _, b in pairs])
    wanted = [exactly_touch(a, b) for a, b in pairs]
    assert found.tolist() == wanted
    assert 0.2 < sum(wanted) / len(wanted) < 0.9


def test_rows_that_are_not_rectangles_are_refused() -> None:
    good = [[0.0, 0.0, 0.0, 4.0, 2.0]]
    with pytest.raises(ValueError, match="row 0"):
        geometry.touches(good, [[0.0, np.nan, 0.0, 4.0, 2.0]])
    with pytest.raises(ValueError, match="5"):
        geometry.distance(good, [[0.0, 0.0, 0.0, 4.0]])
