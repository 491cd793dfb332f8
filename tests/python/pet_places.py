"""PETs of a run, computed anew from where SUMO's fcd-output has the road users: by sampled rectangles, place by place.

    python tests/python/pet_places.py SCENARIO.sumocfg… [--log CONDITION] [--end S]

runs closecall on each scenario and prints how many PETs it logged, how many of them are not those of the places, and of
how many conflicts it has none although the places have one.
"""

from __future__ import annotations

import argparse
import csv
import math
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

Row = dict[str, str]
Array = NDArray[np.float64]

EVERY = 0.025
"""Between two samples, in s."""
CROSSING, PARALLEL = math.radians(30), math.radians(5)
"""Two whose headings differ by less than the first may be on one path; by less than the second, they are parallel."""
TOLERANCE = 0.1
"""In s: of two samples, and of a bend in the half seconds between places kept of the time before a conflict."""
LONGEST = 5.0
"""The longest PET that closecall looks for where no condition asks for a longer one, in s."""


class Course(NamedTuple):
    """A road user at its samples: time, x and y of the front, heading; its rectangles; its length."""

    at: Array
    rectangles: NDArray[np.object_]
    length: float
    width: float


class Crossing(NamedTuple):
    """How a second crosses the path of a first."""

    pet: float
    enters: float
    is_over: bool


def courses_of(fcd: Path) -> dict[str, Array]:
    """Time, x, y and heading of each road user in each step."""
    found: dict[str, list[tuple[float, ...]]] = {}
    for _, step in ET.iterparse(fcd):
        if step.tag == "timestep":
            time = float(step.get("time", "nan"))
            for user in step:
                x, y, angle = (float(user.get(name, "nan")) for name in ("x", "y", "angle"))
                found.setdefault(user.get("id", ""), []).append((time, x, y, math.radians(90 - angle)))
            step.clear()
    return {user: np.array(course) for user, course in found.items()}


def sampled(course: Array, begin: float, end: float, length: float, width: float) -> Course | None:
    """The rectangles between two times, moved and turned evenly within each step."""
    steps = course[(course[:, 0] >= begin - 1e-6) & (course[:, 0] <= end + 1e-6)]
    if len(steps) < 2:
        return None
    heading = np.unwrap(steps[:, 3])
    times = np.arange(steps[0, 0], steps[-1, 0], EVERY)
    x, y, turned = (np.interp(times, steps[:, 0], column) for column in (steps[:, 1], steps[:, 2], heading))
    front, ahead = np.stack([x, y], -1), np.stack([np.cos(turned), np.sin(turned)], -1)
    aside = width / 2 * np.stack([-ahead[:, 1], ahead[:, 0]], -1)
    rear = front - length * ahead
    corners = np.stack([front + aside, rear + aside, rear - aside, front - aside], 1)
    return Course(np.stack([times, x, y, turned], -1), shapely.polygons(corners), length, width)


def crossings(first: Course, second: Course) -> list[Crossing]:
    """Each time that the second crosses or joins the way that the first has driven before."""
    pairs = shapely.STRtree(first.rectangles).query(second.rectangles, predicate="intersects")
    later, earlier = pairs[:, first.at[pairs[1], 0] <= second.at[pairs[0], 0]]
    inside = np.unique(later)
    found = []
    for run in np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1):
        if len(run) == 0 or run[0] == 0:
            continue
        aside, angle, is_on = beside(first, second, run)
        if is_on[0]:
            continue
        end, is_over, since = len(run), bool(run[-1] + 1 < len(second.at)), None
        for at in range(len(run)):
            since = (at if since is None else since) if is_on[at] else None
            if since is not None and angle[at] < PARALLEL:
                end, is_over = since + 1, True
                break
        has_joined = since is not None and end == since + 1
        goes_beyond = not has_joined and aside[0] * aside[-1] < 0
        if max(angle[: end + 1]) < CROSSING and not goes_beyond:
            continue
        enters = second.at[run[0], 0]
        touched = earlier[np.isin(later, run[:end])]
        times = first.at[touched, 0]
        found.append(Crossing(float(enters - times[times <= enters].max()), float(enters), is_over))
    return [crossing for crossing in found if crossing.pet > EVERY]


