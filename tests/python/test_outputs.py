"""`--ssm-output` and `--trj-output`, read back and compared with the log and SUMO's own outputs."""

from __future__ import annotations

import math
import struct
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any, Callable, NamedTuple

import pytest
from conftest import NETS, closecall, parked, rows

Copy = Callable[[str], Path]


def test_the_ssm_file_holds_the_conflicts_of_the_log(tmp_path: Path) -> None:
    file = tmp_path / "ssm.xml"
    config = NETS / "left_turn" / "left_turn.sumocfg"
    done = closecall("run", config, "--out", tmp_path, "--log-series", "--ssm-output", file, "--", "--no-warnings")
    assert done.returncode == 0, done.stderr
    root = ET.parse(file).getroot()
    assert root.tag == "SSMLog"
    logged, steps = rows(tmp_path / "conflicts.csv"), rows(tmp_path / "series.csv")
    counting = [row for row in logged if not row["artefact"]]
    assert len(logged) > len(counting) == len(root) > 20
    for conflict, row in zip(root, counting):
        assert conflict.tag == "conflict"
        assert (conflict.get("ego"), conflict.get("foe")) == (row["ego"], row["foe"])
        assert [float(conflict.get(name, "nan")) for name in ("begin", "end")] == [
            float(row["begin"]),
            float(row["end"]),
        ]
        assert [child.tag for child in conflict] == ["minTTC", "maxDRAC", "PET"]
        own = [
            step
            for step in steps
            if {step["ego"], step["foe"]} == {row["ego"], row["foe"]}
            and float(row["begin"]) <= float(step["time"]) <= float(row["end"])
        ]
        for child, name in zip(conflict, ("ttc", "drac", "pet")):
            assert list(child.attrib) == ["time", "position", "type", "value", "speed"]
            if not row[name]:
                assert set(child.attrib.values()) == {"NA"}
                continue
            assert float(child.get("value", "nan")) == float(row[name])
            time, (x, y) = float(child.get("time", "nan")), map(float, child.get("position", "").split(","))
            if name == "pet":
                assert (x, y) == (float(row["x"]), float(row["y"])) and child.get("type") == "17"
                assert time > float(row["begin"])
            else:
                # series.csv has this extreme in the same step.
                assert float(row[name]) in [float(step[name]) for step in own if float(step["time"]) == time]
                assert child.get("type") == {"rear_end": "2", "side": "11", "frontal": "20"}[row["kind"]]


class Vehicle(NamedTuple):
    """A VEHICLE record."""

    number: int
    link: int
    lane: int
    front_x: float
    front_y: float
    rear_x: float
    rear_y: float
    length: float
    width: float
    speed: float
    acceleration: float
    front_z: float
    rear_z: float


def trajectories(path: Path) -> tuple[tuple[int, ...], list[tuple[float, list[Vehicle]]]]:
    """The bounds and the steps of a .trj file of version 3, read as its specification says."""
    data, at = path.read_bytes(), 0

    def take(layout: str) -> tuple[Any, ...]:
        nonlocal at
        values = struct.unpack_from("<" + layout, data, at)
        at += struct.calcsize("<" + layout)
        return values

    assert take("BcfB") == (0, b"L", 3.0, 1)
    kind, units, scale, *bounds = take("BBfiiii")
    assert (kind, units, scale) == (1, 1, 1.0)
    steps: list[tuple[float, list[Vehicle]]] = []
    while at < len(data):
        (record,) = take("B")
        if record == 2:
            steps.append((take("f")[0], []))
        else:
            assert record == 3
            steps[-1][1].append(Vehicle(*take("iiB10f")))
    return tuple(int(bound) for bound in bounds), steps


