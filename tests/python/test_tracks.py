"""Recordings of other tools and of drones: one scene in each layout gives the conflicts of SUMO's fcd-output."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Callable

import closecall as api
import layouts
import pytest
from conftest import NETS, Row, closecall, is_one_message, rows

Write = Callable[[Path, list[layouts.Sample]], Path]


def replayed(recording: Path, out: Path, *words: str | Path) -> list[Row]:
    done = closecall("replay", recording, "--path", "arc", "--align", "never", "--out", out, "--quiet", *words)
    assert done.returncode == 0, done.stderr
    return rows(out / "conflicts.csv")


def same(found: list[Row], expected: list[Row], within: float) -> None:
    """Whether the conflicts are the same, up to rounding."""

    def key(row: Row) -> tuple[str, ...]:
        return row["ego"], row["foe"], row["kind"], row["severity"], row["collision"], row["ego_type"]

    assert sorted(map(key, found)) == sorted(map(key, expected)) and expected
    for one, other in zip(sorted(found, key=key), sorted(expected, key=key)):
        shift = 1000.0 if float(one["begin"]) >= 900 else 0.0
        assert float(one["begin"]) - shift == pytest.approx(float(other["begin"]))
        for name in ("margin", "gap", "clearance"):
            assert float(one[name]) == pytest.approx(float(other[name]), abs=within), name


LAYOUTS: dict[str, tuple[Write, str, set[str]]] = {
    "inD": (layouts.levelx, "inD", {"car", "truck", "pedestrian"}),
    "highD": (layouts.highd, "highD", {"car", "truck"}),
    "NGSIM": (layouts.ngsim, "ngsim", {"car", "truck"}),
    "INTERACTION": (layouts.interaction, "interaction", {"car", "truck", "pedestrian"}),
    "SinD": (partial(layouts.interaction, heading="heading_rad"), "sind", {"car", "truck", "pedestrian"}),
    "OMEGA-Prime": (layouts.omega_prime, "omega-prime", {"car", "pedestrian"}),
    "fzp": (layouts.fzp, "fzp", {"car", "truck", "pedestrian"}),
    "trj 1.04": (partial(layouts.trj, version=1.04), "trj", {"car", "truck"}),
    "trj 3.0": (partial(layouts.trj, version=3.0), "trj", {"car", "truck"}),
    "trj in feet, big-endian": (
        partial(layouts.trj, version=1.04, order=">", is_english=True),
        "trj",
        {"car", "truck"},
    ),
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_each_layout_gives_the_conflicts_of_the_fcd_output(name: str, tmp_path: Path) -> None:
    write, layout, kinds = LAYOUTS[name]
    scene = [row for row in layouts.scene(only_along_x=name == "highD") if row.kind in kinds]
    recording, types = layouts.fcd(tmp_path, scene)
    expected = replayed(recording, tmp_path / "expected", "--route-files", types)
    file = write(tmp_path, scene)
    within = {"trj": 1e-3}.get(layout, 1e-4)
    same(replayed(file, tmp_path / "told", "--format", layout), expected, within)
    same(replayed(file, tmp_path / "known"), expected, within)
    told = closecall("inspect", file)
    assert told.returncode == 0 and "closecall replay" in told.stdout, told.stderr
    if "columns" in told.stdout:
        assert f"--format {layout}" in told.stdout


def test_citysim_has_no_widths_so_that_they_are_those_of_a_car(tmp_path: Path) -> None:
    file = layouts.citysim(tmp_path, layouts.scene())
    found = replayed(file, tmp_path / "out", "--frame-rate", str(layouts.RATE))
    assert {row["kind"] for row in found} >= {"rear_end"} and {row["ego_width"] for row in found} == {"1.8"}


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_columns_tell_what_a_table_of_no_layout_holds(kind: str, tmp_path: Path) -> None:
    scene = layouts.scene()
    recording, types = layouts.fcd(tmp_path, scene)
    expected = replayed(recording, tmp_path / "expected", "--route-files", types)
    cells = [
        (
            row.id,
            row.frame / layouts.RATE,
            *row.at(row.length / 2),
            90 - row.heading * 57.29577951308232,
            row.speed * 3.6,
            row.length,
            row.width,
            row.kind,
        )
        for row in reversed(scene)
    ]
    names = "name,when,east,north,compass,kmh,l,w,what"
    file = tmp_path / "own.csv"
    layouts.write(file, names, cells)
    if kind == "parquet":
        polars = pytest.importorskip("polars")
        file = tmp_path / "own.parquet"
        polars.read_csv(tmp_path / "own.csv").write_parquet(file, compression="snappy")
    columns = "id=name,time=when,x=east,y=north,heading=compass[north],speed=kmh[km/h],length=l,width=w,class=what"
    same(replayed(file, tmp_path / "out", "--columns", columns, "--origin", "front"), expected, 1e-4)


def test_headings_and_speeds_follow_from_the_movement(tmp_path: Path) -> None:
    scene = [row for row in layouts.scene() if row.id in (1, 2)]
    recording, types = layouts.fcd(tmp_path, scene)
    expected = replayed(recording, tmp_path / "expected", "--route-files", types)
    cells = [(row.id, row.frame, row.x, row.y, row.length, row.width) for row in scene]
    layouts.write(tmp_path / "bare.csv", "id,frame,x,y,length,width", cells)
    columns = "id=id,frame=frame,x=x,y=y,length=length,width=width"
    words = ("--columns", columns, "--frame-rate", str(layouts.RATE))
    found = replayed(tmp_path / "bare.csv", tmp_path / "out", *words)
    assert [(row["ego"], row["foe"], row["kind"]) for row in found] == [
        (row["ego"], row["foe"], row["kind"]) for row in expected
    ]
    done = closecall("replay", tmp_path / "bare.csv", "--path", "arc", "--out", tmp_path / "again", *words)
    assert f"headings: {len(scene)} rows have none" in done.stderr and f"speeds: {len(scene)} rows" in done.stderr


def test_a_trj_that_closecall_wrote_comes_back_with_the_same_conflicts(tmp_path: Path) -> None:
    pytest.importorskip("libsumo")
    folder = NETS / "left_turn"
    net, fcd, trj = folder / "left_turn.net.xml", tmp_path / "fcd.xml", tmp_path / "all.trj"
    run = closecall(
        "run", folder / "left_turn.sumocfg", "--out", tmp_path / "run", "--end", "120", "--quiet", "--trj-output", trj,
        "--", "--fcd-output", fcd, "--precision", "6", "--no-warnings",
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    done = closecall("replay", trj, "--net", net, "--out", tmp_path / "back", "--quiet")
    assert done.returncode == 0, done.stderr
    again = ("--net", net, "--route-files", folder / "left_turn.rou.xml", "--out", tmp_path / "fcd", "--quiet")
    assert closecall("replay", fcd, *again).returncode == 0
    there, back = rows(tmp_path / "fcd" / "conflicts.csv"), rows(tmp_path / "back" / "conflicts.csv")
    assert len(there) == len(back) > 10

    for one, other in zip(there, back):
        told = ("kind", "begin", "end", "severity", "lane", "edge", "junction", "manoeuvre", "ego_lane", "foe_lane")
        assert [one[name] for name in told] == [other[name] for name in told]
        assert float(one["margin"]) == pytest.approx(float(other["margin"]), abs=1e-3)


@pytest.mark.parametrize("library", ["polars", "pandas", "pyarrow"])
def test_a_data_frame_is_replayed_as_its_file_is(library: str, tmp_path: Path) -> None:
    file = layouts.interaction(tmp_path, layouts.scene())
    expected = api.replay(file, path="arc").to_dict()
    module = pytest.importorskip(library)
    pandas = pytest.importorskip("pandas")
    frame = module.read_csv(file) if library != "pyarrow" else module.Table.from_pandas(pandas.read_csv(file))
    columns = {"id": "track_id", "time": "timestamp_ms[ms]", "class": "agent_type", "x": "x", "y": "y"}
    columns |= {"heading": "psi_rad", "vx": "vx", "vy": "vy", "length": "length", "width": "width"}
    found = api.replay(frame, columns, path="arc").to_dict()
    assert found["ego"] == expected["ego"] != [] and list(found["margin"]) == list(expected["margin"])
    with pytest.raises(ValueError, match="it has no column nowhere"):
        api.replay(frame, {**columns, "x": "nowhere"})
    with pytest.raises(ValueError, match='row 1: column agent_type: "car" is not a number'):
        api.replay(frame, {**columns, "x": "agent_type"})
    with pytest.raises(TypeError, match="int is neither a path nor a data frame"):
        api.replay(3)


def test_bad_input_names_row_column_and_what_was_expected(tmp_path: Path) -> None:
    ind = layouts.levelx(tmp_path, layouts.scene())
    broken = tmp_path / "broken_tracks.csv"

    def refused(said: str, file: Path, *words: str) -> None:
        done = closecall("replay", file, "--path", "arc", "--out", tmp_path / "none", *words)
        assert done.returncode == 2 and said in done.stderr and is_one_message(done.stderr), done.stderr
        assert not (tmp_path / "none").exists()

    lines = ind.read_text().splitlines()
    broken.write_text("\n".join([*lines[:5], lines[5].replace(lines[5].split(",")[3], "west"), *lines[6:]]))
    refused(
        'broken_tracks.csv, line 6: column xCenter: "west" is not a number',
        broken,
        "--format",
        "inD",
        "--frame-rate",
        "10",
    )
    broken.write_text("\n".join(lines))
    refused("line 1: its time is a number of frames: --frame-rate HZ is needed", broken, "--format", "inD")
    refused("it has no column Global_Time; its columns are those of inD", ind, "--format", "ngsim")
    refused("--columns: time or frame is missing", ind, "--columns", "id=trackId,x=xCenter,y=yCenter")
    refused("it has no column east", ind, "--columns", "id=trackId,frame=frame,x=east,y=yCenter", "--frame-rate", "10")
    broken.write_text("\n".join([*lines, lines[-1]]))
    refused('"6" at 7.9 s: it is there twice', broken, "--format", "inD", "--frame-rate", "10")
    trj = layouts.trj(tmp_path, layouts.scene(), 1.04)
    trj.write_bytes(trj.read_bytes()[:-3])
    refused("it is cut short within a record", trj)
    trj.write_bytes(trj.read_bytes()[:28] + b"\x09")
    refused("a record begins with", trj)
    fzp = layouts.fzp(tmp_path, layouts.scene())
    fzp.write_text(fzp.read_text().replace("COORDREAR", "REAR"))
    refused("line 5: it has no column COORDREAR", fzp)


def test_inspect_guesses_the_columns_of_an_unknown_table(tmp_path: Path) -> None:
    layouts.write(tmp_path / "own.csv", "track_id,t,x_m,y_m,yaw,colour", [(1, 0.0, 1.0, 2.0, 0.0, "red")])
    told = closecall("inspect", tmp_path / "own.csv")
    assert "a table of no known layout" in told.stdout
    assert "--columns id=track_id,time=t,x=x_m,y=y_m,heading=yaw --path arc" in told.stdout
    layouts.write(tmp_path / "odd.csv", "a,b", [(1, 2)])
    told = closecall("inspect", tmp_path / "odd.csv")
    assert "missing: id, frame, x, y" in told.stdout


def test_parquet_that_is_compressed_otherwise_is_refused_in_a_line(tmp_path: Path) -> None:
    frame = pytest.importorskip("polars").DataFrame({"id": ["a"], "time": [0.0], "x": [1.0], "y": [2.0]})
    frame.write_parquet(tmp_path / "tracks.parquet", compression="zstd")
    columns = ("--columns", "id=id,time=time,x=x,y=y", "--path", "arc")
    for words in (("inspect",), ("replay", *columns, "--out", tmp_path / "log")):
        done = closecall(words[0], tmp_path / "tracks.parquet", *words[1:])
        assert done.returncode == 2 and is_one_message(done.stderr), done.stderr
        assert "tracks.parquet: it is compressed by zstd" in done.stderr
