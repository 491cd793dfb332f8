"""`closecall.read`, `Checker.table`, `--log-format parquet`: Arrow columns, with the libraries that take them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Callable

import closecall as api
import pytest
from conftest import NETS, Once, closecall, python, rows

Copy = Callable[[str], Path]


@pytest.fixture
def log(once: Once) -> Path:
    def fill(folder: Path) -> None:
        net = NETS / "reckless" / "reckless.sumocfg"
        done = closecall("run", net, "--out", folder / "log", "--end", "60", "--log-clips", "none", "--quiet")
        assert done.returncode == 0, done.stderr

    return once("table", fill) / "log"


def agrees(names: list[str], found: list[dict[str, Any]], log: Path) -> None:
    expected = rows(log / "conflicts.csv")
    assert names == list(expected[0]) and len(found) == len(expected) > 20
    for row, known in zip(found, expected):
        for name, value in row.items():
            text = known[name]
            if value is None or value != value:
                assert text == "", name
            elif isinstance(value, bool) or text in ("true", "false"):
                assert bool(value) == (text == "true"), name
            elif isinstance(value, str):
                assert value == text, name
            else:
                assert math.isclose(value, float(text)), name


def test_equal_texts_of_a_column_are_one_object(log: Path) -> None:
    kinds = api.read(log).to_dict()["kind"]
    assert len({id(kind) for kind in kinds}) == len(set(kinds)) < len(kinds)


def test_pandas_polars_pyarrow_and_duckdb_get_the_columns_of_the_log(log: Path) -> None:
    table = api.read(log)
    assert len(table) == len(rows(log / "conflicts.csv")) and "conflicts" in repr(table)
    agrees(table.columns, table.to_pandas().to_dict("records"), log)
    agrees(table.columns, table.to_polars().to_dicts(), log)
    pyarrow = pytest.importorskip("pyarrow")
    arrow = pyarrow.table(table)
    agrees(arrow.column_names, arrow.to_pylist(), log)
    assert arrow.schema.field("margin").metadata == {b"unit": b"m"}
    # The stream can be taken again.
    assert pyarrow.table(table).equals(arrow)
    duckdb = pytest.importorskip("duckdb")
    assert duckdb.sql("SELECT count(*) FROM arrow").fetchall() == [(len(table),)]


TABLE = """
import sys
import libsumo
import closecall
libsumo.start(["sumo", "-c", sys.argv[1], "--no-warnings", "--end", "30"])
with closecall.Checker(libsumo, measures="t2") as checker:
    while libsumo.simulation.getTime() < 30:
        libsumo.simulationStep()
        checker.step()
    table = checker.table()
    assert "pyarrow" not in sys.modules
    frame = table.to_pandas()
    assert list(frame["ego"]) == [conflict.ego for conflict in checker.conflicts]
    assert "t2" in table.columns and "tadv" not in table.columns
    assert table.to_polars().height == len(table) == len(checker.conflicts)
    assert "<th>margin</th>" in table._repr_html_()
print(len(table))
"""


def test_a_checker_gives_its_conflicts_as_a_table_beside_libsumo(scenario: Copy) -> None:
    pytest.importorskip("libsumo")
    done = python(TABLE, scenario("reckless"))
    assert done.returncode == 0 and int(done.stdout.split()[-1]) > 10, done.stderr


def test_a_log_without_conflicts_is_a_table_without_rows() -> None:
    table = api.Checker().table()
    assert len(table) == 0 and list(table.to_pandas().columns) == table.columns == table.to_polars().columns
    assert table._repr_html_().startswith("<table>")


def test_a_conflict_prints_its_values_with_their_units() -> None:
    checker = api.Checker()
    states = {"id": ["<a>", "b"], "x": [0.0, 20.0], "y": [0.0, 0.0], "heading": [0.0, 0.0], "speed": [20.0, 5.0]}
    checker.step(0.0, states)
    conflict = checker.conflicts[0]
    lines = str(conflict).splitlines()
    assert lines[0] == repr(conflict) and any(line.split() == ["ego_speed", "20", "m/s"] for line in lines)
    assert "pet" not in [line.split()[0] for line in lines]
    assert "<th>ego</th><td>&lt;a&gt;</td>" in conflict._repr_html_()  # type: ignore[attr-defined]


def test_a_log_in_parquet_reads_as_one_in_csv(log: Path, scenario: Copy, tmp_path: Path) -> None:
    config = scenario("reckless")
    done = closecall(
        "run", config, "--out", tmp_path / "log", "--end", "60", "--log-format", "parquet", "--log-clips", "none"
    )
    assert done.returncode == 0, done.stderr
    names = sorted(path.name for path in (tmp_path / "log").iterdir())
    assert names == ["conflicts.parquet", "run.json"]
    agrees(api.read(log).columns, api.read(tmp_path / "log").to_polars().to_dicts(), log)
    polars = pytest.importorskip("polars")
    assert polars.read_parquet(tmp_path / "log" / "conflicts.parquet").height == len(rows(log / "conflicts.csv"))
    # The commands that show the worst conflicts name the scenario, which is a copy of its own.
    told = [closecall("stats", folder).stdout.splitlines() for folder in (log, tmp_path / "log")]
    csv_stats, parquet_stats = (
        [line for line in lines if not line.startswith(("the worst: ", "all tables: ", "on a map: "))] for lines in told
    )
    assert csv_stats == parquet_stats != []
    # A run in CSV after it keeps it aside.
    assert closecall("run", config, "--out", tmp_path / "log", "--end", "20", "--quiet").returncode == 0
    assert (tmp_path / "log" / "earlier" / "1" / "conflicts.parquet").exists()
    assert not (tmp_path / "log" / "conflicts.parquet").exists()


def test_what_is_no_log_is_told(tmp_path: Path) -> None:
    with pytest.raises(OSError):
        api.read(tmp_path)
    (tmp_path / "conflicts.csv").write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match='column "id" is missing'):
        api.read(tmp_path)


def test_columns_that_are_wanted_are_those_of_the_table(log: Path) -> None:
    table = api.read(log, columns=["ttc", "ego", "ego_x"])
    assert table.columns == ["ttc", "ego", "ego_x"]
    agrees_in = [row["ego"] for row in rows(log / "conflicts.csv")]
    assert table.to_dict()["ego"] == agrees_in and not math.isnan(sum(table.to_dict()["ego_x"]))
    with pytest.raises(ValueError, match='no "tcc"'):
        api.read(log, columns=["tcc"])
