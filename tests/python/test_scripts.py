"""Scripts as people write them: executeMove, removed vehicles, forks, Ctrl-C."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Callable

import pytest
from conftest import closecall, python

Copy = Callable[[str], Path]

MODULES = pytest.mark.parametrize("module", ["libsumo", "traci"])

MOVES = """
import sys, warnings
import {module} as sumo
import closecall
warnings.simplefilter("error")
def found(moves):
    sumo.start(["sumo", "-c", sys.argv[1], "--no-warnings", "--step-length", "0.5"])
    checker = closecall.Checker(sumo)
    sumo.addStepListener(checker)
    for _ in range(50):
        sumo.simulationStep()
        if moves: sumo.simulation.executeMove()
    checker.close()
    sumo.close()
    assert checker.summary["steps"] == 50, checker.summary["steps"]
    exposure = checker.summary["exposure"]
    return [(it.ego, it.foe, it.kind, it.time) for it in checker.conflicts], exposure["vehicles"]
alone = found(False)
assert len(alone[0]) > 3
assert found(True) == alone
"""


@MODULES
def test_execute_move_after_each_step_changes_nothing(module: str, scenario: Copy) -> None:
    done = python(MOVES.replace("{module}", module), scenario("reckless"))
    assert done.returncode == 0, done.stderr


REMOVES = """
import sys
import traci
import closecall
traci.start(["sumo", "-c", sys.argv[1], "--no-warnings", "--step-length", "0.5"], label="one")
checker = closecall.Checker(traci)
traci.addStepListener(checker)
remove = [traci.vehicle.remove, traci.getConnection("one").vehicle.remove, lambda id: traci.vehicle.remove(vehID=id)]
for step in range(40):
    traci.simulationStep()
    ids = traci.vehicle.getIDList()
    if step > 9 and len(ids) > 2: remove[step % 3](ids[0])
checker.close()
traci.close()
print(checker.summary["steps"])
"""


def test_a_vehicle_that_a_script_removes_prints_nothing(scenario: Copy) -> None:
    done = python(REMOVES, scenario("reckless"))
    said = done.stdout + done.stderr
    assert done.stdout.split()[-1:] == ["40"] and "is not known" not in said, said


FORKS = """
import gc, os, sys
import closecall
out, way = sys.argv[1:]
checker = closecall.Checker(out=out, log_series=True)
for step in range(60):
    if step == 30 and way:
        child = os.fork()
        if child == 0:
            if way == "exit": sys.exit(0)
            if way == "close": checker.close()
            if way == "step": [checker.step(step * 0.1 + n, {"id": [], "x": [], "y": [], "heading": [], "speed": []})
                               for n in range(9)]
            if way == "with":
                with checker: pass
            if way == "drop":
                del checker
                gc.collect()
            if way == "step": assert "fork" in checker.log_error, checker.log_error
            os._exit(0)
        assert os.waitpid(child, 0)[1] == 0
    checker.step(step * 0.1, {"id": [f"v{n}" for n in range(10)],
                              "x": [7.0 * n + n % 7 * 2.0 * step for n in range(10)],
                              "y": [n % 3 * 3.5 for n in range(10)], "heading": [0.0] * 10,
                              "speed": [20.0 * (n % 7) for n in range(10)]})
checker.close()
assert checker.log_error is None
"""


@pytest.mark.parametrize("way", ["exit", "close", "step", "with", "drop"])
def test_a_fork_writes_nothing_into_the_log(way: str, tmp_path: Path) -> None:
    for name, does in (("alone", ""), ("forked", way)):
        done = python(FORKS, tmp_path / name, does)
        assert done.returncode == 0, done.stderr
    whole = [(tmp_path / name / "conflicts.csv").read_bytes() for name in ("alone", "forked")]
    assert whole[0] == whole[1] and whole[0].count(b"\n") > 5
    assert closecall("stats", tmp_path / "forked").returncode == 0


REPLAYS = """
import sys, closecall
print("begun", flush=True)
try: closecall.replay(sys.argv[1], {"id": "i", "time": "t", "x": "x", "y": "y"}, path="straight")
except KeyboardInterrupt: print("interrupted")
"""


def test_ctrl_c_ends_a_replay_in_python(tmp_path: Path) -> None:
    path = tmp_path / "many.csv"
    with path.open("w") as file:
        file.write("i,t,x,y\n")
        for step in range(3_000):
            file.writelines(f"{who},{step / 10},{who * 60 + step % 7 / 10},0\n" for who in range(100))
    command = [sys.executable, "-c", REPLAYS, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        assert process.stdout is not None and process.stdout.readline() == "begun\n"
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        sent = time.monotonic()
        assert process.communicate()[0] == "interrupted\n"
    assert time.monotonic() - sent < 2
