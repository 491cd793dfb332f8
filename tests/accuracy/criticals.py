"""Judges every conflict called critical by the positions that both road users really had, as rectangles.

python tests/accuracy/criticals.py SCENARIO.sumocfg ... [--end S] [--step-length S] [--at-least PERCENT] [--show N]

A critical conflict is right if in one of its steps, or in the one before or after,

- `contact`: the two rectangles overlapped by more than the contact tolerance, in a step or between two; or
- `too late`: the two were on a collision course, and full braking from that moment on did not avoid it. Whoever brakes
  does so with its type's deceleration along the path that it drove afterwards. The foe does what it really did, or goes
  on with the deceleration that it had, along the path that it drove. In side conflicts either may be the one that
  brakes, and in frontal ones both brake.

The others are `grazes`, if the two touched or passed each other within 5 cm, there or in one of these courses, or else
`wrong`. Road users are stiff here, also articulated ones.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import math
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from recording import Numbers, Recording, record
from ways import BETWEEN, Way

TOLERANCE = 0.25
"""closecall's default of --contact-tolerance, in m."""
HORIZON = 10.0
"""How far ahead a collision course is looked for, in s: as far as closecall's TTC."""
MOMENT = 0.02
"""Between the moments at which the rectangles are compared, in s."""
GRAZE = -0.05
"""Two that overlap by more than this graze, in m."""
RIGHT = ("contact", "too late")
VERDICTS = (*RIGHT, "grazes", "wrong")
SHOWN = (
    "id",
    "ego",
    "foe",
    "kind",
    "manoeuvre",
    "begin",
    "end",
    "gap",
    "overlap",
    "clearance",
    "ttb",
    "ego_type",
    "foe_type",
)


def depth(a: Numbers, a_size: tuple[float, float], b: Numbers, b_size: tuple[float, float]) -> Numbers:
    """How deep two rectangles overlap at each moment, in m; below 0 it is a lower bound of how far they are apart.

    A pose is the place of the front bumper's centre and the heading.
    """
    axes = [np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2])], -1) for pose in (a, b)]
    sizes = (a_size, b_size)
    centres = [pose[:, :2] - axis * size[0] / 2 for pose, axis, size in zip((a, b), axes, sizes, strict=True)]
    between = centres[1] - centres[0]
    found = np.full(len(a), np.inf)
    for axis in axes:
        for way in (axis, np.stack([-axis[:, 1], axis[:, 0]], -1)):
            reach = np.zeros(len(a))
            for own, (length, width) in zip(axes, sizes, strict=True):
                along = np.abs((own * way).sum(-1))
                across = np.abs(own[:, 0] * way[:, 1] - own[:, 1] * way[:, 0])
                reach += (along * length + across * width) / 2
            found = np.minimum(found, reach - np.abs((between * way).sum(-1)))
    return found


class Mover:
    """A road user from one of its steps on: the path that it drove, and its speed and deceleration there."""

    def __init__(self, way: Way, at: int) -> None:
        self.track, self.step = way.track, way.step
        places, headings = way.places[at * BETWEEN :], way.headings[at * BETWEEN :]
        moved = np.hypot(*np.diff(places, axis=0).T)
        driven = np.concatenate([[0.0], np.cumsum(moved)])
        keep = np.concatenate([[True], moved > 1e-6])
        # Beyond what is known of the path it goes straight on.
        far, end = HORIZON * 100, headings[-1]
        self.driven = np.append(driven[keep], driven[-1] + far)
        self.x = np.append(places[keep, 0], places[-1, 0] + far * math.cos(end))
        self.y = np.append(places[keep, 1], places[-1, 1] + far * math.sin(end))
        self.heading = np.append(headings[keep], end)
        self.speed = float(self.track.speed[at])
        before = float(self.track.speed[at - 1]) if at > 0 else self.speed
        self.deceleration = max((before - self.speed) / self.step, 0.0)
        self.real = driven
        self.size = (self.track.profile.length, self.track.profile.width)

    def along(self, distances: Numbers) -> Numbers:
        """The poses at these distances along the path."""
        return np.stack([np.interp(distances, self.driven, value) for value in (self.x, self.y, self.heading)], -1)

    def slowing(self, times: Numbers, deceleration: float) -> Numbers:
        """The poses at these times with a constant deceleration to a stand."""
        stands = self.speed / deceleration if deceleration > 0 else math.inf
        until = np.minimum(times, stands)
        return self.along(self.speed * until - deceleration * until**2 / 2)

    def braking(self, times: Numbers) -> Numbers:
        """The poses at these times if it brakes fully now."""
        return self.slowing(times, self.track.profile.decel)

    def going_on(self, times: Numbers) -> Numbers:
        """The poses at these times with the deceleration that it has."""
        return self.slowing(times, self.deceleration)

    def really(self, times: Numbers) -> Numbers:
        """The poses at these times as it drove; it goes on at its last speed when it has left."""
        known = np.arange(len(self.real)) * self.step / BETWEEN
        beyond = np.maximum(times - known[-1], 0.0) * float(self.track.speed[-1])
        return self.along(np.interp(times, known, self.real) + beyond)


