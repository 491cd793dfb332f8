"""`closecall sweep` with real SUMO and Dask loses no run, repeats none, and writes what other tools can read."""

from __future__ import annotations

import csv
import json
import os
import resource
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, Callable, NamedTuple

import psutil
import pytest
from conftest import NETS, Once, begin, closecall, closecall_apart, is_alive, is_one_message, python, rows, until

Copy = Callable[[str], Path]

SHORT = ("--end", "60", "--", "--no-warnings")
LEFT_TURN = NETS / "left_turn" / "left_turn.sumocfg"


def sweep(*words: str | Path, status: int = 0, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run a sweep, which must end with this exit status."""
    done = (closecall_apart if options else closecall)("sweep", *words, **options)
    assert done.returncode == status, done.stdout + done.stderr
    return done


def files(out: Path) -> dict[str, int]:
    """The runs in a data set, each with the time at which it was written."""
    return {
        path.parent.name.removeprefix("run="): path.stat().st_mtime_ns
        for path in (out / "conflicts").glob("run=*/conflicts.parquet")
    }


def stats(*words: str | Path) -> Any:
    """The JSON output of `closecall stats`."""
    done = closecall("stats", *words, "--format", "json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def read(script: str, out: Path) -> Any:
    """The JSON that a script prints about a data set."""
    done = python(script, out / "conflicts")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def children(pid: int) -> dict[psutil.Process, str]:
    """The descendants of a process, with their command lines."""
    found = {}
    for process in psutil.Process(pid).children(recursive=True):
        try:
            found[process] = " ".join(process.cmdline())
        except psutil.Error:
            continue
    return found


class Cluster(NamedTuple):
    """A Dask scheduler with two worker processes, in a process of its own; only their own certificate lets in."""

    address: str
    pid: int


@pytest.fixture
def cluster(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Cluster]:
    """A cluster started outside closecall, and the settings of Dask that let this test in."""
    key, certificate = str(tmp_path / "key.pem"), str(tmp_path / "cert.pem")
    kind = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "1", "-subj", "/CN=closecall")
    subprocess.run(["openssl", "req", "-x509", *kind, "-keyout", key, "-out", certificate], check=True)
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION", "true")
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__TLS__CA_FILE", certificate)
    for role in ("SCHEDULER", "WORKER", "CLIENT"):
        monkeypatch.setenv(f"DASK_DISTRIBUTED__COMM__TLS__{role}__CERT", certificate)
        monkeypatch.setenv(f"DASK_DISTRIBUTED__COMM__TLS__{role}__KEY", key)
    script = """if True:
        import sys
        from distributed import LocalCluster, Security
        if __name__ == "__main__":
            tls = {"protocol": "tls://", "security": Security()}
            with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, **tls) as cluster:
                print(cluster.scheduler_address, flush=True)
                sys.stdin.read()
    """
    command = [sys.executable, "-c", script]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin and process.stdout
        yield Cluster(process.stdout.readline().strip(), process.pid)
        process.stdin.close()


@pytest.fixture(scope="module")
def done(once: Once) -> Path:
    """The folder of a sweep over two seeds, two values of a closecall option, and two of a SUMO option."""

    def fill(out: Path) -> None:
        varied = ("--vary", "mu=minimal,at-rest", "--vary", "sumo:scale=1,1.5")
        result = sweep(LEFT_TURN, "--seeds", "1-2", *varied, "--out", out, "--workers", "2", *SHORT)
        assert result.stdout == f"8 runs in {out}/conflicts\n" and result.stderr == ""

    return once("sweep", fill)


def test_a_sweep_runs_every_combination_of_values(done: Path) -> None:
    wanted = {
        f"mu-{mu}_sumo.scale-{scale}_seed-{seed}"
        for mu in ("minimal", "at-rest")
        for scale in ("1", "1.5")
        for seed in (1, 2)
    }
    assert set(files(done)) == wanted
    assert sorted(path.name for path in done.iterdir()) == ["conflicts"]


def test_a_sweeps_run_equals_closecall_run(done: Path, tmp_path: Path) -> None:
    words = ("--mu", "at-rest", "--seed", "2", "--end", "60", "--", "--no-warnings", "--scale=1.5")
    alone = closecall("run", LEFT_TURN, "--quiet", "--out", tmp_path / "log", *words)
    assert alone.returncode == 0, alone.stderr
    path = done / "conflicts" / "run=mu-at-rest_sumo.scale-1.5_seed-2"
    script = """if True:
        import json, sys
        import pyarrow.parquet as parquet
        file = parquet.ParquetFile(next(__import__("pathlib").Path(sys.argv[1]).glob("*.parquet")))
        record = json.loads(file.schema_arrow.metadata[b"closecall.run.json"])
        print(json.dumps({"rows": file.read().to_pylist(), "record": record}))
    """
    result = python(script, path)
    assert result.returncode == 0, result.stderr
    found = json.loads(result.stdout)
    logged = rows(tmp_path / "log" / "conflicts.csv")
    assert len(logged) > 5 and len(found["rows"]) == len(logged)
    for row, line in zip(found["rows"], logged):
        assert (row.pop("seed"), row.pop("option_mu"), row.pop("sumo_scale")) == (2, "at-rest", 1.5)
        assert list(row) == list(line)
        for name, cell in line.items():
            value = row[name]
            if isinstance(value, bool):
                assert str(value).lower() == cell
            elif isinstance(value, (int, float)):
                assert value == float(cell)
            else:
                assert (value or "") == cell
    own = json.loads((tmp_path / "log" / "run.json").read_text())
    assert found["record"]["complete"] and found["record"]["inputs"] == own["inputs"]
    assert found["record"]["summary"]["conflicts"] == own["summary"]["conflicts"]


READERS = {
    "pandas": """if True:
        import json, sys
        import pandas
        found = pandas.read_parquet(sys.argv[1])
        counts = found.groupby("run", observed=True).size().to_dict()
        scale = sorted(set(found.sumo_scale))
        print(json.dumps([counts, float(found.margin.sum()), int(found.collision.sum()), scale]))
    """,
    "polars": """if True:
        import json, sys
        import polars
        found = polars.scan_parquet(sys.argv[1], hive_partitioning=True).collect()
        counts = dict(found.group_by("run").len().iter_rows())
        scale = sorted(found["sumo_scale"].unique())
        print(json.dumps([counts, found["margin"].sum(), int(found["collision"].sum()), scale]))
    """,
    "duckdb": """if True:
        import json, sys
        import duckdb
        of = f"from read_parquet('{sys.argv[1]}/**/*.parquet', hive_partitioning = true)"
        counts = dict(duckdb.sql(f"select run, count(*) {of} group by run").fetchall())
        sums = duckdb.sql(f"select sum(margin), sum(collision::int)::int {of}").fetchall()[0]
        scale = [row[0] for row in duckdb.sql(f"select distinct sumo_scale {of} order by 1").fetchall()]
        print(json.dumps([counts, *sums, scale]))
    """,
}


@pytest.mark.parametrize("reader", READERS)
def test_other_tools_read_the_data_set(reader: str, done: Path) -> None:
    counts, margins, collisions, scale = read(READERS[reader], done)
    overall = [group for group in stats(done, "--artefacts")["groups"] if group["group"] == "all"]
    assert sum(counts.values()) == sum(group["count"] for group in overall) > 20
    assert set(counts) <= set(files(done))
    assert collisions == sum(group["collisions"] for group in overall) and scale == [1.0, 1.5]
    assert margins < 0


def test_stats_and_report_read_sweeps_like_logs(tmp_path: Path) -> None:
    logs = tmp_path / "logs"
    for seed in ("1", "2"):
        words = ("--quiet", "--seed", seed, "--out", logs / seed, *SHORT)
        assert closecall("run", LEFT_TURN, *words).returncode == 0
    out = tmp_path / "sweep"
    sweep(LEFT_TURN, "--seeds", "1,2", "--out", out, "--workers", "1", "--quiet", *SHORT)
    of_logs, of_sweep = stats(logs, "--by", "type"), stats(out, "--by", "type")
    for found in (of_logs, of_sweep):
        assert found["runs"] == 2 and found["left_out"] == []
        for worst in found["worst"]:
            # These fields name the folders.
            worst.pop("folder", None), worst.pop("run", None), worst.pop("command", None), worst.pop("log", None)
    assert of_logs == of_sweep
    assert stats(logs, "--against", out)["comparison"] is not None
    made = closecall("report", out, "-o", tmp_path / "report.html")
    assert made.returncode == 0 and "of 2 runs in" in made.stdout, made.stderr
    assert f"{of_sweep['groups'][0]['count']} conflicts" in made.stdout


def test_a_sweep_continues_and_repeats_nothing(scenario: Copy, tmp_path: Path) -> None:
    config, out = scenario("side"), tmp_path / "out"
    words = ("--out", out, "--workers", "1", *SHORT)
    sweep(config, "--seeds", "1-2", *words)
    first = files(out)
    result = sweep(config, "--seeds", "1-3", *words)
    assert "2 of them were there already" in result.stdout
    second = files(out)
    assert len(second) == 3 and first.items() <= second.items()
    begun = time.monotonic()
    assert "3 of them were there already" in sweep(config, "--seeds", "1-3", *words).stdout
    assert files(out) == second and time.monotonic() - begun < 5
    # A run with other options or other input files is done again.
    sweep(config, "--seeds", "1-3", "--epsilon", "1", *words)
    third = files(out)
    assert not second.items() & third.items()
    config.with_suffix(".net.xml").open("a").write("<!-- changed -->\n")
    sweep(config, "--seeds", "2", "--epsilon", "1", *words)
    assert third.items() - files(out).items() == {("seed-2", third["seed-2"])}
    # The same holds for a selection named only in the settings file.
    edges = [
        edge.get("id") for edge in ET.parse(config.with_suffix(".net.xml")).iter("edge") if not edge.get("function")
    ]
    selection, settings = tmp_path / "selection.txt", tmp_path / "closecall.toml"
    settings.write_text(f"filter = '{selection}'\n")
    written = []
    for edge in edges[:2]:
        selection.write_text(f"edge:{edge}\n")
        sweep(config, "--seeds", "1", "--config", settings, *words)
        written.append(files(out)["seed-1"])
    assert written[0] != written[1]
    # A run whose file is broken is done again, be it only in a page of its rows.
    file = out / "conflicts" / "run=seed-2" / "conflicts.parquet"
    whole = file.read_bytes()
    in_a_page = len(whole) // 8
    assert whole.find(b"closecall") > in_a_page
    for broken in (b"PAR1", whole[:in_a_page] + bytes([whole[in_a_page] ^ 4]) + whole[in_a_page + 1 :]):
        file.write_bytes(broken)
        done = sweep(config, "--seeds", "2", "--epsilon", "1", *words)
        assert "already" not in done.stdout and file.read_bytes() != broken
    assert stats(out)["runs"] == 3
    # Runs with other columns need a data set of their own.
    other = sweep(config, "--seeds", "1", "--vary", "epsilon=1,2", *words, status=2)
    assert "choose another --out" in other.stderr and other.stderr.count("\n") == 1


def test_repeating_a_run_removes_its_old_series(tmp_path: Path) -> None:
    words = ("--seeds", "1", "--out", tmp_path, "--workers", "1")
    assert sweep(LEFT_TURN, *words, "--log-series", *SHORT).stdout.startswith("1 run in ")
    series = tmp_path / "series" / "run=seed-1" / "series.csv"
    assert series.is_file()
    sweep(LEFT_TURN, *words, *SHORT)
    assert files(tmp_path) and not series.exists()


def test_a_sweep_refuses_the_folder_of_a_log(tmp_path: Path) -> None:
    assert closecall("run", LEFT_TURN, "--quiet", "--out", tmp_path, *SHORT).returncode == 0
    refused = sweep(LEFT_TURN, "--seeds", "1", "--out", tmp_path, *SHORT, status=2)
    assert refused.stderr.startswith(f"closecall: {tmp_path / 'conflicts.csv'}: ") and refused.stderr.count("\n") == 1
    assert not files(tmp_path)


def test_a_failed_run_is_reported_and_the_others_continue(scenario: Copy, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ("--seeds", "1-2", "--vary", "sumo:step-length=0.5,-1", "--out", out, "--workers", "2", *SHORT)
    result = sweep(scenario("side"), *words, status=1)
    assert set(files(out)) == {"sumo.step-length-0.5_seed-1", "sumo.step-length-0.5_seed-2"}
    lines = result.stderr.splitlines()
    assert len(lines) == 2, result.stderr
    for line in lines:
        assert line.startswith("closecall: run sumo.step-length--1_seed-") and "failed twice: " in line
    assert "2 failed; the same command tries them again" in result.stdout


def test_a_sweep_says_why_no_log_could_be_written(tmp_path: Path) -> None:
    def fill_disk() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))

    out = tmp_path / "out"
    result = sweep(LEFT_TURN, "--seeds", "1", "--out", out, *SHORT, status=1, preexec_fn=fill_disk)
    assert "run seed-1 failed twice: " in result.stderr and "File too large" in result.stderr
    assert not files(out)


def test_a_sweep_on_one_machine_opens_no_socket(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "distributed.py").write_text("raise ImportError('Dask is not installed')\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    out = tmp_path / "out"
    process = begin("sweep", LEFT_TURN, "--seeds", "1-4", "--out", out, "--workers", "2", *SHORT)
    looked_at = 0
    while process.poll() is None:
        for one in (psutil.Process(process.pid), *simulations(psutil.Process(process.pid))):
            with suppress(psutil.Error):
                assert not one.net_connections("all")
                looked_at += one.pid != process.pid
    assert looked_at > 10 and len(files(out)) == 4, process.communicate()
    words = ("--seeds", "5", "--out", out, "--scheduler", "tls://127.0.0.1:9", *SHORT)
    refused = closecall_apart("sweep", LEFT_TURN, *words)
    assert refused.returncode == 2 and "pip install 'closecall[sweep]'" in refused.stderr


def test_numbered_runs_side_by_side_make_one_sweep(tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = (LEFT_TURN, "--seeds", "3-5", "--out", out)
    assert sweep(*words, "--list").stdout == "task,run,done\n1,seed-3,false\n2,seed-4,false\n3,seed-5,false\n"
    side_by_side = [begin("sweep", *words, "--task", number, *SHORT) for number in ("1", "3")]
    for process in side_by_side:
        assert process.communicate() == (f"1 run in {out}/conflicts\n", "")
    assert set(files(out)) == {"seed-3", "seed-5"} and [path.name for path in out.iterdir()] == ["conflicts"]
    listed = sweep(*words, "--list", *SHORT).stdout
    assert listed == "task,run,done\n1,seed-3,true\n2,seed-4,false\n3,seed-5,true\n"
    assert "1 of them were there already" in sweep(*words, "--task", "3", *SHORT).stdout
    assert "they are 1 to 3" in sweep(*words, "--task", "4", *SHORT, status=2).stderr


def simulations(of: psutil.Process) -> list[psutil.Process]:
    """The simulations that a sweep or a worker has started."""
    return [process for process, words in children(of.pid).items() if "closecall._child" in words]


def test_a_killed_run_is_done_again(tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = begin("sweep", LEFT_TURN, "--seeds", "1-6", "--out", out, "--workers", "2", "--", "--no-warnings")
    running: list[psutil.Process] = []

    def one_runs() -> bool:
        running[:] = simulations(psutil.Process(process.pid))
        return len(files(out)) >= 2 and len(running) > 0

    # Between two runs there may be none for a moment.
    until(one_runs)
    assert len(running) in (1, 2)
    running[0].kill()
    stdout, stderr = process.communicate(timeout=120)
    assert (process.returncode, stderr) == (0, ""), stdout + stderr
    assert set(files(out)) == {f"seed-{seed}" for seed in range(1, 7)}
    assert stats(out)["runs"] == 6
    assert sorted(path.name for path in out.iterdir()) == ["conflicts"]


def test_a_cluster_outlives_killed_workers_and_sweeps(cluster: Cluster, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ("--seeds", "1-6", "--out", out, "--scheduler", cluster.address, "--", "--no-warnings")
    process = begin("sweep", LEFT_TURN, *words)
    until(lambda: len(files(out)) >= 2)
    spawned = [process for process, words in children(cluster.pid).items() if "spawn_main" in words]
    # One that a worker has just forked to start a simulation still has the worker's command line.
    workers = [process for process in spawned if process.parent() not in spawned]
    assert len(workers) == 2
    running = simulations(workers[0])
    workers[0].kill()
    # Its simulation ends with it.
    until(lambda: not any(map(is_alive, running)), 10)
    stdout, stderr = process.communicate(timeout=120)
    assert (process.returncode, stderr) == (0, ""), stdout + stderr
    assert set(files(out)) == {f"seed-{seed}" for seed in range(1, 7)}
    assert stats(out)["runs"] == 6
    assert sorted(path.name for path in out.iterdir()) == ["conflicts"]
    # When a sweep is killed, Dask forgets its runs, and their simulations end.
    process = begin("sweep", LEFT_TURN, "--seeds", "1-30", "--out", tmp_path / "more", "--scheduler", cluster.address)
    until(lambda: files(tmp_path / "more"))
    process.kill()
    process.communicate()
    until(lambda: not simulations(psutil.Process(cluster.pid)), 20)


@pytest.mark.parametrize(
    ("asked", "group"),
    [(signal.SIGINT, False), (signal.SIGINT, True), (signal.SIGTERM, False), (signal.SIGTERM, True)],
    ids=["sweep", "terminal", "kill", "batch system"],
)
def test_ctrl_c_and_sigterm_leave_nothing_running(asked: signal.Signals, group: bool, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ("--seeds", "1-30", "--out", out, "--workers", "2", *SHORT)
    process = begin("sweep", LEFT_TURN, *words)
    until(lambda: len(files(out)) >= 2)
    running = children(process.pid)
    # A terminal sends the signal to all processes of the group.
    (os.killpg if group else os.kill)(process.pid, asked)
    _, stderr = process.communicate(timeout=30)
    assert process.returncode == 130, stderr
    assert stderr.startswith("closecall: interrupted after ") and stderr.count("\n") == 1, stderr
    until(lambda: not any(map(is_alive, running)), 10)
    # The finished runs are complete.
    before = files(out)
    assert stats(out)["runs"] == len(before)
    sweep(LEFT_TURN, *words[:1], "1-3", *words[2:])
    assert before.items() <= files(out).items()


def test_unusable_arguments_get_one_clear_line(scenario: Copy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    config = scenario("side")
    monkeypatch.chdir(tmp_path)
    # Dask tries an address for 30 s unless configured otherwise, which it reads once in a process.
    impatient = {**os.environ, "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "1s"}
    for words, message in (
        (("gone.sumocfg", "--seeds", "1"), "gone.sumocfg: No such file"),
        ((config,), "--seeds"),
        ((config, "--seeds", "3-1"), "ends before it begins"),
        ((config, "--seeds", "1", "--vary", "epsilon"), "it has no values"),
        ((config, "--seeds", "1", "--vary", "epsilon=a"), "invalid value 'a' for '--epsilon"),
        ((config, "--seeds", "1", "--vary", "epsilom=1"), "no such option"),
        ((config, "--seeds", "1", "--vary", "seed=1"), "use --seeds"),
        ((config, "--seeds", "1", "--vary", "mu=paper", "--vary", "mu=minimal"), "varied twice"),
        ((config, "--seeds", "1", "--epsilon", "-1"), "--epsilon"),
        ((config, "--seeds", "1", "--gui"), "unexpected argument '--gui'"),
        ((config, "--seeds", "1", "--scheduler", "tcp://127.0.0.1:9"), "127.0.0.1:9"),
        ((config, "--seeds", "1", "--scheduler", "a", "--workers", "1"), "cannot be used with"),
    ):
        in_its_own = {"env": impatient} if "--scheduler" in words else {}
        done = sweep(*words, "--out", tmp_path / "out", status=2, **in_its_own)
        assert is_one_message(done.stderr), (words, done.stderr)
        assert message in done.stderr, (words, done.stderr)
    assert not files(tmp_path / "out")


def test_help_lists_the_sweep_and_its_options() -> None:
    assert "  sweep " in closecall("--help").stdout
    text = closecall("sweep", "--help").stdout
    for word in (
        "--seeds",
        "--vary",
        "--workers",
        "--scheduler",
        "--list",
        "--task",
        "--epsilon",
        "--end",
        "SUMO OPTIONS",
    ):
        assert word in text


def test_a_series_is_written_beside_the_conflicts(scenario: Copy, tmp_path: Path) -> None:
    out = tmp_path / "out"
    sweep(scenario("side"), "--seeds", "5", "--log-series", "--out", out, "--workers", "1", *SHORT)
    with (out / "series" / "run=seed-5" / "series.csv").open(newline="") as file:
        assert next(csv.reader(file))[0] == "conflict"
