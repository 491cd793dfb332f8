"""Where conflicts are, and `closecall export`, read with the libraries and programs that people use."""

from __future__ import annotations

import json
import re
import sqlite3
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Callable

import pytest
from conftest import Once, closecall, counted, is_one_message, python, rows

UTM = "+proj=utm +zone=33 +ellps=WGS84 +datum=WGS84 +units=m +no_defs"
OFFSET = (-385000.0, -5819000.0)

Copy = Callable[[str], Path]


def place_on_earth(net: Path) -> None:
    """Give a net a projection, as one from OpenStreetMap has."""
    text = net.read_text()
    text = re.sub('netOffset="[^"]*"', f'netOffset="{OFFSET[0]:.2f},{OFFSET[1]:.2f}"', text, count=1)
    net.write_text(text.replace('projParameter="!"', f'projParameter="{UTM}"', 1))


@pytest.fixture
def log(once: Once, scenario: Copy) -> Path:
    """The log of a run on a net with a projection, with SUMO's own fcd-output beside it."""

    def fill(folder: Path) -> None:
        config = scenario("reckless")
        place_on_earth(config.with_name("reckless.net.xml"))
        words = ("--fcd-output", folder / "fcd.xml", "--precision", "6", "--no-warnings")
        done = closecall("run", config, "--out", folder / "log", "--end", "60", "--quiet", "--", *words)
        assert done.returncode == 0, done.stderr

    return once("places", fill) / "log"


def exported(log: Path, layout: str, out: Path) -> Path:
    done = closecall("export", log, "--format", layout, "--out", out)
    assert done.returncode == 0 and str(out) in done.stdout, done.stderr
    return out


def test_lanes_and_positions_are_those_of_sumo(log: Path) -> None:
    seen = {}
    for step in ET.parse(log.parent / "fcd.xml").getroot():
        for vehicle in step.findall("vehicle"):
            place = vehicle.get("lane"), float(vehicle.get("pos", "nan"))
            seen[round(float(step.get("time", "nan")), 3), vehicle.get("id")] = place
    compared = 0
    for row in rows(log / "conflicts.csv"):
        for side in ("ego", "foe"):
            lane, position = seen.get((round(float(row["time"]), 3), row[side]), (None, 0.0))
            if lane is not None:
                assert row[f"{side}_lane"] == lane
                assert float(row[f"{side}_lane_position"]) == pytest.approx(position, abs=0.02)
                compared += 1
        assert row["edge"] == row["lane"].rpartition("_")[0]
        assert row["junction"] == (row["edge"][1:].rpartition("_")[0] if row["edge"].startswith(":") else "")
    assert compared > 50


def test_longitude_and_latitude_follow_from_the_projection_of_the_net(log: Path) -> None:
    pyproj = pytest.importorskip("pyproj")
    proj = pyproj.Proj(UTM)
    for row in rows(log / "conflicts.csv"):
        lon, lat = proj(float(row["x"]) - OFFSET[0], float(row["y"]) - OFFSET[1], inverse=True)
        assert float(row["lon"]) == pytest.approx(lon, abs=1e-6)
        assert float(row["lat"]) == pytest.approx(lat, abs=1e-6)


@pytest.mark.parametrize(("layout", "ending"), [("geojson", "geojson"), ("geoparquet", "parquet"), ("gpkg", "gpkg")])
def test_gdal_and_geopandas_open_each_map(layout: str, ending: str, log: Path, tmp_path: Path) -> None:
    geopandas, pyogrio = pytest.importorskip("geopandas"), pytest.importorskip("pyogrio")
    file = exported(log, layout, tmp_path / f"places.{ending}")
    expected = counted(log)
    if layout == "geoparquet":
        frame = geopandas.read_parquet(file)
    else:
        # What QGIS reads with.
        assert pyogrio.read_info(file)["features"] == len(expected)
        frame = geopandas.read_file(file)
    assert frame.crs.to_epsg() == 4326 or frame.crs.to_authority() == ("OGC", "CRS84")
    assert len(frame) == len(expected)
    for (_, row), known in zip(frame.iterrows(), expected):
        assert (row.geometry.x, row.geometry.y) == pytest.approx((float(known["lon"]), float(known["lat"])))
        assert (row["ego"], row["kind"], row["severity"]) == (known["ego"], known["kind"], known["severity"])
        assert row["margin"] == pytest.approx(float(known["margin"]))
        assert bool(row["collision"]) == (known["collision"] == "true")


