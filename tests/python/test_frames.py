"""Plain frames that are refused: what they leave behind, and what the error says."""

from __future__ import annotations

import datetime
import json
import threading
from pathlib import Path
from typing import Any, Callable

import closecall as cc
import numpy as np
import pytest
from conftest import python, rows

Copy = Callable[[str], Path]

PAIR: dict[str, Any] = {
    "id": ["a", "b"],
    "x": [0.0, 20.0],
    "y": [0.0, 0.0],
    "heading": [0.0, 0.0],
    "speed": [20.0, 5.0],
}


def driven(checker: cc.Checker, step: int) -> None:
    """A step of two cars, of which one drives up to the other."""
    checker.step(step / 10, {**PAIR, "x": [2.0 * step, 20.0 + 0.5 * step]})


@pytest.mark.parametrize(
    "bad",
    [
        {"x": [0.0, np.nan]},
        {"x": [0.0, 1e300]},
        {"y": [np.inf, 0.0]},
        {"speed": [-1.0, 5.0]},
        {"heading": [0.0]},
        {"id": ["c", "c"]},
        {"id": ["c", "d"], "mass": [1500.0, -1.0]},
        {"id": ["c", "d"], "length": [5.0, 1e12]},
        {"id": ["c", "d"], "category": ["person", "obstacle"]},
    ],
)
def test_a_frame_that_is_refused_changes_nothing(bad: dict[str, Any]) -> None:
    with cc.Checker() as with_bad, cc.Checker() as without:
        for step in range(20):
            if step in (0, 7):
                with pytest.raises(ValueError):
                    with_bad.step(step / 10, {**PAIR, **bad})
            driven(with_bad, step)
            driven(without, step)
    assert with_bad.summary == without.summary
    assert with_bad.conflicts == without.conflicts != []


def test_a_row_that_is_no_place_is_named() -> None:
    with pytest.raises(ValueError, match='"b": x is NaN'):
        cc.Checker().step(0.0, {**PAIR, "x": [0.0, np.nan]})


def test_the_same_time_twice_is_refused() -> None:
    checker = cc.Checker()
    checker.step(0.1, PAIR)
    with pytest.raises(ValueError, match=r"time is 0\.1, after 0\.1"):
        checker.step(0.1, PAIR)
    assert checker.summary["steps"] == 1


NO_NUMBERS = {
    "masked": np.ma.array([0.0, 20.0], mask=[False, True]),
    "complex": np.array([0.0, 20.0 + 1j]),
    "datetime": np.array(["2026-01-01", "2026-01-02"], dtype="datetime64[s]"),
    "timedelta": np.array([0, 20], dtype="timedelta64[s]"),
    "text": np.array(["0", "20"]),
}


@pytest.mark.parametrize("kind", NO_NUMBERS)
def test_what_holds_no_real_numbers_is_refused(kind: str) -> None:
    values = NO_NUMBERS[kind]
    message = "masked array" if kind == "masked" else "must be of real numbers"
    with pytest.raises(ValueError, match=f'"x" is .*{message}'):
        cc.Checker().step(0.0, {**PAIR, "x": values})
    with pytest.raises(ValueError, match=f'"speed" is .*{message}'):
        cc.mu(values, 5.0)
    with pytest.raises(ValueError, match=message):
        cc.geometry.touches(np.ma.array([values] * 5) if kind == "masked" else np.array([values] * 5), [[0.0] * 5])


def test_objects_that_are_no_numbers_are_refused() -> None:
    with pytest.raises(TypeError, match="datetime"):
        cc.Checker().step(0.0, {**PAIR, "x": [datetime.datetime(2026, 1, 1), datetime.datetime(2026, 1, 2)]})


def test_masked_ids_are_refused() -> None:
    with pytest.raises(ValueError, match='"id" is a masked array'):
        cc.Checker().step(0.0, {**PAIR, "id": np.ma.array(["a", "b"], mask=[False, True])})


class Broken(dict[str, Any]):
    """A mapping with a fault of its own."""

    def __getitem__(self, name: str) -> Any:
        if name == self.get("fails"):
            raise ZeroDivisionError(name)
        return super().__getitem__(name)

    def keys(self) -> Any:
        if self.get("fails") == "keys":
            raise ZeroDivisionError("keys")
        return [name for name in list(self) if name != "fails"]


@pytest.mark.parametrize("fails", ["keys", "id", "x", "mass"])
def test_an_exception_in_a_mapping_comes_out_as_itself(fails: str) -> None:
    with pytest.raises(ZeroDivisionError, match=fails):
        cc.Checker().step(0.0, Broken(PAIR, mass=[1500.0, 1500.0], fails=fails))


class Shrinking(dict[str, Any]):
    """A mapping that resizes one column when another one is asked for."""

    def __getitem__(self, name: str) -> Any:
        if name == "mass":
            super().__getitem__("x").resize(0, refcheck=False)
        return super().__getitem__(name)