@dataclass
class Verdict:
    """What a conflict is, and the depth that came nearest to contact, in m."""

    name: str
    nearest: float


def touch(a: Mover, a_poses: Numbers, b: Mover, b_poses: Numbers) -> float:
    """The deepest overlap of two in motion, in m."""
    return float(depth(a_poses, a.size, b_poses, b.size).max())


def too_late(ego: Mover, foe: Mover, kind: str) -> float:
    """The depth at which the two meet although the ego brakes at once, in m; at least that of a collision course."""
    times = np.arange(0.0, HORIZON, MOMENT)
    brakes = ego.braking(times)
    deepest = -math.inf
    for other in (foe.really(times), foe.going_on(times)):
        course = max(touch(ego, way, foe, other) for way in (ego.going_on(times), ego.really(times)))
        evaded = touch(ego, brakes, foe, foe.braking(times) if kind == "frontal" else other)
        deepest = max(deepest, min(course, evaded))
    return deepest


def really_touch(a: Way, b: Way, first: int, last: int) -> float:
    """The deepest overlap of the places that both had in these steps and between them, in m."""
    tracks = [a.track, b.track]
    first = max(first, *(track.first for track in tracks))
    last = min(last, *(track.first + len(track.x) - 1 for track in tracks))
    if last < first:
        return -math.inf
    sizes = [(track.profile.length, track.profile.width) for track in tracks]
    return float(depth(a.poses(first, last), sizes[0], b.poses(first, last), sizes[1]).max())


def judge(recording: Recording, row: dict[str, str]) -> Verdict:
    """Whether a conflict called critical is one."""
    first, last = (round((float(row[name]) - recording.begin) / recording.step) for name in ("begin", "end"))
    ways = [
        [
            Way(track, recording)
            for track in recording.tracks.get(row[name], [])
            if track.first <= last + 1 and track.first + len(track.x) >= first
        ]
        for name in ("ego", "foe")
    ]
    pairs = list(itertools.product(*ways))
    nearest = max((really_touch(ego, foe, first - 1, last + 1) for ego, foe in pairs), default=-math.inf)
    if nearest > TOLERANCE:
        return Verdict("contact", nearest)
    for pair in pairs:
        for step in range(first, last + 1):
            places = [step - way.track.first for way in pair]
            if not all(0 <= at < len(way.track.x) for at, way in zip(places, pair, strict=True)):
                continue
            movers = [Mover(way, at) for way, at in zip(pair, places, strict=True)]
            orders = [movers, movers[::-1]] if row["kind"] == "side" else [movers]
            nearest = max(nearest, *(too_late(*order, row["kind"]) for order in orders))
            if nearest > TOLERANCE:
                return Verdict("too late", nearest)
    return Verdict("grazes" if nearest > GRAZE else "wrong", nearest)


def criticals(words: list[str]) -> list[dict[str, str]]:
    """closecall's critical conflicts of a run."""
    with tempfile.TemporaryDirectory() as folder:
        config, rest = words[1], words[2:]
        command = [sys.executable, "-m", "closecall", "run", config, "--quiet", "--out", folder]
        subprocess.run([*command, "--", *rest, "--no-warnings"], stdout=subprocess.DEVNULL, check=True)
        with (Path(folder) / "conflicts.csv").open(newline="") as file:
            return [row for row in csv.DictReader(file) if row["severity"] == "critical"]


def line(name: str, counts: Counter[str]) -> str:
    """A row of the table."""
    return f"| {name} | {sum(counts.values())} | {' | '.join(str(counts[verdict]) for verdict in VERDICTS)} |"


def main() -> int:
    """Print the table; exit status 1 if the share of right ones, of at least 20, is below the limit."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("scenarios", nargs="+", type=Path)
    parser.add_argument("--end", type=float, help="simulated second at which to end")
    parser.add_argument("--step-length", type=float, help="length of a step in s")
    parser.add_argument("--at-least", type=float, default=0.0, help="limit of the share, in percent")
    parser.add_argument("--show", action="store_true", help="print those that are not right")
    arguments = parser.parse_args()
    total: Counter[str] = Counter()
    print(f"| scenario | critical | {' | '.join(VERDICTS)} |\n|---|---|---|---|---|---|")
    for scenario in arguments.scenarios:
        words = ["-c", str(scenario)]
        for name, value in (("--end", arguments.end), ("--step-length", arguments.step_length)):
            words += [] if value is None else [name, str(value)]
        rows = criticals(words)
        recording = record(words)
        verdicts = [(row, judge(recording, row)) for row in rows]
        counts = Counter(verdict.name for _, verdict in verdicts)
        total += counts
        print(line(scenario.stem, counts), flush=True)
        for row, verdict in verdicts:
            if arguments.show and verdict.name not in RIGHT:
                values = ", ".join(f"{name} {row[name]}" for name in SHOWN)
                print(f"    {verdict.name}, {verdict.nearest:.2f} m deep: {values}", file=sys.stderr)
    count, right = sum(total.values()), sum(total[name] for name in RIGHT)
    share = 100 * right / count if count else math.nan
    print(line("all", total))
    print(f"right: {share:.1f} %")
    return int(count >= 20 and share < arguments.at_least)


if __name__ == "__main__":
    sys.exit(main())
