"""The chart of the benches: attached runs, the detector beside other methods that find close pairs, and replay."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update(
    {"svg.hashsalt": "closecall", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False}
)

import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402

SCENES = ["jam", "platoons", "uniform"]
OURS, OTHER = "#1f6feb", "#9aa4b2"
LIMIT = "#d1242f"
METHODS = {
    "closecall": ("closecall", OURS, "-"),
    "parry2d": ("parry2d, tree rebuilt and tests", "#8250df", "-"),
    "parry2d (kept)": ("the same, tree kept", "#8250df", "--"),
    "parry2d (kept; straight)": ("and straight paths known", "#8250df", ":"),
    "commonroad": ("commonroad-drivability-checker", "#bf8700", "-"),
    "all pairs": ("all pairs of circles", "#57606a", "-"),
}


class Lines(Protocol):
    """The lines that the benches printed, as table.py reads them."""

    rows: list[dict[str, str]]

    def __call__(self, what: str, scene: str, method: str, size: int | None = None) -> float:
        """The value of a line."""


def draw(lines: Lines, path: Path) -> None:
    """Draw the measured values; those not measured are left out."""
    figure, (runs, steps, replays) = plt.subplots(
        1, 3, figsize=(11, 3.4), layout="constrained", width_ratios=[1.1, 1.3, 0.9], facecolor="white"
    )
    attached(runs, lines)
    detector(steps, lines)
    replay(replays, lines)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def bars(axes: Axes, groups: list[str], series: dict[str, list[float]], colours: list[str]) -> None:
    """Draw groups of bars, each with its value on top."""
    width = 0.8 / len(series)
    for place, ((label, values), colour) in enumerate(zip(series.items(), colours)):
        left = [group + (place - (len(series) - 1) / 2) * width for group in range(len(values))]
        drawn = axes.bar(left, values, width, label=label, color=colour)
        # A white background keeps a number legible where a goal's line crosses it.
        ground = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
        axes.bar_label(drawn, fmt="%.2f", padding=2, fontsize=8, bbox=ground, zorder=3)
    axes.set_xticks(range(len(groups)), groups)
    axes.legend(frameon=False, fontsize=8)


def attached(axes: Axes, lines: Lines) -> None:
    """Draw the time of a whole run, relative to plain SUMO."""
    scenes = [row["scene"] for row in lines.rows if row["what"] == "run" and row["method"] == "plain"]
    over = {method: [lines("over plain", scene, method) for scene in scenes] for method in ("closecall", "device.ssm")}
    bars(axes, scenes, over, [OURS, OTHER])
    axes.axhline(1.2, color=LIMIT, linewidth=1, linestyle="--")
    axes.set_title("Whole run, times plain SUMO (goal: 1.2)", fontsize=9)


def detector(axes: Axes, lines: Lines) -> None:
    """Draw the time per road user and step: the range and the median over the three scenes."""
    for method, (label, colour, style) in METHODS.items():
        found: dict[int, list[float]] = {}
        for row in lines.rows:
            if (row["what"], row["method"]) == ("step", method) and row["scene"] in SCENES:
                found.setdefault(int(row["size"]), []).append(float(row["value"]))
        sizes = sorted(found)
        if not sizes:
            continue
        values = [sorted(found[size]) for size in sizes]
        axes.fill_between(sizes, [each[0] for each in values], [each[-1] for each in values], color=colour, alpha=0.12)
        middle = [each[len(each) // 2] for each in values]
        axes.plot(sizes, middle, color=colour, linestyle=style, marker="o", markersize=3, label=label)
    axes.axhline(150, color=LIMIT, linewidth=1, linestyle="--")
    axes.set(xscale="log", yscale="log", xlabel="road users")
    axes.set_title("Detector alone, ns per road user and step (goal: 150)", fontsize=9)
    # Leave room for the legend above the curves.
    axes.set_ylim(top=30 * axes.get_ylim()[1])
    axes.legend(frameon=False, fontsize=7, loc="upper left")


def replay(axes: Axes, lines: Lines) -> None:
    """Draw the vehicle-steps per second of a replay."""
    scenes = ["sparse", "platoons"]
    if any(row["what"] == "replay" for row in lines.rows):
        rates = {form: [lines("replay", scene, form) / 1e6 for scene in scenes] for form in ("CSV", "XML")}
        bars(axes, scenes, rates, [OURS, "#79b8ff"])
    for limit in (3.0, 1.5):
        axes.axhline(limit, color=LIMIT, linewidth=1, linestyle="--")
    axes.set_title("Replay, 10⁶ vehicle-steps per s\n(goals: CSV 3, XML 1.5)", fontsize=9)
