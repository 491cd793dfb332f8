"""`closecall study SCENARIO` says what its runs show, continues where it stopped, and refuses what it cannot study."""

from __future__ import annotations

import json
import re
import signal
import statistics
from pathlib import Path
from typing import Any

import pytest
from conftest import NETS, Once, Row, begin, closecall, is_one_message, python, rows, until

LEFT_TURN = NETS / "left_turn" / "left_turn.sumocfg"
VARIED = ("--vary", "step-length=0.5,1", "--vary", "threads=1,2", "--vary", "mu=minimal,paper")
WORDS = (*VARIED, "--seeds", "1-2", "--end", "60")
SUMO = ("--", "--no-warnings")

READ = """if True:
    import json, sys
    from pathlib import Path
    import pyarrow.parquet as parquet
    found = []
    for path in sorted(Path(sys.argv[1]).glob("run=*/conflicts.parquet")):
        file = parquet.ParquetFile(path)
        record = json.loads(file.schema_arrow.metadata[b"closecall.run.json"])
        time = json.loads(file.schema_arrow.metadata[b"closecall.run_time"])
        table = file.read(["severity", "ttc", "artefact"]).to_pylist()
        counted = [row for row in table if not row["artefact"]]
        found.append({"rows": counted, "summary": record["summary"],
            "name": path.parent.name.removeprefix("run=").rsplit("seed-")[0], "time": time})
    print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def done(once: Once) -> Path:
    """The folder of a study of three step lengths, two numbers of threads and two models of μ, with two seeds."""

    def fill(out: Path) -> None:
        result = closecall("study", LEFT_TURN, "--out", out, *WORDS, *SUMO)
        assert result.returncode == 0
        cost, first, *_ = result.stderr.splitlines()
        assert re.fullmatch(r"closecall: \d+ runs; \d+ at the same time; the first tells how long they take", cost), (
            cost
        )
        assert re.fullmatch(r"closecall: the first run took [\d.]+ s; all others will take about [\d.]+ s", first), (
            first
        )
        (out / "said").write_text(result.stdout)

    return once("study", fill)


@pytest.fixture
def runs(done: Path) -> dict[str, Any]:
    """The runs of each setting, in the order of their seeds."""
    result = python(READ, done / "conflicts")
    assert result.returncode == 0, result.stderr
    found: dict[str, Any] = {}
    for run in json.loads(result.stdout):
        found.setdefault(run["name"], []).append(run)
    return found


def row(done: Path, axis: str, value: str, measure: str) -> Row:
    """The row of `study.csv` for a measure."""
    (found,) = [
        row for row in rows(done / "study.csv") if (row["axis"], row["value"], row["measure"]) == (axis, value, measure)
    ]
    return found


def test_a_study_writes_table_charts_and_page(done: Path) -> None:
    written = {path.name for path in done.iterdir()} - {"said"}
    charts = {f"{name}.{ending}" for name in ("steps", "choices") for ending in ("svg", "png")}
    assert written == {"conflicts", "study.csv", "study.md", *charts}
    page = (done / "study.md").read_text()
    said = (done / "said").read_text()
    sentence = said.splitlines()[0]
    assert sentence.startswith("For 5 % in conflicts per vehicle-hour this scenario needs steps of ")
    assert sentence in page and "At the present setting (steps of 0.2 s)" in page
    assert "threads=2 changes nothing, as it should." in said


def test_its_figures_are_those_of_the_logs(done: Path, runs: dict[str, Any]) -> None:
    assert set(runs) == {"", "step-length-0.5_", "step-length-1_", "threads-2_", "mu-paper_"}

    def rates(name: str) -> list[float]:
        return [len(run["rows"]) / run["summary"]["exposure"]["vehicle_hours"] for run in runs[name]]

    reference = rates("")
    assert min(reference) > 0
    for value, name in (("0.2", ""), ("0.5", "step-length-0.5_"), ("1", "step-length-1_")):
        of = runs[name]
        found = row(done, "step-length", value, "conflicts_per_vehicle_hour")
        hours = sum(run["summary"]["exposure"]["vehicle_hours"] for run in of)
        assert float(found["mean"]) == pytest.approx(sum(len(run["rows"]) for run in of) / hours)
        assert float(found["relative_error"]) == pytest.approx(sum(rates(name)) / sum(reference) - 1, abs=1e-12)
        assert float(found["cpu_seconds"]) == pytest.approx(statistics.mean(run["time"]["cpu"] for run in of))
        assert float(found["cpu_seconds"]) > 0 and float(found["seconds"]) > 0
        assert found["own"] == ("true" if value == "0.2" else "false")
        crashes = row(done, "step-length", value, "risk_index")
        assert float(crashes["mean"]) == pytest.approx(statistics.mean(run["summary"]["risk_index"] for run in of))
        ttc = [[row["ttc"] for row in run["rows"] if row["ttc"] is not None] for run in of]
        median = row(done, "step-length", value, "ttc_q50")
        assert float(median["mean"]) == pytest.approx(statistics.mean(map(statistics.median, ttc)))
        serious = row(done, "step-length", value, "serious_or_critical")
        counts = [sum(row["severity"] != "caution" for row in run["rows"]) for run in of]
        assert float(serious["mean"]) == pytest.approx(statistics.mean(counts))


def test_the_same_command_continues_a_study(tmp_path: Path) -> None:
    words = ("study", LEFT_TURN, "--out", tmp_path, "--vary", "step-length=0.5", "--seeds", "1-3", "--workers", "1")

    def logs() -> dict[str, int]:
        return {str(path): path.stat().st_mtime_ns for path in tmp_path.glob("conflicts/run=*/conflicts.parquet")}

    process = begin(*words, "--end", "60", *SUMO)
    until(lambda: len(logs()) >= 2)
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=60)
    first = logs()
    assert process.returncode == 130 and "of 6 runs; repeat the command to continue" in stderr
    assert len(first) < 6 and not (tmp_path / "study.md").exists()
    again = closecall(*words, "--end", "60", *SUMO)
    assert again.returncode == 0 and f", {len(first)} more are done; " in again.stderr, again.stderr
    assert len(logs()) == 6 and first.items() <= logs().items()
    assert (tmp_path / "study.md").exists()


def test_what_cannot_be_studied_gets_one_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for words, said in (
        ((tmp_path / "none.sumocfg",), "none.sumocfg: "),
        ((LEFT_TURN, "--vary", "scale=1,2"), "write sumo:scale"),
        ((LEFT_TURN, "--vary", "step-length=0.1,x"), "step-length"),
        ((LEFT_TURN, "--vary", "step-length=0,1"), "step-length"),
        ((LEFT_TURN, "--vary", "step-length=1", "--vary", "sumo:step-length=2"), "step-length is varied twice"),
        ((LEFT_TURN, "--vary", "mu=none"), "none"),
        ((LEFT_TURN, "--accuracy", "0"), "--accuracy"),
        ((LEFT_TURN, "--only", "volume"), "--only"),
        (("--seeds", "1-2"), "SCENARIO"),
        (("--epsilon", "1"), "need a SCENARIO"),
    ):
        result = closecall("study", *words)
        assert result.returncode == 2 and is_one_message(result.stderr), result.stderr
        assert said in result.stderr
    assert not list(tmp_path.iterdir())
