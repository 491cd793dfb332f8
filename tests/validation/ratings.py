"""Scores of measures and rules over all pairs: rows of the results."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from statistics import median

import numpy as np
from measures import Measure, Rule
from replays import Steps
from scores import auc, auprc
from tracks import TICK, Pair, Recording

# In seconds before the smallest centre distance.
LEADS = (0.0, 0.5, 1.0)
# An alarm that ends longer before the crash has another reason.
LONGEST_LEAD = 5.0

Result = dict[str, str]
Values = Callable[[Pair], dict[int, float]]


@dataclass(frozen=True)
class Setting:
    """How the recordings were replayed."""

    recordings: str
    path: str
    smooth: bool

    @property
    def columns(self) -> Result:
        """The columns of the results that name it."""
        return {"recordings": self.recordings, "path": self.path, "smooth": "yes" if self.smooth else "no"}


def worst_until(values: dict[int, float], pair: Pair, lead: float, safe: float) -> float:
    """The most dangerous score of the steps up to a lead before the smallest centre distance."""
    last = pair.closest - round(lead / TICK)
    return max((score for tick, score in values.items() if tick <= last), default=safe)


def rate_measure(measure: Measure, pairs: list[Pair], values: Values, setting: Setting) -> Iterator[Result]:
    """AUC over all pairs and AUPRC over those in the same direction, by lead."""
    by_pair = [values(pair) for pair in pairs]
    for lead in LEADS:
        # A pair that was not there so long before says nothing of that lead.
        there = [pair.begin <= pair.closest - round(lead / TICK) for pair in pairs]
        worst = np.array([worst_until(*both, lead, measure.safe) for both in zip(by_pair, pairs)])
        crash = np.array([pair.crash for pair in pairs])
        same = np.array([pair.same_direction for pair in pairs])
        kept = np.array(there)
        all_pairs = auc(worst[kept & crash], worst[kept & ~crash])
        alike = auprc(worst[kept & crash], worst[kept & ~crash & same])
        for kind, estimate, free in (("AUC", all_pairs, kept & ~crash), ("AUPRC", alike, kept & ~crash & same)):
            yield setting.columns | {
                "name": measure.name,
                "kind": kind,
                "lead": f"{lead:g}",
                "value": f"{estimate.value:.3f}",
                "low": f"{estimate.low:.3f}",
                "high": f"{estimate.high:.3f}",
                "crashes": str(int((kept & crash).sum())),
                "free": str(int(free.sum())),
            }


def alarms(rule: Rule, steps: Steps) -> list[int]:
    """The ticks in which a pair meets a rule, artefacts left out."""
    return sorted(tick for tick, row in steps.items() if not row.get("artefact") and rule.met(row[rule.column]))


def lead_of(ticks: list[int], pair: Pair) -> float | None:
    """How long before the smallest centre distance the first alarm was of those within the longest lead."""
    before = [pair.closest - tick for tick in ticks if 0 <= pair.closest - tick <= LONGEST_LEAD / TICK]
    return max(before) * TICK if before else None


def rate_rule(
    rule: Rule, recordings: list[Recording], steps: Callable[[Pair], Steps], setting: Setting
) -> Iterator[Result]:
    """Crashes found by lead, lead times, and false alarms per vehicle-hour."""
    hours = sum(recording.hours for recording in recordings if not recording.crash)
    pairs = [pair for recording in recordings for pair in recording.pairs]
    ticks = {pair: alarms(rule, steps(pair)) for pair in pairs}
    crashes = [pair for pair in pairs if pair.crash]
    for lead in LEADS:
        found = sum(any(tick <= pair.closest - round(lead / TICK) for tick in ticks[pair]) for pair in crashes)
        row = {
            "name": rule.name,
            "kind": "found",
            "lead": f"{lead:g}",
            "value": str(found),
            "crashes": str(len(crashes)),
        }
        yield setting.columns | row
    leads = [ahead for pair in crashes if (ahead := lead_of(ticks[pair], pair)) is not None]
    if leads:
        spread = {"value": f"{median(leads):.1f}", "low": f"{min(leads):.1f}", "high": f"{max(leads):.1f}"}
        yield setting.columns | {"name": rule.name, "kind": "lead time"} | spread
    false = [pair for pair in pairs if not pair.crash and ticks[pair]]
    row = {"name": rule.name, "kind": "false alarms", "value": str(len(false)), "free": str(len(pairs) - len(crashes))}
    yield setting.columns | row | {"hours": f"{hours:.4f}"}


def has_column(name: str, replayed: dict[str, dict[frozenset[str], Steps]]) -> bool:
    """Whether the log has a column."""
    rows = (row for pairs in replayed.values() for steps in pairs.values() for row in steps.values())
    return name in next(rows, {})
