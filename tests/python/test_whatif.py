"""`closecall whatif`: roll-outs of real runs, compared with kinematics and with themselves."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest
from conftest import NETS, Once, Row, begin, closecall, is_one_message, rows, until

ROLL_OUTS = "60"

NODES = '<nodes><node id="a" x="0" y="0"/><node id="b" x="1000" y="0"/></nodes>'
EDGES = '<edges><edge id="ab" from="a" to="b" numLanes="1" speed="20"/></edges>'
ROUTES = """<routes><vType id="car" sigma="0" decel="6" maxSpeed="15" length="5"/>
<vType id="late" sigma="0" decel="9" tau="0.3" speedFactor="1" maxSpeed="15" length="5"/><route id="r" edges="ab"/>
<vehicle id="leader" type="car" route="r" depart="0" departPos="30" departSpeed="15">
<stop lane="ab_0" endPos="500" duration="100"/></vehicle>
<vehicle id="follower" type="late" route="r" depart="20" departPos="10" departSpeed="15"/></routes>"""
CONFIGURATION = """<configuration><net-file value="a.net.xml"/><route-files value="a.rou.xml"/><end value="70"/>
<step-length value="0.1"/><step-method.ballistic value="true"/></configuration>"""


@pytest.fixture(scope="module")
def follower(once: Once) -> Path:
    """A folder with the log of a car that approaches a standing car, and its roll-outs."""

    def fill(folder: Path) -> None:
        for name, text in (("nod", NODES), ("edg", EDGES), ("rou", ROUTES)):
            (folder / f"a.{name}.xml").write_text(text)
        (folder / "a.sumocfg").write_text(CONFIGURATION)
        files = ["-n", "a.nod.xml", "-e", "a.edg.xml", "-o", "a.net.xml"]
        netconvert = Path(sys.executable).with_name("netconvert")
        subprocess.run([netconvert, *files], cwd=folder, check=True, capture_output=True)
        run = closecall("run", folder / "a.sumocfg", "--out", folder / "log", "--quiet")
        assert run.returncode == 0, run.stderr
        asked = closecall("whatif", folder / "log", "--rollouts", ROLL_OUTS, "--out", folder / "whatif", "--quiet")
        assert asked.returncode == 0, asked.stderr

    return once("follower", fill)


def answers(folder: Path) -> list[Row]:
    return rows(folder / "whatif.csv")


def outcomes(folder: Path, arm: str) -> dict[str, bytes]:
    """What came of the roll-outs of an arm, by their names."""
    return {path.parent.name: path.read_bytes() for path in folder.glob(f"series/*_{arm}-*/roll-out.json")}


def test_a_roll_out_ends_as_its_drivers_kinematics_say(follower: Path) -> None:
    crashed = 0
    for text in outcomes(follower / "whatif", "error").values():
        outcome = json.loads(text)
        error = outcome["drivers"][0]
        response, deceleration = error["response"], error["deceleration"]
        # 15 m/s, 0.1 s until the brakes hold, 29 m to a car that stands.
        left = 29.0 - 15.0 * (response + 0.05) - 15.0**2 / (2.0 * deceleration)
        has_contact = outcome["contact"] is not None
        # Overlaps of up to 0.25 m are grazes, and a step ends up to 5 cm later.
        if left > 0.0 or left < -0.3:
            assert has_contact == (left < 0.0), error
        crashed += has_contact
    assert crashed == int(answers(follower / "whatif")[0]["contacts"]) > 0


def test_share_integral_and_formula_agree(follower: Path) -> None:
    answer = answers(follower / "whatif")[0]
    assert answer["roll_outs"] == ROLL_OUTS
    assert float(answer["drift"]) < 1e-6

    def later_than(wait: float) -> float:
        spread = math.log1p((0.28 / 0.92) ** 2)
        above = math.log(max(wait, 1e-9)) - math.log(0.92) + spread / 2.0
        return math.erfc(above / math.sqrt(2.0 * spread)) / 2.0

    weights = {a / 100: math.exp(-(((a / 100 - 8.45) / 1.42) ** 2) / 2.0) for a in range(423, 1269)}
    waits = {a: (29.0 - 15.0**2 / (2.0 * a)) / 15.0 - 0.05 for a in weights}
    integral = sum(later_than(waits[a]) * weight for a, weight in weights.items()) / sum(weights.values())
    assert abs(float(answer["crash_probability_at_opening"]) - integral) < 0.01
    assert float(answer["low"]) < integral < float(answer["high"])


def test_the_same_command_does_nothing_again(follower: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in (follower / "whatif" / "conflicts").rglob("*.parquet")}
    again = closecall("whatif", follower / "log", "--rollouts", ROLL_OUTS, "--out", follower / "whatif", "--quiet")
    assert (again.returncode, again.stderr) == (0, "")
    assert before == {path: path.stat().st_mtime_ns for path in (follower / "whatif" / "conflicts").rglob("*.parquet")}


def test_a_killed_whatif_ends_with_the_bytes_of_a_whole_one(follower: Path, tmp_path: Path) -> None:
    words = ("whatif", follower / "log", "--rollouts", "8", "--out", tmp_path / "killed", "--quiet")
    with begin(*words) as process:
        until(lambda: len(outcomes(tmp_path / "killed", "error")) >= 2)
        os.killpg(process.pid, signal.SIGKILL)
    assert closecall(*words).returncode == 0
    known = outcomes(follower / "whatif", "error")
    found = outcomes(tmp_path / "killed", "error")
    assert len(found) == 8 and all(known[name] == text for name, text in found.items())
    assert answers(tmp_path / "killed")[0]["roll_outs"] == "8"


def test_a_roll_out_that_crashes_is_lost_and_named(follower: Path, tmp_path: Path) -> None:
    def third(process: psutil.Process) -> list[psutil.Process]:
        return [child for child in process.children() if any('"id"' in word for word in words_of(child))]

    with begin("whatif", follower / "log", "--rollouts", "4", "--workers", "1", "--out", tmp_path / "lost") as process:
        parent = psutil.Process(process.pid)
        for _ in range(2):
            until(lambda: third(parent))
            victim = third(parent)[0]
            victim.kill()
            victim.wait()
        said = process.communicate(timeout=120)
    assert process.returncode == 1
    assert "failed twice: killed by signal 9" in said[1]
    answer = answers(tmp_path / "lost")[0]
    assert (answer["roll_outs"], answer["lost"]) == ("3", "1")
    assert "1 roll-out lost" in said[0]


def words_of(process: psutil.Process) -> list[str]:
    """The words of a process; none where it has just ended."""
    try:
        return process.cmdline()
    except psutil.Error:
        return []


def test_the_page_shows_paths_and_clips(follower: Path) -> None:
    page = (follower / "whatif" / "whatif.html").read_text()
    assert page.count("<polyline") > 2 * int(ROLL_OUTS)
    assert "A roll-out with a contact" in page and "A roll-out without" in page


def test_a_person_and_a_vehicle_are_rolled_out(tmp_path: Path) -> None:
    log = tmp_path / "log"
    config = NETS / "crowd" / "crowd.sumocfg"
    assert closecall("run", config, "--end", "120", "--out", log, "--quiet", "--", "--no-warnings").returncode == 0
    with_person = [row for row in rows(log / "conflicts.csv") if "p" in (row["ego"][0], row["foe"][0])]
    with_person = [row for row in with_person if not row["artefact"] and float(row["begin"]) > 20.0]
    ids = [row["id"] for row in sorted(with_person, key=lambda row: -float(row["crash_probability"] or 0))[:2]]
    asked = closecall("whatif", log, *ids, "--rollouts", "6", "--from", "worst", "--out", tmp_path / "whatif")
    assert asked.returncode == 0, asked.stderr
    assert sum(int(answer["contacts"]) for answer in answers(tmp_path / "whatif")) > 0
    assert [answer["conflict"] for answer in answers(tmp_path / "whatif")] == ids
    for text in outcomes(tmp_path / "whatif", "error").values():
        # The vehicle's driver errs; the person is never steered.
        assert len(json.loads(text)["persons"]) == 1 and json.loads(text)["drivers"][0]["response"] > 0.0


def test_states_and_whole_runs_end_in_the_same_contacts(tmp_path: Path) -> None:
    log, config = tmp_path / "log", NETS / "left_turn" / "left_turn.sumocfg"
    assert closecall("run", config, "--end", "100", "--out", log, "--quiet", "--", "--no-warnings").returncode == 0
    for out, more in (("states", ()), ("exact", ("--exact",))):
        words = ("--worst", "3", "--rollouts", "4", "--out", tmp_path / out, "--quiet", *more)
        asked = closecall("whatif", log, *words)
        assert asked.returncode == 0, asked.stderr
    contacts = [
        {name: json.loads(text)["contact"] for name, text in outcomes(tmp_path / out, "error").items()}
        for out in ("states", "exact")
    ]
    drifts = {answer["conflict"]: float(answer["drift"]) for answer in answers(tmp_path / "states")}
    assert all(float(answer["drift"]) == 0.0 for answer in answers(tmp_path / "exact"))
    same = [name for name in contacts[0] if drifts[name.split("conflict-")[1].split("_")[0]] < 1e-6]
    assert same and all(contacts[0][name] == contacts[1][name] for name in same)
    assert len({contact is None for contact in contacts[1].values()}) == 2


def test_what_a_state_loses_is_rolled_out_exactly(tmp_path: Path) -> None:
    config, log = NETS / "obstacles" / "obstacles.sumocfg", tmp_path / "log"
    assert closecall("run", config, "--out", log, "--quiet", "--", "--no-warnings").returncode == 0
    for more, roll_outs in (((), "0"), (("--exact",), "2")):
        asked = closecall("whatif", log, "1", "--rollouts", "2", "--out", tmp_path / "whatif", *more)
        assert asked.returncode == 0, asked.stderr
        assert answers(tmp_path / "whatif")[0]["roll_outs"] == roll_outs
        assert ("try --exact" in asked.stdout) == (roll_outs == "0")


@pytest.mark.parametrize("error", ["gap", "signal"])
def test_other_errors_run_too(follower: Path, tmp_path: Path, error: str) -> None:
    out = tmp_path / "whatif"
    asked = closecall("whatif", follower / "log", "--rollouts", "2", "--error", error, "--draws", "new", "--out", out)
    assert asked.returncode == 0, asked.stderr
    assert f"error: {error}" in (out / "whatif.html").read_text()


def test_what_cannot_be_rolled_out_is_one_line(follower: Path, tmp_path: Path) -> None:
    for words, said in [
        (("7",), "has no conflict 7"),
        (("--driver", "nobody"), "neither a file nor one of attentive, distracted, crash-involved"),
        (("--rollouts", "0"), "0 is not in 1..=100000"),
        (("--exact", "--draws", "new"), "with another seed from its beginning on, it is another run"),
    ]:
        refused = closecall("whatif", follower / "log", *words, "--out", tmp_path / "refused")
        assert refused.returncode == 2 and said in refused.stderr and is_one_message(refused.stderr), refused.stderr
