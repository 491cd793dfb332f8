"""`closecall regress`: an unchanged scenario passes, and a changed one fails with the change named."""

from __future__ import annotations

import fcntl
import json
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import termios
import time
import xml.etree.ElementTree as ET
from contextlib import suppress
from pathlib import Path
from typing import Callable

import psutil
import pytest
from conftest import NETS, TIMEOUT, begin, closecall, is_alive, until, wait_for_rows

Copy = Callable[[str], Path]


@pytest.fixture
def of_six_seeds(tmp_path: Path) -> Copy:
    """Copies a scenario with its expected results, which the test may change, and returns its folder."""

    def copy(name: str) -> Path:
        return Path(shutil.copytree(NETS / name, tmp_path / name, ignore=shutil.ignore_patterns("closecall-out")))

    return copy


@pytest.fixture
def blessed(of_six_seeds: Copy) -> Copy:
    """The same with the first seed alone."""

    def copy(name: str) -> Path:
        folder = of_six_seeds(name)
        edit(folder / "closecall.toml", r"seeds = .*", "seeds = [42]")
        table, summary = folder / "expected" / "conflicts.csv", folder / "expected" / "summary.json"
        lines = table.read_text().splitlines(keepends=True)
        table.write_text("".join(line for line in lines if line.startswith(("seed,", "42,"))))
        found = json.loads(summary.read_text())
        found["seeds"] = [run for run in found["seeds"] if run["seed"] == 42]
        summary.write_text(json.dumps(found))
        return folder

    return copy


def edit(path: Path, pattern: str, replacement: str) -> None:
    """Change the first match of a pattern in a file."""
    text, count = re.subn(pattern, replacement, path.read_text(), count=1)
    assert count == 1, pattern
    path.write_text(text)


def settings(folder: Path, text: str) -> None:
    """Replace a scenario's settings."""
    (folder / "closecall.toml").write_text(text)


def differs(folder: Path, *words: str) -> str:
    """The report on a scenario that must differ from its expected results."""
    done = closecall("regress", folder, *words)
    assert done.returncode == 1, done.stdout + done.stderr
    assert done.stdout.startswith("FAIL "), done.stdout
    return done.stdout


def test_any_number_of_workers_prints_the_same_report(blessed: Copy, tmp_path: Path) -> None:
    folders = [blessed(name) for name in ("frontal", "priority", "side")]
    for folder in folders:
        settings(folder, "[regress]\nseeds = [42, 43]\n")
    assert closecall("regress", *folders, "--bless").returncode == 0
    reports = set()
    for workers in ("1", "4"):
        junit = tmp_path / "junit.xml"
        done = closecall("regress", *folders, "--workers", workers, "--junit", junit)
        assert done.returncode == 0, done.stdout + done.stderr
        reports.add((done.stdout, junit.read_bytes()))
    ((text, _),) = reports
    assert text.splitlines()[-1] == "3 scenarios: 3 pass"


def test_a_folder_runs_all_scenarios_and_only_selects_some(blessed: Copy, tmp_path: Path) -> None:
    blessed("frontal"), blessed("side")
    done = closecall("regress", tmp_path)
    assert (done.returncode, done.stdout.count("pass ")) == (0, 2), done.stdout
    done = closecall("regress", tmp_path, "--only", "side")
    assert "side" in done.stdout and "frontal" not in done.stdout
    done = closecall("regress", tmp_path, "--only", "nothing")
    assert done.returncode == 2 and "nothing" in done.stderr


def test_a_driver_type_with_half_the_headway_is_named(blessed: Copy) -> None:
    folder = blessed("motorway")
    edit(folder / "motorway.rou.xml", '(<vType id="car"[^>]*) tau="1.5"', r'\1 tau="0.75"')
    report = differs(folder)
    assert "changed since blessed: motorway.rou.xml: vType car: tau 1.5 → 0.75" in report
    assert re.search(r"new: seed \d+ rear_end \S+ with \S+, .* s to .* s, on \S+ at \(.*\): \w+, gap .* m", report)


def test_a_signal_phase_lengthened_by_three_seconds_is_named(blessed: Copy) -> None:
    folder = blessed("signals")
    edit(folder / "signals.net.xml", '<phase duration="26"', '<phase duration="29"')
    assert "changed since blessed: signals.net.xml: tlLogic a 0: phase 00 26 s" in differs(folder)


