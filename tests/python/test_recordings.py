"""Recordings: existing data is read, missing data reported, data that is not understood refused."""

from __future__ import annotations

import gzip
import json
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import closecall as api
import pytest
from conftest import Row, closecall, is_one_message, rows

USERS = (("a", 0.0, 20.0), ("b", 40.0, 5.0))
"""Two on one line, the second slower: a crash after 2.3 s."""
COLUMNS = "id=who,time=t,x=x,y=y,speed=v"


def lines(more: str = "", steps: int = 3, *, name: str = "") -> str:
    """A table of these two, with one more column."""
    head = "who,t,x,y,v" + (f",{name}" if name else "")
    cells = [f"{who},{t},{x + v * t:g},0,{v:g}{more}" for t in range(steps) for who, x, v in USERS]
    return "\n".join([head, *cells]) + "\n"


def replay(file: Path | list[Path], *words: str | Path, status: int = 0) -> tuple[str, list[Row]]:
    """What was said, and the conflicts."""
    files = file if isinstance(file, list) else [file]
    log = files[0].with_suffix(".log")
    done = closecall("replay", *files, "--path", "straight", "--out", log, "--force", *words)
    assert done.returncode == status, done.stderr
    if status:
        assert is_one_message(done.stderr), done.stderr
        return done.stderr, []
    return done.stderr + done.stdout, rows(log / "conflicts.csv")


def vehicles(file: Path) -> int:
    exposure: dict[str, int] = json.loads((file.with_suffix(".log") / "run.json").read_text())["summary"]["exposure"]
    return exposure["vehicles"]


def written(folder: Path, text: str, name: str = "t.csv") -> Path:
    (folder / name).write_text(text)
    return folder / name


def test_each_of_several_recordings_gets_its_own_log(tmp_path: Path) -> None:
    files = [written(tmp_path, lines(steps=steps), f"take{steps}.csv") for steps in (3, 4, 5)]
    wrong = written(tmp_path, lines().replace("a,1", ",1"), "wrong.csv")
    out = tmp_path / "out"
    shared = ("--path", "straight", "--columns", COLUMNS)
    done = closecall("replay", "--each", *files, wrong, *shared, "--out", out, "--workers", "2")
    assert done.returncode == 2
    assert "wrong.csv, line 4: column who: an id is needed" in done.stderr
    assert sorted(log.name for log in out.iterdir()) == ["take3", "take4", "take5"]
    for file in files:
        replay(file, *shared)
        alone, log = file.with_suffix(".log"), out / file.stem
        assert f"{log}: 1 conflict, " in done.stdout
        for name in ("conflicts.csv", "run.json"):
            assert (log / name).read_bytes() == (alone / name).read_bytes()
    (out / "conflicts.csv").touch()
    done = closecall("replay", "--each", *files, *shared, "--out", out)
    assert done.returncode == 2 and "the log of a single recording" in done.stderr