def test_duckdb_and_polars_read_geoparquet(log: Path, tmp_path: Path) -> None:
    duckdb, polars = pytest.importorskip("duckdb"), pytest.importorskip("polars")
    file = exported(log, "geoparquet", tmp_path / "places.parquet")
    count = len(counted(log))
    assert duckdb.sql(f"SELECT count(*), count(geometry) FROM '{file}'").fetchall() == [(count, count)]
    assert polars.read_parquet(file)["lon"].is_not_null().all()


def test_a_net_without_projection_keeps_its_metres(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("reckless")
    assert closecall("run", config, "--out", tmp_path / "log", "--end", "30", "--quiet").returncode == 0
    first = counted(tmp_path / "log")[0]
    assert first["lon"] == first["lat"] == ""
    file = exported(tmp_path / "log", "gpkg", tmp_path / "metres.gpkg")
    with sqlite3.connect(file) as database:
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        assert database.execute("SELECT srs_id, min_x <= max_x FROM gpkg_contents").fetchone() == (-1, 1)
        assert database.execute("SELECT x FROM conflicts ORDER BY id").fetchone() == (float(first["x"]),)
    refused = closecall("export", tmp_path / "log", "--format", "geojson")
    assert refused.returncode == 2 and is_one_message(refused.stderr) and "its net has no projection" in refused.stderr
    assert not (tmp_path / "log" / "conflicts.geojson").exists()
    geopandas = pytest.importorskip("geopandas")
    frame = geopandas.read_parquet(exported(tmp_path / "log", "geoparquet", tmp_path / "metres.parquet"))
    assert frame.crs is None and frame.geometry.x[0] == float(first["x"])


def test_equal_logs_give_equal_bytes(log: Path, tmp_path: Path) -> None:
    for layout in ("geojson", "geoparquet", "gpkg", "poi", "ssm"):
        first, second = (exported(log, layout, tmp_path / name).read_bytes() for name in ("first", "second"))
        assert first == second, layout


def test_the_filter_of_stats_chooses_what_is_exported(log: Path, tmp_path: Path) -> None:
    words = ("--kind", "side", "--to", "40")
    expected = [row["id"] for row in counted(log) if row["kind"] == "side" and float(row["time"]) <= 40]
    out = tmp_path / "side.geojson"
    done = closecall("export", log, "--format", "geojson", "--out", out, *words)
    assert done.stdout.startswith(f"{len(expected)} conflict") and f" of {len(counted(log))} in" in done.stdout
    assert [str(feature["id"]) for feature in json.loads(out.read_text())["features"]] == expected != []
    # A log whose first conflict does not pass still has degrees, and a log of which none passes gives an empty file.
    assert closecall("export", log, "--format", "geojson", "--out", out, "--type", "tram").returncode == 0
    assert json.loads(out.read_text())["features"] == []
    refused = closecall("export", log, "--format", "poi", "--from", "9", "--to", "8")
    assert refused.returncode == 2 and "--from 9 is after --to 8" in refused.stderr and is_one_message(refused.stderr)


LOAD_POIS = """
import sys
import libsumo
libsumo.start(["sumo", "-n", sys.argv[1], "-a", sys.argv[2]])
poi = libsumo.poi.getIDList()
first = sys.argv[3]
print(len(poi), libsumo.poi.getType(first), libsumo.poi.getParameter(first, "ego"), libsumo.poi.getColor(first)[:3])
"""


def test_sumo_loads_the_points_of_interest(log: Path, scenario: Copy, tmp_path: Path) -> None:
    pytest.importorskip("libsumo")
    file = exported(log, "poi", tmp_path / "places.poi.xml")
    net = scenario("reckless").with_name("reckless.net.xml")
    expected = counted(log)
    done = python(LOAD_POIS, net, file, f"conflict_{expected[0]['id']}")
    colour = {"critical": (255, 0, 0), "serious": (255, 128, 0), "caution": (255, 255, 0)}[expected[0]["severity"]]
    assert done.stdout.splitlines()[-1] == f"{len(expected)} {expected[0]['kind']} {expected[0]['ego']} {colour}", (
        done.stderr
    )


def test_the_ssm_file_of_a_log_has_its_values(log: Path, tmp_path: Path) -> None:
    root = ET.parse(exported(log, "ssm", tmp_path / "ssm.xml")).getroot()
    for conflict, row in zip(root, counted(log), strict=True):
        found = [child.get("value") for child in conflict]
        assert [value == "NA" for value in found] == [row[name] == "" for name in ("ttc", "drac", "pet")]
        assert [float(value or "nan") for value in found if value != "NA"] == [
            float(row[name]) for name in ("ttc", "drac", "pet") if row[name]
        ]


def test_what_cannot_be_exported_is_told(log: Path, tmp_path: Path) -> None:
    for said, words in [
        ("no log in it", (tmp_path, "--format", "poi")),
        ("would be written over", (log, "--format", "poi", "--out", log / "conflicts.csv")),
        ("logs are in it; name one of them", (tmp_path / "two", "--format", "poi")),
    ]:
        if said.startswith("logs"):
            for name in "ab":
                (tmp_path / "two" / name).mkdir(parents=True)
                (tmp_path / "two" / name / "conflicts.csv").write_bytes((log / "conflicts.csv").read_bytes())
        refused = closecall("export", *words)
        assert refused.returncode == 2 and said in refused.stderr and is_one_message(refused.stderr), refused.stderr
    broken = tmp_path / "broken"
    broken.mkdir()
    lines = (log / "conflicts.csv").read_text().splitlines(keepends=True)
    (broken / "conflicts.csv").write_text("".join([*lines[:-1], lines[-1].replace(",", ";", 3)]))
    for layout in ("geojson", "geoparquet", "gpkg", "poi", "ssm"):
        refused = closecall("export", broken, "--format", layout, "--out", broken / "out")
        assert refused.returncode == 2 and f"line {len(lines)}" in refused.stderr, refused.stderr
        assert sorted(path.name for path in broken.iterdir()) == ["conflicts.csv"], layout


def test_every_feature_of_geojson_is_a_line(log: Path, tmp_path: Path) -> None:
    lines = exported(log, "geojson", tmp_path / "places.geojson").read_text().splitlines()
    features = [json.loads(line.rstrip(",")) for line in lines[1:-1]]
    assert [feature["id"] for feature in features] == [int(row["id"]) for row in counted(log)]
    assert json.loads("\n".join(lines))["type"] == "FeatureCollection"


@pytest.mark.parametrize("name", ["a\x01", "a\x0c\x1f", "a\uffff", 'a<b>&"c]]>'])
def test_any_id_makes_files_that_a_parser_reads(name: str, tmp_path: Path) -> None:
    recording = tmp_path / "t.csv"
    quoted = '"' + name.replace('"', '""') + '"'
    users = [(who, t, x + v * t, v) for t in range(4) for who, x, v in ((quoted, 0, 20), ("b", 40, 5))]
    lines = ["who,t,x,y,v", *(f"{who},{t},{x},0,{v}" for who, t, x, v in users)]
    recording.write_text("\n".join(lines) + "\n", encoding="utf-8")
    log, ssm = tmp_path / "log", tmp_path / "s.xml"
    columns = ("--columns", "id=who,time=t,x=x,y=y,speed=v", "--path", "straight", "--log-clips", "caution")
    done = closecall("replay", recording, *columns, "--out", log, "--ssm-output", ssm)
    assert done.returncode == 0, done.stderr
    number = rows(log / "conflicts.csv")[0]["id"]
    words = (
        ("export", log, "--format", "poi", "--out", tmp_path / "p.xml"),
        ("export", log, "--format", "ssm", "--out", tmp_path / "e.xml"),
        ("clip", log, number, "-o", tmp_path / "c.svg"),
        ("extract", log, number, "--format", "openscenario", "-o", tmp_path / "x"),
        ("plot", log, "--format", "svg", "-o", tmp_path / "plots"),
    )
    for command in words:
        done = closecall(*command)
        assert done.returncode == 0, done.stderr
    written = [path for ending in ("xml", "svg", "xosc") for path in tmp_path.rglob(f"*.{ending}")]
    assert len(written) > 6
    for path in written:
        ET.parse(path)
