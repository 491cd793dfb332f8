"""Traffic conflict checker for SUMO: who comes too close, how close, and what kind of conflict it is.

>>> import closecall
>>> float(closecall.mu(30.0, 25.0, decel=8.0, foe_decel=4.0, response_time=1.0, build_up=0.0, epsilon=0.0))
17.125
"""

from __future__ import annotations

from . import geometry
from ._closecall import Checker as _Checker
from ._closecall import Conflict, __version__, mu

try:
    from traci.step import StepListener
except ImportError:  # without SUMO a checker takes plain frames
    StepListener = object

__all__ = ["Checker", "Conflict", "__version__", "geometry", "mu"]


class Checker(_Checker, StepListener):  # type: ignore[misc]
    """Finds the conflicts of a simulation, or of plain frames, step by step.

    >>> checker = Checker()
    >>> car = {"id": ["a", "b"], "x": [0.0, 20.0], "y": [0.0, 0.0], "heading": [0.0, 0.0], "speed": [20.0, 5.0]}
    >>> checker.step(0.0, car)
    True
    >>> [(conflict.ego, conflict.foe, conflict.kind) for conflict in checker.conflicts]
    [('a', 'b', 'rear_end')]
    """

    def cleanUp(self) -> None:
        """What traci calls when the simulation is closed."""

    def __enter__(self) -> Checker:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
