"""One scene in the layouts of public trajectory data: the data sets themselves may not be redistributed.

python tests/python/layouts.py FOLDER
"""

from __future__ import annotations

import csv
import math
import struct
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

RATE = 10
"""Frames per second."""
FOOT = 0.3048


class Sample(NamedTuple):
    """A road user in a frame, in SI units; x and y are its middle, the heading is counter-clockwise from +x."""

    frame: int
    id: int
    kind: str
    x: float
    y: float
    heading: float
    speed: float
    length: float
    width: float

    @property
    def velocity(self) -> tuple[float, float]:
        return self.speed * math.cos(self.heading), self.speed * math.sin(self.heading)

    def at(self, along: float) -> tuple[float, float]:
        """A point on its axis, this far ahead of its middle."""
        return self.x + along * math.cos(self.heading), self.y + along * math.sin(self.heading)


def scene(*, only_along_x: bool = False) -> list[Sample]:
    """Two cars that collide at a crossing, a pair that follows too closely, a truck, a person that crosses."""
    users = [
        (1, "car", -60.0, 0.0, 0.0, 12.0, 0.0, 4.6, 1.8),
        (2, "car", -40.0, 0.0, 0.0, 12.0, -3.0, 4.4, 1.75),
        (3, "truck", 90.0, 3.57, math.pi, 13.93, 0.0, 7.1, 2.4),
        (4, "car", 115.3, 3.41, math.pi, 19.87, 0.0, 4.6, 1.8),
        (5, "car", 15.13, -48.71, math.pi / 2, 9.83, 0.0, 4.6, 1.8),
        (6, "pedestrian", -40.17, 12.07, -math.pi / 2, 1.47, 0.0, 0.5, 0.5),
    ]
    rows = []
    for frame in range(80):
        time = frame / RATE
        for number, kind, x, y, heading, speed, change, length, width in users:
            if only_along_x and abs(math.sin(heading)) > 0.5:
                continue
            until = min(time, -speed / change) if change < 0 else time
            way = speed * until + change * until * until / 2
            now = max(speed + change * time, 0.0)
            place = x + way * math.cos(heading), y + way * math.sin(heading)
            rows.append(Sample(frame, number, kind, *place, heading, now, length, width))
    return rows


def write(path: Path, names: str, rows: Iterable[Iterable[Any]]) -> None:
    """Write a CSV file."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(names.split(","))
        writer.writerows([round(cell, 6) if isinstance(cell, float) else cell for cell in row] for row in rows)


def by_track(rows: list[Sample]) -> list[Sample]:
    """As most data sets have them: one road user after the other."""
    return sorted(rows, key=lambda row: (row.id, row.frame))


CLASSES = {"car": "passenger", "truck": "truck", "pedestrian": "pedestrian"}


def fcd(folder: Path, rows: list[Sample]) -> tuple[Path, Path]:
    """SUMO's fcd-output, and the types of its road users."""
    path, types = folder / "fcd.xml", folder / "types.add.xml"
    names = {row.id: f"{CLASSES[row.kind]} {row.length:g}x{row.width:g}" for row in rows}
    vtypes = {
        f'<vType id="{names[row.id]}" vClass="{CLASSES[row.kind]}" length="{row.length}" width="{row.width}"/>'
        for row in rows
    }
    types.write_text(f"<additional>{''.join(sorted(vtypes))}</additional>")
    lines = ["<fcd-export>"]
    for frame in sorted({row.frame for row in rows}):
        lines.append(f'<timestep time="{frame / RATE:.2f}">')
        for row in rows:
            if row.frame == frame:
                x, y = row.at(row.length / 2)
                tag = "person" if row.kind == "pedestrian" else "vehicle"
                lines.append(
                    f'<{tag} id="{row.id}" x="{x:.6f}" y="{y:.6f}" angle="{90 - math.degrees(row.heading):.6f}" '
                    f'type="{names[row.id]}" speed="{row.speed:.6f}"/>'
                )
        lines.append("</timestep>")
    path.write_text("\n".join([*lines, "</fcd-export>"]))
    return path, types


def levelx(folder: Path, rows: list[Sample], name: str = "00") -> Path:
    """inD, rounD, exiD, uniD: tracks, and beside them the classes and the frame rate."""
    path = folder / f"{name}_tracks.csv"
    columns = "recordingId,trackId,frame,xCenter,yCenter,heading,width,length,xVelocity,yVelocity"
    cells = [
        (0, row.id, row.frame, row.x, row.y, math.degrees(row.heading) % 360, row.width, row.length, *row.velocity)
        for row in by_track(rows)
    ]
    write(path, columns, cells)
    kinds = {row.id: row.kind for row in rows}
    write(
        folder / f"{name}_tracksMeta.csv", "recordingId,trackId,class", [(0, *kind) for kind in sorted(kinds.items())]
    )
    write(folder / f"{name}_recordingMeta.csv", "recordingId,locationId,frameRate", [(0, 1, RATE)])
    return path


def highd(folder: Path, rows: list[Sample]) -> Path:
    """highD: upper left corners in a picture, width along the road and height across."""
    path = folder / "01_tracks.csv"
    cells = [
        (
            row.frame,
            row.id,
            row.x - row.length / 2,
            -row.y - row.width / 2,
            row.length,
            row.width,
            row.velocity[0],
            -row.velocity[1],
        )
        for row in by_track(rows)
    ]
    write(path, "frame,id,x,y,width,height,xVelocity,yVelocity", cells)
    kinds = {row.id: row.kind.title() for row in rows}
    write(folder / "01_tracksMeta.csv", "id,class", sorted(kinds.items()))
    write(folder / "01_recordingMeta.csv", "id,frameRate", [(1, RATE)])
    return path


