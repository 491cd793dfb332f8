"""`closecall report --against`: before and after; accessibility of all pages, in real Chromium."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Callable

import axe_playwright_python
import pytest
from conftest import NETS, Once, closecall, counted
from report_page import Opened, severe

Copy = Callable[[str], Path]


@pytest.fixture(scope="module")
def change(once: Once) -> Path:
    """A report of the town with less traffic against the town as it is, two seeds each."""

    def fill(folder: Path) -> None:
        config = NETS / "town" / "town.sumocfg"
        for name, scale in (("before", "1"), ("after", "0.5")):
            for seed in ("1", "2"):
                words = ("--seed", seed, "--end", "40", "--out", folder / name / seed)
                done = closecall("run", config, *words, "--", "--no-warnings", "--scale", scale)
                assert done.returncode == 0, done.stderr
        made = closecall("report", folder / "after", "--against", folder / "before", "-o", folder / "report.html")
        assert made.returncode == 0, made.stderr

    return once("change", fill)


def test_before_and_after_are_a_sentence_and_a_plot(browser: Any, change: Path) -> None:
    opened = Opened(browser, change / "report.html")
    counts = [sum(len(severe(counted(change / name / seed))) for seed in ("1", "2")) for name in ("after", "before")]
    assert f"{counts[0]} and {counts[1]} conflicts in 2 runs after, 2 before" in opened.text("#sentence")
    first = opened.text("#forest tbody tr:first-child").split("\t")
    assert [int(cell.replace(",", "")) for cell in first[1:3]] == counts
    low, high = (float(end) for end in first[4].split(" to "))
    assert low < float(first[3]) < high
    groups = opened.text("#forest")
    assert all(f"by {what}" in groups for what in ("severity", "kind", "manoeuvre", "place"))
    assert opened.page.is_checked("input[value=difference]")
    assert "fewer" in opened.text("#legend") and "more" in opened.text("#legend")
    assert opened.colours("#map") > 5
    assert opened.complaints == []


def test_sets_of_several_variants_are_not_compared(change: Path, tmp_path: Path) -> None:
    done = closecall("report", change / "after", "--against", change, "-o", tmp_path / "r.html")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "the runs differ in" in done.stderr


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("page", ["report", "change", "stats"])
def test_pages_break_no_rule_of_accessibility(browser: Any, town: Path, change: Path, page: str, scheme: str) -> None:
    path = (change if page == "change" else town) / ("stats.html" if page == "stats" else "report.html")
    if page == "stats":
        assert closecall("stats", town / "log", "--format", "html", "-o", path).returncode == 0
        opened = browser.new_context(color_scheme=scheme, bypass_csp=True).new_page()
        opened.goto(path.as_uri())
    else:
        opened = Opened(browser, path, scheme=scheme, lax=True).page
    opened.evaluate("document.querySelectorAll('details').forEach((part) => { part.open = true; })")
    opened.evaluate("document.querySelectorAll('.unfold').forEach((_, at, all) => at || all[at].click())")
    opened.evaluate((Path(axe_playwright_python.__file__).parent / "axe.min.js").read_text(encoding="utf-8"))
    broken = opened.evaluate("axe.run()")["violations"]
    assert broken == [], [(rule["id"], [node["target"] for node in rule["nodes"]]) for rule in broken]
