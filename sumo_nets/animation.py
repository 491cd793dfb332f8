"""Draws the README's animated picture: a serious conflict of `left_turn`, as an SVG that plays by itself.

    .venv/bin/python sumo_nets/animation.py

A car turns left before one that comes towards it. While a conflict is open, the two are in the colour of its worst
severity so far.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from pathlib import Path

import closecall
import libsumo

HERE = Path(__file__).parent
CONFIG = HERE / "left_turn" / "left_turn.sumocfg"
NET = CONFIG.with_name("left_turn.net.xml")
PICTURE = HERE.parent / "docs" / "pictures" / "near_miss.svg"

# The conflict of north_east.6 with south_north.19, with seed 42.
BEGIN, END = 208.0, 218.0
SEED = 42
# What is shown, in m around the junction's centre, and its scale in pixels per m.
HALF_WIDTH, HALF_HEIGHT, SCALE = 42.0, 25.0, 9.0

ROAD, MARK, CAR = "#3f4348", "#8b9197", "#c9ced4"
# From the mildest on.
SEVERITY = {"caution": "#ffd400", "serious": "#ff8c00", "critical": "#ff2020"}
RANK = list(SEVERITY)


@dataclass
class Track:
    """A vehicle over all pictures: where it is, or None where it is not there, and its colour."""

    length: float
    width: float
    poses: list[tuple[float, float, float] | None] = field(default_factory=list)
    colours: list[str] = field(default_factory=list)


def drive() -> dict[str, Track]:
    """The vehicles of the scenario between BEGIN and END."""
    libsumo.start(["sumo", "-c", str(CONFIG), "--seed", str(SEED), "--no-warnings"])
    checker = closecall.Checker(libsumo)
    tracks: dict[str, Track] = {}
    worst: dict[frozenset[str], str] = {}
    steps = 0
    while libsumo.simulation.getTime() < END:
        libsumo.simulationStep()
        checker.step()
        if libsumo.simulation.getTime() < BEGIN:
            continue
        worst = {
            pair: max(alarm.severity, worst.get(pair, RANK[0]), key=RANK.index)
            for alarm in checker.active
            if (pair := frozenset((alarm.ego, alarm.foe)))
        }
        severity = {user: worst[pair] for pair in worst for user in pair}
        for name in libsumo.vehicle.getIDList():
            if name not in tracks:
                size = libsumo.vehicle.getLength(name), libsumo.vehicle.getWidth(name)
                tracks[name] = Track(*size, [None] * steps, [CAR] * steps)
            x, y = libsumo.vehicle.getPosition(name)
            tracks[name].poses.append((x, y, libsumo.vehicle.getAngle(name)))
            tracks[name].colours.append(SEVERITY.get(severity.get(name, ""), CAR))
        steps += 1
        for track in tracks.values():
            if len(track.poses) < steps:
                track.poses.append(None)
                track.colours.append(CAR)
    checker.close()
    libsumo.close()
    return tracks


def is_seen(track: Track) -> bool:
    """Whether the vehicle comes into the picture."""
    here = [pose for pose in track.poses if pose]
    reach = track.length + 1.0
    return any(abs(x) < HALF_WIDTH + reach and abs(y) < HALF_HEIGHT + reach for x, y, _ in here)


def point(x: float, y: float) -> str:
    """A place in the picture's coordinates."""
    return f"{(x + HALF_WIDTH) * SCALE:.1f},{(HALF_HEIGHT - y) * SCALE:.1f}"


def roads() -> list[str]:
    """The lanes and junctions of the net."""
    root = ET.parse(NET).getroot()
    shapes = [junction.get("shape", "") for junction in root.iter("junction")]
    drawn = [f'<polygon points="{outline(shape)}" fill="{ROAD}"/>' for shape in shapes if len(shape.split()) > 2]
    for edge in root.iter("edge"):
        for lane in edge.iter("lane"):
            line = f'<polyline points="{outline(lane.get("shape", ""))}" fill="none"'
            width = float(lane.get("width", "3.2")) * SCALE
            if edge.get("function") != "internal":
                drawn.append(f'{line} stroke="{MARK}" stroke-width="{width + 2:.1f}"/>')
            drawn.append(f'{line} stroke="{ROAD}" stroke-width="{width - 1:.1f}"/>')
    return drawn


def outline(shape: str) -> str:
    """SUMO's points of a shape in the picture's coordinates."""
    return " ".join(point(*map(float, place.split(",")[:2])) for place in shape.split())


def animated(track: Track, seconds: float) -> str:
    """A vehicle that moves."""
    first = next(pose for pose in track.poses if pose)
    places, turns, seen, last, turned = [], [], [], first, first[2]
    for pose in track.poses:
        last = pose or last
        turned += math.remainder(last[2] - turned, 360.0)
        places.append(point(last[0], last[1]))
        turns.append(f"{turned:.1f}")
        seen.append("1" if pose else "0")
    length, width = track.length * SCALE, track.width * SCALE
    time = f'dur="{seconds:g}s" repeatCount="indefinite"'
    body = (
        f'<rect x="{-width / 2:.1f}" y="0" width="{width:.1f}" height="{length:.1f}" rx="4" fill="{track.colours[0]}">'
    )
    colour = f'<animate attributeName="fill" calcMode="discrete" values="{";".join(track.colours)}" {time}/>'
    shown = f'<animate attributeName="opacity" calcMode="discrete" values="{";".join(seen)}" {time}/>'
    move = '<animateTransform attributeName="transform" type='
    return (
        f'<g opacity="{seen[0]}">{shown}'
        f'{move}"translate" values="{";".join(places)}" {time}/>'
        f'<g>{move}"rotate" values="{";".join(turns)}" {time}/>{body}{colour}</rect></g></g>'
    )


def main() -> None:
    """Write the picture."""
    tracks = [track for track in drive().values() if is_seen(track)]
    seconds = len(tracks[0].poses) * 0.2
    width, height = 2 * HALF_WIDTH * SCALE, 2 * HALF_HEIGHT * SCALE
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}">',
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="#20302a"/>',
        *roads(),
        *(animated(track, seconds) for track in tracks),
        "</svg>",
    ]
    PICTURE.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
