"""What is logged: conditions, the warm-up and the series of each conflict."""

from __future__ import annotations

import gzip
import json
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Callable

import closecall as cc
import pytest
from conftest import NETS, Row, closecall, rows


def logged(net: str, out: Path, *words: str) -> list[Row]:
    """The conflicts of a scenario."""
    done = closecall("run", NETS / net / f"{net}.sumocfg", "--out", out, "--quiet", *words)
    assert done.returncode == 0, done.stderr
    return rows(out / "conflicts.csv")


@pytest.mark.parametrize("net", ["left_turn", "reckless"])
def test_a_wider_condition_leaves_every_margin_the_same(net: str, tmp_path: Path) -> None:
    in_conflict = []
    for name, condition in (("narrow", "margin < 0"), ("wide", "margin < 0 or ttc < 5 or gap < 20")):
        logged(net, tmp_path / name, "--log", condition, "--log-series", "--end", "80")
        steps = rows(tmp_path / name / "series.csv")
        steps = [{name: cell for name, cell in row.items() if name != "conflict"} for row in steps]
        in_conflict.append(
            sorted((row for row in steps if float(row["margin"]) < 0), key=lambda row: sorted(row.items()))
        )
        if name == "wide":
            assert len(steps) > 2 * len(in_conflict[1])
    narrow, wide = in_conflict
    assert narrow == wide and len(narrow) > 20


def test_a_logged_conflict_meets_the_condition_in_its_steps(tmp_path: Path) -> None:
    found = logged("left_turn", tmp_path, "--log", "ttc < 2 or drac > 4", "--log-series", "--end", "150")
    steps = rows(tmp_path / "series.csv")
    assert len(found) > 5
    assert all(float(row["ttc"] or "inf") < 2 or float(row["drac"] or "0") > 4 for row in steps)
    for row in found:
        own = [float(step["time"]) for step in steps if step["conflict"] == row["id"]]
        assert (min(own), max(own)) == (float(row["begin"]), float(row["end"]))


def test_a_pair_may_be_logged_for_its_pet_alone(tmp_path: Path) -> None:
    found = logged("left_turn", tmp_path / "pet", "--log", "pet < 3", "--end", "150")
    assert found and all(0 <= float(row["pet"]) < 3 and row["kind"] != "rear_end" for row in found if row["pet"])
    assert all(row["pet"] or row["collision"] == "true" for row in found)
    rest = logged("left_turn", tmp_path / "rest", "--log", "margin < 0", "--end", "150")
    both = logged("left_turn", tmp_path / "both", "--log", "pet < 3 or margin < 0", "--end", "150")
    pairs_of = [{frozenset((row["ego"], row["foe"])) for row in one} for one in (found, rest, both)]
    assert pairs_of[2] == pairs_of[0] | pairs_of[1]
    assert pairs_of[0] - pairs_of[1], "the default misses some"


@pytest.mark.parametrize(
    ("condition", "said"),
    [
        ("tcc < 3", 'unknown measure "tcc"; did you mean "ttc"?'),
        ("ttc > 3", '"ttc > 3" holds for pairs however far ahead they meet'),
        ("ttc <", "expected a number at the end"),
    ],
)
def test_a_condition_that_cannot_be_used_is_named(condition: str, said: str, tmp_path: Path) -> None:
    done = closecall("run", NETS / "side" / "side.sumocfg", "--out", tmp_path / "out", "--log", condition)
    assert done.returncode == 2 and said in done.stderr and not (tmp_path / "out").exists()
    with pytest.raises(ValueError) as error:
        cc.Checker(log=condition)
    assert said in str(error.value)


def test_the_record_names_the_condition_and_the_warm_up(tmp_path: Path) -> None:
    (tmp_path / "closecall.toml").write_text('log = "ssam"\nwarmup = 2\n')
    logged("side", tmp_path / "out", "--config", str(tmp_path / "closecall.toml"))
    options = json.loads((tmp_path / "out" / "run.json").read_text())["options"]
    assert (options["log"], options["warmup"]) == ("ttc <= 1.5 or pet <= 5", 2.0)


def test_the_warm_up_is_neither_counted_nor_logged(tmp_path: Path) -> None:
    whole = logged("left_turn", tmp_path / "whole", "--end", "120")
    later = logged("left_turn", tmp_path / "later", "--end", "120", "--warmup", "60")
    records = [json.loads((tmp_path / name / "run.json").read_text()) for name in ("whole", "later")]
    begin = records[0]["summary"]["begin"] + 60
    assert records[1]["summary"]["begin"] == pytest.approx(begin)
    steps, traffic = ([record["summary"][name] for record in records] for name in ("steps", "exposure"))
    assert steps[1] == pytest.approx(steps[0] - 60 / records[0]["step_length"], abs=1)
    assert traffic[1]["vehicle_hours"] < traffic[0]["vehicle_hours"] and traffic[1]["vehicles"] < traffic[0]["vehicles"]
    ends = [float(row["end"]) for row in whole]
    assert 0 < len(later) == sum(end >= begin - 1e-6 for end in ends) < len(whole)
    assert min(float(row["begin"]) for row in later) >= begin - 1e-6


