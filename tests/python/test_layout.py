"""The check of imports that `make lint` runs: it finds what it is there for."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of the sources, to plant faults in."""
    for folder in ("src", "crates", "bridge"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    return tmp_path


def check(tree: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / ".ci/imports.py"), str(tree)]
    return subprocess.run(command, capture_output=True, text=True)


def plant(path: Path, line: str) -> None:
    path.write_text(path.read_text(encoding="utf-8") + line + "\n", encoding="utf-8")


def test_the_layout_has_no_circle_and_no_upward_import() -> None:
    assert check(ROOT).returncode == 0


def test_a_planted_upward_import_is_found(tree: Path) -> None:
    plant(tree / "src/geometry/contact.rs", "use crate::events::Tracker;")
    found = check(tree)
    assert found.returncode == 1
    assert "contact.rs: imports events::tracker, which stands above it" in found.stdout


def test_a_planted_circle_is_found(tree: Path) -> None:
    plant(tree / "src/geometry/exact.rs", "fn circle() { super::contact::touches; }")
    found = check(tree)
    assert found.returncode == 1
    assert "a circle of imports: geometry::contact -> geometry::exact" in found.stdout


def test_a_folder_without_a_layer_is_found(tree: Path) -> None:
    (tree / "src/other.rs").write_text("//! Elsewhere.\n", encoding="utf-8")
    found = check(tree)
    assert found.returncode == 1
    assert "no layer" in found.stdout


def test_a_planted_circle_in_python_is_found(tree: Path) -> None:
    plant(tree / "bridge/python/closecall/sweep_run.py", "from .sweep import results")
    found = check(tree)
    assert found.returncode == 1
    assert "a circle of imports: sweep -> sweep_cluster, sweep_run" in found.stdout
