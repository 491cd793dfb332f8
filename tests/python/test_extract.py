"""`closecall extract`: a conflict as a scenario of its own, in which it happens again."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any, Callable

from conftest import closecall, rows

Copy = Callable[[str], Path]


def test_a_conflict_comes_back_in_a_folder_of_its_own(scenario: Copy, closecall_scenario: Any, tmp_path: Path) -> None:
    config, log, out = scenario("left_turn"), tmp_path / "log", tmp_path / "cut" / "out"
    words = ("--end", "40", "--response-time", "1", "--", "--no-warnings", "--fcd-output", tmp_path / "fcd.xml")
    assert closecall("run", config, "--quiet", "--out", log, *words).returncode == 0
    wanted = rows(log / "conflicts.csv")[-1]
    done = closecall("extract", log, wanted["id"], "--out", out)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"conflict {wanted['id']} at {wanted['time']} s in {out}"), done.stdout
    assert sorted(path.name for path in out.iterdir()) == [
        "README.md",
        "closecall.toml",
        "conflict.sumocfg",
        "expected",
        "left_turn.net.xml",
        "state.xml.gz",
        "test_conflict.py",
    ]
    assert (out / "README.md").read_text().count("\n") == 6
    for path in config.parent.iterdir():
        path.unlink()
    compared = closecall("regress", out)
    assert compared.returncode == 0 and "byte for byte the same" in compared.stdout, compared.stdout + compared.stderr
    check = runpy.run_path(str(out / "test_conflict.py"))["test_the_conflict_is_still_there"]
    check(lambda name: closecall_scenario(out / name))
    assert f"pytest.approx({float(wanted['margin'])!r}, abs=1e-6)" in (out / "test_conflict.py").read_text()


def test_a_scenario_begins_where_the_run_did_if_no_state_leads_there(scenario: Copy, tmp_path: Path) -> None:
    config, log, out = scenario("pedestrian"), tmp_path / "log", tmp_path / "out"
    # SUMO reads routes a second ahead and one road user further, which here is this one. So the state, which is
    # saved 1.3 s before the car departs, lacks the car.
    other = '<person id="other" depart="5.7"><walk edges="west_in" arrivalPos="1"/></person>\n<vehicle id="car"'
    routes = config.with_name("pedestrian.rou.xml")
    routes.write_text(routes.read_text().replace('<vehicle id="car"', other))
    words = ("--end", "16", "--", "--no-warnings", "--route-steps", "1")
    assert closecall("run", config, "--quiet", "--out", log, *words).returncode == 0
    [wanted] = rows(log / "conflicts.csv")
    done = closecall("extract", log, wanted["id"], "--out", out)
    assert done.returncode == 0, done.stderr
    remark = "the scenario begins where the run did, since SUMO's saved state is not exact here"
    assert done.stderr == f'closecall: {remark}: "car" and "walker" are in no conflict\n'
    assert sorted(path.name for path in out.iterdir()) == [
        "README.md",
        "closecall.toml",
        "conflict.sumocfg",
        "expected",
        "pedestrian.net.xml",
        "pedestrian.rou.xml",
        "test_conflict.py",
    ]
    assert "`conflict.sumocfg` begins where the run did" in (out / "README.md").read_text()