def test_a_removed_stop_sign_is_named(blessed: Copy) -> None:
    folder = blessed("priority")
    edit(folder / "priority.nod.xml", "priority_stop", "priority")
    netconvert = Path(sys.executable).with_name("netconvert")
    command = [str(netconvert), "-c", "priority.netccfg", "-o", "priority.net.xml"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=60)
    report = differs(folder)
    assert "changed since blessed: priority.net.xml: junction stop: type priority_stop → priority" in report


def test_an_epsilon_raised_by_half_a_metre_is_named(blessed: Copy) -> None:
    folder = blessed("left_turn")
    text = (folder / "closecall.toml").read_text()
    settings(folder, f"epsilon = 1.0\n{text}")
    assert "changed since blessed: option epsilon 0.5 → 1.0" in differs(folder)


def test_a_changed_vehicle_length_is_named(blessed: Copy) -> None:
    folder = blessed("roundabout")
    edit(folder / "roundabout.rou.xml", '(<vType id="car"[^>]*) length="4.6"', r'\1 length="4.7"')
    report = differs(folder)
    assert "changed since blessed: roundabout.rou.xml: vType car: length 4.6 → 4.7" in report


def test_a_scenario_may_be_blessed_with_added_measures(blessed: Copy) -> None:
    folder = blessed("side")
    settings(folder, 'measures = "t2,max_s"\n[regress]\nseeds = [42]\n')
    assert closecall("regress", folder, "--bless").returncode == 0
    done = closecall("regress", folder)
    assert done.returncode == 0, done.stdout + done.stderr
    (table,) = folder.rglob("conflicts.csv")
    header, first = table.read_text().splitlines()[:2]
    assert header.endswith(",t2,max_s")
    table.write_text(header + "\n" + first.rsplit(",", 1)[0] + ",77\n")
    assert re.search(r"max_s 77 → [\d.]+", differs(folder))


def test_a_difference_without_changed_inputs_is_reported_as_such(blessed: Copy) -> None:
    folder = blessed("rear_end")
    edit(folder / "expected" / "conflicts.csv", "rear_end,caution", "rear_end,critical")
    report = differs(folder)
    assert "severity critical → caution" in report
    assert "versions, options and input files are those blessed" in report


def test_an_added_comment_passes_and_is_reported(blessed: Copy) -> None:
    folder = blessed("rear_end")
    edit(folder / "rear_end.rou.xml", "</routes>", "<!-- a comment --></routes>")
    done = closecall("regress", folder)
    assert done.returncode == 0
    assert "changed since blessed: rear_end.rou.xml" in done.stdout


def test_a_blessed_scenario_passes(of_six_seeds: Copy) -> None:
    folder = of_six_seeds("side")
    shutil.rmtree(folder / "expected")
    missing = closecall("regress", folder, "--seeds", "42")
    assert missing.returncode == 2 and "nothing is blessed yet" in missing.stdout
    assert closecall("regress", folder, "--bless").returncode == 0
    assert closecall("regress", folder).returncode == 0
    assert (folder / "expected" / "conflicts.csv").read_bytes() == (
        NETS / "side" / "expected" / "conflicts.csv"
    ).read_bytes()
    assert (folder / "expected" / "summary.json").read_bytes() == (
        NETS / "side" / "expected" / "summary.json"
    ).read_bytes()


def test_blessing_shows_what_it_changes(blessed: Copy) -> None:
    folder = blessed("frontal")
    settings(folder, "epsilon = 1.0\n[regress]\nseeds = [42]\n")
    done = closecall("regress", folder, "--bless")
    assert done.returncode == 0 and done.stdout.startswith("blessed frontal"), done.stdout
    assert "option epsilon 0.5 → 1.0" in done.stdout and "margin -27.7" in done.stdout
    assert json.loads((folder / "expected" / "summary.json").read_text())["options"]["epsilon"] == 1.0
    assert closecall("regress", folder).returncode == 0


def test_a_folder_without_settings_is_exact_with_six_seeds(scenario: Copy) -> None:
    folder = scenario("fast").parent
    (folder / "closecall.toml").unlink()
    assert closecall("regress", folder, "--bless").returncode == 0
    done = closecall("regress", folder)
    assert (done.returncode, "(exact): 6 seeds" in done.stdout) == (0, True), done.stdout


