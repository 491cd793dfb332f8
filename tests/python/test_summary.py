"""`closecall report --summary`: one sheet of paper, in real Chromium."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any, Callable

import pytest
from conftest import TIMEOUT, closecall, is_one_message
from report_page import Opened

Copy = Callable[[str], Path]


def test_a_summary_is_one_page_without_greek_letters(browser: Any, town: Path, tmp_path: Path) -> None:
    assert closecall("report", town / "log", "--summary", "-o", tmp_path / "s.html").returncode == 0
    opened = Opened(browser, tmp_path / "s.html")
    text = opened.text("body")
    assert not re.search("[\u0370-\u03ff]", text)
    report = Opened(browser, town / "report.html")
    assert opened.text("#verdict") == report.text("#verdict"), "the same sentences"
    assert opened.colours("figure") > 5
    assert (opened.complaints, opened.requests) == ([], [(tmp_path / "s.html").as_uri()])
    assert (tmp_path / "s.html").stat().st_size < 1_000_000


@pytest.mark.usefixtures("chromium")
def test_a_summary_prints_on_one_page_however_much_it_says(scenario: Copy, town: Path, tmp_path: Path) -> None:
    page, printed = tmp_path / "summary.html", tmp_path / "summary.pdf"
    assert closecall("run", scenario("reckless"), "--end", "120", "--quiet", "--out", tmp_path / "log").returncode == 0
    for logs in ([town / "log"], [tmp_path / "log"], [town / "log", tmp_path / "log"]):
        refused = closecall("report", *logs, "--summary", "-o", printed)
        assert refused.returncode == 2 and is_one_message(refused.stderr) and not printed.exists()
        command = refused.stderr.partition("or: ")[2].split()
        assert command[0] == "chromium"
        assert closecall("report", *logs, "--summary", "-o", page).returncode == 0
        subprocess.run([*command, "--no-sandbox"], check=True, capture_output=True, timeout=TIMEOUT)
        assert len(re.findall(rb"/Type\s*/Page\b", printed.read_bytes())) == 1
        printed.unlink()
