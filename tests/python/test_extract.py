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
        "left_turn.net.xml",
        "state.xml.gz",
        "test_conflict.py",
    ]
    assert (out / "README.md").read_text().count("\n") == 6
    for path in config.parent.iterdir():
        path.unlink()
    check = runpy.run_path(str(out / "test_conflict.py"))["test_the_conflict_is_still_there"]
    check(lambda name: closecall_scenario(out / name))
    assert f"pytest.approx({float(wanted['margin'])!r}, abs=1e-6)" in (out / "test_conflict.py").read_text()
