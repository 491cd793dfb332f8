"""The faults of the net: the file, what a run says, and the report agree."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, Callable

import pytest
from conftest import closecall, rows
from report_page import Opened


@pytest.fixture
def log(scenario: Callable[[str], Path], tmp_path: Path) -> Path:
    """A log of a net whose vehicles are wider than its lanes, with what its run said."""
    config = scenario("left_turn")
    routes = config.with_name("left_turn.rou.xml")
    routes.write_text(routes.read_text().replace('width="1.8"', 'width="3.6"'))
    run = closecall("run", config, "--end", "25", "--out", tmp_path / "log")
    assert run.returncode == 0, run.stderr
    (tmp_path / "said").write_text(run.stdout + run.stderr)
    assert closecall("report", tmp_path / "log", "-o", tmp_path / "report.html").returncode == 0
    return tmp_path / "log"


def test_the_file_the_run_and_the_report_agree(log: Path) -> None:
    faults = rows(log / "net_faults.csv")
    said = (log.parent / "said").read_text()
    words = re.search(r"net faults: at (\d+) pairs? of lanes .*?, (\d+) times? with (\d+) road users", said)
    assert words, said
    drawn = {row["id"]: row for row in rows(log / "conflicts.csv") if row["artefact"] == "drawn_overlap"}
    deep = [row for row in drawn.values() if float(row["overlap"]) >= 0.02]
    users = {row[one] for row in deep for one in ("ego", "foe")}
    assert [int(word) for word in words.groups()] == [len(faults), sum(int(row["times"]) for row in faults), len(users)]
    worst = faults[0]
    assert f"the worst is {worst['lane']} and {worst['other_lane']}, {worst['times']} time" in said
    assert worst["remedy"] in said
    assert sum(int(row["conflicts"]) for row in faults) == len(deep)
    for row in faults:
        assert float(drawn[row["deepest"]]["overlap"]) == pytest.approx(float(row["overlap"]), abs=0.006)
        assert int(row["times"]) <= int(row["conflicts"])
    text = re.search(r'id="data">(.*?)</script>', (log.parent / "report.html").read_text(), re.DOTALL)
    assert text
    shown = json.loads(text[1])["net_faults"]
    assert shown["count"] == len(faults)
    assert [
        {name: str(value) for name, value in fault.items() if name not in ("overlap", "x", "y")}
        for fault in shown["worst"]
    ] == [{name: value for name, value in row.items() if name not in ("overlap", "x", "y")} for row in faults]


def test_the_report_lists_and_marks_the_faults(browser: Any, log: Path) -> None:
    worst = rows(log / "net_faults.csv")[0]
    opened = Opened(browser, log.parent / "report.html")
    first = opened.page.locator("#faultlist tbody tr").first
    assert f"{worst['lane']} and {worst['other_lane']}" in first.inner_text() and worst["remedy"] in first.inner_text()
    first.locator("button").click()
    assert opened.page.is_checked("#faultlayer") and "fault of the net" in opened.text("#legend")
    assert opened.complaints == []
