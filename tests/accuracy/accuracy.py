"""Precision and recall of closecall on scenarios, against the paths that the road users drove afterwards.

python tests/accuracy/accuracy.py SCENARIO.sumocfg ... [--end S] [--every S] [--at-least PERCENT]
"""

from __future__ import annotations

import argparse
import csv
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from recording import Recording, record
from truth import NEAR, Verdict, step_truth

KINDS = ("rear_end", "frontal", "side")


def reported(words: list[str], options: list[str]) -> dict[tuple[int, frozenset[str]], dict[str, str]]:
    """closecall's encounters, by time in ms and pair."""
    with tempfile.TemporaryDirectory() as folder:
        config, rest = words[1], words[2:]
        command = [sys.executable, "-m", "closecall", "run", config, "--quiet", "--log-series", "--out", folder]
        subprocess.run([*command, *options, "--", *rest, "--no-warnings"], stdout=subprocess.DEVNULL, check=True)
        with (Path(folder) / "series.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
    return {(round(float(row["time"]) * 1000), frozenset((row["ego"], row["foe"]))): row for row in rows}


class Tally:
    """Counts of one scenario."""

    def __init__(self) -> None:
        self.counts: Counter[tuple[str, str]] = Counter()
        self.excluded: Counter[str] = Counter()
        self.wrong: list[tuple[float, str, Verdict | None, dict[str, str] | None]] = []

    def add(self, time: float, truth: Verdict | None, row: dict[str, str] | None) -> None:
        """Count one pair in one step."""
        kind, what = outcome(truth, row)
        if what in ("right", "false", "missed"):
            self.counts[kind, what] += 1
        elif what:
            self.excluded[what] += 1
        if what in ("false", "missed"):
            self.wrong.append((time, what, truth, row))

    def share(self, kind: str, against: str) -> float:
        """Precision (against "false") or recall (against "missed") in percent."""
        right, other = self.counts[kind, "right"], self.counts[kind, against]
        return 100.0 * right / (right + other) if right + other else float("nan")


def outcome(truth: Verdict | None, row: dict[str, str] | None) -> tuple[str, str]:
    """The kind of a pair, and whether closecall is "right" or "false", or has "missed" it, or why it does not count."""
    if truth is not None and truth.excluded:
        return "", truth.excluded
    margins = [] if truth is None else [truth.margin]
    margins += [] if row is None else [float(row["margin"])]
    if any(abs(margin) <= NEAR for margin in margins):
        return "", "near the limit"
    if row is not None:
        # A follower through a bend is rear-end whatever the angle; the judge knows angles only.
        kinds = ("", "side" if row["manoeuvre"] == "following" else row["kind"], row["kind"])
        fits = truth is not None and truth.margin < 0 and truth.kind in kinds
        return row["kind"], "right" if fits else "false"
    if truth is not None and truth.margin < 0:
        return truth.kind or "side", "missed"
    return "", ""


def compare(recording: Recording, rows: dict[tuple[int, frozenset[str]], dict[str, str]], every: float) -> Tally:
    """Compare truth and report pair by pair, in steps that are `every` s apart."""
    tally = Tally()
    entered = {(track.first, name) for name, tracks in recording.tracks.items() for track in tracks}
    stride = max(round(every / recording.step), 1)
    for step in range(0, recording.steps, stride):
        time = recording.begin + step * recording.step
        key = round(time * 1000)
        truth = step_truth(recording, step)
        pairs = {pair for at, pair in rows if at == key} | set(truth)
        before: dict[frozenset[str], Verdict] | None = None
        for pair in sorted(pairs, key=sorted):
            verdict, row = truth.get(pair), rows.get((key, pair))
            if outcome(verdict, row)[1] in ("false", "missed") and step:
                # closecall looks half a step before, so that what is true in either step will do.
                before = step_truth(recording, step - 1) if before is None else before
                if outcome(before.get(pair), row)[1] == "right":
                    verdict = before.get(pair)
            if row is None and any((step, name) in entered for name in pair):
                # Half a step before it was not there.
                continue
            if row is None and verdict is not None and has_one_between(verdict, truth.values()):
                tally.excluded["another between"] += 1
                continue
            tally.add(time, verdict, row)
    return tally


def has_one_between(verdict: Verdict, others: Iterable[Verdict]) -> bool:
    """Whether another vehicle is between a follower and its leader: only neighbours make rear-end conflicts."""
    nearer = (other for other in others if other.ego == verdict.ego and other.gap < verdict.gap)
    return verdict.kind == "rear_end" and any(other.kind == "rear_end" for other in nearer)


def main() -> int:
    """Print the table; exit status 1 if a figure from at least 20 cases is below the limit."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("scenarios", nargs="+", type=Path)
    parser.add_argument("--end", type=float, default=100.0, help="simulated second at which to end")
    parser.add_argument("--every", type=float, default=1.0, help="seconds between the steps that are compared")
    parser.add_argument("--step-length", type=float, default=0.1, help="length of a step in s")
    parser.add_argument("--at-least", type=float, default=0.0, help="limit for each figure, in percent")
    parser.add_argument("--show", type=int, default=0, help="number of disagreements to print")
    parser.add_argument("--path", default="lanes", help="closecall's path model")
    options = parser.parse_args()
    low = 0
    print(f"{'scenario':<12} {'kind':<9} {'right':>6} {'false':>6} {'missed':>6} {'precision':>10} {'recall':>8}")
    for scenario in options.scenarios:
        words = ["-c", str(scenario), "--end", str(options.end), "--step-length", str(options.step_length)]
        recording = record(words)
        tally = compare(recording, reported(words, ["--path", options.path]), options.every)
        for kind in KINDS:
            right, false, missed = (tally.counts[kind, what] for what in ("right", "false", "missed"))
            precision, recall = tally.share(kind, "false"), tally.share(kind, "missed")
            print(
                f"{scenario.stem:<12} {kind:<9} {right:>6} {false:>6} {missed:>6} {precision:>8.1f} % {recall:>6.1f} %"
            )
            low += right + false >= 20 and precision < options.at_least
            low += right + missed >= 20 and recall < options.at_least
        print(f"{scenario.stem:<12} excluded: {dict(tally.excluded)}", flush=True)
        for time, what, truth, row in tally.wrong[: options.show]:
            print(f"  {time:.1f} s {what}: truth {truth}, closecall {row}")
    return 1 if low else 0


if __name__ == "__main__":
    sys.exit(main())
