"""The filter of conflicts: in the report, in real Chromium, and in `closecall stats` alike."""

from __future__ import annotations

import json
import math
from collections import Counter
from pathlib import Path
from typing import Any, Callable

import pytest
from conftest import Row, closecall, counted
from report_page import ALL, PALETTE, Opened

Copy = Callable[[str], Path]


def test_the_filter_applies_to_everything_below_it(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html", view=ALL)
    found = counted(town / "log")
    spots, before = opened.text("#spots"), opened.text("#worst")
    tiles = opened.text("#figures")
    opened.page.uncheck("input[name='kinds-rear-end']")
    other = [row for row in found if row["kind"] != "rear_end"]
    assert 0 < len(other) < len(found)
    assert opened.text("#shown").startswith(f"{len(other)} of")
    assert opened.text("#spots") != spots and opened.text("#worst") != before and opened.text("#figures") != tiles
    assert "rear of" not in opened.text("#worst")
    opened.page.fill("#to", "30")
    opened.page.press("#to", "Enter")
    early = [row for row in other if float(row["time"]) <= 30]
    opened.page.wait_for_function(f"document.querySelector('#shown').textContent.startsWith('{len(early)} of')")
    for severity in ("caution", "serious", "critical"):
        opened.page.uncheck(f"input[name='severities-{severity}']")
    assert opened.text("#shown").startswith("0 of")
    opened.page.click("button[type=reset]")
    opened.page.wait_for_function(f"document.querySelector('#shown').textContent.startsWith('{len(found):,} of')")
    assert opened.complaints == []


def test_the_filter_is_in_the_address(browser: Any, town: Path) -> None:
    found = counted(town / "log")
    wanted = [
        row for row in found if row["kind"] == "side" and row["severity"] == "caution" and float(row["time"]) <= 50
    ]
    assert wanted
    opened = Opened(browser, town / "report.html", view="kind=side&severity=caution&to=50&manoeuvre=unheard&map=globe")
    assert opened.text("#shown").startswith(f"{len(wanted)} of")
    assert [opened.page.is_checked(f"input[name='severities-{name}']") for name in PALETTE] == [True, False, False]
    assert opened.page.input_value("#to") == "50"
    opened.page.select_option("#manoeuvre", index=1)
    sent = opened.page.url
    assert "kind=side" in sent and "manoeuvre=" in sent and "unheard" not in sent
    again = Opened(browser, town / "report.html", view=sent.split("#")[1])
    assert again.text("#shown") == opened.text("#shown")
    opened.page.click("button[type=reset]")
    assert "#severity=caution,serious,critical" in opened.page.url
    assert opened.complaints == again.complaints == []


@pytest.mark.parametrize(
    ("words", "is_wanted"),
    [
        ("--kind side,frontal", lambda row: row["kind"] in ("side", "frontal")),
        ("--severity serious", lambda row: row["severity"] == "serious"),
        ("--manoeuvre following", lambda row: row["manoeuvre"] == "following"),
        ("--cause leader_braked", lambda row: "leader_braked" in row["cause"].split()),
        ("--from 20 --to 40", lambda row: 20 <= float(row["time"]) <= 40),
        ("--where junction:G5", lambda row: row["lane"].startswith(":G5_")),
        ("--where 500,500,200", lambda row: math.hypot(float(row["x"]) - 500, float(row["y"]) - 500) <= 200),
        ("--type truck", lambda row: "truck" in (row["ego_type"], row["foe_type"])),
    ],
)
def test_stats_and_report_filter_alike(
    words: str, is_wanted: Callable[[Row], bool], town: Path, tmp_path: Path
) -> None:
    wanted = sum(map(is_wanted, counted(town / "log")))
    assert wanted > 0
    done = closecall("stats", town / "log", "--format", "json", *words.split())
    assert done.returncode == 0, done.stderr
    statistics_of = json.loads(done.stdout)
    assert (statistics_of["groups"][0]["count"], statistics_of["filter"]) == (wanted, words)
    done = closecall("report", town / "log", "-o", tmp_path / "r.html", *words.split())
    assert done.stdout.startswith(f"{wanted} conflict"), done.stdout


def test_a_period_has_rates_per_hour_only(town: Path) -> None:
    words = ("stats", town / "log", "--format", "json", "--from", "20", "--to", "49.5")
    [group, *_] = json.loads(closecall(*words).stdout)["groups"]
    assert group["per_hour"]["value"] == pytest.approx(group["count"] * 3600 / 30)
    assert group["per_vehicle_kilometre"] is None


def test_a_click_on_the_map_opens_a_conflict_and_filters_by_a_hexagon(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html", view="map=points")
    worst = opened.page.evaluate("worstRows(shownRows(false), 1)[0]")
    script = "(row) => map.chart.convertToPixel({ gridIndex: 0 }, [column.x[row], column.y[row]])"
    x, y = opened.page.evaluate(script, worst)
    opened.page.click("#map", position={"x": x, "y": y})
    row = opened.page.evaluate("opened.row")
    number, spot = opened.page.evaluate(f"[column.id[{row}], conflicts.spots[spotOf({row})]]")
    assert f"no. {number}" in opened.text("#opened h3") and opened.page.url.endswith(f"conflict={number}")
    assert opened.page.evaluate("shownRows().length") > 1, "the rest stays"
    opened.page.click("text=Only this place")
    assert opened.text("#there") == spot
    assert f"where={spot.replace(' ', ':')}" in opened.page.url
    opened.page.click("#anywhere")
    opened.page.click("#opened button:text-is('Close')")
    assert opened.page.is_hidden("#here") and opened.page.is_hidden("#opened")
    opened.page.check("input[value=density]")
    opened.page.click("#map", position={"x": x, "y": y})
    assert "m around" in opened.text("#there")
    assert opened.complaints == []


def test_places_have_names_of_their_own(browser: Any, town: Path, tmp_path: Path) -> None:
    found = counted(town / "log")
    busy = Counter(row["lane"].rsplit("_", 1)[0] for row in found if not row["lane"].startswith(":")).most_common(2)
    [(edge, on_edge), _] = busy
    at = [(float(row["x"]), float(row["y"])) for row in found if not row["lane"].startswith(f"{edge}_")]
    middle = sorted(x for x, _ in at)[len(at) // 2] + 0.01
    places = tmp_path / "places.toml"
    places.write_text(
        f'[[place]]\nname = "Main road"\nedges = ["{edge}"]\n'
        f'[[place]]\nname = "West"\npolygon = [[-1e5, -1e5], [{middle}, -1e5], [{middle}, 1e5], [-1e5, 1e5]]\n'
    )
    west = sum(x < middle for x, _ in at)
    words = ("stats", town / "log", "--places", places, "--format", "json")
    groups = json.loads(closecall(*words, "--by", "place").stdout)["groups"]
    expected = {"all": len(found), "Main road": on_edge, "West": west, "(none)": len(at) - west}
    assert {group["group"]: group["count"] for group in groups} == expected
    main = json.loads(closecall(*words, "--where", "Main road").stdout)
    assert main["groups"][0]["count"] == on_edge and "--where Main road --places" in main["filter"]
    refused = closecall("stats", town / "log", "--by", "place")
    assert (refused.returncode, "--by place needs a file of --places" in refused.stderr) == (2, True)
    assert closecall("report", town / "log", "--places", places, "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html", view=ALL)
    names = [line.split("\t")[0] for line in opened.text("#areas tbody").split("\n")]
    assert sorted(names) == ["Main road", "West", "elsewhere"]
    opened.page.click("#areas button:text-is('Main road')")
    assert opened.text("#shown") == f"{on_edge} of {len(found)} conflicts" and "area=Main%20road" in opened.page.url
    assert "Only a part of the net" in opened.text("#verdict")
    assert opened.complaints == []
