"""Contact and distance of rectangles, against shapely."""

from __future__ import annotations

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
    """The same as shapely's polygons."""
    x, y, heading, length, width = rows.T
    along = np.stack([np.cos(heading), np.sin(heading)], -1) * (length / 2)[:, None]
    across = np.stack([-np.sin(heading), np.cos(heading)], -1) * (width / 2)[:, None]
    centre = np.stack([x, y], -1)
    corners = [centre + along + across, centre - along + across, centre - along - across, centre + along - across]
    shapes: NDArray[np.object_] = shapely.polygons(np.stack(corners, 1))
    return shapes


def test_contact_and_distance_are_those_of_shapely() -> None:
    a, b = rectangles(100_000, 1), rectangles(100_000, 2)
    ours = geometry.distance(a, b)
    theirs = shapely.distance(polygons(a), polygons(b))
    assert np.abs(ours - theirs).max() < 1e-9
    clear = np.abs(theirs) > 1e-9
    overlap = shapely.intersects(polygons(a), polygons(b))
    assert np.array_equal(geometry.touches(a, b)[clear], overlap[clear])
    assert 0.05 < overlap.mean() < 0.95


def test_touching_counts() -> None:
    first = [[0.0, 0.0, 0.0, 4.0, 2.0]]
    assert geometry.touches(first, [[4.0, 0.0, 0.0, 4.0, 2.0]]).tolist() == [True]
    assert geometry.touches(first, [[4.0 + 1e-12, 0.0, 0.0, 4.0, 2.0]]).tolist() == [False]


def test_rows_that_are_no_rectangles_are_refused() -> None:
    good = [[0.0, 0.0, 0.0, 4.0, 2.0]]
    with pytest.raises(ValueError, match="row 0"):
        geometry.touches(good, [[0.0, np.nan, 0.0, 4.0, 2.0]])
    with pytest.raises(ValueError, match="5"):
        geometry.distance(good, [[0.0, 0.0, 0.0, 4.0]])
