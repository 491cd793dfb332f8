"""What the conflicts of the present step cost: a reward for an agent that learns to drive or to control traffic."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import hypot

from ._closecall import Alarm, Checker


def crash_probability(alarm: Alarm) -> float:
    """The probability that the driver does not brake in time; 1 in a collision."""
    return alarm.probability


class Reward:
    """The cost of each road user in the present step, from the conflicts that a checker finds in it.

    A conflict counts in the steps that meet the log's condition, not in the second for which it stays open after them.
    The reward of an agent is minus its cost: `-reward.of("car")` of a car, `-reward.near(x, y, 50.0)` of a junction.

    Args:
        checker: the checker, attached to the simulation or fed with frames.
        cost: the cost of a conflict in a step, 0 or more; by default its crash probability.

    >>> import closecall
    >>> checker = closecall.Checker()
    >>> reward = Reward(checker, cost=lambda alarm: -alarm.margin)
    >>> car = {"id": ["a", "b"], "x": [0.0, 20.0], "y": [0.0, 0.0], "heading": [0.0, 0.0], "speed": [20.0, 5.0]}
    >>> checker.step(0.0, car)
    True
    >>> reward.of("a") == reward.of("b") > 0.0 == reward.of("c")
    True
    """

    def __init__(self, checker: Checker, cost: Callable[[Alarm], float] = crash_probability) -> None:
        self._checker = checker
        self._cost = cost

    def costs(self) -> dict[str, float]:
        """The sum over its conflicts of each road user that has one. Both of a conflict bear its cost in full."""
        costs: dict[str, float] = {}
        for alarm, cost in self._now():
            for user in (alarm.ego, alarm.foe):
                costs[user] = costs.get(user, 0.0) + cost
        return costs

    def of(self, user: str) -> float:
        """The cost of one road user; 0 where it has no conflict."""
        return self.costs().get(user, 0.0)

    def total(self) -> float:
        """The sum over all conflicts, each counted once."""
        return sum(cost for _, cost in self._now())

    def near(self, x: float, y: float, within: float) -> float:
        """The same over the conflicts whose conflict point is at most `within` m from a place."""
        return sum(cost for alarm, cost in self._now() if hypot(alarm.x - x, alarm.y - y) <= within)

    def _now(self) -> Iterator[tuple[Alarm, float]]:
        for alarm in self._checker.active:
            if alarm.time == self._checker.time:
                yield alarm, self._cost(alarm)
