"""`closecall report` in a real browser, headless Chromium, and the charts of `closecall plot`."""

from __future__ import annotations

import csv
import json
import math
import random
import re
import statistics
from pathlib import Path
from typing import Any, Callable

import axe_playwright_python
import pytest
from conftest import NETS, Once, Row, closecall, python, rows

ALL = "severity=caution,serious,critical"
"""The address of the view of all conflicts: cautions are left out at first."""
PALETTE = {"caution": (0x46, 0x7D, 0xB5), "serious": (0xD9, 0x5F, 0x02), "critical": (0x9B, 0x08, 0x14)}
"""The severities' colours on a light page."""
SIZES = {"desktop": {"width": 1280, "height": 900}, "phone": {"width": 390, "height": 844}}
Copy = Callable[[str], Path]


class Opened:
    """A report in the browser, with its complaints and network requests."""

    def __init__(
        self, browser: Any, path: Path, size: str = "desktop", scheme: str = "light", view: str = "", lax: bool = False
    ) -> None:
        context = browser.new_context(viewport=SIZES[size], color_scheme=scheme, bypass_csp=lax)
        self.page = context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", lambda dialog: self.complaints.append(dialog.message))
        self.page.on("request", lambda request: self.requests.append(request.url))
        session = context.new_cdp_session(self.page)
        session.send("Performance.enable", {"timeDomain": "threadTicks"})
        self.page.goto(path.as_uri() + (f"#{view}" if view else ""))
        self.page.wait_for_selector("html[data-ready]", state="attached")
        self.milliseconds = int(self.page.evaluate("document.documentElement.dataset.ready"))
        metrics = session.send("Performance.getMetrics")["metrics"]
        # The processor time of the page's main thread until then, in s.
        self.busy = float(next(metric["value"] for metric in metrics if metric["name"] == "ThreadTime"))

    def text(self, selector: str) -> str:
        """The text of an element."""
        return str(self.page.inner_text(selector))

    def labels(self) -> list[str]:
        """The text of each chart, for a reader that does not see it."""
        return [str(chart.get_attribute("aria-label")) for chart in self.page.query_selector_all(".chart")]

    def colours(self, selector: str) -> int:
        """The number of colours on the canvas in an element; 1 where nothing is drawn."""
        script = """(element) => {
            const canvas = element.querySelector("canvas");
            const pixels = new Uint32Array(canvas.getContext("2d")
                .getImageData(0, 0, canvas.width, canvas.height).data.buffer);
            return new Set(pixels).size;
        }"""
        return int(self.page.eval_on_selector(selector, script))


@pytest.fixture(scope="module")
def town(once: Once) -> Path:
    """A folder with the log of a minute of the town and the report on it."""

    def fill(folder: Path) -> None:
        config = NETS / "town" / "town.sumocfg"
        done = closecall("run", config, "--end", "60", "--out", folder / "log", "--", "--no-warnings")
        assert done.returncode == 0, done.stderr
        made = closecall("report", folder / "log", "-o", folder / "report.html")
        assert made.returncode == 0, made.stderr

    return once("town", fill)


def made_up(folder: Path, count: int, **changes: str) -> Path:
    """A log of random conflicts, without a simulation."""
    chance = random.Random(1)
    names = [
        "id",
        "ego",
        "foe",
        "kind",
        "severity",
        "begin",
        "end",
        "time",
        "gap",
        "mu",
        "margin",
        "clearance",
        "ttc",
        "drac",
        "pet",
        "delta_v",
    ]
    names += ["ego_speed", "foe_speed", "angle", "x", "y", "lane", "collision"]
    for role in ("ego", "foe"):
        names += [f"{role}_{what}" for what in ["x", "y", "heading", "length", "width", "path"]]
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "conflicts.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, names, lineterminator="\n")
        table.writeheader()
        for number in range(count):
            time, x, y = chance.uniform(0, 3600), chance.uniform(0, 5000), chance.uniform(0, 3000)
            mu = chance.uniform(5, 50)
            gap = chance.uniform(0, mu)
            row: dict[str, Any] = {name: f"{chance.uniform(0, 10):.6f}" for name in names}
            row |= {"id": number + 1, "ego": f"vehicle_{number % 20000}", "foe": f"vehicle_{number % 19997}"}
            row |= {"kind": chance.choice(["rear_end", "rear_end", "frontal", "side"]), "collision": "false"}
            row |= {"severity": chance.choices(["caution", "serious", "critical"], [80, 18, 2])[0]}
            row |= {"begin": f"{time:.2f}", "time": f"{time + 1:.2f}", "end": f"{time + 2:.2f}"}
            row |= {
                "gap": f"{gap:.6f}",
                "mu": f"{mu:.6f}",
                "margin": f"{gap - mu:.6f}",
                "x": f"{x:.6f}",
                "y": f"{y:.6f}",
            }
            row |= {
                "lane": f"edge{number % 500}_0",
                "ego_x": f"{x - 9:.6f}",
                "ego_y": f"{y:.6f}",
                "ego_path": f"{x + 9:.2f} {y:.2f}",
            }
            row |= {"foe_x": f"{x + 9:.6f}", "foe_y": f"{y:.6f}", "foe_path": ""}
            table.writerow(row | changes)
    return folder


