"""Every road user's states in a run, at full precision, from libsumo in a process of its own."""

from __future__ import annotations

import pickle
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]

INVALID = -(2.0**30)
"""A road user whose x is at or below this, in m, has no valid position."""


@dataclass
class Profile:
    """A vehicle type: dimensions in m, deceleration in m/s², response (t1 + t2) and build-up (t3) in s."""

    length: float
    width: float
    decel: float
    response: float
    build_up: float
    person: bool


@dataclass
class Lane:
    """A lane as drawn: its edge, the points of its shape, its length in SUMO's metres, and the lanes that follow."""

    edge: str
    shape: Numbers
    length: float
    following: list[str]


@dataclass
class Track:
    """A road user's states in consecutive steps from `first` on, and whether it left before the recording ended.

    `lane` is its lane's place in the recording's list, -1 where it has none, and `position` where its front bumper is
    there, in SUMO's metres.
    """

    profile: Profile
    first: int
    x: Numbers
    y: Numbers
    heading: Numbers
    speed: Numbers
    lane: Numbers
    position: Numbers
    left: bool


@dataclass
class Recording:
    """A run: step k has the time `begin + k * step`, as in SUMO's outputs."""

    begin: float
    step: float
    steps: int
    tracks: dict[str, list[Track]]
    lane_names: list[str]
    lanes: dict[str, Lane]


def record(words: list[str]) -> Recording:
    """Record a run of SUMO with these command-line words, in another process."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "recording.pickle"
        subprocess.run([sys.executable, __file__, str(file), *words], stdout=subprocess.DEVNULL, check=True)
        recording = pickle.loads(file.read_bytes())
    assert isinstance(recording, Recording)
    return recording


def run(words: list[str]) -> Recording:
    """Record a run of SUMO in this process."""
    import libsumo

    libsumo.start(["sumo", *words, "--no-warnings", "--no-step-log"])
    simulation, vehicle, person = libsumo.simulation, libsumo.vehicle, libsumo.person
    step, begin, end = simulation.getDeltaT(), simulation.getTime(), simulation.getEndTime()
    rows: dict[str, list[tuple[float, ...]]] = {}
    lanes = {name: lane(libsumo, name) for name in libsumo.lane.getIDList()}
    numbers = {name: number for number, name in enumerate(lanes)}
    profiles: dict[str, Profile] = {}
    count = 0
    while simulation.getMinExpectedNumber() > 0 and (end < 0 or simulation.getTime() < end):
        libsumo.simulationStep()
        for domain, is_person in ((vehicle, False), (person, True)):
            for user in domain.getIDList():
                if domain.getVehicle(user) if is_person else domain.isStoppedParking(user):
                    continue
                x, y = domain.getPosition(user)
                if x <= INVALID:
                    continue
                if user not in profiles:
                    profiles[user] = profile(libsumo, domain.getTypeID(user), is_person, step)
                heading = np.radians(90.0 - domain.getAngle(user))
                on = -1 if is_person else numbers.get(domain.getLaneID(user), -1)
                place = (on, domain.getLanePosition(user))
                rows.setdefault(user, []).append((count, x, y, heading, domain.getSpeed(user), *place))
        count += 1
    libsumo.close()
    tracks = {user: split(np.array(states), profiles[user], step, count) for user, states in rows.items()}
    return Recording(begin, step, count, tracks, list(lanes), lanes)


def lane(libsumo: object, name: str) -> Lane:
    """A lane of the net; the lanes within junctions follow those before them."""
    lanes = libsumo.lane  # type: ignore[attr-defined]
    following = [link[4] or link[0] for link in lanes.getLinks(name)]
    return Lane(lanes.getEdgeID(name), np.array(lanes.getShape(name)), lanes.getLength(name), following)


def profile(libsumo: object, name: str, person: bool, step: float) -> Profile:
    """A type with closecall's defaults: t1 + t2 is 1.05 s, or 1.15 s with air brakes; a person stops within a step."""
    types = libsumo.vehicletype  # type: ignore[attr-defined]
    length, width = types.getLength(name), types.getWidth(name)
    if person:
        return Profile(length, width, 1e3, step, 0.0, True)
    air = types.getVehicleClass(name) in ("truck", "trailer", "bus", "coach")
    return Profile(length, width, types.getEmergencyDecel(name), 0.8 + (0.35 if air else 0.25), 0.1, False)


def split(states: Numbers, profile: Profile, step: float, steps: int) -> list[Track]:
    """Split a road user's states into tracks at each missing step and each jump, such as a teleport."""
    index, x, y, _, speed = states.T[:5]
    far = np.hypot(np.diff(x), np.diff(y)) > np.maximum(speed[1:], speed[:-1]) * step * 1.5 + 5.0
    cuts = np.flatnonzero((np.diff(index) > 1) | far) + 1
    pieces = np.split(states, cuts)
    return [
        Track(profile, int(piece[0, 0]), *piece.T[1:].copy(), left=piece is pieces[-1] and piece[-1, 0] < steps - 1)
        for piece in pieces
    ]


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parent))
    import recording

    Path(sys.argv[1]).write_bytes(pickle.dumps(recording.run(sys.argv[2:])))