def test_trajectories_equal_those_that_sumo_records(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("town")
    trj, fcd = tmp_path / "town.trj", tmp_path / "fcd.xml"
    stops = tmp_path / "stops.xml"
    unfinished = ("--stop-output", stops, "--stop-output.write-unfinished")
    sumo = ("--fcd-output", fcd, "--fcd-output.acceleration", "--precision", "6", *unfinished)
    done = closecall("run", config, "--end", "20", "--trj-output", trj, "--", "--no-warnings", *sumo)
    assert done.returncode == 0, done.stderr
    (left, low, right, high), steps = trajectories(trj)
    types = {
        kind.get("id"): (float(kind.get("length", "nan")), float(kind.get("width", "nan")))
        for kind in ET.parse(config.with_suffix(".rou.xml")).getroot().iter("vType")
    }
    recorded = list(ET.parse(fcd).getroot())
    assert [time for time, _ in steps] == pytest.approx([float(step.get("time", "nan")) for step in recorded])
    numbers: dict[int, str] = {}
    seen, sizes = set(), set()
    is_parked = parked(stops)
    for (time, vehicles), step in zip(steps, recorded):
        known = {vehicle.get("id", ""): vehicle for vehicle in step.findall("vehicle")}
        known = {name: vehicle for name, vehicle in known.items() if not is_parked(name, time)}
        places = {(float(v.get("x", "nan")), float(v.get("y", "nan"))): name for name, v in known.items()}
        assert len(vehicles) == len(known)
        for vehicle in vehicles:
            if vehicle.number not in numbers:
                nearest = min(places, key=lambda place: math.dist(place, (vehicle.front_x, vehicle.front_y)))
                numbers[vehicle.number] = places[nearest]
            theirs = known[numbers[vehicle.number]]
            x, y, speed, angle = (float(theirs.get(name, "nan")) for name in ("x", "y", "speed", "angle"))
            assert (vehicle.front_x, vehicle.front_y, vehicle.speed) == pytest.approx((x, y, speed), abs=1e-3)
            if vehicle.number in seen:
                assert vehicle.acceleration == pytest.approx(float(theirs.get("acceleration", "nan")), abs=1e-3)
            seen.add(vehicle.number)
            length, width = types.get(theirs.get("type"), (math.nan, math.nan))
            if not math.isnan(length + width):
                assert (vehicle.length, vehicle.width) == pytest.approx((length, width), abs=1e-3)
                sizes.add((length, width))
            turned = math.radians(angle)
            rear = (x - math.sin(turned) * vehicle.length, y - math.cos(turned) * vehicle.length)
            assert (vehicle.rear_x, vehicle.rear_y) == pytest.approx(rear, abs=2e-3)
            assert left <= x <= right and low <= y <= high and vehicle.link >= 0
    assert len(sizes) >= 2, "vehicles of several sizes"
    assert len(set(numbers.values())) == len(numbers) > 150


def test_trajectories_do_not_depend_on_what_is_left_out(scenario: Copy, tmp_path: Path) -> None:
    config, files = scenario("left_turn"), [tmp_path / "some.trj", tmp_path / "all.trj"]
    for file, words in zip(files, ([], ["--no-shortcuts"])):
        done = closecall("run", config, "--end", "60", "--trj-output", file, "--out", tmp_path / "out", *words)
        assert done.returncode == 0, done.stderr
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.parametrize("option", ["--ssm-output", "--trj-output"])
def test_a_file_that_cannot_be_written_is_named(option: str, scenario: Copy) -> None:
    config = scenario("side")
    done = closecall("run", config, option, "/proc/closecall/file")
    assert done.returncode == 2 and "closecall: /proc/closecall: " in done.stderr
    assert not (config.parent / "closecall-out").exists()


def test_an_output_never_overwrites_an_input(scenario: Copy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    config = scenario("curves")
    routes = config.with_suffix(".rou.xml")
    before = routes.read_bytes()
    (tmp_path / "link.xml").symlink_to(routes)
    for option in ("--ssm-output", "--trj-output"):
        done = closecall("run", config, "--quiet", option, tmp_path / "link.xml", "--out", tmp_path / "out")
        assert (done.returncode, done.stderr) == (2, f"closecall: {option} would be written over {routes}\n")
    recording = tmp_path / "fcd.xml"
    assert closecall("run", config, "--end", "10", "--quiet", "--", "--fcd-output", recording).returncode == 0
    recorded = recording.read_bytes()
    words = ("replay", recording, "--quiet", "--net", config.with_suffix(".net.xml"), "--out", tmp_path / "out")
    (tmp_path / "options.toml").touch()
    refused: list[tuple[str | Path, ...]] = [
        ("--ssm-output", recording),
        ("--ssm-output", "options.toml", "--config", tmp_path / "options.toml"),
        ("--ssm-output", tmp_path / "out" / "conflicts.csv"),
        ("--ssm-output", tmp_path / "one", "--trj-output", "one"),
    ]
    for others in refused:
        done = closecall(*words, *others)
        assert (done.returncode, done.stderr) == (2, f"closecall: --ssm-output would be written over {others[-1]}\n")
    assert (routes.read_bytes(), recording.read_bytes()) == (before, recorded)
    assert not (tmp_path / "out").exists()
    assert closecall(*words, "--ssm-output", "/dev/null", "--trj-output", "/dev/null").returncode == 0
