"""A replay finds the conflicts of the live run and names what is wrong with a recording."""

from __future__ import annotations

import gzip
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Callable

import pytest
from conftest import NETS, Once, begin, closecall, rows, wait_for_rows
from recordings import record, replay, same

Copy = Callable[[str], Path]

STANDING = '<vehicle id="a" x="%s" y="1" angle="0" speed="0"/>'

RECORDINGS = [
    ("reckless", "900", 30, "fcd.xml", ()),
    ("reckless", "900", 30, "fcd.csv", ()),
    ("reckless", "900", 30, "fcd.parquet", ()),
    ("crowd", "1000", 10, "fcd.xml", ("--sublane",)),
    ("crowd", "1000", 10, "fcd.csv", ("--sublane",)),
]
"""Scenario, end, number of conflicts exceeded, file, and options. SUMO's own gzip has a test below. The crowd has
persons too, to which SUMO's CSV gives the columns of vehicles. All have left at the end, so that their routes are
known."""
HALF = ("--scale", "0.5")
"""Half the traffic."""


@pytest.mark.parametrize(("name", "end", "conflicts", "recording", "words"), RECORDINGS)
def test_a_replay_finds_what_the_live_run_finds(
    name: str, end: str, conflicts: int, recording: str, words: tuple[str, ...], scenario: Copy, tmp_path: Path
) -> None:
    config = scenario(name)
    assert replay(config, record(config, recording, "--end", end, sumo=HALF), tmp_path, *words) == (0, "")
    live = rows(config.parent / "live" / "conflicts.csv")
    assert len(live) > conflicts
    same(live, rows(tmp_path / "conflicts.csv"))
    for log in (config.parent / "live", tmp_path):
        assert json.loads((log / "run.json").read_text())["sublane"] is ("--sublane" in words)


RIDE = """<routes>
    <person id="rider" depart="0" departPos="80"><walk edges="west_in" arrivalPos="90"/>
        <ride to="east_out" lines="car"/><walk edges="east_out" arrivalPos="80"/></person>
    <vehicle id="car" depart="{depart}" departPos="20"><route edges="west_in east_out"/>
        <stop lane="west_in_1" endPos="92" triggered="person" parking="false"/>
        <stop lane="east_out_1" endPos="60" duration="5"/></vehicle>
</routes>"""


@pytest.mark.parametrize("depart", ["0", "5"])
@pytest.mark.parametrize("recording", ["fcd.xml", "fcd.csv"])
def test_a_passenger_is_not_a_road_user(depart: str, recording: str, scenario: Copy, tmp_path: Path) -> None:
    config = scenario("pedestrian")
    config.with_suffix(".rou.xml").write_text(RIDE.format(depart=depart))
    assert replay(config, record(config, recording, "--end", "300"), tmp_path) == (0, "")
    live, again = (json.loads((log / "run.json").read_text())["summary"] for log in (config.parent / "live", tmp_path))
    assert again["exposure"] == pytest.approx(live["exposure"], rel=1e-5)
    assert (live["exposure"]["vehicles"], live["exposure"]["persons"]) == (1, 1)
    same(rows(config.parent / "live" / "conflicts.csv"), rows(tmp_path / "conflicts.csv"))
    assert again["collisions"] == 0


