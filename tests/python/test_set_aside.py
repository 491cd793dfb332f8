"""What is not traffic stays in the log, is not counted anywhere, and a line reports it; `--artefacts` includes it."""

from __future__ import annotations

import csv
import html
import json
import math
import re
import sqlite3
import xml.etree.ElementTree as ET
from collections import Counter
from pathlib import Path
from typing import Any

import closecall as module
import pytest
from conftest import closecall, rows
from report_page import ALL, Opened, made_up

ARTEFACTS = ["drawn_overlap", "", "jumped", "", "drawn_overlap", ""]
WHY = "set aside 3 that are not traffic's: 2 drawn_overlap, 1 jumped"
COUNTS = "(--artefacts includes them)"


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """A log of six conflicts, of which three are traffic; the other three are the worst."""
    folder = made_up(tmp_path / "log", len(ARTEFACTS))
    found = rows(folder / "conflicts.csv")
    for row, artefact in zip(found, ARTEFACTS):
        row |= {"artefact": artefact, "nearness": "near_certain", "consequence": "moderate"}
        row["severity"] = "critical" if artefact else "caution"
    with (folder / "conflicts.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(found[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(found)
    counts = Counter((row["kind"], row["severity"], row["artefact"]) for row in found)
    summary: dict[str, Any] = {
        "begin": 0.0,
        "end": 3599.9,
        "steps": 36000,
        "conflicts": [
            {"kind": kind, "severity": severity, "artefact": artefact or None, "count": count}
            for (kind, severity, artefact), count in counts.items()
        ],
        "collisions": 0,
        "left_out": [],
        "exposure": {"vehicles": 100, "persons": 0, "vehicle_kilometres": 50.0, "vehicle_hours": 2.0},
    }
    record: dict[str, object] = {
        "versions": {"closecall": "0.1.0", "sumo": None},
        "scenario": "made",
        "seed": None,
        "step_length": 0.1,
        "sumo_words": [],
        "inputs": [],
        "options": {},
        "complete": True,
        "summary": summary,
    }
    (folder / "run.json").write_text(json.dumps(record), encoding="utf-8")
    return folder


def test_statistics_leave_it_out_and_say_why(log: Path) -> None:
    for words, count, aside in (((), 3, {"drawn_overlap": 2, "jumped": 1}), (("--artefacts",), 6, {})):
        done = closecall("stats", log, "--format", "json", *words)
        assert (done.returncode, done.stderr) == (0, "")
        found = json.loads(done.stdout)
        assert (found["groups"][0]["count"], found["set_aside"]) == (count, aside)
        assert {one["artefact"] for one in found["worst"]} == (set(ARTEFACTS) if words else {""})
        assert (f"{WHY} {COUNTS}" in found["notes"]) == (not words)
    for form in ("text", "html"):
        assert f"{WHY} {COUNTS}" in " ".join(html.unescape(closecall("stats", log, "--format", form).stdout).split()), (
            form
        )
    lines = closecall("stats", log, "--format", "csv").stdout.splitlines()
    for line in ("set aside,1,drawn_overlap,conflicts,2", "set aside,2,jumped,conflicts,1"):
        assert line in lines


def test_a_report_leaves_it_out_and_says_why(browser: Any, log: Path, tmp_path: Path) -> None:
    page = tmp_path / "r.html"
    done = closecall("report", log, "-o", page)
    assert done.stdout.startswith("3 conflicts of 1 run") and done.stdout.endswith(f"\n{WHY} {COUNTS}\n")
    opened = Opened(browser, page, view=ALL)
    assert opened.text("#shown") == "3 of 3 conflicts"
    assert f"{WHY} (--artefacts shows them)." in opened.text("#notes")
    cards = opened.text("#worst")
    assert "A crash was near certain, and would have been moderate." in cards and "Not traffic" not in cards
    done = closecall("report", log, "-o", page, "--artefacts")
    assert done.stdout.startswith("6 conflicts of 1 run") and WHY not in done.stdout
    opened = Opened(browser, page, view=ALL)
    texts = [card.inner_text() for card in opened.page.locator("#worst li").all()]
    assert ["Not traffic: " in text for text in texts] == [False] * 3 + [True] * 3, "traffic first"
    assert opened.complaints == []


def test_a_report_of_nothing_else_says_so(browser: Any, tmp_path: Path) -> None:
    log = made_up(tmp_path / "log", 1)
    text = (log / "conflicts.csv").read_text().splitlines()
    (log / "conflicts.csv").write_text(f"{text[0]},artefact\n{text[1]},appeared\n")
    assert closecall("report", log, "-o", tmp_path / "r.html").returncode == 0
    assert "No conflict is traffic’s." in Opened(browser, tmp_path / "r.html").text("#nothing")


def test_pictures_and_exports_leave_it_out(log: Path, tmp_path: Path) -> None:
    assert closecall("plot", log, "-o", tmp_path / "plots").stdout.endswith(f"\n{WHY} {COUNTS}\n")
    for words, count in (((), 3), (("--artefacts",), 6)):
        out = tmp_path / "places.poi.xml"
        done = closecall("export", log, "--format", "poi", "--out", out, *words)
        assert done.stdout.startswith(f"{count} conflict") and (WHY in done.stdout) == (not words)
        assert len(re.findall("<poi ", out.read_text())) == count


def test_a_geopackage_names_what_is_not_traffic(log: Path, tmp_path: Path) -> None:
    out = tmp_path / "places.gpkg"
    for words, wanted in (((), [""] * 3), (("--artefacts",), ARTEFACTS)):
        done = closecall("export", log, "--format", "gpkg", "--out", out, *words)
        assert done.stdout.startswith(f"{len(wanted)} conflicts "), done.stderr
        with sqlite3.connect(out) as database:
            found = database.execute("SELECT coalesce(artefact, '') FROM conflicts ORDER BY id").fetchall()
        assert [artefact for (artefact,) in found] == wanted


def ssm_artefacts(file: Path) -> list[str | None]:
    """The attribute `artefact` of each conflict of a file in the format of SUMO's device.ssm."""
    return [conflict.get("artefact") for conflict in ET.parse(file).getroot()]


def test_ssm_files_of_a_run_and_of_its_log_have_the_same_conflicts(tmp_path: Path) -> None:
    tracks = ["id,time,x,y,speed"]
    for step in range(20):
        time = step / 10
        tracks += [f"a,{time},{20 * time},0,20", f"b,{time},{40 + 5 * time},0,5"]
        # It appears before the third, which drives on.
        tracks += [f"c,{time},{20 * time},50,20"] + ([f"d,{time},{20 + 5 * time},50,5"] if step >= 12 else [])
    (tmp_path / "tracks.csv").write_text("\n".join(tracks) + "\n")
    columns = ("--columns", "id=id,time=time,x=x,y=y,speed=speed", "--path", "straight")
    for words in ((), ("--artefacts",)):
        run, exported = tmp_path / "run.xml", tmp_path / "log.xml"
        words_of_run = (*columns, "--out", tmp_path / "log", "--ssm-output", run, "--force", *words)
        assert closecall("replay", tmp_path / "tracks.csv", *words_of_run).returncode == 0
        assert closecall("export", tmp_path / "log", "--format", "ssm", "--out", exported, *words).returncode == 0
        logged = [row["artefact"] or None for row in rows(tmp_path / "log" / "conflicts.csv")]
        assert None in logged and any(logged), logged
        assert ssm_artefacts(run) == ssm_artefacts(exported) == [one for one in logged if words or not one]


def test_the_worst_are_of_traffic_and_an_id_names_any(log: Path, tmp_path: Path) -> None:
    done = closecall("clip", log, "--worst", "4", "-o", tmp_path / "clip.svg")
    assert done.returncode == 2
    assert f"--worst 4: {log} has 3 conflicts, and has {WHY}; name one by its id" in done.stderr
    done = closecall("clip", log, "1", "-o", tmp_path / "clip.svg")
    assert "it is not traffic's (drawn_overlap); run it again with --artefacts" in done.stderr


def test_alarms_and_rewards_leave_out_who_has_just_appeared() -> None:
    for artefacts in (False, True):
        checker = module.Checker(artefacts=artefacts)
        reward = module.Reward(checker)
        for step in range(12):
            checker.step(0.1 * step, {"id": ["a"], "x": [2.0 * step], "y": [0.0], "heading": [0.0], "speed": [20.0]})
        one = {"id": ["a", "b"], "x": [24.0, 40.0], "y": [0.0, 0.0], "heading": [0.0, 0.0], "speed": [20.0, 0.0]}
        checker.step(1.2, one)
        [conflict] = checker.conflicts
        assert conflict.artefact == "appeared"
        assert (len(checker.active), reward.total() > 0) == ((1, True) if artefacts else (0, False))
        assert [alarm.artefact for alarm in checker.active] == (["appeared"] if artefacts else [])
        summary = checker.summary
        assert [count.get("artefact") for count in summary["conflicts"]] == [None if artefacts else "appeared"]
        assert (summary["risk_index"] > 0) == artefacts


@pytest.mark.parametrize(("name", "artefact"), [("steady", ""), ("swings once", ""), ("sways", "tracking")])
def test_a_tracked_heading_that_sways_is_an_error_not_one_swing(name: str, artefact: str, tmp_path: Path) -> None:
    def heading(time: float) -> float:
        swing = 0.7 * math.sin(math.pi * min(time, 1.0))
        return {"steady": 0.0, "swings once": swing, "sways": -0.2 if int(2 * time) % 2 else 0.2}[name]

    lines = ["id,time,x,y,heading,speed"]
    for time in (step / 10 for step in range(60)):
        lines += [f"ego,{time},{15 * time - 10},0,0,15", f"foe,{time},{50 + 5 * time},0,{heading(time)},5"]
    (tmp_path / "tracks.csv").write_text("\n".join(lines) + "\n")
    columns = "id=id,time=time,x=x,y=y,heading=heading[rad],speed=speed"
    done = closecall(
        "replay", tmp_path / "tracks.csv", "--columns", columns, "--path", "straight", "--out", tmp_path / "log"
    )
    assert done.returncode == 0, done.stderr
    assert [row["artefact"] for row in rows(tmp_path / "log" / "conflicts.csv")] == [artefact]
