"""What a new user of closecall meets: wrong files, examples, and output that fits a screen."""

from __future__ import annotations

from pathlib import Path
from typing import Callable

import pytest
from conftest import closecall, closecall_apart, is_one_message

Copy = Callable[[str], Path]


def test_a_part_of_a_scenario_is_recognised_and_the_scenario_named(scenario: Copy) -> None:
    config = scenario("side")
    for name, what in (("side.net.xml", "a SUMO net"), ("side.rou.xml", "a SUMO route file")):
        part = config.with_name(name)
        done = closecall("run", part)
        assert done.returncode == 2 and is_one_message(done.stderr), done.stderr
        assert f"it is {what}, not a configuration: closecall run {config}, which names it" in done.stderr
        done = closecall("inspect", part)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout == f"{part}: {what}\nclosecall run {config}, which names it\n"
    done = closecall("replay", config)
    assert done.returncode == 2 and "it is a SUMO configuration, not a recording" in done.stderr
    config.unlink()
    assert "--save-configuration" in closecall("run", config.with_name("side.net.xml")).stderr


def test_a_recording_is_no_scenario(scenario: Copy, tmp_path: Path) -> None:
    recording = tmp_path / "fcd.xml"
    recording.write_text("<fcd-export>\n</fcd-export>\n")
    done = closecall("run", recording)
    assert done.returncode == 2 and f"closecall replay {recording} --net NET" in done.stderr


@pytest.mark.parametrize("name", ["left_turn", "side", "town"])
def test_an_example_runs_and_is_not_written_twice(name: str, tmp_path: Path) -> None:
    done = closecall_apart("example", name, cwd=tmp_path)
    configuration = f"{name}/{name}.sumocfg"
    assert (done.returncode, done.stdout) == (0, f"{name} in {name}; check it: closecall run {configuration}\n")
    ran = closecall_apart("run", configuration, "--end", "5", "--quiet", cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    again = closecall_apart("example", name, cwd=tmp_path)
    assert again.returncode == 2 and f"{configuration} is there already" in again.stderr


def test_a_run_ends_with_ten_lines_and_its_statistics_fit_a_screen(town: Path) -> None:
    said, log = (town / "said").read_text(), town / "log"
    ending = ("conflicts " + said.partition("conflicts  ")[2]).splitlines()
    assert len(ending) <= 10 and ending[-1].startswith(f"log in {log}"), said
    brief = closecall("stats", log).stdout.splitlines()
    # The folder of this test has a long name, that of a user hardly.
    lines = [line.replace(str(log), "log") for line in brief if not line.startswith("the worst: sumo-gui")]
    assert len(brief) < 40 and max(map(len, lines)) <= 80, "\n".join(brief)
    assert f"all tables: closecall stats {log} --all" in brief
    whole = closecall("stats", log, "--all").stdout
    assert len(whole.splitlines()) > 60 and "EDGES" in whole and "per 1000 vehicles" in whole
    assert whole.count("no crashes extrapolated") <= 1
