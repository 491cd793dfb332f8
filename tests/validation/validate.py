"""Crashes against crash-free traffic: how well each measure and rule tells them apart.

python tests/validation/validate.py [--crashes FILE ...] [--free FILE ...] [--label NAME] [--ssms-on-plane FOLDER]
    [--page docs/validation.md]

Replays each recording in crashes/ and free/ along the paths driven and along arcs, as it is and smoothed, and writes
results.csv beside this file. `--crashes` takes other crashes or near-crashes instead, `--free` other crash-free
recordings, as those that may not be passed on; the results stand under a label of their own, with the date. Rows of
results.csv that a run does not repeat are kept: those of other labels, and, without `--ssms-on-plane`, those of
SSMsOnPlane. `--page` writes the tables into a page, between its marks.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Callable, Mapping
from datetime import date
from pathlib import Path
from typing import Any

from elsewhere import Elsewhere
from measures import ELSEWHERE, MEASURES, RULES, Measure
from page import write_tables
from ratings import Result, Setting, Values, has_column, rate_measure, rate_rule
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


def recordings(crashes: list[Path], free: list[Path]) -> list[Recording]:
    """These recordings; where there are none, those that are kept here."""
    crashes = crashes or sorted((HERE / "crashes").glob("*.csv"))
    free = free or sorted((HERE / "free").glob("*.csv"))
    return [read(path, True) for path in crashes] + [read(path, False) for path in free]


def steps_in(replayed: Replayed) -> Callable[[Pair], Steps]:
    """The steps of a pair in these replays."""
    return lambda pair: replayed[pair.recording].get(pair.names, {})


def scores_in(steps: Callable[[Pair], Mapping[int, Mapping[str, Any]]], measure: Measure) -> Values:
    """The scores of a pair by a measure."""
    return lambda pair: {tick: measure.score(row[measure.name]) for tick, row in steps(pair).items()}


def rated(scene: list[Recording], setting: Setting) -> list[Result]:
    """The rows of closecall's own measures and rules."""
    wide = {each.name: replay(each.path, setting.path, setting.smooth) for each in scene}
    logged = {each.name: replay(each.path, setting.path, setting.smooth, "margin < 0") for each in scene}
    pairs = [pair for each in scene for pair in each.pairs]
    rows: list[Result] = []
    for measure in MEASURES:
        if has_column(measure.name, wide):
            rows += rate_measure(measure, pairs, scores_in(steps_in(wide), measure), setting)
    for rule in RULES:
        replayed = logged if rule.default_log else wide
        if has_column(rule.column, replayed):
            rows += rate_rule(rule, scene, steps_in(replayed), setting)
    return rows


def rated_elsewhere(scene: list[Recording], functions: Elsewhere, label: str) -> list[Result]:
    """The rows of SSMsOnPlane's measures."""
    steps = {each.name: functions.steps(each) for each in scene}
    pairs = [pair for each in scene for pair in each.pairs]
    setting = Setting(label, BY_SSMS_ON_PLANE, False)
    rows: list[Result] = []
    for measure in ELSEWHERE:
        values = scores_in(lambda pair: steps[pair.recording].get(pair.names, {}), measure)
        rows += rate_measure(measure, pairs, values, setting)
    return rows


def main() -> None:
    """Rate everything, write the results, and the tables of the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--crashes", type=Path, nargs="+", default=[], metavar="FILE")
    parser.add_argument("--free", type=Path, nargs="+", default=[], metavar="FILE")
    parser.add_argument("--label", default=None, help="name of the results with --crashes or --free")
    parser.add_argument("--ssms-on-plane", type=Path, default=None, metavar="FOLDER")
    parser.add_argument("--page", type=Path, default=None)
    arguments = parser.parse_args()
    others = bool(arguments.crashes or arguments.free)
    if others != bool(arguments.label):
        sys.exit("--crashes and --free need --label, and --label needs one of them")
    label = arguments.label or KEPT
    scene = recordings(arguments.crashes, arguments.free)
    rows: list[Result] = []
    for path in PATHS:
        for smooth in (False, True):
            rows += rated(scene, Setting(label, path, smooth))
    if arguments.ssms_on_plane:
        rows += rated_elsewhere(scene, Elsewhere(arguments.ssms_on_plane), label)
    today = {"date": date.today().isoformat()}
    rows = [row | (today if others or row["path"] == BY_SSMS_ON_PLANE else {}) for row in rows]
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