def test_another_sumo_version_is_compared_by_statistics(blessed: Copy) -> None:
    folder = blessed("motorway")
    settings(folder, "end = 80\n[regress]\nseeds = [41, 42, 43, 44, 45, 46]\n")
    assert closecall("regress", folder, "--bless").returncode == 0
    summary = folder / "expected" / "summary.json"
    edit(summary, '"sumo": "SUMO [^"]*"', '"sumo": "SUMO 1.20.0"')
    same = closecall("regress", folder)
    assert (same.returncode, "byte for byte the same" in same.stdout) == (0, True), same.stdout
    # Other seeds stand for the other version's drivers: no change is there to find.
    other = closecall("regress", folder, "--seeds", "1,2,3,4,5,6")
    assert other.returncode == 0, other.stdout
    assert "compared by statistics, not exactly (SUMO 1." in other.stdout
    edit(folder / "motorway.rou.xml", '(<vType id="car"[^>]*) tau="1.5"', r'\1 tau="0.75"')
    report = differs(folder)
    assert re.search(r"rear_end conflicts per run: [\d.]+ → [\d.]+ \(p = 0\.00\d+\)", report), report


def test_statistics_tolerate_other_seeds_and_detect_half_the_headway(blessed: Copy) -> None:
    folder = blessed("motorway")
    settings(folder, 'end = 80\n[regress]\nlevel = "statistics"\nseeds = [1, 2, 3, 4, 5, 6]\n')
    assert closecall("regress", folder, "--bless").returncode == 0
    other = closecall("regress", folder, "--seeds", "11,12,13,14,15,16")
    assert (other.returncode, "0 of " in other.stdout) == (0, True), other.stdout
    edit(folder / "motorway.rou.xml", '(<vType id="car"[^>]*) tau="1.5"', r'\1 tau="0.75"')
    report = differs(folder)
    assert "all conflicts per vehicle-km" in report and "rear_end conflicts per run" in report


def test_too_few_seeds_for_a_test_are_refused(of_six_seeds: Copy) -> None:
    folder = of_six_seeds("motorway")
    done = closecall("regress", folder, "--seeds", "1,2")
    assert done.returncode == 2
    assert "2 seeds against 6 blessed can never tell a difference" in done.stdout
    assert "6 on both sides can" in done.stdout


def test_junit_tells_failures_from_errors(blessed: Copy, tmp_path: Path) -> None:
    good, changed, broken = blessed("frontal"), blessed("side"), blessed("rear_end")
    settings(changed, (changed / "closecall.toml").read_text() + "\n[type.car]\nresponse_time = 2.0\n")
    edit(changed / "side.rou.xml", 'jmIgnoreFoeProb="1"', 'jmIgnoreFoeProb="0"')
    (broken / "rear_end.rou.xml").write_text("<routes><vehicle></routes>")
    junit = tmp_path / "out" / "junit.xml"
    done = closecall("regress", good, changed, broken, "--junit", junit)
    assert done.returncode == 2
    assert "3 scenarios: 1 pass, 1 FAIL, 1 ERROR" in done.stdout
    suite = ET.parse(junit).getroot()[0]
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("3", "1", "1")
    cases = {case.get("name"): case for case in suite.iter("testcase")}
    assert cases["frontal"].find("failure") is None and cases["frontal"].find("error") is None
    failure, error = cases["side"].find("failure"), cases["rear_end"].find("error")
    assert failure is not None and "gone" in (failure.get("message") or "")
    assert error is not None and "rear_end.rou.xml, line 1" in (error.get("message") or "")