def test_a_report_draws_without_errors_or_network_requests(browser: Any, town: Path) -> None:
    report = town / "report.html"
    opened = Opened(browser, report)
    found = rows(town / "log" / "conflicts.csv")
    severe = [row for row in found if row["severity"] != "caution"]
    assert opened.text("#shown") == f"{len(severe):,} of {len(found):,} conflicts"
    assert (opened.page.title(), opened.text("h1")) == ("town – conflicts", "town")
    for selector in ("#map", "#times", "#distributions > div:first-child .chart", "#worst li:first-child .chart"):
        assert opened.colours(selector) > 5, selector
    assert len(opened.page.query_selector_all("#distributions .chart")) == 6
    assert opened.page.is_hidden("#notes")
    assert opened.complaints == []
    assert opened.requests == [report.as_uri()]


def test_the_filter_applies_to_everything_below_it(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html", view=ALL)
    found = rows(town / "log" / "conflicts.csv")
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
    text = Opened(browser, tmp_path / "r.html").text("#worst")
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
    opened = Opened(browser, tmp_path / "r.html")
    assert opened.text("#shown").endswith(" of 100,000 conflicts")
    assert opened.complaints == []
    print(f"open after {opened.milliseconds} ms, {opened.busy:.2f} s of them busy")
    # The busy time, as other tests that run beside this one delay the page without making it busier.
    assert opened.busy < 2


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
    figures = opened.text("#figures").lower()
    assert [f"conflicts per vehicle-km, epsilon={epsilon}" in figures for epsilon in ("0.25", "0.5")] == [True, True]
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


def test_unusable_input_gets_one_clear_line(tmp_path: Path) -> None:
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
        ((bad,), "line 2: gap: "),
        ((cut,), 'line 1: the column "mu" is missing'),
        ((broken,), "run.json: it is not JSON"),
        ((log, "-o", "/proc/r.html"), "/proc/r.html: "),
        ((log, "--net", tmp_path / "gone.net.xml"), "gone.net.xml: "),
        ((log, "--from", "9", "--to", "3"), "--from 9 is after --to 3"),
        ((log, "--against", tmp_path / "gone"), "gone: No such file"),
    ):
        done = closecall("report", *words, cwd=tmp_path)
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


def severe(found: list[Row]) -> list[Row]:
    """Those that the page shows at first."""
    return [row for row in found if row["severity"] != "caution"]


def test_the_filter_is_in_the_address(browser: Any, town: Path) -> None:
    found = rows(town / "log" / "conflicts.csv")
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
    wanted = sum(map(is_wanted, rows(town / "log" / "conflicts.csv")))
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


