"""What really happened: every road user's states at full precision, from libsumo, in a process of its own."""

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


@dataclass
class Kind:
    """A type: dimensions in m, deceleration in m/s², response in s (t1 + t2)."""

    length: float
    width: float
    decel: float
    response: float
    build_up: float
    person: bool


@dataclass
class Track:
    """One road user: its states in consecutive steps, as columns, and whether it left before the recording ended."""

    kind: Kind
    first: int
    x: Numbers
    y: Numbers
    heading: Numbers
    speed: Numbers
    left: bool


@dataclass
class Recording:
    """A run: the time of step k is `begin + k * step`, in SUMO's own outputs' terms."""

    begin: float
    step: float
    steps: int
    tracks: dict[str, list[Track]]


def record(words: list[str]) -> Recording:
    """Run SUMO with these words in another process and record it."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "recording.pickle"
        subprocess.run([sys.executable, __file__, str(file), *words], stdout=subprocess.DEVNULL, check=True)
        recording = pickle.loads(file.read_bytes())
    assert isinstance(recording, Recording)
    return recording


def run(words: list[str]) -> Recording:
    """Run SUMO in this process."""
    import libsumo

    libsumo.start(["sumo", *words, "--no-warnings", "--no-step-log"])
    simulation, vehicle, person = libsumo.simulation, libsumo.vehicle, libsumo.person
    step, begin, end = simulation.getDeltaT(), simulation.getTime(), simulation.getEndTime()
    rows: dict[str, list[tuple[int, float, float, float, float]]] = {}
    kinds: dict[str, Kind] = {}
    count = 0
    while simulation.getMinExpectedNumber() > 0 and (end < 0 or simulation.getTime() < end):
        libsumo.simulationStep()
        for domain, is_person in ((vehicle, False), (person, True)):
            for who in domain.getIDList():
                if (is_person and domain.getVehicle(who)) or (not is_person and domain.isStoppedParking(who)):
                    continue
                x, y = domain.getPosition(who)
                if x <= -(2**30):
                    continue
                if who not in kinds:
                    kinds[who] = kind_of(libsumo, domain.getTypeID(who), is_person, step)
                heading = np.radians(90.0 - domain.getAngle(who))
                rows.setdefault(who, []).append((count, x, y, heading, domain.getSpeed(who)))
        count += 1
    libsumo.close()
    tracks = {who: split(np.array(states), kinds[who], step, count) for who, states in rows.items()}
    return Recording(begin, step, count, tracks)


def kind_of(libsumo: object, name: str, person: bool, step: float) -> Kind:
    """A type by the defaults: t1 0.8 s, t2 0.25 or (air brakes) 0.35 s, t3 0.1 s; persons stop in a step."""
    types = libsumo.vehicletype  # type: ignore[attr-defined]
    length, width = types.getLength(name), types.getWidth(name)
    if person:
        return Kind(length, width, 1e3, step, 0.0, True)
    air = types.getVehicleClass(name) in ("truck", "trailer", "bus", "coach")
    return Kind(length, width, types.getEmergencyDecel(name), 0.8 + (0.35 if air else 0.25), 0.1, False)


def split(states: Numbers, kind: Kind, step: float, steps: int) -> list[Track]:
    """Tracks without a gap or a jump: a teleport or a leap ends one and begins another."""
    index, x, y, _, speed = states.T
    far = np.hypot(np.diff(x), np.diff(y)) > np.maximum(speed[1:], speed[:-1]) * step * 1.5 + 5.0
    cuts = np.flatnonzero((np.diff(index) > 1) | far) + 1
    pieces = np.split(states, cuts)
    return [
        Track(kind, int(piece[0, 0]), *piece.T[1:].copy(), left=piece is pieces[-1] and piece[-1, 0] < steps - 1)
        for piece in pieces
    ]


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parent))
    import recording

    Path(sys.argv[1]).write_bytes(pickle.dumps(recording.run(sys.argv[2:])))
