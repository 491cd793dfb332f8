"""Leaving out work that a scene does not need changes no result: `--no-shortcuts` gives the same bytes everywhere."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import closecall as cc
import libsumo
import pytest
from conftest import NETS, closecall

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

Found = tuple[dict[str, bytes], dict[str, Any]]
"""The files of a log, and its record without the fields that tell only how it was computed."""

END = 100
ENDS = {"town": 25, "bridge": 60}
"""Ends in s: with every pair kept, the time of a step grows with the square of the road users."""
BESIDE_ENDS = {"town": 8, "bridge": 60}
"""The same where several checkers follow one simulation."""
SEEDS = {"town": 44}
"""With this seed a stale path of a vehicle that had been in no pair for a while would change the conflict at 23 s."""

METHODS: dict[str, dict[str, Any]] = {"arc": {"path": "arc"}, "paper": {"mode": "paper"}}

BY_DEFINITION = {"one was not there yet", "both stand", "both are persons", "on different levels"}
OF_THE_SCENE = {"no sumo-gui", "none enters the scene"}


def logged(out: Path, kept: bool) -> Found:
    """What a checker has logged."""
    record = json.loads((out / "run.json").read_text())
    assert record["options"].pop("keep_all") is kept
    record["left_out"] = record["summary"].pop("left_out")
    return {name: (out / name).read_bytes() for name in ("conflicts.csv", "series.csv")}, record


def checked(config: Path, out: Path, *words: str) -> Found:
    """The log of a run."""
    end = ["--end", str(ENDS.get(config.stem, END))]
    seed = ["--seed", str(SEEDS[config.stem])] if config.stem in SEEDS else []
    more = ["--config", str(config.parent / "closecall.toml"), *end, *seed, *words]
    done = closecall("run", config, *more, "--log-series", "--quiet", "--out", out)
    assert done.returncode == 0, done.stderr
    return logged(out, "--no-shortcuts" in words)


def differ_only_in_what_is_left_out(found: Found, whole: Found) -> tuple[int, int]:
    """Assert it, and return how many tests were left out, and how many where all are kept."""
    (log, record), (whole_log, whole_record) = found, whole
    assert log == whole_log
    left_out, kept = record.pop("left_out"), whole_record.pop("left_out")
    assert record == whole_record
    assert {entry["why"] for entry in kept} <= BY_DEFINITION | OF_THE_SCENE
    return len(left_out), len(kept)


all_scenarios = pytest.mark.parametrize("config", sorted(NETS.glob("*/*.sumocfg")), ids=lambda config: config.stem)


@all_scenarios
def test_leaving_out_changes_no_result(config: Path, tmp_path: Path) -> None:
    found, whole = checked(config, tmp_path / "left_out"), checked(config, tmp_path / "kept", "--no-shortcuts")
    left_out, kept = differ_only_in_what_is_left_out(found, whole)
    assert left_out > kept


@all_scenarios
def test_leaving_out_changes_no_result_of_other_methods(config: Path, tmp_path: Path) -> None:
    settings = tomllib.loads((config.parent / "closecall.toml").read_text())
    for of_a_run in ("regress", "end"):
        settings.pop(of_a_run, None)
    libsumo.start(["sumo", "-c", str(config), "--no-warnings"])
    checkers = [
        cc.Checker(
            libsumo, out=tmp_path / name / str(keep_all), log_series=True, keep_all=keep_all, **method, **settings
        )
        for name, method in METHODS.items()
        for keep_all in (False, True)
    ]
    last = libsumo.simulation.getEndTime()
    end = min(BESIDE_ENDS.get(config.stem, END), last if last >= 0 else math.inf)
    while libsumo.simulation.getMinExpectedNumber() > 0 and libsumo.simulation.getTime() < end:
        libsumo.simulationStep()
        for checker in checkers:
            checker.step()
    for checker in checkers:
        checker.close()
    libsumo.close()
    for method in METHODS:
        found, whole = (logged(tmp_path / method / str(keep_all), keep_all) for keep_all in (False, True))
        left_out, kept = differ_only_in_what_is_left_out(found, whole)
        # Paper mode leaves out only pairs that are too far apart, and a small scene has none.
        assert method == "paper" or left_out > kept


@pytest.mark.parametrize("net", ["left_turn", "reckless"])
def test_leaving_out_changes_no_result_of_a_wider_condition(net: str, tmp_path: Path) -> None:
    config, wider = NETS / net / f"{net}.sumocfg", ("--log", "ssm", "--end", "50")
    found, whole = (
        checked(config, tmp_path / "left_out", *wider),
        checked(config, tmp_path / "kept", *wider, "--no-shortcuts"),
    )
    assert found[0]["conflicts.csv"].count(b"\n") > 10
    left_out, kept = differ_only_in_what_is_left_out(found, whole)
    assert left_out > kept
