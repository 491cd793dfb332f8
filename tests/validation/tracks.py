"""Recordings as tables of trajectories, and the pairs of road users in them.

A table has the columns id, t, x, y, heading, length and width, and perhaps speed and class; units are SI, x and y are
centres. Recordings of INTERACTION are read too.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path

import numpy as np

COLUMNS = ("id", "t", "x", "y", "heading", "speed", "length", "width", "class")
# In seconds: times are compared in whole numbers of this.
TICK = 0.001


@dataclass(frozen=True)
class Track:
    """A road user: where it was at which times."""

    name: str
    length: float
    width: float
    ticks: np.ndarray
    x: np.ndarray
    y: np.ndarray
    heading: np.ndarray
    speed: np.ndarray
    """As recorded, or else what `speeds` makes of the places."""


@dataclass(frozen=True)
class Pair:
    """Two road users that are in the scene together."""

    recording: str
    names: frozenset[str]
    crash: bool
    begin: int
    """First common tick."""
    closest: int
    """Tick of the smallest centre distance."""
    same_direction: bool
    """Whether their headings differ by less than 30° then."""


@dataclass(frozen=True)
class Recording:
    """A recording and what is in it."""

    path: Path
    crash: bool
    tracks: dict[str, Track]

    @property
    def name(self) -> str:
        """Its file name without the ending."""
        return self.path.stem

    @property
    def hours(self) -> float:
        """How long all its road users were in the scene together, in vehicle-hours."""
        return sum(int(track.ticks[-1] - track.ticks[0]) for track in self.tracks.values()) * TICK / 3600

    @cached_property
    def pairs(self) -> list[Pair]:
        """All pairs with at least two common times."""
        return list(self._pairs())

    def _pairs(self) -> Iterator[Pair]:
        for one, other in combinations(self.tracks.values(), 2):
            if one.ticks[-1] < other.ticks[0] or other.ticks[-1] < one.ticks[0]:
                continue
            common, of_one, of_other = np.intersect1d(one.ticks, other.ticks, return_indices=True)
            if len(common) < 2:
                continue
            distance = np.hypot(one.x[of_one] - other.x[of_other], one.y[of_one] - other.y[of_other])
            at = int(np.argmin(distance))
            turned = math.cos(one.heading[of_one[at]] - other.heading[of_other[at]])
            names = frozenset((one.name, other.name))
            same = turned > math.cos(math.radians(30))
            yield Pair(self.name, names, self.crash, int(common[0]), int(common[at]), same)


def speeds(ticks: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Central differences of the places, in m/s."""
    if len(ticks) < 2:
        return np.zeros(len(ticks))
    seconds = ticks * TICK
    return np.asarray(np.hypot(np.gradient(x, seconds), np.gradient(y, seconds)))


def read(path: Path, crash: bool) -> Recording:
    """A table of trajectories, or a recording of INTERACTION."""
    with path.open(newline="") as lines:
        rows = list(csv.DictReader(lines))
    grouped: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        plain = row if "heading" in row else of_interaction(row)
        grouped.setdefault(plain["id"], []).append(plain)
    tracks = {}
    for name, of_one in grouped.items():
        of_one.sort(key=lambda row: float(row["t"]))
        t, x, y, heading = (np.array([float(row[key]) for row in of_one]) for key in ("t", "x", "y", "heading"))
        ticks = np.rint(t / TICK).astype(int)
        recorded = "speed" in of_one[0]
        speed = np.array([float(row["speed"]) for row in of_one]) if recorded else speeds(ticks, x, y)
        length, width = float(of_one[0]["length"]), float(of_one[0]["width"])
        tracks[name] = Track(name, length, width, ticks, x, y, heading, speed)
    return Recording(path, crash, tracks)


def of_interaction(row: dict[str, str]) -> dict[str, str]:
    """A row of a recording of INTERACTION as one of a table."""
    speed = math.hypot(float(row["vx"]), float(row["vy"]))
    seconds = float(row["timestamp_ms"]) / 1000
    plain = {"id": row["track_id"], "t": f"{seconds:.3f}", "heading": row["psi_rad"], "speed": f"{speed:.4f}"}
    return plain | {"class": row["agent_type"]} | {key: row[key] for key in ("x", "y", "length", "width")}
