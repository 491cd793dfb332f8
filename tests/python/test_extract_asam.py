"""`closecall extract --format openscenario|osi`, read with ASAM's schema and OSI's own bindings."""

from __future__ import annotations

import gzip
import json
import math
import shutil
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

import pytest
from conftest import NETS, closecall, closecall_apart
from lxml import etree

SCHEMA = etree.XMLSchema(file=distribution("scenariogeneration").locate_file("schemas/OpenSCENARIO_1_2.xsd"))
"""ASAM's own."""
LANE = 3.2
"""Width of the lanes in m."""
ROUNDED = 0.01
"""Places in a clip are rounded to this, in m."""
PARALLEL = 0.002
"""The largest angle between a road and a road user that drives along it, in rad."""


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of a run in which a left-turning car obstructs others; some come later or leave."""
    folder = tmp_path_factory.mktemp("asam")
    shutil.copytree(NETS / "left_turn", folder / "net", ignore=shutil.ignore_patterns("expected"))
    words = ["--quiet", "--end", "40", "--log-clips", "caution", "--", "--no-warnings"]
    done = closecall("run", folder / "net" / "left_turn.sumocfg", "--out", folder / "log", *words)
    assert done.returncode == 0, done.stderr
    return folder / "log"


def clip_of(log: Path, conflict: int) -> dict[str, Any]:
    """The clip of a conflict."""
    with gzip.open(log / "clips.jsonl.gz", "rt") as lines:
        return next(clip for clip in map(json.loads, lines) if clip["conflict"] == conflict)


def extracted(log: Path, form: str, out: Path) -> dict[str, Any]:
    """Extracts the worst conflict; returns its clip."""
    done = closecall("extract", log, "--worst", "1", "--format", form, "--out", out)
    assert done.returncode == 0, done.stderr
    return clip_of(log, int(done.stdout.split()[1]))


def ahead(x: float, y: float, heading: float, metres: float) -> tuple[float, float]:
    """The place this far ahead of another."""
    return x + metres * math.cos(heading), y + metres * math.sin(heading)


def places(clip: dict[str, Any], user: dict[str, Any]) -> dict[float, tuple[float, float, float]]:
    """Where the front of a road user was, and its heading, by the time after the clip's begin."""
    rows = zip(clip["times"], user["x"], user["y"], user["heading"])
    return {round(time - clip["times"][0], 6): (x, y, h) for time, x, y, h in rows if x is not None}


def test_an_openscenario_is_valid_and_drives_what_the_clip_holds(log: Path, tmp_path: Path) -> None:
    clip = extracted(log, "openscenario", tmp_path / "out")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["conflict.xosc", "net.xodr"]
    text = etree.parse(tmp_path / "out" / "conflict.xosc")
    SCHEMA.assertValid(text)
    come_later = 0
    for user in clip["users"]:
        [box] = text.xpath(f"//ScenarioObject[@name='{user['id']}']/Vehicle/BoundingBox")
        assert float(box.find("Dimensions").get("length")) == user["length"]
        to_front = float(box.find("Center").get("x")) + user["length"] / 2
        wanted = places(clip, user)
        vertices = text.xpath(f"//ManeuverGroup[@name='{user['id']}']//Vertex")
        for vertex in vertices:
            at = vertex.find("Position/WorldPosition")
            x, y, heading = (float(at.get(name)) for name in ("x", "y", "h"))
            clip_x, clip_y, clip_heading = wanted.pop(float(vertex.get("time")))
            assert math.dist(ahead(x, y, heading, to_front), (clip_x, clip_y)) < 1e-5
            assert math.cos(heading - clip_heading) > 1 - 1e-9
        # One that is there at a single time drives no line.
        assert len(wanted) <= 1
        come_later += len(text.xpath(f"//EntityAction[@entityRef='{user['id']}']/AddEntityAction"))
    assert come_later > 0


def test_road_users_stand_on_the_lanes_of_the_opendrive(log: Path, tmp_path: Path) -> None:
    clip = extracted(log, "openscenario", tmp_path / "out")
    roads = etree.parse(tmp_path / "out" / "net.xodr").xpath("//road[@junction='-1'][count(planView/geometry/line)=1]")
    assert len(roads) == 8
    found = 0
    for user in clip["users"]:
        for front_x, front_y, heading in places(clip, user).values():
            centre = ahead(front_x, front_y, heading, -user["length"] / 2)
            for road in roads:
                line = road.find("planView/geometry")
                x, y, along_road, length = (float(line.get(name)) for name in ("x", "y", "hdg", "length"))
                along, left = (
                    (centre[0] - x) * math.cos(turn) + (centre[1] - y) * math.sin(turn)
                    for turn in (along_road, along_road + math.pi / 2)
                )
                is_parallel = math.cos(heading - along_road) > math.cos(PARALLEL)
                if is_parallel and 0 < along < length and -2 * LANE < left < 2 * LANE:
                    assert min(abs(left + LANE / 2), abs(left + 1.5 * LANE)) <= ROUNDED
                    found += 1
    assert found > 200


