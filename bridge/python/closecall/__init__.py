"""Traffic conflict checker for SUMO: which road users come too close, how close, and in what kind of conflict.

>>> import closecall
>>> float(closecall.mu(30.0, 25.0, decel=8.0, foe_decel=4.0, response_time=1.0, build_up=0.0, epsilon=0.0))
17.125
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import geometry
from ._closecall import Alarm, Conflict, Table, __version__, mu, read, replay
from .reward import Reward

if TYPE_CHECKING:
    from ._checker import Checker

__all__ = ["Alarm", "Checker", "Conflict", "Reward", "Table", "__version__", "geometry", "mu", "read", "replay"]


def __getattr__(name: str) -> type[Checker]:
    # Checker imports traci, which takes longer than closecall itself and which the runs of a sweep do not need.
    if name == "Checker":
        from ._checker import Checker

        return Checker
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
