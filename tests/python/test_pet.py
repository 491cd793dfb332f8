"""PETs against where SUMO's fcd-output has the road users, place by place; and that a PET is one value."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import NETS, closecall, rows
from pet_places import run, told


@pytest.mark.parametrize(
    ("name", "end", "least"), [("priority", 60, 8), ("left_turn", 60, 8), ("roundabout", 50, 8), ("side", 30, 1)]
)
def test_every_pet_is_that_of_the_places(name: str, end: int, least: int, tmp_path: Path) -> None:
    words = ("--end", str(end), "--step-length", "0.1")
    checked = run(NETS / name / f"{name}.sumocfg", tmp_path, "pet < 5 or margin < 0", *words)
    assert len(checked.pets) >= least
    assert not checked.wrong, told(checked.wrong)
    assert not checked.missing, told(checked.missing)


@pytest.mark.parametrize(("step", "end", "least"), [("0.1", "45", 14), ("0.5", "60", 20)])
def test_every_pet_is_that_of_the_places_where_two_lanes_go_round(
    step: str, end: str, least: int, tmp_path: Path
) -> None:
    config = Path(__file__).parent / "two_lane_roundabout" / "two_lane_roundabout.sumocfg"
    checked = run(config, tmp_path, "pet < 5 or margin < 0", "--end", end, "--step-length", step)
    assert len(checked.pets) >= least
    assert not checked.wrong, told(checked.wrong)
    assert not checked.missing, told(checked.missing)


def test_a_condition_may_ask_for_a_longer_pet(tmp_path: Path) -> None:
    words = ("--end", "50", "--step-length", "0.1")
    checked = run(NETS / "roundabout" / "roundabout.sumocfg", tmp_path, "pet < 10", *words, longest=10.0)
    assert any(float(row["pet"]) > 6 for row in checked.pets)
    assert not checked.wrong, told(checked.wrong)


def pets(folder: Path, log: str, end: int) -> dict[frozenset[str], list[float]]:
    """The PETs of each pair in the roundabout."""
    config = NETS / "roundabout" / "roundabout.sumocfg"
    done = closecall("run", config, "--log", log, "--out", folder, "--end", str(end), "--quiet", "--", "--no-warnings")
    assert done.returncode == 0, done.stderr
    found: dict[frozenset[str], list[float]] = {}
    for row in rows(folder / "conflicts.csv"):
        if row["pet"]:
            found.setdefault(frozenset((row["ego"], row["foe"])), []).append(float(row["pet"]))
    return found


def test_a_pet_depends_on_neither_condition_nor_end(tmp_path: Path) -> None:
    logs = [("pet < 5", 50), ("ttc < 3", 50), ("ttc < 3 or pet < 2", 50), ("pet < 5", 42), ("pet < 5", 38)]
    whole, *others = [pets(tmp_path / str(number), log, end) for number, (log, end) in enumerate(logs)]
    assert len(whole) >= 8
    for (log, end), found in zip(logs[1:], others):
        assert found, log
        for pair, values in found.items():
            # Before a conflict begins, places are known every half second.
            assert values == pytest.approx([whole[pair][0]] * len(values), abs=0.05), (log, end, pair)
