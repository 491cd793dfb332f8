"""Outputs are whole or not there, never written over an input, and never mixed with another run's."""

from __future__ import annotations

import os
import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Callable

import closecall as cc
import pytest
from conftest import begin, closecall, closecall_apart, until

Copy = Callable[[str], Path]

PAIR = {"id": ["a", "b"], "x": [0.0, 20.0], "y": [0.0, 0.0], "heading": [0.0, 0.0], "speed": [20.0, 5.0]}


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """A small log."""
    with cc.Checker(out=tmp_path / "log") as checker:
        checker.step(0.0, PAIR)
    return tmp_path / "log"


def test_a_second_run_in_the_same_folder_is_refused(scenario: Copy, tmp_path: Path) -> None:
    config, out = scenario("town"), tmp_path / "out"
    first = begin("run", config, "--end", "1000", "--out", out)
    try:
        until((out / "conflicts.csv").exists)
        second = closecall("run", config, "--end", "10", "--out", out)
        assert (second.returncode, second.stdout) == (2, "")
        told = rf"closecall: {out}: another run writes its log there \(process {first.pid}, begun \d+ seconds? ago\); "
        assert re.match(told, second.stderr), second.stderr
        with pytest.raises(ValueError, match=f"process {first.pid}"):
            cc.Checker(out=out)
        assert not (out / "earlier").exists()
        first.send_signal(signal.SIGINT)
        assert first.wait(60) == 130
        assert closecall("stats", out).returncode in (0, 2), "the first run's log is its own"
        again = closecall("run", config, "--end", "10", "--out", out)
        assert again.returncode == 0, again.stderr
    finally:
        first.kill()
        first.communicate()
    assert not [path for path in out.iterdir() if path.name.startswith(".")]


def test_a_killed_run_keeps_nobody_out(scenario: Copy, tmp_path: Path) -> None:
    config, out = scenario("town"), tmp_path / "out"
    first = begin("run", config, "--end", "1000", "--out", out)
    until((out / "conflicts.csv").exists)
    first.kill()
    first.communicate()
    done = closecall("run", config, "--end", "10", "--out", out)
    assert done.returncode == 0, done.stderr
    assert (out / "earlier" / "1" / "conflicts.csv").exists()


def test_runs_at_once_get_folders_of_their_own(scenario: Copy) -> None:
    config = scenario("rear_end")
    command = [sys.executable, "-m", "closecall", "run", str(config), "--quiet", "--out", "auto"]
    runs = [subprocess.Popen(command) for _ in range(3)]
    assert [run.wait(60) for run in runs] == [0, 0, 0]
    made = sorted(path.name for path in config.parent.iterdir() if path.name.startswith("closecall-out"))
    assert made == ["closecall-out-1", "closecall-out-2", "closecall-out-3"]
    assert {(config.parent / name / "conflicts.csv").read_bytes() for name in made} != set()
    assert closecall("stats", *(config.parent / name for name in made)).returncode == 0


def test_a_sweep_has_its_folder_for_itself(scenario: Copy, tmp_path: Path) -> None:
    with cc.Checker(out=tmp_path / "out"):
        done = closecall("sweep", scenario("rear_end"), "--seeds", "1", "--out", tmp_path / "out")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert f"(process {os.getpid()}, begun" in done.stderr


@pytest.mark.parametrize("name", ["conflicts.csv", "run.json"])
@pytest.mark.parametrize("command", [("report",), ("stats", "--format", "csv")])
def test_no_output_is_written_over_the_log_that_it_shows(command: tuple[str, ...], name: str, log: Path) -> None:
    before = (log / name).read_bytes()
    done = closecall(*command, log.parent, "-o", log / ".." / "log" / name)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "--out would be written over" in done.stderr
    assert (log / name).read_bytes() == before


