"""The fixture `closecall_scenario`, as the tests of other projects use it."""

from __future__ import annotations

from pathlib import Path

import pytest
from closecall import Conflict
from closecall._closecall import read_log
from closecall.pytest_plugin import RunScenario
from conftest import NETS, rows

pytest_plugins = ["pytester"]


def test_plain_asserts_work_on_conflicts(closecall_scenario: RunScenario) -> None:
    run = closecall_scenario(NETS / "side")
    (conflict,) = run.conflicts
    assert (conflict.ego, conflict.foe, conflict.kind) == ("minor", "major", "side")
    assert conflict.margin < 0
    assert conflict.pet is not None and conflict.pet == pytest.approx(0.08, abs=0.02)
    assert conflict.ttc is None or conflict.ttc > 0
    assert not conflict.collision
    assert run.summary["collisions"] == 0


def test_a_conflict_has_an_attribute_for_every_column(closecall_scenario: RunScenario) -> None:
    run = closecall_scenario(NETS / "side", measures="all")
    (conflict,), (row,) = run.conflicts, rows(run.log / "conflicts.csv")
    assert [name for name in vars(Conflict) if not name.startswith("_")] == list(row)
    for column, cell in row.items():
        value = getattr(conflict, column)
        shown = "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
        assert shown == cell or float(shown) == float(cell), column
    (again,) = read_log(run.log)
    assert again == conflict and hash(again) == hash(conflict)


def test_options_and_the_scenarios_own_settings_apply(closecall_scenario: RunScenario) -> None:
    with_crate = closecall_scenario(NETS / "obstacles")
    assert "crate" in {conflict.foe for conflict in with_crate.conflicts}
    short = closecall_scenario(NETS / "rear_end" / "rear_end.sumocfg", end=5, epsilon=1.0, no_shortcuts=True)
    assert short.summary["end"] <= 5
    (conflict,) = short.conflicts
    (as_ever,) = closecall_scenario(NETS / "rear_end", end=5).conflicts
    assert conflict.mu == pytest.approx(as_ever.mu + 0.5)


def test_unusable_arguments_raise_named_errors(closecall_scenario: RunScenario, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="no_such_folder"):
        closecall_scenario("no_such_folder")
    with pytest.raises(ValueError, match='for "epsilon"'):
        closecall_scenario(NETS / "side", epsilon=-1)
    with pytest.raises(ValueError, match="sumocfg"):
        closecall_scenario(tmp_path)


def test_a_relative_path_starts_at_the_tests_folder(pytester: pytest.Pytester) -> None:
    nets = pytester.mkdir("nets")
    for file in (NETS / "frontal").iterdir():
        if file.is_file():
            (nets / file.name).write_bytes(file.read_bytes())
    pytester.makepyfile(
        """
        def test_frontal(closecall_scenario):
            run = closecall_scenario("nets")
            assert [conflict.kind for conflict in run.conflicts] == ["frontal"]

        def test_wrong(closecall_scenario):
            assert not closecall_scenario("nets").conflicts
        """
    )
    pytester.runpytest_subprocess().assert_outcomes(passed=1, failed=1)