def ngsim(folder: Path, rows: list[Sample]) -> Path:
    """NGSIM: feet, milliseconds, the middle of the front, no headings."""
    path = folder / "trajectories.csv"
    codes = {"car": 2, "truck": 3}
    cells = [
        (
            row.id,
            row.frame,
            1000000 + 100 * row.frame,
            *(it / FOOT for it in row.at(row.length / 2)),
            row.length / FOOT,
            row.width / FOOT,
            codes[row.kind],
            row.speed / FOOT,
        )
        for row in by_track(rows)
        if row.kind in codes
    ]
    write(path, "Vehicle_ID,Frame_ID,Global_Time,Local_X,Local_Y,v_Length,v_Width,v_Class,v_Vel", cells)
    return path


def interaction(folder: Path, rows: list[Sample], heading: str = "psi_rad") -> Path:
    """INTERACTION; with heading_rad, SinD."""
    path = folder / f"{heading}.csv"
    cells = [
        (row.id, row.frame, 100 * row.frame, row.kind, row.x, row.y, *row.velocity, row.heading, row.length, row.width)
        for row in by_track(rows)
    ]
    write(path, f"track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy,{heading},length,width", cells)
    return path


def citysim(folder: Path, rows: list[Sample]) -> Path:
    """CitySim: feet in a picture, miles per hour, the ends of each vehicle."""
    path = folder / "citysim.csv"

    def place(row: Sample, along: float) -> tuple[float, float]:
        x, y = row.at(along)
        return x / FOOT, -y / FOOT

    cells = [
        (
            row.frame,
            row.id,
            *place(row, 0),
            *place(row, row.length / 2),
            *place(row, -row.length / 2),
            row.speed / 0.44704,
        )
        for row in rows
        if row.kind == "car"
    ]
    write(path, "frameNum,carId,carCenterXft,carCenterYft,headXft,headYft,tailXft,tailYft,speed", cells)
    return path


def omega_prime(folder: Path, rows: list[Sample]) -> Path:
    """OMEGA-Prime: nanoseconds, OSI's types."""
    path = folder / "omega.csv"
    codes = {"car": 2, "truck": 2, "pedestrian": 3}
    cells = [
        (
            100000000 * row.frame,
            row.id,
            row.x,
            row.y,
            0.0,
            *row.velocity,
            0.0,
            row.length,
            row.width,
            1.5,
            0.0,
            0.0,
            row.heading,
            codes[row.kind],
        )
        for row in rows
    ]
    write(path, "total_nanos,idx,x,y,z,vel_x,vel_y,vel_z,length,width,height,roll,pitch,yaw,type", cells)
    return path


def fzp(folder: Path, rows: list[Sample]) -> Path:
    """Vissim's vehicle record."""
    path = folder / "record.fzp"
    codes = {"car": 100, "truck": 200, "pedestrian": 510}
    lines = ["$VISION", "* Table: Vehicles In Network", "* SPEED: Speed, Speed [km/h]", "*"]
    lines.append("$VEHICLE:SIMSEC;NO;LANE\\LINK\\NO;COORDFRONT;COORDREAR;WIDTH;SPEED;VEHTYPE")
    for row in rows:
        ends = (" ".join(f"{it:.6f}" for it in (*row.at(along), 0.0)) for along in (row.length / 2, -row.length / 2))
        lines.append(
            f"{row.frame / RATE:.2f};{row.id};7;{';'.join(ends)};{row.width};{row.speed * 3.6:.6f};{codes[row.kind]}: x"
        )
    path.write_text("\n".join(lines) + "\n")
    return path


def trj(folder: Path, rows: list[Sample], version: float, order: str = "<", *, is_english: bool = False) -> Path:
    """SSAM's trajectories; persons are not in them."""
    unit = 1 / FOOT if is_english else 1.0
    data = struct.pack(f"{order}Bcf", 0, b"L" if order == "<" else b"B", version)
    data += b"" if version < 2 else b"\x01"
    data += struct.pack(f"{order}BBf4i", 1, not is_english, 0.5, -200, -200, 200, 200)
    for frame in sorted({row.frame for row in rows}):
        data += struct.pack(f"{order}Bf", 2, frame / RATE)
        for row in rows:
            if row.frame == frame and row.kind != "pedestrian":
                ends = (it * unit / 0.5 for along in (row.length / 2, -row.length / 2) for it in row.at(along))
                sizes = (it * unit for it in (row.length, row.width, row.speed))
                data += struct.pack(f"{order}Biib8f", 3, row.id, 1, 0, *ends, *sizes, 0.0)
                data += b"" if version < 2 else struct.pack(f"{order}2f", 0, 0)
    path = folder / f"{version}{'le' if order == '<' else 'be'}{is_english}.trj"
    path.write_bytes(data)
    return path


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.mkdir(parents=True, exist_ok=True)
    for made in (levelx, ngsim, interaction, citysim, omega_prime, fzp):
        print(made(target, scene()))
    print(highd(target, scene(only_along_x=True)))
    print(trj(target, scene(), 1.04), trj(target, scene(), 3.0))
