"""`closecall report` in a real browser, headless Chromium."""

from __future__ import annotations

import csv
import json
import re
import statistics
from collections import Counter
from pathlib import Path
from typing import Any, Callable

import pytest
from conftest import NETS, Once, closecall, counted, python, rows
from report_page import ALL, PALETTE, Opened, made_up, severe

Copy = Callable[[str], Path]


def test_a_report_draws_without_errors_or_network_requests(browser: Any, town: Path) -> None:
    report = town / "report.html"
    opened = Opened(browser, report)
    found = counted(town / "log")
    severe = [row for row in found if row["severity"] != "caution"]
    assert opened.text("#shown") == f"{len(severe):,} of {len(found):,} conflicts"
    assert (opened.page.title(), opened.text("h1")) == ("town – conflicts", "town")
    for selector in ("#map", "#times", "#distributions > div:first-child .chart", "#worst li:first-child .chart"):
        assert opened.colours(selector) > 5, selector
    assert len(opened.page.query_selector_all("#distributions .chart")) == 6
    artefacts = Counter(row["artefact"] for row in rows(town / "log" / "conflicts.csv") if row["artefact"])
    why = ", ".join(f"{count} {artefact}" for artefact, count in sorted(artefacts.items()))
    aside = f"set aside {artefacts.total()} that are not traffic's: {why} (--artefacts shows them)"
    assert aside in opened.text("#notes")
    card = opened.page.locator("#worst li").first
    assert card.locator("output").inner_text() == "worst step"
    assert f"closecall show {town / 'log'} " in str(card.text_content())
    assert "a driver needs 1.05 s" in str(card.locator("svg.curves").text_content())
    still = card.locator("canvas").screenshot()
    card.locator("input").press("ArrowLeft")
    assert card.locator("output").inner_text().startswith("−") and card.locator("canvas").screenshot() != still
    states = []
    for _ in range(2):
        card.locator("input").press(" ")
        states.append(opened.page.evaluate("Player.playing !== null"))
    assert states == [True, False], "the space bar plays and halts"
    assert opened.complaints == []
    assert opened.requests == [report.as_uri()]


