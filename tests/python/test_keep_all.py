"""Leaving out work that a scene does not need changes no result: `--keep-all` gives the same bytes everywhere."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from conftest import NETS, closecall

ENDS = {"town": 25, "bridge": 60}
"""Shorter ends in s: with every pair kept, the time of a step grows with the square of the road users."""
SEEDS = {"town": 44}
"""With this seed a stale path of a vehicle that had been in no pair for a while would change the conflict at 23 s."""


def checked(config: Path, out: Path, *words: str) -> tuple[dict[str, bytes], dict[str, Any]]:
    """The log of a scenario, and its record without the fields that tell only how it was computed."""
    end = ["--end", str(ENDS[config.stem])] if config.stem in ENDS else []
    seed = ["--seed", str(SEEDS[config.stem])] if config.stem in SEEDS else []
    more = ["--config", str(config.parent / "closecall.toml"), *end, *seed, *words]
    done = closecall("run", config, *more, "--log-series", "--quiet", "--out", out)
    assert done.returncode == 0, done.stderr
    record = json.loads((out / "run.json").read_text())
    assert record["options"].pop("keep_all") is ("--keep-all" in words)
    record["left_out"] = record["summary"].pop("left_out")
    return {name: (out / name).read_bytes() for name in ("conflicts.csv", "series.csv")}, record


@pytest.mark.parametrize("method", ["--path lanes", "--path arc", "--mode paper"])
@pytest.mark.parametrize("config", sorted(NETS.glob("*/*.sumocfg")), ids=lambda config: config.stem)
def test_leaving_out_changes_no_result(config: Path, method: str, tmp_path: Path) -> None:
    log, record = checked(config, tmp_path / "left_out", *method.split())
    whole_log, whole_record = checked(config, tmp_path / "kept", *method.split(), "--keep-all")
    assert log == whole_log
    left_out, kept = record.pop("left_out"), whole_record.pop("left_out")
    assert record == whole_record
    by_definition = {"one was not there yet", "both stand", "both are persons", "on different levels"}
    of_the_scene = {"no sumo-gui", "none enters the scene"}
    assert {entry["why"] for entry in kept} <= by_definition | of_the_scene
    # Paper mode leaves out only pairs that are too far apart, and a small scene has none.
    assert method == "--mode paper" or len(left_out) > len(kept)


@pytest.mark.parametrize("net", ["left_turn", "reckless"])
def test_leaving_out_changes_no_result_of_a_wider_condition(net: str, tmp_path: Path) -> None:
    config, wider = NETS / net / f"{net}.sumocfg", ("--log", "ssm", "--end", "100")
    log, record = checked(config, tmp_path / "left_out", *wider)
    whole_log, whole_record = checked(config, tmp_path / "kept", *wider, "--keep-all")
    assert log == whole_log and log["conflicts.csv"].count(b"\n") > 10
    assert len(record.pop("left_out")) > len(whole_record.pop("left_out"))
    assert record == whole_record
