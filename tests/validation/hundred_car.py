"""The crashes and near-crashes of the 100-Car study as tables of trajectories, from its raw data.

python tests/validation/hundred_car.py RAW OUT

RAW is a folder with the files of doi 10.15787/VTT1/CEU6RB (CC0): HundredCar_Crash_Public_Compiled.txt,
HundredCar_NearCrash_Public_Compiled.txt and 100CarEventVideoReducedData_v1_5.txt. OUT gets crash/ID.csv and
near_crash/ID.csv, each with the instrumented vehicle and the one that it came near.

The instrumented vehicle goes by its speed and yaw rate. The other is the radar target that was nearest during the
event, ahead or behind as the event's description says; only those that came within 4.5 m are kept, so that none can
be between the two (the rule of Jiao's Reconstruct100CarNDSData). Radar sees its nearest side: its centre is half a
length farther. Columns, units and signs: Researcher Dictionary for Time-Series Data, version 1.2 (2010).
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

MPH, FOOT = 0.44704, 0.3048
NEAREST = 4.5
# The instrumented vehicles are saloon cars: Camry, Corolla, Taurus, Malibu, Cavalier.
OWN_SIZE = (4.75, 1.77)
# Beginnings of the target's type, with SUMO's length, width and class.
SIZES = [("Automobile", 5.0, 1.8, "car"), ("Pickup", 5.9, 2.0, "car"), ("Sport", 4.8, 1.9, "car")]
SIZES += [("Van", 5.2, 2.0, "van"), ("School bus", 10.5, 2.5, "bus"), ("Transit bus", 12.0, 2.5, "bus")]
SIZES += [("Single-unit", 7.1, 2.4, "truck"), ("Tractor-trailer", 16.5, 2.55, "truck")]
# Columns of the time series, from 0.
SYNC, TIME, SPEED, YAW_RATE = 1, 2, 4, 6
TARGETS = 7
AHEAD = {"id": 20, "range": 34, "azimuth": 62, "sign": 1}
BEHIND = {"id": 27, "range": 41, "azimuth": 69, "sign": -1}
# Columns of the events, from 0.
EVENT, BEGIN, END, NATURE, TARGET = 0, 2, 3, 8, 62
# A target that was not seen for so long, in s, is another one: numbers are used again.
LOST = 1.0
# Headings follow from the movement over so long to either side, in s, at this speed, in m/s, or more.
AROUND, MOVES = 0.5, 1.0
FILES = {"crash": "HundredCar_Crash_Public_Compiled.txt", "near_crash": "HundredCar_NearCrash_Public_Compiled.txt"}
EVENTS = "100CarEventVideoReducedData_v1_5.txt"

# x, y and heading.
Way = tuple[np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Seen:
    """A radar target: when it was seen where, and how near."""

    time: np.ndarray
    x: np.ndarray
    y: np.ndarray
    range: np.ndarray


def number(text: str) -> float:
    """A cell; a point stands for a missing value."""
    try:
        return float(text)
    except ValueError:
        return float("nan")


def trips(path: Path) -> Iterator[tuple[str, np.ndarray]]:
    """The rows of each trip."""
    with path.open(newline="", encoding="latin-1") as lines:
        rows = (row for row in csv.reader(lines) if row and row[0].strip('" ').isdigit())
        for trip, of_trip in groupby(rows, key=lambda row: row[0].strip('" ')):
            yield trip, np.array([[number(cell.strip('" ')) for cell in row[:76]] for row in of_trip])


def own_way(rows: np.ndarray) -> Way:
    """x, y and heading of the instrumented vehicle's centre."""
    time, speed = rows[:, TIME], rows[:, SPEED] * MPH
    known = speed >= 0
    if not known.any():
        raise ValueError("its speed is never known")
    speed = np.interp(time, time[known], speed[known])
    turning = np.radians(np.nan_to_num(rows[:, YAW_RATE]))
    steps = np.diff(time, prepend=time[0])
    heading = np.cumsum(turning * steps)
    x, y = (np.cumsum(speed * part(heading) * steps) for part in (np.cos, np.sin))
    return x, y, heading


