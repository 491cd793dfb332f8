"""The report says only what is so: its sentences, on many kinds of log, against what stands beside them."""

from __future__ import annotations

import itertools
import json
import re
from pathlib import Path
from typing import Any, Callable

import pytest
from conftest import closecall
from report_page import ALL, Opened
from small_logs import small_log

Conflict = dict[str, Any]


def many(count: int, **values: Any) -> list[Conflict]:
    """So many conflicts alike."""
    return [dict(values) for _ in range(count)]


def places(*counts: int, probability: float = 0.9) -> list[Conflict]:
    """Conflicts at several edges, so many at each."""
    found = [many(count, lane=f"edge{number}_0", crash_probability=probability) for number, count in enumerate(counts)]
    return list(itertools.chain(*found))


def runs(folder: Path, *logs: list[Conflict], **record: Any) -> Path:
    """Several runs that differ in the seed."""
    for seed, conflicts in enumerate(logs, 1):
        small_log(folder / str(seed), conflicts, seed=str(seed), **record)
    return folder


def plans(folder: Path, *logs: list[Conflict]) -> Path:
    """A run of each of several plans."""
    for number, conflicts in enumerate(logs):
        small_log(folder / f"plan{number}", conflicts, scenario=f"plan{number}.sumocfg", options={"epsilon": number})
    return folder


KINDS: dict[str, tuple[Callable[[Path], Path], tuple[str, ...]]] = {
    "nothing": (lambda folder: small_log(folder, []), ()),
    "one conflict": (lambda folder: small_log(folder, places(1)), ()),
    "two places apart": (lambda folder: small_log(folder, places(60, 1)), ()),
    "two places alike": (lambda folder: small_log(folder, places(5, 4)), ()),
    "three places": (lambda folder: small_log(folder, places(200, 60, 55)), ()),
    "many places": (lambda folder: small_log(folder, places(300, 40, 35, 30, 2, 1, 1)), ()),
    "nearly all at three": (
        lambda folder: small_log(folder, places(400, 300, 300) + places(0, 0, 0, 1, probability=0.1)),
        (),
    ),
    "runs alike": (lambda folder: runs(folder, places(4, 1), places(4, 1)), ()),
    "runs nearly alike": (
        lambda folder: runs(
            folder, *(places(4, 1) + many(1, lane="edge0_0", crash_probability=tiny) for tiny in (0, 1e-4, 0))
        ),
        (),
    ),
    "no risk": (lambda folder: small_log(folder, many(5, crash_probability="")), ()),
    "nearly no risk": (lambda folder: small_log(folder, places(3, 2, 1, 1, probability=1e-3)), ()),
    "cautions": (lambda folder: small_log(folder, many(9, severity="caution", crash_probability=0.05)), ()),
    "a place": (lambda folder: small_log(folder, places(20, 10, 5)), ("--where", "edge0")),
    "two of its places": (
        lambda folder: small_log(folder, places(20, 10, 5)),
        ("--where", "edge0", "--where", "edge1"),
    ),
    "a period": (lambda folder: small_log(folder, places(20, 10, 5)), ("--to", "25")),
    "a kind": (
        lambda folder: small_log(folder, places(20, 10) + many(4, kind="side", lane="edge3_0")),
        ("--kind", "rear_end"),
    ),
    "two plans": (lambda folder: plans(folder, places(8, 3), places(2, 9)), ()),
    "five plans": (lambda folder: plans(folder, *(places(4, number) for number in range(1, 6))), ()),
    "artefacts": (
        lambda folder: small_log(folder, places(3, 2) + many(4, artefact="jumped", lane="edge5_0")),
        ("--artefacts",),
    ),
}


def named_intervals(opened: Opened) -> list[tuple[float, float] | None]:
    """The interval of each place that the verdict names, where one is given."""
    found = []
    for text in opened.page.locator("#verdict li").all_inner_texts():
        brackets = re.search(r"risk index [\d.,]+ \(([\d.,]+) to ([\d.,]+)\)", text)
        found.append((float(brackets[1].replace(",", "")), float(brackets[2].replace(",", ""))) if brackets else None)
    return found


