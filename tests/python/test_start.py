"""A command imports only what it needs, so that it starts at once."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SLOW = {"numpy", "libsumo", "traci", "sumolib", "dask"}
"""Modules that take 0.1 s and more to import."""


@pytest.mark.parametrize("command", ["--version", "mu", "stats", "plot", "report", "export"])
def test_a_command_without_sumo_imports_no_slow_module(command: str, town: Path, tmp_path: Path) -> None:
    log = str(town / "log")
    words = {
        "mu": ["--speed", "14", "--foe-speed", "0"],
        "stats": [log],
        "plot": [log, "-o", str(tmp_path / "plots")],
        "report": [log, "-o", str(tmp_path / "report.html")],
        "export": [log, "--format", "poi", "-o", str(tmp_path / "poi.xml")],
    }
    run = [sys.executable, "-X", "importtime", "-m", "closecall", command, *words.get(command, [])]
    done = subprocess.run(run, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr[-500:]
    imported = {line.rsplit("|", 1)[-1].strip() for line in done.stderr.splitlines() if line.startswith("import time:")}
    assert "closecall._closecall" in imported
    assert not imported & SLOW