def test_no_output_is_written_through_a_link(log: Path, tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    mine.write_text("mine")
    (tmp_path / "plots").mkdir()
    for link in ("page.html", "plots/map.svg"):
        (tmp_path / link).symlink_to(mine)
    for words in (
        ("report", log, "-o", tmp_path / "page.html"),
        ("stats", log, "-o", tmp_path / "page.html"),
        ("plot", log, "-o", tmp_path / "plots"),
    ):
        done = closecall(*words)
        assert done.returncode == 2 and "a symbolic link" in done.stderr, done.stderr
    assert mine.read_text() == "mine"


def test_a_log_is_not_written_over_the_recording(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    recording = tmp_path / "out" / "conflicts.csv"
    recording.parent.mkdir()
    fcd = ("--fcd-output", recording)
    done = closecall("run", config, "--end", "10", "--quiet", "--out", tmp_path / "run", "--", *fcd)
    assert done.returncode == 0, done.stderr
    before = recording.read_bytes()
    for more in ((), ("--force",)):
        net = config.with_suffix(".net.xml")
        done = closecall("replay", recording, "--net", net, "--out", recording.parent, *more)
        assert done.stderr == f"closecall: the log would be written over {recording}\n"
        assert recording.read_bytes() == before


def full() -> None:
    """A write beyond this size fails, as it does on a full disk."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))


@pytest.mark.parametrize("command", ["report", "stats", "plot"])
def test_a_full_disk_leaves_the_output_as_it_was(command: str, log: Path, tmp_path: Path) -> None:
    out = tmp_path / "out" / ("map.svg" if command == "plot" else "page")
    out.parent.mkdir()
    out.write_text("before")
    more = ("--format", "html") if command == "stats" else ()
    target = out.parent if command == "plot" else out
    done = closecall_apart(command, log, *more, "-o", target, preexec_fn=full)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert f"{out}: " in done.stderr
    assert [path.name for path in out.parent.iterdir()] == [out.name] and out.read_text() == "before"


@pytest.mark.parametrize("option", ["--ssm-output", "--trj-output"])
def test_a_killed_run_leaves_no_half_file(option: str, scenario: Copy, tmp_path: Path) -> None:
    out = tmp_path / "file"
    run = begin("run", scenario("town"), "--end", "1000", "--out", tmp_path / "out", option, out)
    until((tmp_path / "out" / "conflicts.csv").exists)
    time.sleep(0.3)
    run.kill()
    run.communicate()
    assert not out.exists()


def test_statistics_are_written_to_a_file(log: Path, tmp_path: Path) -> None:
    printed = closecall("stats", log)
    written = closecall("stats", log, "--out", tmp_path / "table.txt")
    assert (written.returncode, written.stdout) == (0, "")
    assert (tmp_path / "table.txt").read_text() == printed.stdout
    assert (tmp_path / "table.txt").stat().st_mode & 0o777 == 0o666 & ~current_umask()


def current_umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def test_a_linked_folder_is_not_written_into(scenario: Copy, log: Path, tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "summary.json").write_text("mine")
    folder = scenario("side").parent
    (folder / "expected").symlink_to(mine)
    (log / "earlier").symlink_to(mine)
    done = closecall("regress", "--bless", folder)
    assert done.returncode == 2 and f"{folder / 'expected'}: a symbolic link" in done.stdout, done.stdout
    with pytest.raises(ValueError, match="earlier: a symbolic link"):
        cc.Checker(out=log)
    assert [(path.name, path.read_text()) for path in mine.iterdir()] == [("summary.json", "mine")]


@pytest.mark.parametrize(
    "setting", ['ssm-output = "FILE"', 'trj_output = "FILE"', '[regress]\nsumo_options = ["--log", "FILE"]']
)
def test_a_scenarios_settings_name_no_file_to_write(setting: str, scenario: Copy, tmp_path: Path) -> None:
    precious, config = tmp_path / "precious", scenario("side")
    precious.write_text("mine")
    toml = config.parent / "closecall.toml"
    toml.write_text(setting.replace("FILE", str(precious)))
    done = closecall("regress", config.parent)
    assert done.returncode == 2 and "file to be written" in done.stdout, done.stdout
    if "regress" not in setting:
        done = closecall("sweep", config, "--config", toml, "--seeds", "1-2", "--out", tmp_path / "sweep")
        assert done.returncode == 2 and "all runs would write the same file" in done.stderr, done.stderr
    assert precious.read_text() == "mine"


def test_each_run_of_a_sweep_writes_its_own_files(scenario: Copy, tmp_path: Path) -> None:
    config, file = scenario("side"), tmp_path / "fcd.xml"
    words = ("sweep", config, "--seeds", "1-2", "--out", tmp_path / "sweep", "--end", "5")
    done = closecall(*words, "--vary", f"sumo:fcd-output={file}")
    assert (done.returncode, list(tmp_path.glob("*fcd.xml"))) == (2, []) and "fcd-output" in done.stderr
    done = closecall(*words, "--", "--fcd-output", file)
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in tmp_path.glob("*fcd.xml")) == ["seed-1_fcd.xml", "seed-2_fcd.xml"]