def beside(first: Course, second: Course, run: NDArray[np.int64]) -> tuple[Array, Array, NDArray[np.bool_]]:
    """How far the front of the second is beside the path of the first (left above 0), the angle there, whether the two
    are on one path."""
    begin = first.at[0]
    back = np.arange(0.0, first.length, 0.1)[::-1, None] * np.array([math.cos(begin[3]), math.sin(begin[3])])
    tail = np.column_stack([np.full(len(back), begin[0]), begin[1:3] - back, np.full(len(back), begin[3])])
    way = np.concatenate([tail, first.at])
    aside, angle, is_on = np.zeros(len(run)), np.zeros(len(run)), np.zeros(len(run), bool)
    for number, (time, x, y, heading) in enumerate(second.at[run]):
        known = way[way[:, 0] <= time]
        off = np.array([x, y]) - known[:, 1:3]
        nearest = int(np.argmin(np.hypot(off[:, 0], off[:, 1])))
        there = known[nearest, 3]
        distance = float(np.hypot(*off[nearest]))
        across = math.cos(there) * off[nearest, 1] - math.sin(there) * off[nearest, 0]
        aside[number] = math.copysign(distance, across)
        angle[number] = abs((heading - there + math.pi) % (2 * math.pi) - math.pi)
        widest = 2 * CROSSING if nearest < len(tail) else CROSSING
        is_on[number] = distance < max(first.width, second.width) / 2 and angle[number] < widest
    return aside, angle, is_on


class Checked(NamedTuple):
    """The conflicts with a PET, those that places do not confirm, and those without one although places have it."""

    pets: list[Row]
    wrong: list[tuple[Row, list[Crossing]]]
    missing: list[tuple[Row, list[Crossing]]]


def check(conflicts: list[Row], courses: dict[str, Array], longest: float = LONGEST) -> Checked:
    """Compares the PET of each conflict with those of its places. Closecall looks so long before and after it."""
    checked = Checked([], [], [])
    for row in conflicts:
        begin, end = float(row["begin"]), float(row["end"])
        both: list[Course] = []
        for user in ("ego", "foe"):
            size = float(row[f"{user}_length"] or 0), float(row[f"{user}_width"] or 0)
            if row[user] in courses:
                course = sampled(courses[row[user]], begin - longest, end + 2 * longest + 2, *size)
                both += [course] if course is not None else []
        if len(both) < 2:
            continue
        ego, foe = both
        found = [one for one in crossings(ego, foe) + crossings(foe, ego) if one.pet <= longest + TOLERANCE]
        found = sorted(found, key=lambda one: one.enters)
        if row["pet"]:
            checked.pets.append(row)
            if not any(abs(one.pet - float(row["pet"])) <= TOLERANCE for one in found):
                checked.wrong.append((row, found))
            continue
        # Well within what closecall looks at, and both are there until it is over.
        there = min(ego.at[-1, 0], foe.at[-1, 0])
        sure = [
            one
            for one in found
            if one.is_over and begin < one.enters < min(end + longest - 0.5, there - 3) and one.pet < longest - 0.5
        ]
        if sure:
            checked.missing.append((row, found))
    return checked


def run(config: Path, out: Path, log: str, *words: str, longest: float = LONGEST) -> Checked:
    """Runs closecall on a scenario, with the poses as SUMO reports them, and checks its PETs."""
    fcd = out / "fcd.xml"
    command = [sys.executable, "-m", "closecall", "run", str(config), "--align", "never", "--log", log]
    command += ["--out", str(out), "--force", "--quiet", "--", "--fcd-output", str(fcd), "--precision", "6"]
    command += ["--fcd-output.attributes", "x,y,angle", "--no-warnings", *words]
    subprocess.run(command, check=True, capture_output=True, text=True)
    with (out / "conflicts.csv").open(newline="") as file:
        return check(list(csv.DictReader(file)), courses_of(fcd), longest)


def told(cases: list[tuple[Row, list[Crossing]]]) -> str:
    """One line for each."""
    names = ("ego", "foe", "kind", "manoeuvre", "begin", "end", "pet")
    return "\n".join(f"    {[row.get(name) for name in names]} places: {found}" for row, found in cases)


def main() -> None:
    """Checks the scenarios of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", nargs="+", type=Path)
    parser.add_argument("--log", default="pet < 5 or margin < 0")
    parser.add_argument("--end", default=None)
    parser.add_argument("--step-length", default=None)
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    words = ["--end", options.end] if options.end else []
    words += ["--step-length", options.step_length] if options.step_length else []
    for scenario in options.scenario:
        with tempfile.TemporaryDirectory() as out:
            pets, wrong, missing = run(scenario, Path(out), options.log, *words)
        print(f"{scenario.stem}: {len(pets)} PETs, {len(wrong)} not of the places, {len(missing)} missing")
        if options.verbose:
            print(f"  not of the places:\n{told(wrong)}\n  missing:\n{told(missing)}")


if __name__ == "__main__":
    main()
