"""The faults of the net: the file, what a run says, and the report agree."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Callable

import pytest
from conftest import closecall, rows
from report_page import Opened


def test_the_file_the_run_and_the_report_agree(browser: Any, scenario: Callable[[str], Path], tmp_path: Path) -> None:
    log, report = tmp_path / "log", tmp_path / "report.html"
    run = closecall("run", scenario("pedestrian"), "--out", log)
    assert run.returncode == 0, run.stderr
    faults = rows(log / "net_faults.csv")
    said = run.stdout + run.stderr
    words = re.search(r"net faults: at (\d+) pairs? of lanes .*?, (\d+) times? with \d+ road users", said)
    assert words, said
    assert [int(word) for word in words.groups()] == [len(faults), sum(int(row["times"]) for row in faults)]
    worst = faults[0]
    assert f"the worst is {worst['lane']} and {worst['other_lane']}, {worst['times']} time" in said
    drawn = [row for row in rows(log / "conflicts.csv") if row["artefact"] == "drawn_overlap" and float(row["overlap"]) >= 0.02]
    assert sum(int(row["conflicts"]) for row in faults) == len(drawn)
    deepest = {row["id"]: row for row in drawn}[worst["deepest"]]
    assert float(deepest["overlap"]) == pytest.approx(float(worst["overlap"]), abs=0.006)

    assert closecall("report", log, "-o", report).returncode == 0
    opened = Opened(browser, report)
    table = opened.page.locator("#faultlist tbody tr")
    assert table.count() == min(len(faults), 20)
    first = table.first.inner_text()
    assert f"{worst['lane']} and {worst['other_lane']}" in first and worst["remedy"] in first
    before = opened.page.locator("#map canvas").first.screenshot()
    table.first.locator("button").click()
    assert opened.page.is_checked("#faultlayer") and opened.page.locator("#map canvas").first.screenshot() != before
    assert "fault of the net" in opened.text("#legend")
    assert opened.complaints == []
