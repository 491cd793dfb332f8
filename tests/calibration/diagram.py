"""The reliability diagram of docs/whatif.md: what roll-outs say over what the formula says."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update(
    {"svg.hashsalt": "closecall", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False}
)

import matplotlib.pyplot as plt  # noqa: E402

OURS, OTHER = "#1f6feb", "#9aa4b2"


class Point(NamedTuple):
    """The conflicts of a bin: their mean formula, their mean share of contacts with its interval, their number."""

    formula: float
    share: float
    low: float
    high: float
    conflicts: int


def draw(points: list[Point], path: Path) -> None:
    """Draw the points with their intervals above the numbers of conflicts."""
    size = {"figsize": (4.6, 4.8), "height_ratios": [4, 1], "layout": "constrained", "facecolor": "white"}
    figure, (shares, counts) = plt.subplots(2, 1, sharex=True, **size)
    said = [point.formula for point in points]
    shares.plot([0, 1], [0, 1], color=OTHER, linewidth=1, linestyle="--", label="formula and roll-outs agree")
    ends = [[point.share - point.low for point in points], [point.high - point.share for point in points]]
    seen = [point.share for point in points]
    shares.errorbar(said, seen, yerr=ends, fmt="o-", color=OURS, capsize=3, label="roll-outs, 95 % interval")
    shares.set_ylabel("share of roll-outs with a contact")
    shares.set_ylim(-0.02, 1.02)
    shares.legend(frameon=False, fontsize=8, loc="upper left")
    drawn = counts.bar(said, [point.conflicts for point in points], 0.03, color=OTHER)
    counts.bar_label(drawn, padding=2, fontsize=8)
    counts.margins(y=0.3)
    counts.set_ylabel("conflicts")
    counts.set_xlabel("crash probability by the formula, mean of the bin")
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
