"""The checker as a step listener of traci and libsumo, or with plain frames without SUMO."""

from __future__ import annotations

from ._closecall import Checker as _Checker

try:
    from traci.step import StepListener
except ImportError:
    StepListener = object


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
        """Do nothing: traci and libsumo call this method of their listeners when the simulation is closed."""

    def __enter__(self) -> Checker:
        return self

    def __exit__(self, _: object, error: BaseException | None, __: object) -> None:
        self._end(None if error is None else f"{type(error).__name__}: {error}")
