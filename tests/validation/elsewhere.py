"""2D-TTC, TTC2D, ACT and TAdv of every pair in every step, as SSMsOnPlane computes them.

2D-TTC is its `TTC`, of rectangles at constant velocities (Jiao 2023); TTC2D is that of Guo et al. (2023).
SSMsOnPlane (Yiru Jiao, MIT) is a repository, not a package: `--ssms-on-plane` names a copy of it. It needs pandas.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from tracks import Pair, Recording, Track

# Pairs whose centres are farther apart have no small value of any.
FAR = 100.0


class Elsewhere:
    """The functions of SSMsOnPlane."""

    def __init__(self, repository: Path) -> None:
        sys.path.insert(0, str(repository))
        along, on_plane = (import_module(f"src.{name}") for name in ("longitudinal_ssms", "two_dimensional_ssms"))
        self.functions: dict[str, Any] = {"2D-TTC": along.TTC}
        self.functions |= {name: getattr(on_plane, name) for name in ("TTC2D", "ACT", "TAdv")}

    def steps(self, recording: Recording) -> dict[frozenset[str], dict[int, dict[str, float]]]:
        """The values of each pair by tick."""
        import pandas

        names: list[tuple[frozenset[str], int]] = []
        parts: list[dict[str, np.ndarray]] = []
        for pair in recording.pairs:
            ticks, columns = samples(recording, pair)
            names += [(pair.names, int(tick)) for tick in ticks]
            parts.append(columns)
        if not parts:
            return {}
        table = pandas.DataFrame({key: np.concatenate([part[key] for part in parts]) for key in parts[0]})
        with np.errstate(all="ignore"):
            values = {name: function(table.copy(), "values") for name, function in self.functions.items()}
        found: dict[frozenset[str], dict[int, dict[str, float]]] = {}
        for index, (pair_names, tick) in enumerate(names):
            # Below 0 the two overlap: that is contact.
            of_step = {name: max(float(of[index]), 0.0) for name, of in values.items()}
            found.setdefault(pair_names, {})[tick] = of_step
        return found


def samples(recording: Recording, pair: Pair) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """The common ticks of a pair while it is near, and what SSMsOnPlane wants to know of them."""
    one, other = (recording.tracks[name] for name in sorted(pair.names))
    common, of_one, of_other = np.intersect1d(one.ticks, other.ticks, return_indices=True)
    near = np.hypot(one.x[of_one] - other.x[of_other], one.y[of_one] - other.y[of_other]) < FAR
    columns = dict(columns_of(one, of_one[near], "i")) | dict(columns_of(other, of_other[near], "j"))
    return common[near], columns


def columns_of(track: Track, at: np.ndarray, which: str) -> Iterator[tuple[str, np.ndarray]]:
    """The columns of one road user."""
    east, north = np.cos(track.heading[at]), np.sin(track.heading[at])
    yield from {f"x_{which}": track.x[at], f"y_{which}": track.y[at]}.items()
    yield from {f"hx_{which}": east, f"hy_{which}": north}.items()
    yield from {f"vx_{which}": track.speed[at] * east, f"vy_{which}": track.speed[at] * north}.items()
    yield f"length_{which}", np.full(len(at), track.length)
    yield f"width_{which}", np.full(len(at), track.width)