def test_a_truncated_recording_is_checked_up_to_its_end(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    recording = record(config, "fcd.xml")
    text = recording.read_text()
    recording.write_text(text[: int(len(text) * 0.8)])
    status, message = replay(config, recording, tmp_path)
    assert status == 3
    assert message.count("\n") == 1
    assert "fcd.xml: cut short after time" in message
    assert [row["kind"] for row in rows(tmp_path / "conflicts.csv")] == ["rear_end"]
    assert json.loads((tmp_path / "run.json").read_text())["complete"] is False


def test_truncated_gzip_and_csv_recordings_are_detected(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    plain = record(config, "fcd.xml").read_bytes()
    packed = tmp_path / "fcd.xml.gz"
    packed.write_bytes(gzip.compress(plain)[:-2000])
    status, message = replay(config, packed, tmp_path / "packed")
    assert (status, message.count("\n")) == (3, 1), message
    table = record(config, "fcd.csv")
    table.write_text(table.read_text().rstrip("\n")[:-3])
    status, message = replay(config, table, tmp_path / "table")
    assert (status, message.count("\n")) == (3, 1), message


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "the file is empty"),
        ("<routes/>", "it is a SUMO route file, not a recording"),
        ("a;b\n1;2\n", "timestep_time"),
        ('<fcd-export><timestep time="0"><vehicle id="a" x="1"/></timestep></fcd-export>', '"a" has no attribute y'),
        ("timestep_time;vehicle_id;vehicle_x\n", "vehicle_y"),
        (
            f'<fcd-export><timestep time="0">{STANDING % "1"}{STANDING % "9"}</timestep></fcd-export>',
            '"a" is there twice',
        ),
        (f'<fcd-export><timestep time="0">{STANDING % "inf"}</timestep></fcd-export>', 'x is "inf", not a number'),
    ],
)
def test_a_file_that_is_not_a_recording_is_refused(text: str, expected: str, scenario: Copy, tmp_path: Path) -> None:
    recording = tmp_path / "fcd"
    recording.write_text(text)
    status, message = replay(scenario("rear_end"), recording, tmp_path / "out")
    assert status == 2
    assert message.count("\n") == 1
    assert expected in message
    assert not (tmp_path / "out").exists()


