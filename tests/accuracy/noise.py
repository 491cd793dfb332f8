"""What `--smooth` makes of noise: places, headings, speeds and conflicts against the truth.

    python tests/accuracy/noise.py [SCENARIO]

A scenario of sumo_nets/ is recorded at 25 Hz for two minutes. Its vehicles are written as a table of tracks with noise:
white, or correlated over one second, with the same standard deviation in x and in y, and headings as if both ends of a
vehicle were found with it. Speeds are left out. Each table is replayed with `--path driven` as it is and smoothed.
"""

from __future__ import annotations

import csv
import math
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from driven import BIN, NETS, Row, same
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
STEP = 0.04
END = "120"
CORRELATED = 1.0
"""The time in s over which correlated noise falls to 1/e."""
COLUMNS = "id=id,time=time,x=x,y=y,heading=heading,length=length,width=width"
Track = tuple[str, float, float, Numbers]
"""Id, length, width; and rows of time, x and y of the middle, heading and speed."""


def record(name: str, folder: Path) -> list[Track]:
    file = folder / "truth.fcd.csv"
    words = ["--step-length", str(STEP), "--end", END, "--fcd-output", file, "--precision", "6"]
    subprocess.run([BIN / "sumo", "-c", NETS / name / f"{name}.sumocfg", *words], check=True, capture_output=True)
    types = {}
    for kind in xml.parse(NETS / name / f"{name}.rou.xml").iter("vType"):
        types[kind.get("id")] = (float(kind.get("length", "5")), float(kind.get("width", "1.8")))
    rows: dict[str, list[tuple[float, ...]]] = {}
    sizes = {}
    with file.open() as source:
        for row in csv.DictReader(source, delimiter=";"):
            if name := row["vehicle_id"]:
                x, y, angle, speed = (float(row[f"vehicle_{key}"]) for key in ("x", "y", "angle", "speed"))
                sizes[name] = length, _ = types.get(row["vehicle_type"], (5.0, 1.8))
                heading = math.radians(90 - angle)
                middle = x - math.cos(heading) * length / 2, y - math.sin(heading) * length / 2
                rows.setdefault(name, []).append((float(row["timestep_time"]), *middle, heading, speed))
    return [(name, *sizes[name], np.array(of)) for name, of in rows.items()]


def white(random: np.random.Generator, count: int) -> Numbers:
    return random.standard_normal(count)


def correlated(random: np.random.Generator, count: int) -> Numbers:
    keeps = math.exp(-STEP / CORRELATED)
    noise = random.standard_normal(count)
    for step in range(1, count):
        noise[step] = keeps * noise[step - 1] + math.sqrt(1 - keeps**2) * noise[step]
    return noise


def write(
    tracks: list[Track], file: Path, noise: Callable[[np.random.Generator, int], Numbers], deviation: float
) -> None:
    random = np.random.default_rng(7)
    with file.open("w") as out:
        print("id,time,x,y,heading,length,width", file=out)
        for name, length, width, rows in tracks:
            count = len(rows)
            off = np.array([noise(random, count) for _ in range(3)]) * deviation
            off[2] *= math.sqrt(2) / length
            for (time, x, y, heading, _), (dx, dy, turn) in zip(rows, off.T):
                print(f"{name},{time:.2f},{x + dx},{y + dy},{heading + turn},{length},{width}", file=out)


def trajectories(file: Path) -> Iterator[tuple[float, int, float, float, float, float]]:
    """Of SSAM's .trj: the time, number, front, rear and speed of each vehicle."""
    data, at, time = file.read_bytes(), 0, 0.0
    while at < len(data):
        if data[at] == 0:
            at += struct.calcsize("<BcfB")
        elif data[at] == 1:
            at += struct.calcsize("<BBfiiii")
        elif data[at] == 2:
            time = struct.unpack_from("<f", data, at + 1)[0]
            at += 5
        else:
            number, _, _, *values = struct.unpack_from("<iiB10f", data, at + 1)
            at += 1 + struct.calcsize("<iiB10f")
            yield (time, number, *values[:4], values[6])  # type: ignore[misc]


def replay(net: Path, table: Path, out: Path, *words: str) -> tuple[list[Row], list[tuple[float, ...]]]:
    """The conflicts, and each row's time, x and y of the middle, heading and speed."""
    trj = table.with_suffix(".trj")
    words = ("--columns", COLUMNS, "--path", "driven", "--quiet", "--out", str(out), *words)
    subprocess.run([BIN / "closecall", "replay", table, "--net", net, "--trj-output", trj, *words], check=True)
    rows = []
    for time, _, x, y, rear_x, rear_y, speed in trajectories(trj):
        rows.append((round(time / STEP), (x + rear_x) / 2, (y + rear_y) / 2, math.atan2(y - rear_y, x - rear_x), speed))
    with (out / "conflicts.csv").open() as file:
        return list(csv.DictReader(file)), rows


def errors(rows: list[tuple[float, ...]], truth: list[tuple[float, ...]]) -> str:
    """RMS errors: rows come in the order of time, within a step in that of the vehicles' numbers."""
    found, expected = np.array(rows), np.array(truth)
    off = found - expected
    turn = (off[:, 3] + math.pi) % (2 * math.pi) - math.pi
    rms = [math.sqrt(np.mean(of)) for of in (off[:, 1] ** 2 + off[:, 2] ** 2, turn**2, off[:, 4] ** 2)]
    return f"{rms[0]:.3f} m  {math.degrees(rms[1]):5.2f}°  {rms[2]:6.3f} m/s"


def told(conflicts: list[Row], truth: list[Row]) -> str:
    known = sum(any(same(one, other) for other in conflicts) for one in truth)
    right = sum(any(same(one, other) for other in truth) for one in conflicts)
    return f"{len(conflicts):5}, {known} of {len(truth)} found, {len(conflicts) - right} more"


def main() -> None:
    name = sys.argv[1] if len(sys.argv) > 1 else "roundabout"
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        tracks = record(name, folder)
        net, table = NETS / name / f"{name}.net.xml", folder / "truth.csv"
        write(tracks, table, white, 0.0)
        conflicts, truth = replay(net, table, folder / "truth")
        print(f"{name}, truth (speeds from places): {len(conflicts)} conflicts")
        for kind, noise in (("white", white), ("correlated", correlated)):
            for deviation in (0.1, 0.3, 0.5):
                write(tracks, table, noise, deviation)
                for smoothed in (False, True):
                    words = (f"--smooth={deviation}",) if smoothed else ()
                    found, rows = replay(net, table, folder / f"{kind}{deviation}{smoothed}", *words)
                    what = "smoothed" if smoothed else "noisy   "
                    print(f"{kind:10} {deviation} m {what}  {errors(rows, truth)}  {told(found, conflicts)}")


if __name__ == "__main__":
    main()
