"""Crashes against crash-free traffic: how well each measure and rule tells them apart.

python tests/validation/validate.py [--more FILE ... --label NAME] [--ssms-on-plane FOLDER] [--page docs/validation.md]

Replays each recording in crashes/ and free/ along the paths driven and along arcs, as it is and smoothed, and writes
results.csv beside this file. `--more` adds crash-free recordings that may not be passed on; their results stand under
a label of their own, with the date. Rows of results.csv that a run does not repeat are kept: those of `--more`, and,
without `--ssms-on-plane`, those of SSMsOnPlane. `--page` writes the tables into a page, between its marks.
"""

from __future__ import annotations

import argparse
import csv
import sys
from datetime import date
from pathlib import Path

from elsewhere import Elsewhere
from measures import ELSEWHERE, MEASURES, RULES
from page import write_tables
from ratings import Result, Setting, has_column, rate_measure, rate_rule
from replays import PATHS, Steps, replay
from tracks import Pair, Recording, read

HERE = Path(__file__).parent
RESULTS = HERE / "results.csv"
COLUMNS = ["recordings", "path", "smooth", "name", "kind", "lead", "value", "low", "high"]
COLUMNS += ["crashes", "free", "hours", "date"]
KEPT = "kept"
BY_SSMS_ON_PLANE = "SSMsOnPlane"

# By recording, then by pair.
Replayed = dict[str, dict[frozenset[str], Steps]]


def recordings(more: list[Path]) -> list[Recording]:
    """All recordings that are kept here, and more that are crash-free."""
    crashes = [read(path, True) for path in sorted((HERE / "crashes").glob("*.csv"))]
    free = [read(path, False) for path in [*sorted((HERE / "free").glob("*.csv")), *more]]
    return crashes + free


def rated(scene: list[Recording], setting: Setting) -> list[Result]:
    """The rows of closecall's own measures and rules."""
    wide = {each.name: replay(each.path, setting.path, setting.smooth) for each in scene}
    logged = {each.name: replay(each.path, setting.path, setting.smooth, "margin < 0") for each in scene}
    pairs = [pair for each in scene for pair in each.pairs]
    rows: list[Result] = []
    columns = next(iter(steps for of_pair in wide.values() for steps in of_pair.values()), {})
    known = next(iter(columns.values()), {})
    for measure in MEASURES:
        if measure.name not in known:
            continue

        def values(pair: Pair, name: str = measure.name, score=measure.score) -> dict[int, float]:
            steps = wide[pair.recording].get(pair.names, {})
            return {tick: score(row[name]) for tick, row in steps.items()}

        rows += rate_measure(measure, pairs, values, setting)
    for rule in RULES:
        replayed: Replayed = logged if rule.default_log else wide
        if has_column(rule, replayed):
            rows += rate_rule(rule, scene, lambda pair, of=replayed: of[pair.recording].get(pair.names, {}), setting)
    return rows


def rated_elsewhere(scene: list[Recording], functions: Elsewhere, label: str) -> list[Result]:
    """The rows of SSMsOnPlane's measures."""
    steps = {each.name: functions.steps(each) for each in scene}
    pairs = [pair for each in scene for pair in each.pairs]
    rows: list[Result] = []
    for measure in ELSEWHERE:

        def values(pair: Pair, name: str = measure.name, score=measure.score) -> dict[int, float]:
            of_pair = steps[pair.recording].get(pair.names, {})
            return {tick: score(row[name]) for tick, row in of_pair.items()}

        rows += rate_measure(measure, pairs, values, Setting(label, BY_SSMS_ON_PLANE, False))
    return rows


def main() -> None:
    """Rate everything, write the results, and the tables of the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--more", type=Path, nargs="+", default=[], metavar="FILE")
    parser.add_argument("--label", default=None, help="name of the recordings with those of --more")
    parser.add_argument("--ssms-on-plane", type=Path, default=None, metavar="FOLDER")
    parser.add_argument("--page", type=Path, default=None)
    arguments = parser.parse_args()
    if bool(arguments.more) != bool(arguments.label):
        sys.exit("--more needs --label, and --label needs --more")
    label = arguments.label or KEPT
    scene = recordings(arguments.more)
    rows: list[Result] = []
    for path in PATHS:
        for smooth in (False, True):
            rows += rated(scene, Setting(label, path, smooth))
    if arguments.ssms_on_plane:
        rows += rated_elsewhere(scene, Elsewhere(arguments.ssms_on_plane), label)
    of_today = {"date": date.today().isoformat()} if arguments.more or arguments.ssms_on_plane else {}
    rows = [row | (of_today if row["path"] == BY_SSMS_ON_PLANE or arguments.more else {}) for row in rows]
    results = merged(rows)
    with RESULTS.open("w", newline="") as out:
        writer = csv.DictWriter(out, COLUMNS, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(results)
    if arguments.page:
        write_tables(arguments.page, results)


def merged(rows: list[Result]) -> list[Result]:
    """These rows, and those of the last results whose recordings and path they do not have."""
    repeated = {(row["recordings"], row["path"]) for row in rows}
    if not RESULTS.exists():
        return rows
    with RESULTS.open(newline="") as lines:
        before = [row for row in csv.DictReader(lines) if (row["recordings"], row["path"]) not in repeated]
    return rows + before


if __name__ == "__main__":
    main()
