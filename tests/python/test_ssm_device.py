"""TTC, DRAC and PET against SUMO's own device.ssm, step by step; docs/statistics.md explains each difference."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path
from typing import Callable, NamedTuple

import pytest
from conftest import NETS, Row, closecall, rows

FOLLOWER, CROSSING_FOLLOWER = "2", "11"


class Step(NamedTuple):
    """What the device says of an ego and a foe in one step."""

    type: str
    ttc: float | None
    drac: float | None


class Run(NamedTuple):
    """A run with both."""

    conflicts: list[Row]
    encounters: list[Row]
    steps: dict[tuple[float, str, str], Step]
    pets: dict[frozenset[str], float]


Compared = Callable[[str], Run]


def maybe(text: str | None) -> float | None:
    return None if text in ("NA", "", None) else float(text)


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> Compared:
    """Runs a scenario once with closecall and the device, in the same steps."""

    @cache
    def run(name: str) -> Run:
        out: Path = tmp_path_factory.mktemp(name)
        words = ["--device.ssm.probability", "1", "--device.ssm.measures", "TTC DRAC PET", "--precision", "6"]
        words += ["--device.ssm.thresholds", "1000 0 1000", "--device.ssm.range", "200"]
        words += ["--device.ssm.trajectories", "true", "--device.ssm.file", str(out / "ssm.xml"), "--no-warnings"]
        done = closecall("run", NETS / name / f"{name}.sumocfg", "--out", out, "--log-encounters", "--", *words)
        assert done.returncode == 0, done.stderr
        steps: dict[tuple[float, str, str], Step] = {}
        pets: dict[frozenset[str], float] = {}
        for conflict in ET.parse(out / "ssm.xml").getroot():
            ego, foe = conflict.get("ego", ""), conflict.get("foe", "")
            spans = (conflict.find(name) for name in ("timeSpan", "typeSpan", "TTCSpan", "DRACSpan"))
            columns = [(span.get("values") or "").split() for span in spans if span is not None]
            for time, kind, ttc, drac in zip(*columns):
                steps[round(float(time), 3), ego, foe] = Step(kind, maybe(ttc), maybe(drac))
            pet = conflict.find("PET")
            if pet is not None and (value := maybe(pet.get("value"))) is not None:
                pair = frozenset((ego, foe))
                pets[pair] = min(value, pets.get(pair, value))
        return Run(rows(out / "conflicts.csv"), rows(out / "encounters.csv"), steps, pets)

    return run


def pairs_of(run: Run, kind: str, device_type: str) -> list[tuple[Row, Step]]:
    """The steps of a kind in which the device sees the pair as of this type, from the same ego."""
    found = []
    for row in run.encounters:
        step = run.steps.get((round(float(row["time"]), 3), row["ego"], row["foe"]))
        if row["kind"] == kind and step and step.type == device_type:
            found.append((row, step))
    return found


@pytest.mark.parametrize(("name", "least"), [("rear_end", 70), ("signals", 10)])
def test_followers_have_the_devices_ttc_and_drac(name: str, least: int, compared: Compared) -> None:
    equal = 0
    for row, step in pairs_of(compared(name), "rear_end", FOLLOWER):
        for ours, theirs in ((maybe(row["ttc"]), step.ttc), (maybe(row["drac"]), step.drac)):
            if ours is not None:
                assert theirs == pytest.approx(ours, abs=2e-6), (row, step)
                equal += 1
        if row["ttc"] == "" and step.ttc is not None:
            # closecall looks ahead as far as the ego needs to stop; who closes so slowly gets no further.
            assert step.ttc > 5, (row, step)
    assert equal >= 2 * least


STRAIGHT = re.compile(r"([ab]_)?(we|ew|sn|ns)\.")


@pytest.mark.parametrize("name", ["signals", "priority"])
def test_straight_crossings_have_the_devices_ttc_and_drac(name: str, compared: Compared) -> None:
    run = compared(name)
    found = [
        (row, step)
        for row, step in pairs_of(run, "side", CROSSING_FOLLOWER)
        if STRAIGHT.match(row["ego"]) and STRAIGHT.match(row["foe"])
    ]
    assert len([row for row, _ in found if row["drac"]]) >= 3
    for row, step in found:
        ours, theirs = maybe(row["ttc"]), step.ttc
        if theirs is not None:
            assert ours == pytest.approx(theirs, abs=1e-3), (row, step)
        ours, theirs = maybe(row["drac"]), step.drac
        if ours is None or theirs is None:
            continue
        # The device lets an accelerating foe leave a little earlier: less than a step makes.
        near = [one["drac"] for one, _ in found if (one["ego"], one["foe"]) == (row["ego"], row["foe"])]
        change = max(float(drac) for drac in near if drac) - min(float(drac) for drac in near if drac)
        assert -0.001 <= ours - theirs <= max(0.02, change / 2), (row, step)


@pytest.mark.parametrize(
    ("name", "least", "tolerance"), [("side", 1, 1e-3), ("signals", 4, 1e-3), ("left_turn", 3, 0.25)]
)
def test_crossings_have_the_devices_pet(name: str, least: int, tolerance: float, compared: Compared) -> None:
    run = compared(name)
    compared_pets = 0
    for row in run.conflicts:
        pair = frozenset((row["ego"], row["foe"]))
        if row["kind"] == "side" and row["pet"]:
            assert float(row["pet"]) == pytest.approx(run.pets[pair], abs=tolerance), row
            compared_pets += 1
        elif row["kind"] == "side" and pair in run.pets:
            # Who comes more than 5 s after the conflict closed is not waited for.
            assert run.pets[pair] > 5, row
    assert compared_pets >= least


def test_no_ttc_is_0_where_nobody_touches(compared: Compared) -> None:
    run = compared("left_turn")
    times = [float(row["ttc"]) for row in run.conflicts if row["ttc"]]
    assert times and min(times) > 0
    assert all(row["collision"] == "false" for row in run.conflicts)
