"""Bad input ends with exit status 2, one line that names the file and the fault, and no half-written output."""

from __future__ import annotations

import json
import os
import re
import resource
import subprocess
import sys
from pathlib import Path
from typing import Callable

import pytest
from conftest import closecall, closecall_apart, is_one_message, python

Copy = Callable[[str], Path]


def refused(config: Path, *words: str, names: str, usage: bool = False) -> None:
    """Run the configuration and expect that closecall refuses it, in one line or as clap does."""
    done = closecall("run", config, *words)
    assert done.returncode == 2, (done.returncode, done.stderr)
    assert done.stdout == ""
    assert is_one_message(done.stderr) and ("try '--help'" in done.stderr) == usage, done.stderr
    assert re.search(names, done.stderr), done.stderr
    assert not (config.parent / "closecall-out").exists()


def change(path: Path, pattern: str, to: str) -> None:
    """Replace the first match of a pattern, which the file must contain."""
    text = path.read_text()
    changed = re.sub(pattern, to, text, count=1)
    assert changed != text
    path.write_text(changed)


def test_a_missing_configuration_is_refused(tmp_path: Path) -> None:
    refused(tmp_path / "none.sumocfg", names=r"none\.sumocfg: No such file")


def test_a_misspelt_option_gets_a_suggestion(scenario: Copy) -> None:
    found = r"'--modus' found\n\n  tip: a similar argument exists: '--mode'\n(.*\n)*\nUsage: closecall run "
    refused(scenario("rear_end"), "--modus", "paper", names=found, usage=True)


def test_a_full_output_is_reported_and_a_closed_pipe_accepted(scenario: Copy) -> None:
    config = scenario("rear_end")
    for words in (("mu", "--speed", "30", "--foe-speed", "25"), ("run", config), ("stats", config.parent)):
        command = [sys.executable, "-m", "closecall", *map(str, words)]
        with Path("/dev/full").open("w") as full:
            done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
        assert "standard output: No space left on device" in done.stderr
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            assert process.stdout and process.stderr
            process.stdout.close()
            assert (process.stderr.read(), process.wait(60)) == ("", 0)


def test_a_malformed_configuration_is_refused(scenario: Copy) -> None:
    config = scenario("rear_end")
    config.write_text("<configuration><input>")
    refused(config, names=r"rear_end\.sumocfg")


def test_a_mesoscopic_simulation_is_refused(scenario: Copy) -> None:
    refused(scenario("rear_end"), "--", "--mesosim", names=r"rear_end\.sumocfg: mesosim: .* needs the microscopic one")


def test_a_missing_net_is_refused(scenario: Copy) -> None:
    config = scenario("rear_end")
    (config.parent / "rear_end.net.xml").unlink()
    refused(config, names=r"rear_end\.net\.xml")


def test_a_malformed_net_is_refused(scenario: Copy) -> None:
    config = scenario("rear_end")
    net = config.parent / "rear_end.net.xml"
    net.write_text(net.read_text()[:-200])
    refused(config, names=r"rear_end\.net\.xml")


def test_a_net_without_geometry_is_refused(scenario: Copy) -> None:
    config = scenario("rear_end")
    change(config.parent / "rear_end.net.xml", r'(<lane id="road_0"[^>]*shape=)"[^"]*"', r'\1""')
    refused(config, names=r"road_0")


def test_a_missing_route_file_is_refused(scenario: Copy) -> None:
    config = scenario("rear_end")
    (config.parent / "rear_end.rou.xml").unlink()
    refused(config, names=r"rear_end\.rou\.xml")


def test_a_route_file_malformed_at_its_end_is_refused(scenario: Copy) -> None:
    config = scenario("rear_end")
    routes = config.parent / "rear_end.rou.xml"
    routes.write_text(routes.read_text().replace("</routes>", "<vehicle>\n</routes>"))
    refused(config, names=r"rear_end\.rou\.xml")


