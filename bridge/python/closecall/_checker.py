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

    def setID(self, ID: int) -> None:
        """Note that a simulation calls each step; traci and libsumo call this method of a listener that is added.

        Raises:
            ValueError: it is a listener already, so that each step would be checked twice.
        """
        if self._id is not None:
            raise ValueError("this checker is a step listener already")
        self._id = ID
        self._listen(True)

    def getID(self) -> int | None:
        return self._id

    def cleanUp(self) -> None:
        """Note that no simulation calls the steps any more; traci and libsumo call this method when they remove it."""
        self._id = None
        self._listen(False)

    _id: int | None = None

    def __enter__(self) -> Checker:
        return self

    def __exit__(self, _: object, error: BaseException | None, __: object) -> None:
        self._end(None if error is None else f"{type(error).__name__}: {error}")
