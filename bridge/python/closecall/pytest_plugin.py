"""A pytest plugin: the fixture `closecall_scenario` runs a SUMO scenario with the checker attached.

def test_no_side_conflicts(closecall_scenario):
    run = closecall_scenario("nets/crossing", end=300, seed=7)
    assert not [conflict for conflict in run.conflicts if conflict.kind == "side"]
"""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Protocol

import pytest

from . import _start
from ._closecall import Conflict, read_log, scenario


@dataclass(frozen=True)
class ScenarioRun:
    """The log of a run of a scenario.

    `conflicts` has those that count, `set_aside` those that are not traffic's (docs/artefacts.md).
    The option `artefacts` counts all.
    """

    conflicts: list[Conflict]
    set_aside: list[Conflict]
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

    A relative path starts at the test's own folder. Options are those of `closecall run` with underscores; the default
    seed is the first of the scenario. Each run is a process, as libsumo allows one simulation per process.

    Raises:
        ValueError: the scenario or an option cannot be used; the message states why.
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
            raise (ValueError if done.returncode == 2 else RuntimeError)(in_keywords(message))
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


def in_keywords(message: str) -> str:
    """A message that names keywords where that of the command names its options, such as '--serious-ttc <S>'."""
    return re.sub(r"'--([a-z-]+)(?: <[^']*>)?'", lambda option: f'"{option[1].replace("-", "_")}"', message)


def read(log: Path) -> ScenarioRun:
    """The log of a run."""
    record = json.loads((log / "run.json").read_text(encoding="utf-8"))
    counts_all = record["options"].get("artefacts", False)
    parts: tuple[list[Conflict], list[Conflict]] = [], []
    for conflict in read_log(log):
        parts[conflict.artefact is not None and not counts_all].append(conflict)
    return ScenarioRun(*parts, record["summary"], log)