def test_an_empty_scenario_is_refused_and_leaves_outputs_alone(scenario: Copy) -> None:
    config = scenario("rear_end")
    (config.parent / "rear_end.rou.xml").write_text("<routes/>\n")
    refused(config, names=r"rear_end\.sumocfg: the scenario is empty")
    file, device = config.parent / "ssm.xml", config.parent / "device"
    device.symlink_to("/dev/null")
    for output in (file, device):
        assert closecall("run", config, "--ssm-output", output).returncode == 2
    assert not file.exists()
    assert device.is_symlink(), "closecall removed an output that is not a regular file"


@pytest.mark.parametrize(("name", "value"), [("length", "-5"), ("width", "nan"), ("emergencyDecel", "0")])
def test_impossible_dimensions_are_refused(name: str, value: str, scenario: Copy) -> None:
    config = scenario("rear_end")
    routes = config.parent / "rear_end.rou.xml"
    text = re.sub(rf' {name}="[^"]*"', "", routes.read_text())
    routes.write_text(re.sub(r"<vType ", f'<vType {name}="{value}" ', text))
    refused(config, names=name)


@pytest.mark.parametrize(("option", "value"), [("--mu", "big"), ("--epsilon", "-1"), ("--step-length", "0")])
def test_an_impossible_option_is_refused(option: str, value: str, scenario: Copy) -> None:
    refused(scenario("rear_end"), option, value, names=option, usage=True)


def test_an_output_folder_that_cannot_be_written_is_refused(scenario: Copy, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    refused(scenario("rear_end"), "--out", str(tmp_path / "file" / "out"), names="file/out")


def test_a_full_disk_is_reported_and_no_row_is_cut(scenario: Copy, tmp_path: Path) -> None:
    def limit() -> None:
        # A write beyond this size fails, as it does on a full disk.
        resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, 10_000))

    words = ("--quiet", "--out", tmp_path, "--", "--no-warnings")
    done = closecall_apart("run", scenario("reckless"), *words, preexec_fn=limit)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert "conflicts.csv: " in done.stderr
    written = (tmp_path / "conflicts.csv").read_text()
    assert written.endswith("\n")
    assert len({line.count(",") for line in written.splitlines()}) == 1
    record = json.loads((tmp_path / "run.json").read_text())
    assert not record["complete"]
    assert record["error"].endswith(f"; the last whole row of the log is {len(written.splitlines()) - 1}")


def test_a_missing_libsumo_is_named_with_its_remedy(scenario: Copy) -> None:
    script = """
import sys
sys.modules["libsumo"] = None
from closecall.__main__ import main
sys.argv = ["closecall", "run", sys.argv[1]]
sys.exit(main())
"""
    done = python(script, scenario("rear_end"))
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert "pip install libsumo" in done.stderr


def test_a_libsumo_that_cannot_be_loaded_is_not_called_missing(scenario: Copy, tmp_path: Path) -> None:
    package = tmp_path / "libsumo"
    package.mkdir()
    (package / "__init__.py").write_text("from . import _libsumo\n")
    # The loader refuses it as it refuses one whose libraries the system lacks.
    (package / "_libsumo.so").write_bytes(b"")
    done = closecall_apart("run", scenario("rear_end"), env={**os.environ, "PYTHONPATH": str(tmp_path)})
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert "libsumo cannot be loaded (" in done.stderr
    assert "apt install libgl1" in done.stderr


def test_a_failure_of_sumo_during_a_run_keeps_the_log(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    routes = config.parent / "rear_end.rou.xml"
    # SUMO notices the missing lane only when the vehicle departs.
    late = '<vehicle id="late" depart="10" departLane="7"><route edges="road"/></vehicle>\n</routes>'
    text = re.sub(r"</routes>", late, routes.read_text())
    routes.write_text(text)
    done = closecall("run", config, "--out", tmp_path / "out")
    assert done.returncode == 1, done.stderr
    assert "SUMO failed at" in done.stderr
    assert (tmp_path / "out" / "conflicts.csv").read_text().count("\n") == 2