def test_an_osi_trace_has_the_places_of_the_clip(log: Path, tmp_path: Path) -> None:
    betterosi = pytest.importorskip("betterosi")
    out = tmp_path / "worst_gt.osi"
    clip = extracted(log, "osi", out)
    messages = list(betterosi.read(str(out), return_ground_truth=True))
    assert [truth.timestamp.seconds + truth.timestamp.nanos / 1e9 for truth in messages] == clip["times"]
    kinds = betterosi.MovingObject.VehicleClassification.Type
    for step, truth in enumerate(messages):
        users = [(number, user) for number, user in enumerate(clip["users"], 1) if user["x"][step] is not None]
        assert [moving.id.value for moving in truth.moving_object] == [number for number, _ in users]
        for moving, (_, user) in zip(truth.moving_object, users):
            base, heading = moving.base, user["heading"][step]
            assert moving.source_reference[0].identifier == [user["id"]]
            assert moving.vehicle_classification.type == kinds.CAR
            assert (base.dimension.length, base.dimension.width) == (user["length"], user["width"])
            assert base.position.z == base.dimension.height / 2
            place = ahead(base.position.x, base.position.y, base.orientation.yaw, user["length"] / 2)
            assert math.dist(place, (user["x"][step], user["y"][step])) < 1e-9
            velocity = ahead(0, 0, heading, user["speed"][step])
            assert math.dist(velocity, (base.velocity.x, base.velocity.y)) < 1e-9


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of a recording without a net: a car, a bicycle, and a pedestrian of the car's name that is lost for 2 s.

    In its clip there is a crate besides.
    """
    folder = tmp_path_factory.mktemp("recording")
    rows = ["id,t,x,y,heading,speed,class"]
    for step in range(100):
        time = step / 10
        rows += [f"$a,{time},{time * 10 - 60},0,0,10,car", f"a<b,{time},0,{time * 10 - 62},90,10,bicycle"]
        rows += [] if 30 < step < 50 else [f"a,{time},{time * 2},10,0,2,pedestrian"]
    (folder / "tracks.csv").write_text("\n".join(rows))
    columns = "id=id,time=t,x=x,y=y,heading=heading[deg],speed=speed,class=class"
    words = ["--columns", columns, "--path", "straight", "--log-clips", "caution", "--quiet", "--out", "log"]
    done = closecall_apart("replay", "tracks.csv", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    clip = clip_of(folder / "log", 1)
    crate = [[10.0, 4.0], [12.0, 4.0], [12.0, 5.0]]
    lists = {name: [4.0] * len(clip["times"]) for name in ("x", "y", "heading", "speed")}
    clip["users"].append({"id": "crate", "category": "obstacle", "length": 0, "width": 0, "outlines": [crate], **lists})
    with gzip.open(folder / "log" / "clips.jsonl.gz", "wt") as lines:
        lines.write(json.dumps(clip, separators=(",", ":")) + "\n")
    return folder / "log"


def test_a_recording_needs_no_net(recording: Path, tmp_path: Path) -> None:
    done = closecall("extract", recording, "1", "--format", "openscenario", "--out", tmp_path / "out")
    assert done.returncode == 0
    assert done.stderr == "closecall: no net was found, so that the scenario has no roads; --net gives one\n"
    text = etree.parse(tmp_path / "out" / "conflict.xosc")
    SCHEMA.assertValid(text)
    # A name that begins with $ would be a parameter's, and none may occur twice.
    objects = {entity.get("name"): entity[0] for entity in text.iter("ScenarioObject")}
    assert sorted(objects) == ["a", "a<b", "a_2", "crate"]
    assert objects["a<b"].get("vehicleCategory") == "bicycle"
    box = objects["crate"].find("BoundingBox/Dimensions")
    assert (objects["crate"].tag, box.get("length"), box.get("width")) == ("MiscObject", "2", "1")
    at = text.find(".//Private[@entityRef='crate']//WorldPosition")
    assert (at.get("x"), at.get("y")) == ("11", "4.5")
    walker = next(name for name, entity in objects.items() if entity.tag == "Pedestrian")
    events = text.xpath(f"//ManeuverGroup[@name='{walker}']//Event/@name")
    assert events == ["drives_0", "leaves_0", "drives_1"]


def test_pedestrians_and_obstacles_have_osi_types_of_their_own(recording: Path, tmp_path: Path) -> None:
    betterosi = pytest.importorskip("betterosi")
    out = tmp_path / "worst_gt.osi"
    clip = extracted(recording, "osi", out)
    first = next(iter(betterosi.read(str(out), return_ground_truth=True)))
    kinds = betterosi.MovingObject.Type
    walks = [user["category"] == "person" for user in clip["users"][:-1]]
    assert [moving.type for moving in first.moving_object] == [
        kinds.PEDESTRIAN if it else kinds.VEHICLE for it in walks
    ]
    [crate] = first.stationary_object
    middle = crate.base.position
    corners = [(middle.x + corner.x, middle.y + corner.y) for corner in crate.base.base_polygon]
    assert corners == [tuple(corner) for corner in clip["users"][-1]["outlines"][0]]
    assert crate.id.value == len(clip["users"]) + 1
