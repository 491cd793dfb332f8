"""A pytest plugin: the fixture `closecall_scenario` runs a SUMO scenario with the checker attached.

def test_nobody_is_hit_from_the_side(closecall_scenario):
    run = closecall_scenario("nets/crossing", end=300, seed=7)
    assert not [conflict for conflict in run.conflicts if conflict.kind == "side"]
"""

from __future__ import annotations

import csv
import json
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Protocol

import pytest

from . import _start
from ._closecall import scenario


@dataclass(frozen=True)
class ScenarioConflict:
    """A row of `conflicts.csv`: SI units, None where a measure does not exist."""

    ego: str
    foe: str
    kind: str
    severity: str
    begin: float
    end: float
    time: float
    gap: float
    mu: float
    margin: float
    clearance: float
    ttc: float | None
    drac: float | None
    pet: float | None
    delta_v: float
    ego_speed: float
    foe_speed: float
    angle: float
    x: float
    y: float
    lane: str | None
    collision: bool


@dataclass(frozen=True)
class ScenarioRun:
    """What a run of a scenario left in its log."""

    conflicts: list[ScenarioConflict]
    summary: dict[str, Any]
    log: Path


class RunScenario(Protocol):
    """The type of the fixture `closecall_scenario`."""

    def __call__(
        self, path: str | PathLike[str], *, sumo_options: Sequence[str] = (), **options: Any
    ) -> ScenarioRun: ...


@pytest.fixture
def closecall_scenario(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> RunScenario:
    """Run the scenario at a path: a folder, or a SUMO configuration, with the `closecall.toml` beside it.

    A relative path starts at the test's own folder. Options are those of `closecall run` with underscores; without a
    seed it is the first of the scenario's. libsumo allows one simulation per process, hence a process of its own.

    Raises:
        ValueError: the scenario or an option cannot be used, as the message says.
        RuntimeError: SUMO failed in mid-run.
    """

    def run(path: str | PathLike[str], *, sumo_options: Sequence[str] = (), **options: Any) -> ScenarioRun:
        folder, words, own_options, seed = scenario(str(request.path.parent / Path(path)))
        log = tmp_path_factory.mktemp("closecall")
        words += ["--quiet", "--out", str(log), f"--seed={seed}", *option_words(options)]
        command = [*_start.command("__main__"), *words, "--", *own_options, *sumo_options]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            lines = [line for line in done.stderr.splitlines() if line.startswith("closecall: ")]
            message = lines[-1].removeprefix("closecall: ") if lines else done.stderr
            raise (ValueError if done.returncode == 2 else RuntimeError)(message)
        return read(log)

    return run


def option_words(options: dict[str, Any]) -> list[str]:
    """Keywords as words of the command line."""
    words = []
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        if value is True:
            words.append(option)
        elif value is not False and value is not None:
            text = ",".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)
            words.append(f"{option}={text}")
    return words


def read(log: Path) -> ScenarioRun:
    """The log of a run."""
    with (log / "conflicts.csv").open(newline="", encoding="utf-8") as file:
        conflicts = [conflict(row) for row in csv.DictReader(file)]
    record = json.loads((log / "run.json").read_text(encoding="utf-8"))
    return ScenarioRun(conflicts, record["summary"], log)


def conflict(row: dict[str, str]) -> ScenarioConflict:
    """A row of the file with the types of its columns."""

    def maybe(column: str) -> float | None:
        return float(row[column]) if row[column] else None

    return ScenarioConflict(
        ego=row["ego"],
        foe=row["foe"],
        kind=row["kind"],
        severity=row["severity"],
        begin=float(row["begin"]),
        end=float(row["end"]),
        time=float(row["time"]),
        gap=float(row["gap"]),
        mu=float(row["mu"]),
        margin=float(row["margin"]),
        clearance=float(row["clearance"]),
        ttc=maybe("ttc"),
        drac=maybe("drac"),
        pet=maybe("pet"),
        delta_v=float(row["delta_v"]),
        ego_speed=float(row["ego_speed"]),
        foe_speed=float(row["foe_speed"]),
        angle=float(row["angle"]),
        x=float(row["x"]),
        y=float(row["y"]),
        lane=row["lane"] or None,
        collision=row["collision"] == "true",
    )
