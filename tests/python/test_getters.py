"""States read through libsumo's C++ interface, through the functions below it, or through its Python getters are equal.

closecall falls back to the Python getters where the C++ functions are not verified for this SUMO, cannot be called, or
disagree with them.
"""

from __future__ import annotations

import ctypes
import json
import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
from conftest import NETS, TIMEOUT, python

CHECK = """
import collections, json, sys
from closecall import _sumo
libsumo = _sumo.import_libsumo()
from libsumo import _libsumo
import closecall

config, out, end, change, *more = sys.argv[1:]
calls = collections.Counter()

def counted(domain, getter, changed):
    asked = getattr(_libsumo, f"{domain}_{getter}")
    def ask(*words):
        calls[domain] += 1
        return changed(asked(*words))
    setattr(_libsumo, f"{domain}_{getter}", ask)

for domain in ("vehicle", "person"):
    turned = change == "turned"
    counted(domain, "getAngle", (lambda angle: angle + 90) if turned else (lambda angle: angle))
if change == "nowhere":
    _libsumo.__file__ = "/nowhere/_libsumo.so"
versions = {"older": "SUMO 1.27.0", "unknown": "SUMO 99.0.0"}
if change in versions:
    _libsumo.simulation_getVersion = lambda: (23, versions[change])
libsumo.start(["sumo", "-c", config, "--no-warnings", *more])
checker = closecall.Checker(libsumo, out=out, log_series=True, epsilon=10.0)
entered, steps, teleports, rides = collections.Counter(), collections.Counter(), 0, 0
domains = {"vehicle": libsumo.vehicle, "person": libsumo.person}
while libsumo.simulation.getMinExpectedNumber() > 0 and libsumo.simulation.getTime() < float(end):
    libsumo.simulationStep()
    checker.step()
    for name, domain in domains.items():
        steps[name] += domain.getIDCount()
    entered["vehicle"] += libsumo.simulation.getDepartedNumber()
    entered["person"] += libsumo.simulation.getDepartedPersonNumber()
    teleports += libsumo.simulation.getStartingTeleportNumber()
    rides += sum(bool(libsumo.person.getVehicle(person)) for person in libsumo.person.getIDList())
asked, taken = dict(calls), libsumo.vehicle.getIDList()[:1]
for vehicle in taken:
    libsumo.vehicle.remove(vehicle)
for _ in range(2):
    libsumo.simulationStep()
    assert checker.step()
libsumo.load(["-c", config, "--no-warnings"])
libsumo.simulationStep()
assert not checker.step()
checker.close()
libsumo.close()
seen = {"steps": steps, "teleports": teleports, "rides": rides, "getters": checker.getters}
print(json.dumps({"calls": asked, "entered": entered, "taken": taken, **seen}))
"""
"""Counts calls of Python's getter of the angle. `turned`: it returns another angle than C++. `nowhere`: the module is
not at the path that it states. `older`: of the module's version closecall knows only libsumo's interface. `unknown`: it
knows nothing of it. At the end the script removes a vehicle (its id is then unknown) and loads the simulation again."""

SCENES = [("bridge", 60), ("pedestrian", 60), ("crowd", 165), ("town", 10)]
"""Scenes with roads on two levels, with pedestrians, with bus passengers, and with all kinds of vehicles."""


def checked(scene: str, end: int, out: Path, change: str = "none", *more: str) -> dict[str, Any]:
    """Check a scene, with more options for SUMO, and return the counts that the script prints."""
    done = python(CHECK, NETS / scene / f"{scene}.sumocfg", out, str(end), change, *more)
    assert done.returncode == 0, done.stderr
    asked: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return {**asked, "said": [line for line in done.stderr.splitlines() if "SUMO" in line]}


def logged(out: Path) -> list[bytes]:
    """The files of a log."""
    return [(out / name).read_bytes() for name in ("conflicts.csv", "series.csv")]


needs_compiled = pytest.mark.skipif(
    not sys.platform.startswith("linux") or shutil.which("c++") is None,
    reason="libsumo's C++ functions are called on Linux only, where closecall was built with a C++ compiler",
)
# A package of the system, which .ci/run installs.
needs_valgrind = pytest.mark.skipif(
    shutil.which("valgrind") is None, reason="valgrind is not installed: apt install valgrind"
)


@needs_compiled
@pytest.mark.parametrize(("scene", "end"), SCENES)
def test_every_interface_of_libsumo_gives_the_same_states(scene: str, end: int, tmp_path: Path) -> None:
    compiled = checked(scene, end, tmp_path / "compiled")
    of_older = checked(scene, end, tmp_path / "older", "older")
    through_python = checked(scene, end, tmp_path / "python", "nowhere")
    assert [run["getters"] for run in (of_older, through_python)] == ["libsumo", "python"]
    assert logged(tmp_path / "compiled") == logged(tmp_path / "older") == logged(tmp_path / "python")
    assert compiled["calls"] == of_older["calls"]
    # A vehicle is removed at the end, where one is left; then its id is unknown.
    assert compiled["taken"] == of_older["taken"] == through_python["taken"]
    assert compiled["taken"] or scene in ("bridge", "pedestrian")
    assert logged(tmp_path / "compiled")[1].count(b"\n") > 1
    assert scene == "bridge" or compiled["steps"]["person"] > 0
    assert (compiled["rides"] > 0) == (scene == "crowd")
    for domain, asked in compiled["calls"].items():
        assert asked <= compiled["entered"][domain]
        assert through_python["calls"][domain] > asked