def listed_intervals(opened: Opened) -> list[tuple[float, float]]:
    """The interval of each place of the table."""
    lines = [line.split("\t") for line in opened.text("#spots tbody").split("\n")]
    cells = [next(cell for cell in line if " to " in cell) for line in lines]
    return [
        (float(low.replace(",", "")), float(high.replace(",", "")))
        for low, high in (cell.split(" to ") for cell in cells)
    ]


def check_order(verdict: str, intervals: list[tuple[float, float] | None]) -> None:
    """The order may be chance where two intervals overlap, and nowhere else."""
    pairs = [
        (one, other)
        for (one, a), (other, b) in itertools.combinations(enumerate(intervals, 1), 2)
        if a and b and b[1] >= a[0] - 0.05
    ]
    assert ("overlap" in verdict) == bool(pairs), (verdict, intervals)
    if named := re.search(r"The intervals of (\d.*) overlap", verdict):
        assert [tuple(map(int, pair)) for pair in re.findall(r"(\d) and (\d)", named[1])] == pairs
    assert ("In brackets" in verdict) == any(intervals), verdict


def check_doubt(doubt: str, intervals: list[tuple[float, float]]) -> None:
    """What is said of the table's ranks."""
    others = sum(high >= intervals[0][0] - 0.005 for _, high in intervals[1:])
    assert bool(doubt) == bool(others), (doubt, intervals)
    if numbers := re.search(r"of (\d+|one) of the (\d+) places", doubt):
        assert (numbers[1].replace("one", "1"), numbers[2]) == (str(others), str(len(intervals) - 1))
    if "all" in doubt:
        assert others == len(intervals) - 1


@pytest.mark.parametrize("kind", KINDS)
def test_every_sentence_is_so(kind: str, browser: Any, tmp_path: Path) -> None:
    make, words = KINDS[kind]
    made = closecall("report", make(tmp_path / "logs"), "-o", tmp_path / "r.html", *words)
    assert made.returncode == 0, made.stderr
    opened = Opened(browser, tmp_path / "r.html", view=ALL)
    assert opened.complaints == []
    if kind == "nothing":
        assert "No conflicts were found" in opened.text("#nothing")
        return
    verdict, figures = opened.text("#verdict"), opened.text("#figures").lower()
    assert "100 %" not in verdict and " 0 %" not in verdict and "(0.0 to 0.0)" not in verdict
    several, of_place, of_period = "plans" in kind, "--where" in words, "--to" in words
    assert ("conflicts per vehicle-km" in figures) == (not several and not of_place and not of_period)
    if several:
        two = kind == "two plans"
        assert opened.page.is_visible("#plans") and opened.page.is_hidden("#figures")
        assert opened.page.locator("#verdict h3").all_inner_texts() == (["plan0", "plan1"] if two else [])
        assert "numbered on the map" not in verdict and "Circled" not in opened.text("#legend")
        assert opened.page.is_hidden("#hot") == (not two)
        assert opened.page.title().startswith("plan0 and plan1" if two else "5 scenarios")
        return
    shown = len({row for row in opened.page.evaluate("shownRows().filter((row) => risk[row] > 0).map(spotOf)")})
    named = opened.page.locator("#verdict li").count()
    assert ("Most dangerous" in verdict) == (shown > named > 0 and not of_place)
    assert ("at one place" in verdict) == (shown == 1 and named == 1 and not of_place)
    assert ("numbered on the map" in verdict) == (named > 1 and not of_place)
    assert ("Only a part of the net" in verdict) == of_place
    if named:
        check_order(verdict, named_intervals(opened))
    if opened.page.evaluate("hasRisk"):
        check_doubt(opened.text("#doubt"), listed_intervals(opened))
    if kind == "artefacts":
        assert "edge5" not in verdict and "not traffic" in figures
        assert "risk index\n4.5" in figures.replace("4.50", "4.5")


STANDING = [
    ("side_by_side", "rear_end", 10.0, 0.0, "They were side by side."),
    ("side_by_side", "rear_end", 10.0, 9.0, "They drove side by side."),
    ("following", "rear_end", 10.0, 0.0, "One was behind the other."),
    ("head_on", "frontal", 5.0, 0.0, "They faced each other"),
    ("left_turn_across", "side", 0.0, 8.0, "The way of one turned left"),
]


