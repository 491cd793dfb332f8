"""Live runs that are recorded, and replays that are compared with them."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Callable

import pytest
from conftest import Row, closecall

Done = subprocess.CompletedProcess[str]

FULL = ("--fcd-output.attributes", "all", "--precision", "9")


def record(
    config: Path, name: str, *words: str, sumo: tuple[str, ...] = (), run: Callable[..., Done] = closecall
) -> Path:
    """Run a scenario live and record it, with these words for SUMO; its log is in the folder `live` beside it."""
    recording = config.parent / name
    log = config.parent / "live"
    done = run("run", config, *words, "--quiet", "--out", log, "--", "--fcd-output", recording, *FULL, *sumo)
    assert done.returncode == 0, done.stderr
    return recording


def replay(config: Path, recording: Path, out: Path, *words: str) -> tuple[int, str]:
    """Exit status and messages of a replay, without those on how the net is drawn and how long the steps are."""
    net, routes = config.with_suffix(".net.xml"), config.with_suffix(".rou.xml")
    done = closecall("replay", recording, "--net", net, "--route-files", routes, "--out", out, *words)
    opening = ("drawn", "steps of")
    return done.returncode, "".join(
        line for line in done.stderr.splitlines(keepends=True) if not any(part in line for part in opening)
    )


def same(live: list[Row], again: list[Row], within: float = 2e-6) -> None:
    """Equal, numbers within two units in the log's last place."""
    texts = ("ego", "foe", "ego_type", "foe_type", "kind", "severity", "lane", "collision")
    assert [[row[name] for name in texts] for row in again] == [[row[name] for name in texts] for row in live]
    for name in ("begin", "end", "time", "gap", "mu", "margin", "clearance", "ttc", "pet", "angle", "x", "y"):
        for one, other in zip(live, again):
            if one[name]:
                assert float(other[name]) == pytest.approx(float(one[name]), abs=within), (name, one, other)
            else:
                assert not other[name]