def test_a_teleporting_vehicle_is_absent_through_every_interface(tmp_path: Path) -> None:
    for change in ("none", "older", "nowhere"):
        counted = checked("signals", 120, tmp_path / change, change, "--time-to-teleport", "2")
        assert counted["teleports"] > 0
    assert logged(tmp_path / "none") == logged(tmp_path / "older") == logged(tmp_path / "nowhere")


ANNOUNCED = "SUMO 99.0.0: closecall does not know its C++ functions and reads through Python, which takes longer"

COMMAND = """
import sys
from libsumo import _libsumo
_libsumo.simulation_getVersion = lambda: (23, "SUMO 99.0.0")
from closecall._closecall import main
sys.exit(main(["closecall", "run", *sys.argv[1:]]))
"""


@needs_compiled
def test_an_unverified_sumo_is_read_through_python_and_announced_once(tmp_path: Path) -> None:
    counted = checked("reckless", 30, tmp_path / "unknown", "unknown")
    assert (counted["getters"], counted["said"]) == ("python", [f"closecall: {ANNOUNCED}"])
    assert counted["calls"]["vehicle"] >= counted["steps"]["vehicle"] > 0
    verified = checked("reckless", 30, tmp_path / "same")
    assert (verified["getters"], verified["said"]) == ("direct", [])
    assert logged(tmp_path / "unknown") == logged(tmp_path / "same")
    scenario = NETS / "reckless" / "reckless.sumocfg"
    for words, lines in ((), 1), (("--quiet",), 0):
        done = python(COMMAND, scenario, "--end", "30", "--out", tmp_path / "run", *words)
        assert done.returncode == 0, done.stderr
        assert done.stderr.count(f"closecall: {ANNOUNCED}\n") == lines


@needs_compiled
def test_a_known_sumo_exports_the_functions_called_directly() -> None:
    sources = Path(__file__).parents[2] / "bridge/src/sumo"
    known = re.findall(r'\("(SUMO .*)", Verified::Behind\)', (sources / "compiled.rs").read_text())
    names = re.findall(r'find\(direct\.\w+, "(\w+)"\)', (sources / "compiled.cpp").read_text())
    ask = "from libsumo import _libsumo; print(_libsumo.__file__); print(_libsumo.simulation_getVersion()[1])"
    file, version = python(ask).stdout.splitlines()[-2:]
    missing = [name for name in names if not hasattr(ctypes.CDLL(file), name)]
    assert len(names) == 11
    assert known and not (version in known and missing)


@needs_compiled
def test_python_getters_decide_where_compiled_ones_disagree(tmp_path: Path) -> None:
    turned = checked("pedestrian", 60, tmp_path / "turned", "turned")
    assert turned["calls"]["vehicle"] >= turned["steps"]["vehicle"] > 0
    assert turned["getters"] == "python"
    (line,) = turned["said"]
    assert "its C++ functions and Python's differ" in line
    checked("pedestrian", 60, tmp_path / "same")
    assert logged(tmp_path / "turned") != logged(tmp_path / "same")


@needs_compiled
@needs_valgrind
def test_valgrind_finds_no_fault_in_compiled_calls(tmp_path: Path) -> None:
    # All in one process, as valgrind takes 13 s to import libsumo.
    script = f"{CHECK}\nfrom closecall._closecall import main\n"
    for scene, end in (("signals", "60"), ("town", "8")):
        run = [
            "closecall",
            "run",
            NETS / scene / f"{scene}.sumocfg",
            "--end",
            end,
            "--out",
            tmp_path / scene,
            "--quiet",
        ]
        sumo = ["--tripinfo-output", tmp_path / f"{scene}.xml", "--time-to-teleport", "2", "--no-warnings"]
        script += f"assert main({[str(word) for word in (*run, '--', *sumo)]}) == 0\n"
    output = under_valgrind(tmp_path, "-c", script, NETS / "crowd" / "crowd.sumocfg", tmp_path / "out", "10", "none")
    asked = json.loads(output[output.index("{") :].splitlines()[0])
    assert asked["taken"]
    assert asked["steps"]["person"] > asked["calls"]["person"]
    for scene, left in (("signals", 5), ("town", 1)):
        assert json.loads((tmp_path / scene / "run.json").read_text())["complete"]
        # SUMO deletes a vehicle that has left, so that a pointer kept to it would dangle.
        assert len(ET.parse(tmp_path / f"{scene}.xml").getroot()) >= left


def under_valgrind(folder: Path, *words: object) -> str:
    """Run Python under valgrind, expect no error in closecall's calls, and return what Python prints."""
    errors = folder / "errors.xml"
    valgrind = ["valgrind", "--leak-check=full", "--xml=yes", f"--xml-file={errors}", sys.executable]
    # Python's own allocator would hide reads beyond the end of a block.
    environment = {**os.environ, "PYTHONMALLOC": "malloc"}
    command = [*valgrind, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=2 * TIMEOUT, check=False, env=environment)
    assert done.returncode == 0, done.stderr
    found = [error for error in ET.parse(errors).getroot().findall("error") if is_ours(error)]
    assert [ET.tostring(error, encoding="unicode") for error in found] == []
    return done.stdout


def is_ours(error: ET.Element) -> bool:
    """Whether closecall is in the stack of an error; blocks that are only possibly lost do not count."""
    objects = [frame.findtext("obj", "") for frame in error.iter("frame")]
    return error.findtext("kind") != "Leak_PossiblyLost" and any("_closecall" in name for name in objects)
