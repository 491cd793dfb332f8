"""`closecall extract`: a conflict as a scenario of its own, in which it happens again."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Callable

from conftest import closecall, is_one_message, rows

Copy = Callable[[str], Path]


def test_a_conflict_comes_back_in_a_folder_of_its_own(scenario: Copy, tmp_path: Path) -> None:
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
    again = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", out], capture_output=True, text=True
    )
    assert "1 passed" in again.stdout, again.stdout
    assert f"pytest.approx({float(wanted['margin'])!r}, abs=1e-6)" in (out / "test_conflict.py").read_text()
    refused = closecall("extract", log, wanted["id"], "--out", out)
    assert refused.returncode == 2 and "it is not empty" in refused.stderr and is_one_message(refused.stderr)
    refused = closecall("extract", log, wanted["id"], "--out", tmp_path / "new")
    assert refused.returncode == 2 and "left_turn.sumocfg, which its run read, is gone" in refused.stderr
    refused = closecall("extract", log, "999", "--out", tmp_path / "new")
    assert refused.returncode == 2 and "has no conflict 999" in refused.stderr and is_one_message(refused.stderr)
    assert not (tmp_path / "new").exists()
