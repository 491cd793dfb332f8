"""TTC, DRAC and PET against SUMO's device.ssm, step by step; docs/statistics_how.md explains each difference."""

from __future__ import annotations

import math
import pickle
import re
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path
from typing import Callable, NamedTuple

import pytest
from conftest import NETS, Once, Row, closecall, rows

FOLLOWER, CROSSING_FOLLOWER = "2", "11"
ENDS = {"left_turn": "220", "priority": "280", "rear_end": "280", "side": "280", "signals": "230"}


class Step(NamedTuple):
    """The device's values for an ego and a foe in one step."""

    type: str
    ttc: float | None
    drac: float | None


class Run(NamedTuple):
    """What closecall and the device found in the same run."""

    conflicts: list[Row]
    encounters: list[Row]
    steps: dict[tuple[float, str, str], Step]
    pets: dict[frozenset[str], float]
    fcd: Path


Compared = Callable[[str], Run]


def maybe(text: str | None) -> float | None:
    return None if text in ("NA", "", None) else float(text)


@pytest.fixture(scope="module")
def compared(once: Once) -> Compared:
    """Runs a scenario once, with closecall and the device in the same steps."""

    def run(name: str, out: Path) -> Run:
        words = ["--device.ssm.probability", "1", "--device.ssm.measures", "TTC DRAC PET", "--precision", "6"]
        words += ["--device.ssm.thresholds", "1000 0 1000", "--device.ssm.range", "100"]
        words += ["--device.ssm.trajectories", "true", "--device.ssm.file", str(out / "ssm.xml"), "--no-warnings"]
        words += ["--fcd-output", str(out / "fcd.xml"), "--fcd-output.attributes", "x,y,angle,lane,pos"]
        own = ("--end", ENDS[name], "--out", out, "--align", "never", "--log-series")
        done = closecall("run", NETS / name / f"{name}.sumocfg", *own, "--", *words)
        assert done.returncode == 0, done.stderr
        encounters = rows(out / "series.csv")
        pairs = {(row["ego"], row["foe"]) for row in encounters}
        steps: dict[tuple[float, str, str], Step] = {}
        pets: dict[frozenset[str], float] = {}
        for _, conflict in ET.iterparse(out / "ssm.xml"):
            if conflict.tag != "conflict":
                continue
            ego, foe = conflict.get("ego", ""), conflict.get("foe", "")
            spans = (conflict.find(name) for name in ("timeSpan", "typeSpan", "TTCSpan", "DRACSpan"))
            columns = [(span.get("values") or "").split() for span in spans if span is not None and (ego, foe) in pairs]
            for time, kind, ttc, drac in zip(*columns):
                steps[round(float(time), 3), ego, foe] = Step(kind, maybe(ttc), maybe(drac))
            pet = conflict.find("PET")
            if pet is not None and (value := maybe(pet.get("value"))) is not None:
                pair = frozenset((ego, foe))
                pets[pair] = min(value, pets.get(pair, value))
            conflict.clear()
        return Run(rows(out / "conflicts.csv"), encounters, steps, pets, out / "fcd.xml")

    @cache
    def found(name: str) -> Run:
        def fill(out: Path) -> None:
            (out / "run.pickle").write_bytes(pickle.dumps(run(name, out)))

        loaded = pickle.loads((once(f"ssm_{name}", fill) / "run.pickle").read_bytes())
        assert isinstance(loaded, Run)
        return loaded

    return found


def pairs_of(run: Run, kind: str, device_type: str) -> list[tuple[Row, Step]]:
    """The encounters of a kind to which the device gives this type, with the same ego."""
    found = []
    for row in run.encounters:
        step = run.steps.get((round(float(row["time"]), 3), row["ego"], row["foe"]))
        if row["kind"] == kind and step and step.type == device_type:
            found.append((row, step))
    return found


@pytest.mark.parametrize(("name", "least"), [("rear_end", 70), ("signals", 10)])
def test_followers_ttc_and_drac_equal_the_devices(name: str, least: int, compared: Compared) -> None:
    equal = 0
    for row, step in pairs_of(compared(name), "rear_end", FOLLOWER):
        for ours, theirs in ((maybe(row["ttc"]), step.ttc), (maybe(row["drac"]), step.drac)):
            if ours is not None:
                assert theirs == pytest.approx(ours, abs=2e-6), (row, step)
                equal += 1
        if row["ttc"] == "" and step.ttc is not None:
            # closecall looks ahead only over the ego's stopping distance, too short for a gap that closes this slowly.
            assert step.ttc > 5, (row, step)
    assert equal >= 2 * least


STRAIGHT = re.compile(r"([ab]_)?(we|ew|sn|ns)\.")