def test_hot_spots_are_ranked_by_expected_crashes_and_sortable(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html")
    crashes: dict[str, float] = {}
    for row in severe(rows(town / "log" / "conflicts.csv")):
        edge = row["lane"].rsplit("_", 1)[0]
        spot = f"junction {edge[1:].rsplit('_', 1)[0]}" if edge.startswith(":") else f"edge {edge}"
        crashes[spot] = crashes.get(spot, 0) + float(row["crash_probability"])
    ranked = sorted(crashes.items(), key=lambda item: -item[1])
    lines = [line.split("\t") for line in opened.text("#spots tbody").split("\n")]
    assert [line[1] for line in lines[:3]] == [spot for spot, _ in ranked[:3]]
    assert [float(line[2]) for line in lines[:3]] == pytest.approx([value for _, value in ranked[:3]], abs=0.01)
    low, high = (float(end) for end in lines[0][3].split(" to "))
    assert low < ranked[0][1] < high
    assert ranked[0][0] in opened.text("#verdict")
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


def test_a_click_on_the_map_filters_by_the_place(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html", view="map=points")
    worst = opened.page.evaluate("worstRows(shownRows(false), 1)[0]")
    script = "(row) => map.chart.convertToPixel({ gridIndex: 0 }, [column.x[row], column.y[row]])"
    x, y = opened.page.evaluate(script, worst)
    opened.page.click("#map", position={"x": x, "y": y})
    spot = opened.page.evaluate(f"conflicts.spots[spotOf({worst})]")
    assert opened.text("#there") == spot
    assert f"where={spot.replace(' ', ':')}" in opened.page.url
    opened.page.click("#anywhere")
    assert opened.page.is_hidden("#here")
    opened.page.check("input[value=density]")
    opened.page.click("#map", position={"x": x, "y": y})
    assert "m around" in opened.text("#there")
    assert opened.complaints == []


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
    assert len(labels) == 14
    assert all(len(label) > 20 for label in labels), labels
    [of_map] = [label for label in labels if label.startswith("Map of")]
    found = severe(rows(town / "log" / "conflicts.csv"))
    assert f"Map of {len(found)} conflicts" in of_map
    opened.page.uncheck("input[name='kinds-rear-end']")
    assert opened.labels() != labels


def test_the_shown_conflicts_become_files(browser: Any, town: Path, tmp_path: Path) -> None:
    opened = Opened(browser, town / "report.html", view="severity=critical,serious&kind=side")
    found = [row for row in severe(rows(town / "log" / "conflicts.csv")) if row["kind"] == "side"]
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
        opened.page.is_hidden("#filter") and opened.page.is_hidden(".controls") and opened.page.is_visible("#printed")
    )
    opened.page.emulate_media(media="screen")
    opened.page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert opened.page.evaluate("colours.critical") == dark
    assert opened.page.pdf(format="A4").startswith(b"%PDF")
    assert opened.complaints == []


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
    counts = [
        sum(len(severe(rows(change / name / seed / "conflicts.csv"))) for seed in ("1", "2"))
        for name in ("after", "before")
    ]
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
    opened.evaluate((Path(axe_playwright_python.__file__).parent / "axe.min.js").read_text(encoding="utf-8"))
    broken = opened.evaluate("axe.run()")["violations"]
    assert broken == [], [(rule["id"], [node["target"] for node in rule["nodes"]]) for rule in broken]


@pytest.mark.parametrize("form", ["png", "svg"])
def test_plot_draws_every_chart_reproducibly(town: Path, tmp_path: Path, form: str) -> None:
    for out in ("first", "second"):
        done = closecall("plot", town / "log", "-o", tmp_path / out, "--format", form)
        assert done.returncode == 0, done.stderr
    names = ["delta_v", "drac", "map", "margin", "pet", "time", "ttc"]
    assert sorted(path.name for path in (tmp_path / "first").iterdir()) == [f"{name}.{form}" for name in names]
    for name in names:
        first, second = ((tmp_path / out / f"{name}.{form}").read_bytes() for out in ("first", "second"))
        assert first == second
        assert first.startswith(b"\x89PNG" if form == "png" else b"<svg")
        assert len(first) > 5_000


def test_plot_names_what_it_cannot_write(tmp_path: Path) -> None:
    done = closecall("plot", made_up(tmp_path / "log", 2), "-o", "/proc/plots")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "/proc/plots: " in done.stderr


@pytest.mark.parametrize("form", ["png", "svg"])
def test_plot_reports_a_full_disk(form: str, tmp_path: Path) -> None:
    (tmp_path / f"map.{form}").symlink_to("/dev/full")
    done = closecall("plot", made_up(tmp_path / "log", 2), "-o", tmp_path, "--format", form)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert f"map.{form}: " in done.stderr and "No space left" in done.stderr


def test_a_picture_for_a_paper_is_as_wide_as_a_column(town: Path, tmp_path: Path) -> None:
    words = ("plot", town / "log", "-o", tmp_path, "--style", "paper")
    assert closecall(*words).returncode == 0
    text = (tmp_path / "ttc.svg").read_text(encoding="utf-8")
    assert text.startswith('<svg width="85mm"')
    assert "Time to collision" in text and "#D95F02" in text
    # 8 pt in pixels of which four are one of CSS's.
    sizes = {float(size) for size in re.findall(r'font-size="([0-9.]+)"', text)}
    assert list(sizes) == [pytest.approx(8 / 72 * 96 * 4, rel=0.01)]
    refused = closecall(*words, "--format", "png")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "--style paper is for --format svg" in refused.stderr


def test_plot_draws_what_passes_the_filter(town: Path, tmp_path: Path) -> None:
    for name, words in (("all", ()), ("critical", ("--severity", "critical"))):
        assert closecall("plot", town / "log", "-o", tmp_path / name, *words).returncode == 0
    texts = {name: (tmp_path / name / "time.svg").read_text(encoding="utf-8") for name in ("all", "critical")}
    bars = {name: text.count('fill="#467DB5"') for name, text in texts.items()}
    assert bars["critical"] == 1 < bars["all"], "the legend's patch is left"