@pytest.mark.parametrize(
    ("text", "columns", "said"),
    [
        (lines(",12", name="len"), COLUMNS + ",length=lenght", "t.csv, line 1: it has no column lenght"),
        (lines(",1", name="x"), COLUMNS, "t.csv, line 1: it has 2 columns x"),
        (lines(",-5", name="len"), COLUMNS + ",length=len", "t.csv, line 2: column len: -5 m is below 0"),
        (lines().replace(",5\n", ",-5\n"), COLUMNS, "speed is -5, it must be 0 to 1000 m/s"),
        (lines(",12", name="len").replace("a,1", ",1"), COLUMNS, "t.csv, line 4: column who: an id is needed"),
        (lines() + "a,3,99\n", COLUMNS, "t.csv, line 8: the row has 3 cells, not 5"),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_line(text: str, columns: str, said: str, tmp_path: Path) -> None:
    assert said in replay(written(tmp_path, text), "--columns", columns, status=2)[0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (lines()[:-1], "t.csv: its last row has no line break"),
        (lines(), "lengths: 6 rows have none, so they are those of SUMO's classes"),
        (lines(), "classes: 6 rows have none, so they are cars"),
        (lines().replace(",5\n", ",-0.009\n", 2), "speeds: 2 are below 0 by at most 0.1 m/s"),
    ],
)
def test_what_is_missing_is_said_and_counted(text: str, said: str, tmp_path: Path) -> None:
    assert said in replay(written(tmp_path, text), "--columns", COLUMNS)[0]


def test_the_exact_name_is_preferred_to_another_case(tmp_path: Path) -> None:
    text = lines(",0", name="X").replace("t,x", "t,x")
    said, found = replay(written(tmp_path, text), "--columns", COLUMNS)
    assert "2 columns" not in said and [row["kind"] for row in found] == ["rear_end"]


def test_things_are_left_out_and_counted(tmp_path: Path) -> None:
    things = "".join(
        f"{kind},{t},{x},0,0,{kind}\n" for t in range(3) for kind, x in (("static", 20), ("background", 25))
    )
    file = written(tmp_path, lines(",vehicle", name="kind") + things)
    said, found = replay(file, "--columns", COLUMNS + ",class=kind")
    assert '"static", "background" are not road users, so their rows are left out: 6' in said
    assert vehicles(file) == 2 and [row["foe"] for row in found] == ["b"]


def test_a_missing_file_of_classes_is_said(tmp_path: Path) -> None:
    names = "trackId,frame,xCenter,yCenter,heading,width,length,xVelocity,yVelocity\n"
    cells = "".join(f"1,{n},{n},0,0,1.8,4.5,10,0\n2,{n},50,{n},90,0,0,0,1\n" for n in range(5))
    file = written(tmp_path, names + cells, "7_tracks.csv")
    said, _ = replay(file, "--frame-rate", "10")
    assert "the file 7_tracksMeta.csv with the classes is missing" in said
    written(tmp_path, "trackId,class\n1,car\n", "7_tracksMeta.csv")
    said, _ = replay(file, "--frame-rate", "10")
    assert '7_tracksMeta.csv lacks 1 of the road users, one of them "2"' in said


def test_two_files_are_one_recording(tmp_path: Path) -> None:
    names = "track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy"
    cars = [f"1,{n + 1},{100 * (n + 1)},car,{n},0,10,0,0,4.5,1.8" for n in range(26)]
    walkers = [f"1,{n + 1},{100 * (n + 1)},pedestrian,30.25,{0.14 * (n - 20):.3f},0,1.4" for n in range(26)]
    both = [
        written(tmp_path, "\n".join([f"{names},psi_rad,length,width", *cars]) + "\n", "vehicles.csv"),
        written(tmp_path, "\n".join([names, *walkers]) + "\n", "walkers.csv"),
    ]
    told = closecall("inspect", both[1]).stdout
    assert "INTERACTION" in told and "--frame-rate" not in told
    for files in (both, both[::-1]):
        _, found = replay(files)
        assert [(row["kind"], row["ego_type"][:9]) for row in found] == [("side", "passenger")]
    found_here = api.replay(both, path="straight").to_dict()
    assert found_here["kind"] == ["side"]
    inputs = json.loads((both[1].with_suffix(".log") / "run.json").read_text())["inputs"]
    assert len(inputs) == 2
    xml = written(tmp_path, "<fcd-export></fcd-export>", "f.xml")
    assert "several files may only be tables" in replay([both[0], xml], status=2)[0]


def test_ids_of_ngsim_are_used_again(tmp_path: Path) -> None:
    names = "Vehicle_ID,Frame_ID,Total_Frames,Global_Time,Local_X,Local_Y,v_Length,v_Width,v_Class,v_Vel,Location"

    def text(tracks: list[tuple[int, int, int, str]]) -> str:
        cells = [
            f"{who},{begin + n},{total},{100 * (begin + n)},16.5,{4 * n},15,6,2,40,{where}"
            for who, begin, total, where in tracks
            for n in range(total)
        ]
        return "\n".join([names, *cells]) + "\n"

    for tracks, count in (
        ([(5, 1, 30, "i-80"), (5, 31, 40, "i-80")], 2),
        ([(5, 1, 30, "i-80"), (5, 331, 30, "i-80")], 2),
        ([(5, 1, 30, "i-80"), (5, 31, 30, "us-101")], 2),
        ([(5, 1, 30, "i-80"), (9, 31, 40, "i-80")], 2),
        ([(5, 1, 30, "i-80")], 1),
    ):
        file = written(tmp_path, text(tracks))
        replay(file)
        assert vehicles(file) == count, tracks


def test_inspect_tells_units_from_the_values(tmp_path: Path) -> None:
    users = (("a", 0, 0, 0, 10, 0), ("b", 50, -30, 90, 0, 10))
    cells = [
        f"{n},{1000 + 100 * n},{who},{x + vx * n / 10},{y + vy * n / 10},{yaw},{vx},{vy}"
        for n in range(20)
        for who, x, y, yaw, vx, vy in users
    ]
    names = "frame,timestamp,actor,x,y,yaw,vx,vy"
    file = written(tmp_path, "\n".join([names, *cells]) + "\n")
    told = closecall("inspect", file).stdout
    assert "'id=actor,time=timestamp[ms],x=x,y=y,heading=yaw[deg],vx=vx,vy=vy'" in told, told
    columns = "id=actor,time=timestamp[ms],x=x,y=y,heading=yaw"
    assert "heading=yaw[deg]" in replay(file, "--columns", columns)[0]
    assert "headings:" not in replay(file, "--columns", columns + "[deg]")[0]
    frames = [cell.split(",", 2)[0] + "," + cell.split(",", 2)[2] for cell in cells]
    told = closecall("inspect", written(tmp_path, "\n".join(["frame,actor,x,y,yaw,vx,vy", *frames]) + "\n")).stdout
    assert "--frame-rate 10 " in told, told
    named = "frame,t (s),id,x [m],y [m],speed_kmh\n" + "".join(f"{n},{n},a,{10 * n},0,36\n" for n in range(9))
    told = closecall("inspect", written(tmp_path, named)).stdout
    assert "'id=id,time=t (s),x=x [m][m],y=y [m][m],speed=speed_kmh[km/h]'" in told, told


def test_files_of_another_kind_are_named(tmp_path: Path) -> None:
    other = written(tmp_path, '<?xml version="1.0"?><commonRoad timeStepSize="0.1"/>', "a.xml")
    packed = tmp_path / "a.csv.zst"
    packed.write_bytes(bytes.fromhex("28b52ffd2004210000") + b"a;b\n")
    for words in (("inspect",), ("replay", "--out", tmp_path / "log")):
        done = closecall(words[0], other, *words[1:])
        assert done.returncode == 2 and "its root element is <commonRoad>" in done.stderr and not done.stdout
        done = closecall(words[0], packed, *words[1:])
        assert done.returncode == 2 and "it is packed by zstd" in done.stderr and is_one_message(done.stderr)


def test_front_and_rear_at_one_place_are_refused(tmp_path: Path) -> None:
    text = "$VEHICLE:SIMSEC;NO;COORDFRONT;COORDREAR;SPEED\n0;1;0 4 0;0 4 0;36\n"
    assert "line 2: COORDFRONT and COORDREAR are at one place" in replay(written(tmp_path, text, "p.fzp"), status=2)[0]


def test_route_files_tell_the_types_that_a_recording_lacks(tmp_path: Path) -> None:
    steps = "".join(
        f'<timestep time="{t}"><vehicle id="s" x="{30 + t}" y="0" angle="90" speed="1"/>'
        f'<vehicle id="f.0" x="{6 * t}" y="0" angle="90" speed="6"/></timestep>'
        for t in range(3)
    )
    file = written(tmp_path, f"<fcd-export>{steps}</fcd-export>", "min.xml")
    types = '<vType id="b" vClass="bicycle"/><vehicle id="s" type="b" depart="0"/><flow id="f" type="b" begin="0"/>'
    demand = written(tmp_path, f"<routes>{types}</routes>", "r.rou.xml")
    said, found = replay(file, "--route-files", demand, "--log", "ttc < 10")
    assert "types" not in said and {row["ego_length"] for row in found} == {"1.6"}
    assert "types (none)" in replay(file, "--log", "ttc < 10")[0]


def test_elements_that_are_no_vehicles_are_counted(tmp_path: Path) -> None:
    step = '<timestep time="{}"><vehicle id="s" x="3" y="0" angle="90" speed="-0.01"/><container id="c"/></timestep>'
    text = "".join(map(step.format, range(3)))
    with gzip.open(tmp_path / "c.xml.gz", "wt") as file:
        file.write(f"<fcd-export>{text}</fcd-export>")
    said, _ = replay(tmp_path / "c.xml.gz")
    assert "left out: 3 elements" in said and "speeds: 3 are below 0" in said


TYPES = {
    "decimal": ("[decimal.Decimal('12.000')] * 6, pyarrow.decimal128(9, 3)", 12.0),
    "decimal of 32 bits": ("[decimal.Decimal('12.0')] * 6, pyarrow.decimal128(5, 1)", 12.0),
    "half": ("numpy.full(6, 12, numpy.float16), pyarrow.float16()", 12.0),
    "uint8": ("[12] * 6, pyarrow.uint8()", 12.0),
    "text": ("['12'] * 6, pyarrow.string()", 12.0),
    "categories": ("['12'] * 6, pyarrow.dictionary(pyarrow.int8(), pyarrow.string())", 12.0),
    "booleans": ("[True] * 6, pyarrow.bool_()", None),
    "lists": ("[[12.0]] * 6, pyarrow.list_(pyarrow.float64())", None),
    "structs": ("[{'m': 12.0}] * 6, pyarrow.struct([('m', pyarrow.float64())])", None),
    "timestamps": ("[12] * 6, pyarrow.timestamp('ns')", None),
}


def arrow_table(kind: str) -> Any:
    """A table with a column of lengths of this kind; PyArrow may not be loaded beside libsumo."""
    import decimal

    numpy = pytest.importorskip("numpy")
    pyarrow = pytest.importorskip("pyarrow")
    lengths = eval(f"pyarrow.array({TYPES[kind][0]})", {"pyarrow": pyarrow, "decimal": decimal, "numpy": numpy})
    cells = [(who, float(t), x + v * t, v) for t in range(3) for who, x, v in USERS]
    who, t, x, v = map(list, zip(*cells))
    nothing = pyarrow.nulls(6)
    return pyarrow.table({"who": who, "t": t, "x": x, "y": [0.0] * 6, "v": v, "len": lengths, "note": nothing})


@pytest.mark.parametrize("kind", TYPES)
def test_a_column_of_any_type_is_read_or_refused_by_its_name(kind: str, tmp_path: Path) -> None:
    table, length = arrow_table(kind), TYPES[kind][1]
    parquet = pytest.importorskip("pyarrow.parquet")
    columns = COLUMNS + ",length=len"
    file = tmp_path / "t.parquet"
    try:
        parquet.write_table(table, file, compression="snappy")
    except Exception as error:  # an older PyArrow writes no half-precision floats
        pytest.skip(str(error))
    if length is None:
        assert "t.parquet: column len holds" in replay(file, "--columns", columns, status=2)[0]
        with pytest.raises(ValueError, match="column len holds"):
            api.replay(table, columns, path="straight")
    else:
        _, found = replay(file, "--columns", columns)
        assert [row["ego_length"] for row in found] == ["12"]
        assert list(api.replay(table, columns, path="straight").to_dict()["ego_length"]) == [length]
    # Where the column is not read, its type does not matter.
    assert len(replay(file, "--columns", COLUMNS)[1]) == len(api.replay(table, COLUMNS, path="straight")) == 1


def test_a_column_of_nulls_does_not_matter() -> None:
    polars = pytest.importorskip("polars")
    cells = [(who, float(t), x + v * t, 0.0, v) for t in range(3) for who, x, v in USERS]
    frame = polars.DataFrame(cells, schema=["who", "t", "x", "y", "v"], orient="row").with_columns(n=polars.lit(None))
    for columns in (COLUMNS, COLUMNS + ",length=n"):
        assert api.replay(frame, columns, path="straight").to_dict()["kind"] == ["rear_end"]


def test_whole_numbers_as_ids_keep_all_their_digits(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    big = 2**53 + 1
    table = pyarrow.table(
        {"who": [big, big - 1, big + 1] * 2, "t": [0, 0, 0, 1, 1, 1], "x": [0.0, 50.0, 90.0, 20.0, 55.0, 95.0]}
    ).append_column("y", pyarrow.array([0.0] * 6))
    parquet.write_table(table, tmp_path / "t.parquet", compression="snappy")
    _, found = replay(tmp_path / "t.parquet", "--columns", "id=who,time=t,x=x,y=y")
    assert vehicles(tmp_path / "t.parquet") == 3 and {row["ego"] for row in found} <= {str(big), str(big - 1)}


def test_python_says_what_the_command_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = written(tmp_path, lines(",kart", name="kind"))
    said, _ = replay(file, "--columns", COLUMNS + ",class=kind")
    table = api.replay(file, COLUMNS + ",class=kind", path="straight")
    unknown = 'classes: "kart" are unknown, so they are cars'
    assert unknown in table.remarks and any("lengths: 6 rows" in remark for remark in table.remarks)
    assert all(f"closecall: {remark}\n" in said for remark in table.remarks)
    # What is not in the data at all, its caller knows.
    assert capsys.readouterr().err == f"closecall: {unknown}\n"


def test_ctrl_c_ends_a_replay_in_python(tmp_path: Path) -> None:
    chance = random.Random(1)
    cells = (f"{who},{t},{who * 60 + chance.random():.3f},0\n" for t in range(4000) for who in range(100))
    file = written(tmp_path, "i,t,x,y\n" + "".join(cells))
    text = (
        "import sys, closecall\nprint('begin', flush=True)\n"
        "try: closecall.replay(sys.argv[1], 'id=i,time=t,x=x,y=y', path='straight')\n"
        "except KeyboardInterrupt: print('interrupted')"
    )
    process = subprocess.Popen([sys.executable, "-c", text, str(file)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "begin\n"
    time.sleep(0.3)
    sent = time.monotonic()
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=60)[0] == "interrupted\n" and time.monotonic() - sent < 10