def test_one_that_stands_is_not_said_to_drive(browser: Any, tmp_path: Path) -> None:
    names = ("manoeuvre", "kind", "ego_speed", "foe_speed")
    beside = {"ego_x": 10, "foe_x": 10, "foe_y": 2.5}
    conflicts = [dict(zip(names, values)) | (beside if values[0] == "side_by_side" else {}) for values in STANDING]
    log = small_log(tmp_path / "log", conflicts)
    assert closecall("report", log, "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    for row, (manoeuvre, _, *speeds, sentence) in enumerate(STANDING):
        story = str(opened.page.evaluate(f"storyOf({row})"))
        assert sentence in story
        assert min(speeds) > 0 or "drove" not in story
        assert manoeuvre != "side_by_side" or ("came too close to f" in story and "the rear of" not in story)


def test_the_remarks_of_the_runs_are_in_the_box_under_the_title(browser: Any, tmp_path: Path) -> None:
    long = {"code": "long_steps", "text": "steps of 1 s are long"}
    cut = {"code": "corners_cut", "text": "on 3 junction lanes vehicles cut corners"}
    runs(tmp_path / "logs", places(2), places(3), summary={"remarks": [long]})
    small_log(tmp_path / "logs" / "3", places(1), seed="3", summary={"remarks": [long, cut]})
    assert closecall("report", tmp_path / "logs", "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html")
    said = opened.page.locator("#said li").all_inner_texts()
    assert said == [long["text"], f"{cut['text']} (1 of 3 runs)"]
    assert opened.page.evaluate("byId('remarks').compareDocumentPosition(byId('verdict')) & 4"), "above the verdict"


def test_a_run_says_with_codes_what_to_know(tmp_path: Path, scenario: Callable[[str], Path], browser: Any) -> None:
    done = closecall("run", scenario("side"), "--out", tmp_path / "log", "--", "--step-length", "0.2")
    assert done.returncode == 0, done.stderr
    remarks = json.loads((tmp_path / "log" / "run.json").read_text())["summary"]["remarks"]
    [long] = [remark["text"] for remark in remarks if remark["code"] == "long_steps"]
    assert long.startswith("steps of 0.2 s are long") and f"closecall: {long}\n" in done.stderr
    assert long not in done.stdout, "said once"
    assert closecall("report", tmp_path / "log", "-o", tmp_path / "r.html").returncode == 0
    assert long in Opened(browser, tmp_path / "r.html").text("#said")


def test_before_and_after_compare_what_there_is(browser: Any, tmp_path: Path) -> None:
    def cautions(count: int) -> list[Conflict]:
        return many(count, severity="caution", crash_probability=0.05)

    before = runs(tmp_path / "before", *(cautions(30 + seed) for seed in range(6)))
    after = runs(tmp_path / "after", *(cautions(6 + seed % 3) for seed in range(6)))
    assert closecall("report", after, "--against", before, "-o", tmp_path / "r.html").returncode == 0
    opened = Opened(browser, tmp_path / "r.html", view=ALL)
    sentence, table = opened.text("#sentence"), opened.text("#forest")
    assert "fewer conflicts after the change" in sentence and "chance alone" not in sentence
    none = "collisions, serious conflicts, critical conflicts, frontal conflicts or side conflicts"
    assert sentence.endswith(f"Neither set of runs has {none}.")
    lines = {line.split("\t")[0]: line.split("\t")[1:3] for line in table.split("\n") if "\t" in line}
    assert lines["conflicts"] == ["42", "195"] and lines["rear end"] == ["42", "195"]
    assert [float(value) for value in lines["risk index"]] == pytest.approx([2.1, 9.75])
    assert "serious and critical" not in table
    assert "After the change" in opened.text("#verdict")
    empty = runs(tmp_path / "none", [], [])
    assert closecall("report", after, "--against", empty, "-o", tmp_path / "r.html").returncode == 0
    assert "only after the change" in Opened(browser, tmp_path / "r.html", view=ALL).text("#sentence")
