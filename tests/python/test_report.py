"""`closecall report` in a real browser, headless Chromium, and the charts of `closecall plot`."""

from __future__ import annotations

import csv
import json
import random
import re
import shutil
import statistics
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Callable

import pytest
from conftest import NETS, Once, closecall, python, rows
from playwright import sync_api as playwright

CHROMIUM = shutil.which("chromium")
SIZES = {"desktop": {"width": 1280, "height": 900}, "phone": {"width": 390, "height": 844}}
Copy = Callable[[str], Path]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Headless Chromium, a package of the system, which .ci/run installs."""
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed: apt install chromium")
    with playwright.sync_playwright() as driver:
        # Chromium refuses to run as root with its sandbox, which containers do not support either.
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


class Opened:
    """A report in the browser, with its complaints and network requests."""

    def __init__(self, browser: Any, path: Path, size: str = "desktop", scheme: str = "light") -> None:
        context = browser.new_context(viewport=SIZES[size], color_scheme=scheme)
        self.page = context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", lambda dialog: self.complaints.append(dialog.message))
        self.page.on("request", lambda request: self.requests.append(request.url))
        session = context.new_cdp_session(self.page)
        session.send("Performance.enable", {"timeDomain": "threadTicks"})
        self.page.goto(path.as_uri())
        self.page.wait_for_selector("html[data-ready]", state="attached")
        self.milliseconds = int(self.page.evaluate("document.documentElement.dataset.ready"))
        metrics = session.send("Performance.getMetrics")["metrics"]
        # The processor time of the page's main thread until then, in s.
        self.busy = float(next(metric["value"] for metric in metrics if metric["name"] == "ThreadTime"))

    def text(self, selector: str) -> str:
        """The text of an element."""
        return str(self.page.inner_text(selector))

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
    assert opened.text("#shown") == f"{len(found):,} of {len(found):,} conflicts"
    for selector in ("#map", "#times", "#distributions > div:first-child .chart", "#worst li:first-child .chart"):
        assert opened.colours(selector) > 5, selector
    assert len(opened.page.query_selector_all("#distributions .chart")) == 6
    assert opened.page.is_hidden("#notes")
    assert opened.complaints == []
    assert opened.requests == [report.as_uri()]


def test_the_filter_applies_to_everything_below_it(browser: Any, town: Path) -> None:
    opened = Opened(browser, town / "report.html")
    found = rows(town / "log" / "conflicts.csv")
    spots, before = opened.text("#spots"), opened.text("#worst")
    opened.page.uncheck("input[name='kinds-rear-end']")
    other = [row for row in found if row["kind"] != "rear_end"]
    assert 0 < len(other) < len(found)
    assert opened.text("#shown").startswith(f"{len(other)} of")
    assert (opened.text("#spots"), opened.text("#worst")) != (spots, before)
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
    text = Opened(browser, tmp_path / "r.html").text("#distributions")
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
    opened = Opened(browser, tmp_path / "r.html")
    assert evil in opened.text("#worst")
    assert f"edge {evil}" in opened.text("#spots")
    place = opened.page.evaluate("map.chart.convertToPixel({gridIndex: 0}, [column.x[0], column.y[0]])")
    opened.page.hover("#map", position={"x": place[0], "y": place[1]})
    assert evil in opened.text(".tip")
    assert opened.complaints == []


def test_100_000_conflicts_open_within_3_seconds(browser: Any, tmp_path: Path) -> None:
    log = made_up(tmp_path / "log", 100_000)
    assert closecall("report", log, "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    assert opened.text("#shown") == "100,000 of 100,000 conflicts"
    assert opened.complaints == []
    print(f"open after {opened.milliseconds} ms, {opened.busy:.2f} s of them busy")
    # The busy time, as other tests that run beside this one delay the page without making it busier.
    assert opened.busy < 3


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
    opened = Opened(browser, tmp_path / "r.html")
    assert opened.page.query_selector_all("#worst .chart") == []
    assert len(opened.page.query_selector_all("#worst li")) == 3
    assert opened.complaints == []


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