def test_an_array_that_shrinks_meanwhile_is_refused() -> None:
    shrinking = Shrinking(PAIR, x=np.array([0.0, 20.0]), mass=np.full(2, 1500.0))
    with pytest.raises(ValueError, match='"x" changed its length'):
        cc.Checker().step(0.0, shrinking)


def test_a_structured_array_keeps_its_optional_columns() -> None:
    table: Any = np.zeros(2, dtype=[(name, "U1" if name == "id" else "f8") for name in [*PAIR, "length"]])
    for name, values in PAIR.items():
        table[name] = values
    table["length"] = [4.0, 3.0]
    with cc.Checker() as checker:
        checker.step(0.0, table)
    assert [(conflict.ego_length, conflict.foe_length) for conflict in checker.conflicts] == [(4.0, 3.0)]


def test_reading_conflicts_in_a_thread_never_fails_a_step() -> None:
    checker, ends, faults = cc.Checker(), threading.Event(), []

    def read() -> None:
        while not ends.is_set():
            try:
                assert len(checker.conflicts) <= checker.summary["steps"] + 1
            except Exception as fault:
                faults.append(fault)

    readers = [threading.Thread(target=read) for _ in range(3)]
    for reader in readers:
        reader.start()
    for step in range(200):
        driven(checker, step)
    ends.set()
    for reader in readers:
        reader.join()
    assert faults == [] and checker.summary["steps"] == 200


class Curious(dict[str, Any]):
    """A mapping that asks its own checker."""

    checker: cc.Checker

    def __getitem__(self, name: str) -> Any:
        self.found = self.checker.conflicts
        return super().__getitem__(name)


def test_a_mapping_may_ask_its_own_checker() -> None:
    curious = Curious(PAIR)
    curious.checker = cc.Checker()
    curious.checker.step(0.0, curious)
    curious.checker.step(0.1, curious)
    assert len(curious.found) == 1


def test_only_the_latest_conflicts_are_kept_if_so_wanted(tmp_path: Path) -> None:
    with cc.Checker(out=tmp_path, keep=2, artefacts=True) as checker:
        for step in range(5):
            foe = {**PAIR, "id": [f"a{step}", f"b{step}"]}
            checker.step(step * 10.0, foe)
    logged = [(row["id"], row["ego"]) for row in rows(tmp_path / "conflicts.csv")]
    assert len(logged) == 5
    assert [(str(conflict.id), conflict.ego) for conflict in checker.conflicts] == logged[-2:]
    assert checker.summary["conflicts"][0]["count"] == 5


def test_a_listener_gets_conflicts_that_are_not_kept() -> None:
    found: list[cc.Conflict] = []
    with cc.Checker(keep=0, artefacts=True, on_conflict=found.append) as checker:
        for step in range(5):
            checker.step(step * 10.0, {**PAIR, "id": [f"a{step}", f"b{step}"]})
    assert [conflict.id for conflict in found] == [1, 2, 3, 4, 5] and checker.conflicts == []


FULL = """
import json, resource, sys, warnings
import closecall
checker = closecall.Checker(out=sys.argv[1], log_series=True)
def step(number):
    zeros = [0.0, 0.0]
    pair = {"id": [f"a{number}", f"b{number}"], "x": [0.0, 20.0], "y": zeros, "heading": zeros, "speed": [20.0, 5.0]}
    checker.step(number * 10.0, pair)
step(0), step(1)
assert checker.log_error is None
most = resource.getrlimit(resource.RLIMIT_FSIZE)
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    # A write beyond this size fails, as it does on a full disk.
    resource.setrlimit(resource.RLIMIT_FSIZE, (3000, most[1]))
    for number in range(2, 12): step(number)
    # The disk has room again.
    resource.setrlimit(resource.RLIMIT_FSIZE, most)
    for number in range(12, 20): step(number)
    checker.close()
print(json.dumps([len(checker.conflicts), checker.log_error, [str(warning.message) for warning in caught]]))
"""


def test_a_log_ends_where_its_disk_was_full(tmp_path: Path) -> None:
    done = python(FULL, tmp_path / "log")
    assert done.returncode == 0, done.stderr
    found, error, warned = json.loads(done.stdout)
    assert found == 20, "the checker goes on"
    written = rows(tmp_path / "log" / "conflicts.csv")
    assert [row["id"] for row in written] == [str(number + 1) for number in range(len(written))]
    assert 0 < len(written) < 12
    assert "conflicts.csv: " in error and error.endswith(f"the last whole row of the log is {len(written)}")
    assert len(warned) == 1 and warned[0].endswith("the checker goes on, but its log ends here")
    record = json.loads((tmp_path / "log" / "run.json").read_text())
    assert (record["complete"], record["error"]) == (False, error)
