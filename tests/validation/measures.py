"""What is compared: measures, of which a step has a value, and rules, which a step meets or not."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

Row = dict[str, str]


@dataclass(frozen=True)
class Measure:
    """A column of the series. A pair without a value scores as no danger at all."""

    name: str
    rises: bool
    """Whether a larger value is more dangerous."""

    @property
    def safe(self) -> float:
        """The score of a step without a value."""
        return 0.0 if self.rises else -math.inf

    def score(self, text: str | float | None) -> float:
        """How dangerous a value is: the larger, the more."""
        if text in ("", None):
            return self.safe
        return float(text) if self.rises else -float(text)


@dataclass(frozen=True)
class Rule:
    """What calls a step dangerous."""

    name: str
    column: str
    met: Callable[[str], bool]
    default_log: bool
    """Whether it is applied to the log's default condition, as the levels are, or to every step."""


MEASURES = [
    Measure("crash_probability", True),
    Measure("crash_probability_braking", True),
    Measure("ttb", False),
    Measure("response_left", False),
    Measure("ttc", False),
    Measure("mttc", False),
    Measure("drac", True),
    Measure("act", False),
    Measure("max_braking", True),
]

# By SSMsOnPlane.
ELSEWHERE = [Measure(name, False) for name in ("2D-TTC", "TTC2D", "ACT", "TAdv")]


def one_of(*words: str) -> Callable[[str], bool]:
    """Whether a cell is one of these words."""
    return lambda cell: cell in words


def below(bound: float) -> Callable[[str], bool]:
    """Whether a cell has a value below a bound."""
    return lambda cell: cell != "" and float(cell) < bound


def at_least(bound: float) -> Callable[[str], bool]:
    """Whether a cell has a value of at least a bound."""
    return lambda cell: cell != "" and float(cell) >= bound


RULES = [
    Rule("severity: serious or critical", "severity", one_of("serious", "critical"), True),
    Rule("severity: critical", "severity", one_of("critical"), True),
    Rule("nearness: likely or near_certain", "nearness", one_of("likely", "near_certain"), True),
    Rule("nearness: near_certain", "nearness", one_of("near_certain"), True),
    Rule("crash_probability ≥ 0.5", "crash_probability", at_least(0.5), False),
    Rule("TTC < 1.5 s", "ttc", below(1.5), False),
]
