"""`closecall rare` on a junction whose drivers err often enough for plain simulation to measure the rate."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import NETS, Once, Row, closecall, is_one_message, rows

LEFT_TURN = NETS / "left_turn" / "left_turn.sumocfg"
ASKED = ("--share", "0.001", "--seeds", "1-3", "--conflicts", "3", "--rollouts", "3", "--quiet")


@pytest.fixture(scope="module")
def estimated(once: Once) -> Path:
    """A folder with an estimate of three short repetitions."""

    def fill(folder: Path) -> None:
        done = closecall("rare", LEFT_TURN, *ASKED, "--end", "80", "--out", folder / "rare", "--", "--no-warnings")
        assert done.returncode == 0, done.stderr

    return once("rare", fill)


def estimate(folder: Path) -> Row:
    return rows(folder / "rare.csv")[0]


def test_each_repetition_has_its_conflicts_rolled_out(estimated: Path) -> None:
    found = estimate(estimated / "rare")
    assert (found["repetitions"], found["rolled_out"], found["roll_outs"]) == ("3", "9", "27")
    assert float(found["low"]) <= float(found["per_hour"]) <= float(found["high"])
    assert float(found["plain_hours"]) > float(found["hours"])


def test_no_two_roll_outs_have_the_same_driver(estimated: Path) -> None:
    texts = [path.read_text() for path in (estimated / "rare").glob("*/series/*_error-*/roll-out.json")]
    drivers = [json.loads(text)["drivers"][0] for text in texts]
    erred = [driver["response"] for driver in drivers if driver["from"] is not None]
    assert len(drivers) == 27 and len(set(erred)) == len(erred) > 18


def test_the_rate_is_proportional_to_the_share(estimated: Path, tmp_path: Path) -> None:
    words = ("--end", "80", "--out", estimated / "rare", "--share", "0.01", "--", "--no-warnings")
    before = estimate(estimated / "rare")
    again = closecall("rare", LEFT_TURN, *ASKED, *words)
    assert (again.returncode, again.stderr) == (0, "")
    after = estimate(estimated / "rare")
    assert float(after["per_hour"]) == pytest.approx(10.0 * float(before["per_hour"]))
    assert after["roll_outs"] == before["roll_outs"], "nothing is run again"


def test_a_share_of_nothing_is_refused(tmp_path: Path) -> None:
    refused = closecall("rare", LEFT_TURN, "--share", "0", "--out", tmp_path / "none")
    assert refused.returncode == 2 and "a share above 0" in refused.stderr and is_one_message(refused.stderr)