@pytest.mark.parametrize("name", ["signals", "priority"])
def test_straight_crossings_ttc_and_drac_equal_the_devices(name: str, compared: Compared) -> None:
    run = compared(name)
    found = [
        (row, step)
        for row, step in pairs_of(run, "side", CROSSING_FOLLOWER)
        if STRAIGHT.match(row["ego"]) and STRAIGHT.match(row["foe"])
    ]
    assert len([row for row, _ in found if row["drac"]]) >= 3
    for row, step in found:
        ours, theirs = maybe(row["ttc"]), step.ttc
        if ours is None and theirs is not None:
            # The two only graze, which hardly any braking avoids.
            assert step.drac is not None and step.drac < 0.5, (row, step)
        elif theirs is not None:
            assert ours == pytest.approx(theirs, abs=1e-3), (row, step)
        ours, theirs = maybe(row["drac"]), step.drac
        if ours is None or theirs is None:
            continue
        # With the device an accelerating foe leaves earlier, by less than the change within a step.
        near = [one["drac"] for one, _ in found if (one["ego"], one["foe"]) == (row["ego"], row["foe"])]
        change = max(float(drac) for drac in near if drac) - min(float(drac) for drac in near if drac)
        assert -0.001 <= ours - theirs <= max(0.02, change / 2), (row, step)


class Place(NamedTuple):
    """A car's state at a time: front, heading in rad, lane, and position on the lane."""

    time: float
    x: float
    y: float
    heading: float
    lane: str
    position: float


def courses(run: Run) -> dict[str, list[Place]]:
    """The states of each car in SUMO's fcd-output."""
    found: dict[str, list[Place]] = {}
    for _, step in ET.iterparse(run.fcd):
        if step.tag != "timestep":
            continue
        for car in step:
            value = {name: float(car.get(name, "nan")) for name in ("x", "y", "angle", "pos")}
            heading = math.radians(90.0 - value["angle"])
            place = Place(
                float(step.get("time", "nan")), value["x"], value["y"], heading, car.get("lane", ""), value["pos"]
            )
            found.setdefault(car.get("id", ""), []).append(place)
        step.clear()
    return found


LENGTH, WIDTH = 4.6, 1.8


@pytest.mark.parametrize(
    ("name", "least", "tolerance"),
    [("side", 1, 1e-3), ("signals", 4, 1e-3), ("left_turn", 3, 0.26), ("priority", 4, 1e-3)],
)
def test_crossings_pet_equals_the_devices(name: str, least: int, tolerance: float, compared: Compared) -> None:
    run = compared(name)
    compared_pets = 0
    for row in run.conflicts:
        pair = frozenset((row["ego"], row["foe"]))
        if name == "priority" and not (STRAIGHT.match(row["ego"]) and STRAIGHT.match(row["foe"])):
            # Turning cars have a test of their own below.
            continue
        if row["kind"] == "side" and row["pet"]:
            assert float(row["pet"]) == pytest.approx(run.pets[pair], abs=tolerance), row
            compared_pets += 1
        elif row["kind"] == "side" and pair in run.pets:
            # closecall waits 5 s after a conflict closes for its second road user.
            assert run.pets[pair] > 5, row
    assert compared_pets >= least


def passes(course: list[Place], starts: dict[str, float], distance: float) -> float:
    """When a car's front has driven this distance, given the distance at the start of each lane."""
    driven = [(place.time, starts[place.lane] + place.position) for place in course if place.lane in starts]
    for (time, before), (later, after) in zip(driven, driven[1:]):
        if before <= distance <= after:
            return time + (later - time) * (distance - before) / (after - before)
    raise AssertionError(distance)


def test_the_devices_pet_of_a_left_turn_ends_early(compared: Compared) -> None:
    # The device's conflict area begins `ahead` m before the point where the lanes cross (measured where the second car
    # enters it) and is as long as the other car is wide, at any angle (MSDevice_SSM.cpp, egoConflictAreaLength).
    run = compared("priority")
    places = courses(run)
    straight = {"mid_east_0": -235.60, ":yield_5_0": 0.0, "east_out_0": 14.4}
    turning = {"yield_in_0": -188.8, ":yield_3_0": 0.0, "mid_west_0": 18.19}
    # Distance from the junction's entry to the crossing of both lanes' centre lines (priority.net.xml).
    cross_straight, cross_turning = (
        7.2,
        4.0 + math.dist((251.6, -7.2), (251.05, -3.35)) + math.dist((251.05, -3.35), (250, -1.6)),
    )
    ahead = 1.432
    left_turns = [row for row in run.conflicts if row["pet"] and {row["ego"][:2], row["foe"][:2]} == {"we", "yw"}]
    frontal = [row for row in left_turns if row["kind"] == "frontal"]
    assert len(frontal) == 3
    for row in frontal:
        first, second = sorted((row["ego"], row["foe"]), reverse=True)
        enters = passes(places[second], straight, cross_straight - ahead)
        leaves = passes(places[first], turning, cross_turning - ahead + WIDTH + LENGTH)
        device = run.pets[frozenset((first, second))]
        assert device == pytest.approx(enters - leaves, abs=2e-3), row
        # The turning car's rear is then 0.4 m past the other's centre line, where 2.7 m are needed to clear its path,
        # and the turning car covers 1.3 m more of that path than the device's area.
        assert 0.45 < device - float(row["pet"]) < 0.55, row


def test_ttc_is_never_0_without_contact(compared: Compared) -> None:
    run = compared("left_turn")
    times = [float(row["ttc"]) for row in run.conflicts if row["ttc"]]
    assert times and min(times) > 0
    assert all(row["collision"] == "false" for row in run.conflicts)