def test_a_run_shorter_than_its_warm_up_says_so(tmp_path: Path) -> None:
    config = NETS / "side" / "side.sumocfg"
    done = closecall("run", config, "--out", tmp_path, "--warmup", "1000")
    assert done.returncode == 0 and "warmup: the run ended before 1000 s had passed" in done.stdout + done.stderr
    assert rows(tmp_path / "conflicts.csv") == []


def test_warm_up_counts_the_vehicles_that_are_there_when_it_ends() -> None:
    states = {"heading": [0.0, 0.0], "speed": [10.0, 10.0], "y": [0.0, 0.0]}
    with cc.Checker(warmup=1.0) as checker:
        checker.step(0.0, {**states, "id": ["gone", "stays"], "x": [0.0, 300.0]})
        checker.step(1.0, {**states, "id": ["stays", "new"], "x": [310.0, 0.0]})
    assert checker.summary["steps"] == 1 and checker.summary["exposure"]["vehicles"] == 2
    assert checker.summary["exposure"]["vehicle_hours"] == pytest.approx(2 / 3600)


BEYOND: dict[str, Callable[[float], bool]] = {
    "minTTC": lambda ttc: ttc < 3,
    "maxDRAC": lambda drac: drac > 3,
    "PET": lambda pet: pet < 2,
}
"""The device's measures, and when each is beyond its default threshold."""


def beyond_its_thresholds(file: Path) -> dict[frozenset[str], set[str]]:
    """The pairs that device.ssm reports, with its encounter types of the measures that are beyond its thresholds."""
    found: dict[frozenset[str], set[str]] = {}
    for conflict in ET.parse(file).getroot():
        for name, is_beyond in BEYOND.items():
            extreme = conflict.find(name)
            value = "NA" if extreme is None else extreme.get("value", "NA")
            if extreme is not None and value not in ("NA", "") and is_beyond(float(value)):
                pair = frozenset((conflict.get("ego", ""), conflict.get("foe", "")))
                found.setdefault(pair, set()).add(extreme.get("type", ""))
    return found


CROSSING_OR_LEFT = {"10", "11", "17"}
"""The device's types whose arrival times and conflict areas differ from closecall's: docs/statistics_how.md."""


@pytest.mark.parametrize(("net", "end", "least"), [("left_turn", "120", 60), ("signals", "110", 50)])
def test_pairs_of_the_ssm_device_are_logged_or_explained(net: str, end: str, least: int, tmp_path: Path) -> None:
    words = ["--device.ssm.probability", "1", "--device.ssm.measures", "TTC DRAC PET", "--precision", "6"]
    words += ["--device.ssm.thresholds", "3 3 2", "--device.ssm.file", str(tmp_path / "ssm.xml"), "--no-warnings"]
    found = logged(net, tmp_path / "ssm", "--log", "ssm", "--align", "never", "--end", end, "--", *words)
    wide = "ttc <= 10 or drac > 0.1 or pet <= 5 or gap < 40"
    wider = logged(net, tmp_path / "wide", "--log", wide, "--align", "never", "--end", end, "--", "--no-warnings")
    pairs, others = ({frozenset((row["ego"], row["foe"])) for row in one} for one in (found, wider))
    theirs = beyond_its_thresholds(tmp_path / "ssm.xml")
    missing = set(theirs) - pairs
    assert len(theirs) >= least and len(missing) <= 0.02 * len(theirs)
    assert missing <= others, "closecall has them, with values that are not beyond the thresholds"
    assert all(theirs[pair] <= CROSSING_OR_LEFT for pair in missing)


@pytest.mark.parametrize("net", ["roundabout", "signals"])
def test_entered_counts_the_vehicles_of_each_junction(net: str, tmp_path: Path) -> None:
    logged(net, tmp_path, "--end", "60", "--", "--fcd-output", str(tmp_path / "fcd.xml"))
    roads = ET.parse(NETS / net / f"{net}.net.xml").getroot()
    begins = {edge.get("id"): edge.get("from") for edge in roads.findall("edge")}
    last: dict[str, str] = {}
    expected: dict[str, int] = {}
    for vehicle in ET.parse(tmp_path / "fcd.xml").getroot().iter("vehicle"):
        name, edge = str(vehicle.get("id")), str(vehicle.get("lane")).rsplit("_", 1)[0]
        junction = edge[1:].rsplit("_", 1)[0] if edge.startswith(":") else str(begins[edge])
        before = last.get(name)
        was_there = before is not None and before.startswith(f":{junction}_")
        if before != edge and not was_there and (before is not None or edge.startswith(":")):
            expected[junction] = expected.get(junction, 0) + 1
        last[name] = edge
    assert json.loads((tmp_path / "run.json").read_text())["summary"]["entered"] == expected
    assert sum(expected.values()) > 20


@pytest.mark.parametrize("net", ["priority", "side"])
def test_each_severe_conflict_has_a_clip(net: str, tmp_path: Path) -> None:
    # Some are severe only by their PET, which is known after they close, or by how close they passed.
    found = logged(net, tmp_path, "--log-clips", "serious")
    severe = {row["id"] for row in found if row["severity"] != "caution" and not row["artefact"]}
    with gzip.open(tmp_path / "clips.jsonl.gz", "rt") as lines:
        clips = {str(json.loads(line)["conflict"]) for line in lines}
    assert clips == severe != set()