def test_a_recording_of_another_place_is_refused(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("reckless")
    recording = record(config, "fcd.xml", "--end", "60")
    moved = tmp_path / "moved.xml"
    moved.write_text(re.sub(r' x="([^"]+)"', lambda x: f' x="{float(x[1]) + 9e3}"', recording.read_text()))
    code, message = replay(config, moved, tmp_path / "log")
    assert code == 2
    assert "moved.xml" in message and "on lane" in message and "recorded on another net?" in message
    assert replay(config, recording, tmp_path / "log")[0] == 0


def test_degrees_are_converted_by_the_projection_of_the_net(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("reckless")
    net = config.with_suffix(".net.xml")
    projection = 'netOffset="-385000.00,-5819000.00" projParameter="+proj=utm +zone=33 +ellps=WGS84 +units=m +no_defs"'
    net.write_text(re.sub('netOffset="[^"]*"', "", net.read_text()).replace('projParameter="!"', projection))
    degrees = ("--fcd-output.geo", "--precision.geo", "13", *HALF)
    assert replay(config, record(config, "fcd.xml", "--end", "900", sumo=degrees), tmp_path) == (0, "")
    live = rows(config.parent / "live" / "conflicts.csv")
    assert len(live) > 30
    same(live, rows(tmp_path / "conflicts.csv"), within=2e-5)


@pytest.mark.parametrize("recording", ["fcd.xml.gz", "fcd.csv", "fcd.parquet"])
def test_clock_times_are_the_seconds_of_the_run(recording: str, scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    assert replay(config, record(config, recording, sumo=("--human-readable-time",)), tmp_path) == (0, "")
    live = rows(config.parent / "live" / "conflicts.csv")
    assert len(live) == 1
    same(live, rows(tmp_path / "conflicts.csv"))


@pytest.mark.parametrize("header", ["plain", "auto", "tag"])
def test_tables_may_have_any_of_the_column_headers(header: str, scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    sumo = ("--output.column-header", header, "--output.column-separator", ",", "--output.compression", "gzip")
    for recording in (record(config, "fcd.csv", sumo=sumo), record(config, "fcd.parquet", sumo=sumo)):
        assert replay(config, recording, tmp_path) == (0, "")
        same(rows(config.parent / "live" / "conflicts.csv"), rows(tmp_path / "conflicts.csv"))
    packed = tmp_path / "fcd.parquet.gz"
    packed.write_bytes(gzip.compress(recording.read_bytes()))
    assert replay(config, packed, tmp_path) == (0, "")
    same(rows(config.parent / "live" / "conflicts.csv"), rows(tmp_path / "conflicts.csv"))


def test_parquet_of_an_unread_compression_is_refused(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    recording = record(config, "fcd.parquet", sumo=("--output.compression", "zstd"))
    status, message = replay(config, recording, tmp_path / "out")
    assert (status, message.count("\n")) == (2, 1)
    assert "compressed by zstd" in message and "--output.compression" in message


def on_lanes(lanes: list[str]) -> str:
    """A recording in which a vehicle is on these lanes of sumo_nets/rear_end, second by second."""
    row = '<timestep time="{}"><vehicle id="a" x="{}" y="-1.6" angle="90" speed="1" pos="{}" lane="{}"/></timestep>'
    steps = (row.format(time, 9 + time, 9 + time, lane) for time, lane in enumerate(lanes))
    return f"<fcd-export>{''.join(steps)}</fcd-export>"


def test_a_recording_without_a_lane_of_the_net_is_refused(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    recording = tmp_path / "fcd.xml"
    recording.write_text(on_lanes(["other_0", "other_1"]))
    for words in ((), ("--path", "arc")):
        status, message = replay(config, recording, tmp_path / "out", *words)
        assert (status, message.count("\n")) == (2, 1)
        assert 'the net has none of the recording\'s lanes ("other_0" and so on)' in message
        assert not (tmp_path / "out").exists()


def test_the_share_of_unknown_lanes_is_told(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    recording = tmp_path / "fcd.xml"
    lane = ET.parse(config.with_suffix(".net.xml")).findall("edge[@from]/lane")[0]
    recording.write_text(on_lanes([lane.get("id", ""), "other_0", "other_0"]))
    done = closecall("replay", recording, "--net", config.with_suffix(".net.xml"), "--out", tmp_path / "out")
    assert "lanes: 66.7 % of the vehicle-steps are on no lane of the net" in done.stdout, done


def test_a_missing_recording_is_named(scenario: Copy, tmp_path: Path) -> None:
    status, message = replay(scenario("rear_end"), tmp_path / "none.xml", tmp_path / "out")
    assert (status, message.count("\n")) == (2, 1)
    assert "none.xml: No such file" in message


def test_a_pipe_is_refused_at_once(scenario: Copy, tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    status, message = replay(scenario("rear_end"), pipe, tmp_path / "out")
    assert (status, message.count("\n")) == (2, 1)
    assert "pipe" in message and "has to be a file" in message


def test_types_that_no_file_defines_are_reported(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    recording = tmp_path / "fcd.xml"
    types = ["", ' type="DEFAULT_VEHTYPE"', ' type="car"', *(f' type="{letter}"' for letter in "fbcade")]
    states = [
        f'<vehicle id="{number}" x="{number}9" y="1" angle="0" speed="0"{its}/>' for number, its in enumerate(types)
    ]
    recording.write_text(f'<fcd-export><timestep time="0">{"".join(states)}</timestep></fcd-export>')
    defined = tmp_path / "types.xml"
    defined.write_text('<routes><vType id="car"/></routes>')
    net = config.with_suffix(".net.xml")
    done = closecall("replay", recording, "--net", net, "--route-files", defined, "--out", tmp_path / "out")
    reported = [line for line in done.stdout.splitlines() if line.startswith("types ")]
    assert [line.split(":")[0] for line in reported] == ['types (none), "a", "b", "c", "d" and 2 more'], done.stderr


def repeat(recording: Path, times: int, seconds: float) -> None:
    """Repeat the steps of a recording of `seconds` s, each time that much later."""
    head, step, rest = recording.read_text().partition("<timestep")
    body, end, tail = (step + rest).rpartition("</timestep>")

    def later(by: float) -> str:
        return re.sub(r'<timestep time="([^"]+)"', lambda time: f'<timestep time="{float(time[1]) + by}"', body + end)

    recording.write_text(head + "".join(later(number * seconds) for number in range(times)) + tail)


@pytest.fixture(scope="module")
def long(once: Once) -> Path:
    """A recording of the town that takes a while, with the net beside it."""

    def fill(folder: Path) -> None:
        for kind in ("sumocfg", "net.xml", "rou.xml", "add.xml"):
            shutil.copy(NETS / "town" / f"town.{kind}", folder)
        repeat(record(folder / "town.sumocfg", "fcd.xml", "--end", "25"), 8, 25)

    return once("long", fill) / "fcd.xml"


def test_ctrl_c_ends_a_replay_cleanly(long: Path, tmp_path: Path) -> None:
    words = ("--quiet", "--net", long.with_name("town.net.xml"), "--out", tmp_path / "out")
    process = begin("replay", long, *words)
    wait_for_rows(tmp_path / "out" / "conflicts.csv", process, 2)
    process.send_signal(signal.SIGINT)
    _, message = process.communicate(timeout=30)
    assert process.returncode == 130
    assert re.fullmatch(r"closecall: interrupted at [0-9.]+ s; the log has all conflicts so far\n", message), message
    found = json.loads((tmp_path / "out" / "run.json").read_text())
    assert found["complete"] is False and found["summary"]["steps"] < 400
    assert sum(count["count"] for count in found["summary"]["conflicts"]) == len(
        rows(tmp_path / "out" / "conflicts.csv")
    )


def test_ctrl_c_ends_several_replays_cleanly(long: Path, tmp_path: Path) -> None:
    copy = Path(shutil.copy(long, tmp_path / "copy.xml"))
    words = ("--quiet", "--net", long.with_name("town.net.xml"), "--out", tmp_path / "out", "--workers", "2")
    process = begin("replay", "--each", long, copy, *words)
    for name in ("fcd", "copy"):
        wait_for_rows(tmp_path / "out" / name / "conflicts.csv", process, 2)
    process.send_signal(signal.SIGINT)
    _, message = process.communicate(timeout=30)
    assert process.returncode == 130
    assert message == "closecall: interrupted after 0 of 2 recordings; each log has all conflicts so far\n"
    for name in ("fcd", "copy"):
        assert json.loads((tmp_path / "out" / name / "run.json").read_text())["complete"] is False


PARKS = """<routes><vType id="d" sigma="0" speedDev="0"/>
<vehicle id="beside" type="d" depart="0" departSpeed="10"><route edges="east"/>
    <stop lane="east_0" endPos="60" duration="20" parking="true"/></vehicle>
<vehicle id="area" type="d" depart="4" departSpeed="10"><route edges="east"/>
    <stop parkingArea="off" duration="20"/></vehicle>
<vehicle id="road" type="d" depart="8" departSpeed="10"><route edges="east"/>
    <stop parkingArea="on" duration="20"/></vehicle>
<vehicle id="by" type="d" depart="24" departSpeed="13"><route edges="east"/></vehicle></routes>"""
AREAS = """<additional><parkingArea id="off" lane="east_0" startPos="80" endPos="110" roadsideCapacity="2"/>
<parkingArea id="on" lane="east_0" startPos="130" endPos="150" roadsideCapacity="2" onRoad="true"/></additional>"""


def test_vehicles_parked_off_the_road_are_left_out_as_live(tmp_path: Path) -> None:
    net, routes, areas = (tmp_path / name for name in ("n.net.xml", "r.rou.xml", "a.add.xml"))
    (tmp_path / "n.nod.xml").write_text('<nodes><node id="w" x="0" y="0"/><node id="e" x="200" y="0"/></nodes>')
    (tmp_path / "n.edg.xml").write_text('<edges><edge id="east" from="w" to="e" numLanes="1"/></edges>')
    made = (
        Path(sys.executable).with_name("netconvert"),
        "-n",
        tmp_path / "n.nod.xml",
        "-e",
        tmp_path / "n.edg.xml",
        "-o",
        net,
    )
    subprocess.run(made, check=True, capture_output=True)
    routes.write_text(PARKS)
    areas.write_text(AREAS)
    config, fcd, stops = (tmp_path / name for name in ("c.sumocfg", "f.xml", "s.xml"))
    inputs = f'<net-file value="{net}"/><route-files value="{routes}"/><additional-files value="{areas}"/>'
    config.write_text(f"<configuration><input>{inputs}</input></configuration>")
    log = ("--log", "ttc < 9 or gap < 20", "--align", "never")
    words = ("--end", "45", "--step-length", "0.5", "--", "--fcd-output", fcd, "--stop-output", stops)
    done = closecall("run", config, "--out", tmp_path / "live", *log, *words)
    assert done.returncode == 0, done.stderr

    def pairs(folder: str) -> set[tuple[str, str]]:
        return {(row["ego"], row["foe"]) for row in rows(tmp_path / folder / "conflicts.csv")}

    def replay(folder: str, *words: str | Path) -> set[tuple[str, str]]:
        done = closecall("replay", fcd, "--out", tmp_path / folder, "--route-files", routes, *log, *words)
        assert done.returncode == 0, done.stderr
        return pairs(folder)

    assert ("by", "road") in pairs("live")
    assert replay("net", "--net", net) == pairs("live")
    straight = ("--path", "straight")
    with_stops = replay("stops", *straight, "--stops", stops)
    assert not {pair for pair in with_stops if "area" in pair and "by" in pair}