@pytest.mark.parametrize("folder", sorted(path.parent for path in NETS.glob("*/closecall.toml")), ids=lambda f: f.name)
def test_each_readme_states_the_blessed_counts(folder: Path) -> None:
    line = re.search(
        r"\*\*Blessed\*\* .*: (\d+) rear-end, (\d+) frontal, (\d+) side conflicts; (\d+) with a collision",
        (folder / "README.md").read_text(),
    )
    assert line
    summary = json.loads((folder / "expected" / "summary.json").read_text())
    (run,) = (run for run in summary["seeds"] if run["seed"] == 42)
    counts = [
        sum(count["count"] for count in run["conflicts"] if count["kind"] == kind and "artefact" not in count)
        for kind in ("rear_end", "frontal", "side")
    ]
    assert [int(number) for number in line.groups()] == [*counts, run["collisions"]]


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("epsilom = 1.0\n", "epsilom"),
        ("[regress]\nseed = [1]\n", "seed"),
        ("[regress]\nlevel = 'strict'\n", "strict"),
        ("[regress]\nsumocfg = 'other.sumocfg'\n", "other.sumocfg"),
        ("[regress\n", "closecall.toml, line 1"),
        ("epsilon = -1\n", "epsilon"),
    ],
)
def test_an_unusable_setting_is_named(text: str, named: str, blessed: Copy) -> None:
    folder = blessed("frontal")
    settings(folder, text)
    done = closecall("regress", folder)
    assert done.returncode == 2
    assert done.stdout.startswith("ERROR") and named in done.stdout.splitlines()[0], done.stdout


def test_expected_results_that_cannot_be_read_are_named(blessed: Copy) -> None:
    folder = blessed("frontal")
    (folder / "expected" / "summary.json").write_text('{"closecall": 1')
    done = closecall("regress", folder)
    assert done.returncode == 2 and "summary.json, line 1" in done.stdout
    shutil.rmtree(folder / "expected")
    (folder / "expected").mkdir()
    (folder / "expected" / "conflicts.csv").write_text("a,b\n")
    done = closecall("regress", folder)
    assert done.returncode == 2 and "expected" in done.stdout


def test_a_folder_without_a_scenario_is_refused(tmp_path: Path) -> None:
    for folder in (tmp_path, tmp_path / "missing"):
        done = closecall("regress", folder)
        assert (done.returncode, done.stderr.count("\n"), done.stdout) == (2, 1, "")
        assert str(folder) in done.stderr


def test_progress_is_shown_on_a_terminal(blessed: Copy) -> None:
    terminal, end = pty.openpty()
    # 24 rows of 100 columns.
    fcntl.ioctl(end, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 100, 0, 0))
    seeds = ",".join(map(str, range(1, 13)))
    command = [sys.executable, "-m", "closecall", "regress", str(blessed("side")), "--workers", "1", "--seeds", seeds]
    with subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=end, env={**os.environ, "TERM": "xterm"}
    ) as process:
        os.close(end)
        shown = b""
        with suppress(OSError):
            while part := os.read(terminal, 4096):
                shown += part
        process.wait(TIMEOUT)
    os.close(terminal)
    assert b" of 12 runs, " in shown, shown


def test_logs_are_kept_on_request(blessed: Copy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = blessed("side")
    monkeypatch.chdir(tmp_path)
    assert closecall("regress", folder, "--out", "kept").returncode == 0
    assert (tmp_path / "kept" / "side" / "seed-42" / "run.json").is_file()
    assert not (folder / "closecall-out").exists()


def test_ctrl_c_ends_the_simulations_too(blessed: Copy, tmp_path: Path) -> None:
    folder = blessed("town")
    settings(folder, "[regress]\nseeds = [42, 43]\n")
    process = begin("regress", folder, "--out", tmp_path / "kept")
    log = tmp_path / "kept" / "town" / "seed-42" / "conflicts.csv"
    wait_for_rows(log, process, 10)
    process.send_signal(signal.SIGINT)
    _, message = process.communicate(timeout=30)
    assert (process.returncode, message.count("\n")) == (130, 1), message
    assert "interrupted" in message
    size = log.stat().st_size
    time.sleep(0.5)
    assert log.stat().st_size == size


def test_a_killed_regress_leaves_no_simulation_running(blessed: Copy, tmp_path: Path) -> None:
    folder = blessed("town")
    settings(folder, "[regress]\nseeds = [42, 43]\n")
    process = begin("regress", folder, "--out", tmp_path / "kept")
    wait_for_rows(tmp_path / "kept" / "town" / "seed-42" / "conflicts.csv", process, 10)
    runs = psutil.Process(process.pid).children()
    assert runs
    process.kill()
    process.communicate(timeout=30)
    # Left alone, each simulation would run on for seconds.
    until(lambda: not any(map(is_alive, runs)), 1)
