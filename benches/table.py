"""Turns the output of the benches into a table of the goals and a chart.

    python benches/table.py FOLDER [--readme]

Reads the lines `what,scene,method,size,value,unit` of the benches from FOLDER/parts/*.csv, prints the table and writes
FOLDER/bench.csv and FOLDER/bench.svg. With --readme it also updates docs/bench.md, docs/bench_details.md with its chart
in docs/pictures/bench.svg, and the line in README.md.
"""

from __future__ import annotations

import csv
import importlib.metadata
import os
import platform
import shutil
import sys
from pathlib import Path

from chart import draw
from goals import GOALS, SCENARIOS, Lines
from paid import PAID

COLUMNS = ["what", "scene", "method", "size", "value", "unit"]
MARKS = ("<!-- make bench: begin -->\n", "<!-- make bench: end -->")


def machine() -> str:
    """The processor, its number of cores, the system, and SUMO's version."""
    information = Path("/proc/cpuinfo")
    lines = information.read_text().splitlines() if information.exists() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    model = models[0] if models else platform.processor() or platform.machine()
    return f"{model}, {os.cpu_count()} cores, {platform.system()}, SUMO {importlib.metadata.version('libsumo')}"


def line(lines: Lines) -> str:
    """The README's line about the bench."""
    ours, device = (
        [lines("over plain", scenario, method) for scenario in SCENARIOS] for method in ("closecall", "device.ssm")
    )
    return (
        f"With closecall attached, a run of SUMO takes {min(ours):.2f} to {max(ours):.2f} times as long; with "
        f"`device.ssm`, TTC alone, {min(device):.1f} to {max(device):.1f} times: [what it costs](docs/bench.md).\n"
    )


def table(head: list[str], rows: list[list[str]]) -> str:
    """A table of Markdown."""
    return "".join(f"| {' | '.join(row)} |\n" for row in [head, ["---"] * len(head), *rows])


def fill(page: Path, text: str) -> None:
    """Replace the text between the page's two marks."""
    before, rest = page.read_text(encoding="utf-8").split(MARKS[0])
    after = rest.split(MARKS[1])[1]
    page.write_text(before + MARKS[0] + text + MARKS[1] + after, encoding="utf-8")


def main() -> None:
    """Write the table and the chart, and update the pages on request."""
    folder = Path(sys.argv[1])
    rows: list[dict[str, str]] = []
    for part in sorted((folder / "parts").glob("*.csv")):
        with part.open(encoding="utf-8", newline="") as file:
            rows.extend(csv.DictReader(file))
    with (folder / "bench.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    lines = Lines(rows)
    on = f"\nMeasured on: {machine()}.\n"
    goals = table(["goal", "measured", "limit", "held"], [goal.row(lines) for goal in GOALS]) + on
    paid = table(["what you do", "what it costs"], [[what, cost(lines)] for what, cost in PAID]) + on
    print(goals, paid, sep="\n")
    draw(lines, folder / "bench.svg")
    if "--readme" in sys.argv:
        shutil.copy(folder / "bench.svg", "docs/pictures/bench.svg")
        fill(Path("docs/bench.md"), paid)
        fill(Path("docs/bench_details.md"), f"![the same as a chart](pictures/bench.svg)\n\n{goals}")
        fill(Path("README.md"), line(lines))


if __name__ == "__main__":
    main()