def test_hovering_a_conflict_shows_its_values(browser: Any, scenario: Copy, tmp_path: Path) -> None:
    config = scenario("side")
    assert closecall("run", config, "--out", tmp_path / "log").returncode == 0
    assert closecall("report", tmp_path / "log", "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    [row] = rows(tmp_path / "log" / "conflicts.csv")
    place = opened.page.evaluate("map.chart.convertToPixel({gridIndex: 0}, [column.x[0], column.y[0]])")
    opened.page.hover("#map", position={"x": place[0], "y": place[1]})
    tip = opened.text(".tip")
    assert f"{row['ego']} → {row['foe']}" in tip
    assert f"margin {float(row['margin']):.2f} m".replace("-", "−") in tip
    assert opened.complaints == []


@pytest.mark.parametrize("count", [1, 2, 4, 5])
def test_medians_equal_those_of_the_margins(count: int, browser: Any, tmp_path: Path) -> None:
    log = made_up(tmp_path / "log", count)
    assert closecall("report", log, "-o", tmp_path / "r.html").returncode == 0
    margins = [float(row["margin"]) for row in rows(log / "conflicts.csv")]
    text = Opened(browser, tmp_path / "r.html", view=ALL).text("#distributions")
    medians = re.findall(rf"{count} of {count} have one, median (\S+) m\n", text.replace("−", "-"))
    # The page stores centimetres.
    assert any(float(median) == pytest.approx(statistics.median(margins), abs=0.011) for median in medians), text


def test_zooming_keeps_the_same_scale_on_both_axes(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html")
    opened.page.click("#closer")
    opened.page.hover("#map", position={"x": 300, "y": 200})
    opened.page.mouse.wheel(0, -300)
    length = "map.chart.convertToPixel({gridIndex: 0}, [X, Y])"
    origin, along, up = (
        opened.page.evaluate(length.replace("X", x).replace("Y", y))
        for x, y in (("0", "0"), ("100", "0"), ("0", "100"))
    )
    assert along[0] - origin[0] == pytest.approx(origin[1] - up[1], rel=1e-3)
    assert opened.page.evaluate("map.spans()[1] - map.spans()[0]") < 50


def test_the_worst_conflicts_are_described_in_words(browser: Any, scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    assert closecall("run", config, "--out", tmp_path / "log").returncode == 0
    assert closecall("report", tmp_path / "log", "-o", tmp_path / "r.html").returncode == 0
    [row] = rows(tmp_path / "log" / "conflicts.csv")
    text = Opened(browser, tmp_path / "r.html").page.text_content("#worst")
    assert f"{row['ego']} ({row['ego_type']}) at {float(row['ego_speed']):.1f} m/s" in text
    assert f"run into the rear of {row['foe']}" in text
    assert f"μ = {float(row['mu']):.2f} m" in text


def test_ids_are_shown_verbatim_and_never_run(browser: Any, tmp_path: Path) -> None:
    evil = "<script>alert(1)</script><img src=x onerror=alert(2)>{{scripts}}"
    log = made_up(tmp_path / evil.replace("/", "|"), 3, ego=evil, lane=f"{evil}_0")
    assert closecall("report", log, "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html", view=ALL)
    assert evil in opened.text("#worst")
    assert f"edge {evil}" in opened.text("#spots")
    place = opened.page.evaluate("map.chart.convertToPixel({gridIndex: 0}, [column.x[0], column.y[0]])")
    opened.page.hover("#map", position={"x": place[0], "y": place[1]})
    assert evil in opened.text(".tip")
    assert opened.complaints == []


def test_100_000_conflicts_open_within_2_seconds(browser: Any, tmp_path: Path) -> None:
    log = made_up(tmp_path / "log", 100_000)
    assert closecall("report", log, "-o", tmp_path / "r.html").returncode == 0
    openings = (Opened(browser, tmp_path / "r.html") for _ in range(3))
    opened = next((opened for opened in openings if opened.busy < 2), None)
    # The busy time, and once of three times: tests beside this one delay the page and share the processor's caches.
    assert opened, "busy for 2 s and more each time"
    assert opened.text("#shown").endswith(" of 100,000 conflicts")
    assert opened.complaints == []
    print(f"open after {opened.milliseconds} ms, {opened.busy:.2f} s of them busy")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", ["desktop", "phone"])
def test_a_report_fits_every_screen(browser: Any, town: Path, size: str, scheme: str) -> None:
    opened = Opened(browser, town / "report.html", size, scheme)
    assert opened.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    ground = opened.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert ground == {"light": "rgb(244, 245, 247)", "dark": "rgb(20, 23, 27)"}[scheme]
    opened.page.screenshot(path=town / f"{size}-{scheme}.png", full_page=True)
    assert (town / f"{size}-{scheme}.png").stat().st_size > 50_000
    assert opened.colours("#map") > 5
    assert opened.complaints == []


def test_several_runs_share_one_report(browser: Any, scenario: Copy, tmp_path: Path) -> None:
    config = scenario("side")
    for seed in ("1", "2"):
        assert closecall("run", config, "--seed", seed, "--out", tmp_path / "runs" / seed).returncode == 0
    assert closecall("report", tmp_path / "runs", "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    assert opened.text("#shown") == "2 of 2 conflicts"
    opened.page.select_option("#run", index=2)
    assert opened.text("#shown") == "1 of 2 conflicts"
    assert "--seed 2" in opened.page.text_content("#runs")
    assert "conflicts per vehicle-km" in opened.text("#figures")
    assert opened.complaints == []
    assert opened.page.is_hidden("#notes")
    killed = "import closecall, os, sys; checker = closecall.Checker(out=sys.argv[1]); os._exit(0)"
    python(killed, tmp_path / "runs" / "3")
    assert closecall("report", tmp_path / "runs", "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    assert "1 of 3 runs have no result" in opened.text("#notes")
    assert "conflicts per vehicle-km" not in opened.text("#figures")


def test_runs_that_differ_in_an_option_are_variants(browser: Any, scenario: Copy, tmp_path: Path) -> None:
    config = scenario("side")
    for epsilon in ("0.5", "0.25"):
        for seed in ("1", "2"):
            words = ("--seed", seed, "--epsilon", epsilon, "--out", tmp_path / "runs" / f"{epsilon}-{seed}")
            assert closecall("run", config, *words).returncode == 0
    assert closecall("report", tmp_path / "runs", "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    assert "The runs differ in epsilon" in opened.text("#notes")
    head, *lines = (line.split("\t") for line in opened.text("#planlist").split("\n"))
    assert head == ["Plan", "epsilon=0.25", "epsilon=0.5"]
    assert [line[1:] for line in lines if line[0] == "runs"] == [["2", "2"]]
    assert any(line[0] == "conflicts per vehicle-km" and all(map(float, line[1:])) for line in lines)
    assert opened.page.is_hidden("#figures"), "nothing is added up"
    opened.page.select_option("#variant", label="epsilon=0.25")
    assert opened.text("#shown") == "2 of 4 conflicts"
    assert opened.complaints == []


def test_a_missing_net_is_noted_and_conflicts_are_drawn(browser: Any, scenario: Copy, tmp_path: Path) -> None:
    config = scenario("side")
    net = config.parent / "side.net.xml"
    assert closecall("run", config, "--out", tmp_path / "log").returncode == 0
    kept = net.rename(tmp_path / "kept.net.xml")
    assert closecall("report", tmp_path / "log", "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    assert "side.net.xml is not there any more" in opened.text("#notes")
    assert opened.colours("#map") > 5
    assert closecall("report", tmp_path / "log", "-o", tmp_path / "r.html", "--net", kept).returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    assert opened.page.is_hidden("#notes")
    assert opened.complaints == []


def test_a_log_without_conflicts_is_good_news(browser: Any, tmp_path: Path) -> None:
    log = made_up(tmp_path / "log", 0)
    assert closecall("report", log, "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    assert "No conflicts were found" in opened.text("main")
    assert opened.page.is_hidden("#map")
    assert opened.complaints == []


def test_unusable_input_gets_one_clear_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    log = made_up(tmp_path / "log", 2)
    (tmp_path / "empty").mkdir()
    bad = made_up(tmp_path / "bad", 2, gap="much")
    cut = made_up(tmp_path / "cut", 2)
    (cut / "conflicts.csv").write_text((cut / "conflicts.csv").read_text().replace(",mu,", ",nu,"))
    broken = made_up(tmp_path / "broken", 2)
    (broken / "run.json").write_text("{")
    for words, message in (
        ((tmp_path / "gone",), "gone: No such file"),
        ((tmp_path / "empty",), "no log in it: neither conflicts.csv"),
        ((log / "conflicts.csv",), "it is a file; name the folder of a log"),
        ((bad,), "line 2: gap: "),
        ((cut,), 'line 1: the column "mu" is missing'),
        ((broken,), "run.json: it is not JSON"),
        ((log, "-o", "/proc/r.html"), "/proc/r.html: "),
        ((log, "--net", tmp_path / "gone.net.xml"), "gone.net.xml: "),
        ((log, "--from", "9", "--to", "3"), "--from 9 is after --to 3"),
        ((log, "--against", tmp_path / "gone"), "gone: No such file"),
    ):
        done = closecall("report", *words)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1), (words, done.stderr)
        assert message in done.stderr, (words, done.stderr)


def test_an_old_log_without_places_has_no_drawings(browser: Any, tmp_path: Path) -> None:
    log = made_up(tmp_path / "log", 3)
    old = [{name: row[name] for name in list(row)[:23]} for row in rows(log / "conflicts.csv")]
    with (log / "conflicts.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(old[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(old)
    (log / "run.json").write_text(json.dumps({"inputs": []}))
    assert closecall("report", log, "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html", view=ALL)
    assert opened.page.query_selector_all("#worst .chart") == []
    assert len(opened.page.query_selector_all("#worst li")) == 3
    assert opened.complaints == []


def test_hot_spots_are_ranked_by_risk_index_and_sortable(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html")
    crashes: dict[str, float] = {}
    for row in severe(counted(town / "log")):
        edge = row["lane"].rsplit("_", 1)[0]
        spot = f"junction {edge[1:].rsplit('_', 1)[0]}" if edge.startswith(":") else f"edge {edge}"
        crashes[spot] = crashes.get(spot, 0) + float(row["crash_probability"])
    ranked = sorted(crashes.items(), key=lambda item: -item[1])
    lines = [line.split("\t") for line in opened.text("#spots tbody").split("\n")]
    assert [line[1] for line in lines[:3]] == [spot for spot, _ in ranked[:3]]
    assert [float(line[2]) for line in lines[:3]] == pytest.approx([value for _, value in ranked[:3]], abs=0.01)
    low, high = (float(end) for end in lines[0][3].split(" to "))
    assert low < ranked[0][1] < high
    entered = json.loads((town / "log" / "run.json").read_text())["summary"]["entered"]
    for line in lines:
        junction = line[1].removeprefix("junction ")
        assert (line[4] == "–") == (junction == line[1]), "known of junctions"
        if junction != line[1]:
            rate = 1000 * crashes[line[1]] / entered[junction]
            assert float(line[4].split()[0]) == pytest.approx(rate, abs=0.06 if rate < 10 else 0.6)
    assert ranked[0][0] in opened.text("#verdict")
    opened.page.locator(".unfold").first.click()
    assert opened.page.get_attribute(".unfold", "aria-expanded") == "true"
    label = str(opened.page.get_attribute("svg.movements", "aria-label"))
    assert label.startswith("Movements at junction") and "1: " in label and "risk index" in label
    assert opened.page.locator(".diagram tbody tr").count() == opened.page.locator("svg.movements .dot").count() > 0
    assert "from the" in opened.text(".diagram")
    opened.page.locator(".unfold").first.click()
    opened.page.click("#spots th:nth-child(2) button")
    names = [line.split("\t")[1] for line in opened.text("#spots tbody").split("\n")]
    assert names == sorted(names)
    assert opened.page.get_attribute("#spots th:nth-child(2)", "aria-sort") == "ascending"


def test_a_conflict_has_its_colour_where_it_is(browser: Any, tmp_path: Path) -> None:
    log = made_up(tmp_path / "log", 300)
    assert closecall("report", log, "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html", view=f"{ALL}&map=points")
    script = """(row) => {
        const [x, y] = map.chart.convertToPixel({ gridIndex: 0 }, [column.x[row], column.y[row]]);
        const canvas = map.element.querySelector("canvas");
        const sharp = canvas.width / map.element.clientWidth;
        return [...canvas.getContext("2d").getImageData(x * sharp, y * sharp, 1, 1).data].slice(0, 3);
    }"""
    found = enumerate(rows(log / "conflicts.csv"))
    critical = [number for number, row in found if row["severity"] == "critical"]
    for number in critical:
        seen = opened.page.evaluate(script, number)
        apart = {name: sum((a - b) ** 2 for a, b in zip(seen, colour)) for name, colour in PALETTE.items()}
        assert min(apart, key=lambda name: apart[name]) == "critical", (number, seen)
    opened.page.uncheck("input[name='severities-critical']")
    for severity in ("serious", "caution"):
        opened.page.uncheck(f"input[name='severities-{severity}']")
    ground = [0xEE, 0xF1, 0xEC]
    # A canvas without a net is transparent where nothing is drawn.
    assert all(opened.page.evaluate(script, number) in ([0, 0, 0], ground) for number in critical), (
        "nothing is left over"
    )


def test_the_map_follows_the_keyboard(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html")
    opened.page.focus("#map")
    opened.page.keyboard.press("+")
    before = opened.page.evaluate("map.spans()")
    opened.page.keyboard.press("ArrowRight")
    after = opened.page.evaluate("map.spans()")
    assert before[1] - before[0] < 60 and after[0] > before[0] and after[2] == before[2]
    opened.page.keyboard.press("0")
    assert opened.page.evaluate("map.spans()") == [0, 100, 0, 100]


def test_values_beyond_an_axis_are_counted_beside_it(browser: Any, tmp_path: Path) -> None:
    log = made_up(tmp_path / "log", 1000)
    found = rows(log / "conflicts.csv")
    for row in found[:3]:
        row["drac"] = "99.7"
    with (log / "conflicts.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(found[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(found)
    assert closecall("report", log, "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html", view=ALL)
    [label] = [text for text in opened.labels() if text.startswith("Deceleration")]
    assert "3 are above 10 m/s²" in label


def test_every_chart_says_what_it_shows(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html")
    labels = opened.labels()
    found = severe(counted(town / "log"))
    assert len(labels) == 8 + min(6, len(found)), "six of the worst at first"
    assert all(len(label) > 20 for label in labels), labels
    [of_map] = [label for label in labels if label.startswith("Map of")]
    assert f"Map of {len(found)} conflicts" in of_map
    opened.page.uncheck("input[name='kinds-rear-end']")
    assert opened.labels() != labels


def test_the_shown_conflicts_become_files(browser: Any, town: Path, tmp_path: Path) -> None:
    opened = Opened(browser, town / "report.html", view="severity=caution&kind=side")
    found = [row for row in counted(town / "log") if (row["kind"], row["severity"]) == ("side", "caution")]
    assert found
    for button in ("csv", "geojson"):
        with opened.page.expect_download() as download:
            opened.page.click(f"#{button}")
        assert download.value.suggested_filename == f"town.{button}"
        download.value.save_as(tmp_path / button)
    written = rows(tmp_path / "csv")
    assert [(row["id"], row["ego"], row["manoeuvre"]) for row in written] == [
        (row["id"], row["ego"], row["manoeuvre"]) for row in found
    ]
    features = json.loads((tmp_path / "geojson").read_text())["features"]
    assert len(features) == len(found)
    assert features[0]["geometry"]["coordinates"] == pytest.approx(
        [float(found[0]["x"]), float(found[0]["y"])], abs=0.01
    )


def test_a_printed_page_is_white_and_has_no_controls(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html", scheme="dark")
    dark = opened.page.evaluate("colours.critical")
    opened.page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert opened.page.evaluate("colours.critical") != dark
    opened.page.emulate_media(media="print")
    assert opened.page.evaluate("getComputedStyle(document.body).color") == "rgb(28, 33, 40)"
    assert (
        opened.page.is_hidden("#filter")
        and opened.page.is_hidden(".play")
        and opened.page.is_hidden(".controls")
        and opened.page.is_visible("#printed")
    )
    # Swatches and bars are printed even if the printer leaves backgrounds out.
    adjusted = "(selector) => getComputedStyle(document.querySelector(selector)).printColorAdjust"
    for selector in ("#legend .key i", ".share span", "#figures div", "#verdict li > b"):
        assert opened.page.evaluate(adjusted, selector) == "exact", selector
    opened.page.emulate_media(media="screen")
    opened.page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert opened.page.evaluate("colours.critical") == dark
    assert opened.page.pdf(format="A4").startswith(b"%PDF")
    assert opened.complaints == []


def test_an_address_opens_its_conflict(browser: Any, town: Path) -> None:
    found = counted(town / "log")
    caution = next(row for row in found if row["severity"] == "caution")
    for row in (next(row for row in found if row["severity"] != "caution"), caution):
        opened = Opened(browser, town / "report.html", view=f"conflict={row['id']}")
        card = opened.text("#opened")
        assert f"no. {row['id']}" in card and row["ego"] in card and row["foe"] in card
        assert opened.page.locator("#opened canvas").count() == 1, "its clip or its drawing"
        assert opened.page.url.endswith(f"#conflict={row['id']}")
        opened.page.locator("#opened").press("Escape")
        assert opened.page.is_hidden("#opened") and "conflict=" not in opened.page.url
        assert opened.complaints == []
    opened = Opened(browser, town / "report.html", view="conflict=99999")
    assert opened.text("#opened") == "The conflict 99999 is not on this page."
    opened.page.locator("#worst h3 a").first.click()
    worst = opened.page.evaluate("worstRows(shownRows(), 1)[0]")
    assert opened.page.evaluate("opened.row") == worst
    assert opened.page.locator("#opened .player").count() == 1


def test_a_conflict_that_does_not_play_says_why_and_what_does(browser: Any, town: Path, tmp_path: Path) -> None:
    log = town / "log"
    assert closecall("report", log, "-o", tmp_path / "r.html", "--clips", "1").returncode == 0
    opened = Opened(browser, tmp_path / "r.html", view=ALL)
    assert opened.page.evaluate("data.clips.length") == 1
    for rank, why in ((0, "Play it in sumo-gui: "), (1, "Only the worst 1 play on this page. ")):
        row = opened.page.evaluate(f"worstRows(shownRows(), 2)[{rank}]")
        opened.page.evaluate(f"opened.open({row})")
        assert why in str(opened.page.text_content("#opened"))
    command = str(opened.page.locator("#opened code").text_content()).split()
    assert command[:2] == ["closecall", "clip"]
    assert closecall(*command[1:], "-o", tmp_path / "clip.svg").returncode == 0
    opened.page.evaluate("opened.open(shownRows().find((row) => column.severity[row] === 0 && isTraffic(row)))")
    assert "kept no clip of it. Run it again with --log-clips caution" in str(opened.page.text_content("#opened"))
    assert opened.complaints == []


def test_tables_fit_a_screen_of_1400_pixels(browser: Any, named_town: Path) -> None:
    opened = Opened(browser, named_town / "report.html", view=ALL)
    opened.page.set_viewport_size({"width": 1400, "height": 900})
    wide = opened.page.evaluate(
        "[...document.querySelectorAll('.scroll')]"
        ".filter((part) => part.clientWidth && part.scrollWidth > part.clientWidth).map((part) => part.ariaLabel)"
    )
    assert wide == []


def test_places_have_the_names_of_their_streets(browser: Any, named_town: Path) -> None:
    opened = Opened(browser, named_town / "report.html")
    name = opened.page.locator("#verdict strong").first.inner_text()
    assert re.fullmatch(r"Street of .* \((junction|edge) \S+\)", name)
    assert "Street" in opened.text("#spots") and "Street" in opened.text("#worst")
    opened.page.locator("#spots td:nth-child(2) button").first.click()
    assert "Street" in opened.text("#there") and re.search("where=(junction|edge):", opened.page.url)
    assert opened.complaints == []


@pytest.fixture(scope="module")
def named_town(town: Path, once: Once) -> Path:
    """The town's report with long names of streets in its net."""

    def fill(folder: Path) -> None:
        net = (NETS / "town" / "town.net.xml").read_text()
        names = iter(f"Street of the {number}th of November" for number in range(10_000))
        named = re.sub(r'<edge (?=id="[^:])', lambda _: f'<edge name="{next(names)}" ', net)
        (folder / "town.net.xml").write_text(named)
        words = ("--net", folder / "town.net.xml", "-o", folder / "report.html")
        assert closecall("report", town / "log", *words).returncode == 0

    return once("named_town", fill)


def test_a_background_map_is_asked_for_only_if_wanted(browser: Any, town: Path, tmp_path: Path) -> None:
    net = (NETS / "town" / "town.net.xml").read_text()
    offset = 'netOffset="-391000,-5819000" convBoundary="0,0,1000,1000" origBoundary="13,52,14,53"'
    utm = f'{offset} projParameter="+proj=utm +zone=33"'
    (tmp_path / "town.net.xml").write_text(re.sub("<location [^>]*/>", f"<location {utm}/>", net))
    url = "http://127.0.0.1:9/{z}/{x}/{y}.png"
    words = ("--net", tmp_path / "town.net.xml", "-o", tmp_path / "r.html")
    assert closecall("report", town / "log", *words, "--tiles", url).returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    asked = [request for request in opened.requests if request.startswith("http://127.0.0.1:9/")]
    zoom, column, line = map(int, re.fullmatch(r".*:9/(\d+)/(\d+)/(\d+)\.png", asked[0]).groups())  # type: ignore[union-attr]
    # Berlin.
    assert (column >> (zoom - 8), line >> (zoom - 8)) == (137, 83)
    assert "map: 127.0.0.1:9" in opened.text("#legend")
    assert closecall("report", town / "log", *words).returncode == 0
    assert len(Opened(browser, tmp_path / "r.html").requests) == 1
    refused = closecall("report", town / "log", "-o", tmp_path / "r.html", "--tiles", url)
    assert (refused.returncode, "no geographic projection" in refused.stderr) == (2, True)
    refused = closecall("report", town / "log", "-o", tmp_path / "r.html", "--tiles", "tiles")
    assert refused.returncode == 2 and "{z}, {x}, {y}" in refused.stderr