def targets(rows: np.ndarray, way: Way, radar: dict[str, int]) -> Iterator[Seen]:
    """What a radar saw, target by target: the place of its nearest side."""
    x, y, heading = way
    ids, ranges, azimuths = (rows[:, radar[key] : radar[key] + TARGETS] for key in ("id", "range", "azimuth"))
    for target in np.unique(ids[ids > 0]):
        row, column = np.nonzero((ids == target) & (ranges >= 0) & np.isfinite(azimuths))
        row, first = np.unique(row, return_index=True)
        away = ranges[row, column[first]] * FOOT
        # Azimuths are positive to the right of the radar's own direction.
        towards = heading[row] + (0 if radar["sign"] > 0 else np.pi) - azimuths[row, column[first]]
        bumper = radar["sign"] * OWN_SIZE[0] / 2
        east = x[row] + bumper * np.cos(heading[row]) + away * np.cos(towards)
        north = y[row] + bumper * np.sin(heading[row]) + away * np.sin(towards)
        time = rows[row, TIME]
        for part in np.split(np.arange(len(time)), np.flatnonzero(np.diff(time) > LOST) + 1):
            yield Seen(time[part], east[part], north[part], away[part])


def nearest(rows: np.ndarray, way: Way, event: list[str]) -> tuple[Seen, int] | None:
    """The target that was nearest during the event, and whether ahead (1) or behind (−1)."""
    inside = (rows[:, SYNC] >= float(event[BEGIN])) & (rows[:, SYNC] <= float(event[END]))
    if not inside.any():
        return None
    begin, end = rows[inside, TIME][[0, -1]]
    found = [(seen, radar["sign"]) for radar in (AHEAD, BEHIND) for seen in targets(rows, way, radar)]
    side = {"lead": 1, "foll": -1}.get(event[NATURE].replace("Conflict with a ", "")[:4])
    found = [both for both in found if both[1] == side] or found
    during = {index: seen.range[(seen.time >= begin) & (seen.time <= end)] for index, (seen, _) in enumerate(found)}
    least = {index: ranges.min() for index, ranges in during.items() if len(ranges)}
    if not least or min(least.values()) > NEAREST:
        return None
    return found[min(least, key=lambda index: least[index])]


def headings(time: np.ndarray, x: np.ndarray, y: np.ndarray, otherwise: np.ndarray) -> np.ndarray:
    """Headings from the movement; where it hardly moves, the last, or else another."""
    before, after = np.searchsorted(time, time - AROUND), np.searchsorted(time, time + AROUND, side="right") - 1
    moved = np.hypot(x[after] - x[before], y[after] - y[before])
    moves = moved >= MOVES * np.maximum(time[after] - time[before], 1e-9)
    heading = np.where(moves, np.arctan2(y[after] - y[before], x[after] - x[before]), np.nan)
    for index in range(1, len(heading)):
        if np.isnan(heading[index]):
            heading[index] = heading[index - 1]
    return np.where(np.isnan(heading), otherwise, heading)


def table(trip: str, rows: np.ndarray, event: list[str]) -> list[list[str]] | None:
    """The rows of an event's table; none if no target came near."""
    way = own_way(rows)
    match = nearest(rows, way, event)
    if match is None:
        return None
    seen, sign = match
    length, width, kind = next((of[1:] for of in SIZES if event[TARGET].startswith(of[0])), SIZES[0][1:])
    own = np.searchsorted(rows[:, TIME], seen.time)
    heading = way[2][own]
    x, y = seen.x + sign * length / 2 * np.cos(heading), seen.y + sign * length / 2 * np.sin(heading)
    ego = zip(seen.time, way[0][own], way[1][own], heading)
    foe = zip(seen.time, x, y, headings(seen.time, x, y, heading))
    sized = ((f"{trip}_ego", ego, (*OWN_SIZE, "car")), (f"{trip}_target", foe, (length, width, kind)))
    return [
        [name, f"{t:.3f}", f"{x:.3f}", f"{y:.3f}", f"{heading:.4f}", *map(str, size)]
        for name, places, size in sized
        for t, x, y, heading in places
    ]


def main() -> None:
    """Write a table for each event in which a target came near."""
    raw, out = map(Path, sys.argv[1:3]) if len(sys.argv) == 3 else sys.exit(__doc__)
    with (raw / EVENTS).open(encoding="latin-1") as lines:
        events = {row[EVENT]: row for row in (line.rstrip("\r\n").split("\t") for line in lines) if len(row) > TARGET}
    for kind, name in FILES.items():
        (out / kind).mkdir(parents=True, exist_ok=True)
        written, without = 0, 0
        for trip, rows in trips(raw / name):
            try:
                lines_of_event = table(trip, rows, events[trip]) if trip in events else None
            except ValueError as reason:
                print(f"{name}, trip {trip}: left out, {reason}", file=sys.stderr)
                lines_of_event = None
            if lines_of_event is None:
                without += 1
                continue
            written += 1
            with (out / kind / f"{trip}.csv").open("w", newline="") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(["id", "t", "x", "y", "heading", "length", "width", "class"])
                writer.writerows(lines_of_event)
        print(f"{out / kind}: {written} events, {without} left out")


if __name__ == "__main__":
    main()
