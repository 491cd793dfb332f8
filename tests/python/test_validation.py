"""What rates measures on real crashes: the ratings themselves, and the readers of what others recorded."""

from __future__ import annotations

import csv
import gzip
import io
import json
import math
import sys
from contextlib import redirect_stdout
from pathlib import Path
from types import ModuleType

import agreement
import draw
import hundred_car
import numpy as np
import police
import pytest
from conftest import closecall
from draw import shares
from measures import RULES, Measure
from page import MARKS, write_tables
from ratings import Setting, lead_of, rate_rule, worst_until
from replays import replay
from scores import auc, auprc, average_precision
from tracks import Pair, read

VALIDATION = Path(__file__).parents[1] / "validation"
PAIR = Pair("one", frozenset("ab"), crash=True, begin=0, closest=2000, same_direction=True)


def script(module: ModuleType, *words: str | Path) -> str:
    """What a script of tests/validation prints, with intervals from few resamples."""
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(io.StringIO()) as said:
        patch.setattr(sys, "argv", [module.__name__, *map(str, words)])
        patch.setattr(module, "RESAMPLES", 200, raising=False)
        module.main()
    return said.getvalue()


def test_auc_counts_ties_half() -> None:
    found = auc(np.array([1.0, 0.5]), np.array([0.5, 0.0]))
    assert found.value == pytest.approx(7 / 8)
    assert found.low < found.value < found.high


def test_perfect_separation_of_seven_is_not_certain() -> None:
    found = auc(np.arange(10.0, 17.0), np.arange(9.0))
    assert (found.value, found.high) == (1, 1)
    assert found.low == pytest.approx(0.025 ** (1 / 7))


def test_pairs_without_value_are_one_tie_in_the_precision() -> None:
    crashes, free = np.array([3.0, -math.inf]), np.array([-math.inf, -math.inf])
    # One of one, then two of four, whatever the order of the three without a value.
    assert average_precision(crashes, free) == pytest.approx(0.5 * 1 + 0.5 * 2 / 4)
    assert auprc(crashes, free).low <= 0.75 <= auprc(crashes, free).high


def test_the_score_of_a_lead_ignores_later_steps() -> None:
    values = {1000: 0.2, 1500: 0.6, 1600: 0.9}
    assert [worst_until(values, PAIR, lead, 0.0) for lead in (0, 0.5, 1.0, 1.5)] == [0.9, 0.6, 0.2, 0.0]
    assert Measure("ttc", False).score("") == -math.inf
    assert lead_of([1200, 1700, 2300], PAIR) == pytest.approx(0.8)


def test_alarms_with_an_artefact_do_not_count(tmp_path: Path) -> None:
    table = tmp_path / "one.csv"
    rows = [f"{name},{t / 10},{5 * x + t},0,0,4,2" for t in range(20) for x, name in enumerate("ab")]
    table.write_text("id,t,x,y,heading,length,width\n" + "\n".join(rows) + "\n")
    recording = read(table, crash=False)
    rule = next(rule for rule in RULES if rule.column == "ttc")
    setting = Setting("kept", "driven", False)
    for artefact, count in (("", "1"), ("tracking", "0")):
        alarm = {1000: {"ttc": "1.2", "artefact": artefact}}
        results = list(rate_rule(rule, [recording], dict.fromkeys(recording.pairs, alarm).__getitem__, setting))
        assert [row["value"] for row in results if row["kind"] == "false alarms"] == [count]


def test_a_real_crash_is_foreseen_half_a_second_ahead() -> None:
    recording = read(VALIDATION / "crashes" / "8676.csv", crash=True)
    (pair,) = recording.pairs
    steps = replay(recording.path, "driven", smooth=False)[pair.names]
    probabilities = {tick: float(row["crash_probability"]) for tick, row in steps.items()}
    assert worst_until(probabilities, pair, 0.5, 0.0) > 0.9
    assert worst_until(probabilities, pair, 5.0, 0.0) < 0.5


def test_the_tables_replace_what_stands_between_their_marks(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    names = ("measures", "settings", "rules")
    page.write_text(
        "before\n" + "".join(MARKS[0].format(name) + "old\n" + MARKS[1].format(name) + "\n" for name in names)
    )
    with (VALIDATION / "results.csv").open(newline="") as lines:
        write_tables(page, list(csv.DictReader(lines)))
    text = page.read_text()
    assert text.startswith("before\n") and "old" not in text
    assert "| `crash_probability` | 0.9" in text and "| TTC < 1.5 s | 6, 6, 5 |" in text


def raw_event(trip: int, behind: bool) -> str:
    """An event of the 100-Car study: two come nearer at 15 m/s, 20 m apart; a crash after 1.3 s."""
    lines = []
    for step in range(14):
        cells = ["."] * 79
        cells[:3] = [str(trip), str(step), f"{step / 10:.1f}"]
        cells[4], cells[6] = "0" if behind else f"{15 / 0.44704:.4f}", "0"
        # The target of the event in the second column of its radar, another, far one in the first.
        ids, ranges, azimuths = (27, 41, 69) if behind else (20, 34, 62)
        cells[ids : ids + 2], cells[azimuths : azimuths + 2] = ["9", "7"], ["0", "0"]
        cells[ranges : ranges + 2] = ["400", f"{(20 - 1.5 * step) / 0.3048:.4f}"]
        lines.append(",".join(cells))
    return "\n".join(lines)


@pytest.mark.parametrize("other", ["lead", "following"])
def test_raw_events_of_the_100_car_study_become_crashes(tmp_path: Path, other: str) -> None:
    header = "trip_id," + ",".join(f"c{column}" for column in range(1, 79))
    events = [raw_event(trip, other == "following") for trip in (8000, 8001)]
    (tmp_path / "HundredCar_Crash_Public_Compiled.txt").write_text("\n".join([header, *events]) + "\n")
    (tmp_path / "HundredCar_NearCrash_Public_Compiled.txt").write_text(header + "\n")
    event = ["8000", "1019", "8", "13", "Crash", ".", ".", "", f"Conflict with a {other} vehicle", *["."] * 60]
    event[62] = "Automobile"
    (tmp_path / "100CarEventVideoReducedData_v1_5.txt").write_text("\t".join(event) + "\n")
    out = tmp_path / "out"
    # The second event has no description.
    assert "1 events, 1 left out" in script(hundred_car, tmp_path, out)
    recording = read(out / "crash" / "8000.csv", crash=True)
    ego, target = recording.tracks["8000_ego"], recording.tracks["8000_target"]
    gap = abs(target.x - ego.x) - (target.length + ego.length) / 2
    assert gap == pytest.approx(20 - 1.5 * np.arange(14), abs=2e-3)
    (pair,) = recording.pairs
    steps = replay(recording.path, "arc", smooth=False)[pair.names]
    assert any(float(row["crash_probability"]) > 0.5 for row in steps.values())
    assert {row["ego"] for row in steps.values()} == {"8000_target" if other == "following" else "8000_ego"}


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_police_reports_are_ranked_against_conflicts(tmp_path: Path) -> None:
    junctions = [(0, 3), (200, 2), (400, 1), (600, 0)]
    lines = "".join(f'<junction id="j{x}" type="priority" x="{x}" y="0"/>' for x, _ in junctions)
    location = '<location netOffset="-300000.00,-5600000.00" projParameter="+proj=utm +zone=32 +ellps=WGS84 +units=m"/>'
    (tmp_path / "net.net.xml").write_text(f"<net>{location}{lines}</net>")
    pyproj = pytest.importorskip("pyproj")
    back = pyproj.Proj("+proj=utm +zone=32 +ellps=WGS84 +units=m")
    places = [back(300000 + x + 30, 5600000, inverse=True) for x, count in junctions for _ in range(count)]
    far = back(300100, 5600000, inverse=True)
    text = "".join(f"1;{x:.9f};{y:.9f}\n".replace(".", ",") for x, y in [*places, far])
    (tmp_path / "crashes.csv").write_text("IstRad;XGCSWGS84;YGCSWGS84\n" + text)
    rows = [f"{x},0,serious,side,0.5," for x, count in junctions for _ in range(count + 1)]
    rows += ["600,0,serious,side,0.5,drawn_overlap"] * 9
    (tmp_path / "conflicts.csv").write_text("x,y,severity,kind,crash_probability,artefact\n" + "\n".join(rows) + "\n")
    (tmp_path / "run.json").write_text(json.dumps({"summary": {"entered": {f"j{x}": 9 for x, _ in junctions}}}))
    printed = script(police, "--net", tmp_path / "net.net.xml", "--crashes", tmp_path / "crashes.csv", "--", tmp_path)
    assert printed.startswith("6 crashes within 40 m of 4 junctions")
    assert "| serious or critical | 1.00 [" in printed


def test_readers_get_positions_and_nothing_else(tmp_path: Path) -> None:
    log, out = tmp_path / "log", tmp_path / "out"
    log.mkdir()
    rows = ["1,serious,side,,100", "2,caution,side,,100", "3,critical,rear_end,jumped,100", "4,critical,frontal,,100.1"]
    rows += ["5,serious,side,,99"]
    (log / "conflicts.csv").write_text("id,severity,kind,artefact,begin\n" + "\n".join(rows) + "\n")
    moving = {"x": [10.0, 11.0, None], "y": [0.0, 0.0, None], "heading": [0.0, 0.0, None], "speed": [9.0, 9.0, None]}
    user = {"id": "car", "category": "vehicle", "length": 4.0, "width": 2.0, **moving}
    with gzip.open(log / "clips.jsonl.gz", "wt") as clips:
        for number in range(1, 6):
            times = [100.0, 100.1, 100.2]
            clip = {"conflict": number, "times": times, "severity": ["serious"] * 3, "users": [user, user, user]}
            clips.write(json.dumps(clip) + "\n")
    printed = script(draw, out, log, "--count", "50")
    assert "2 of 3 severe conflicts" in printed and "begin too late: 1" in printed
    cases = sorted((out / "cases").iterdir())
    assert [case.name for case in cases] == ["01.csv", "02.csv"]
    lines = cases[0].read_text().splitlines()
    assert lines[:2] == ["user,t,x,y,heading,speed,length,width", "A,0.000,8.000,0.000,0.000,9.000,4.000,2.000"]
    assert [line[0] for line in lines[1:]] == ["A", "A", "B", "B"]


def test_each_scenario_gives_as_many_cases_as_the_others_or_all_it_has() -> None:
    assert shares([100, 2, 30], 20) == [9, 2, 9]
    assert shares([1, 2], 50) == [1, 2]


def test_agreement_of_two_readers_is_cohens_kappa(tmp_path: Path) -> None:
    # Cohen's kappa of this table: 0.7 agree, 0.35 by chance.
    answers = [("near miss", "near miss")] * 4 + [("near miss", "borderline")] * 2 + [("borderline", "borderline")] * 1
    answers += [("borderline", "not")] * 1 + [("not", "not")] * 2
    for reader in (0, 1):
        sheet = "".join(f"{case:02},{both[reader]}\n" for case, both in enumerate(answers))
        (tmp_path / f"answers_{reader}.csv").write_text("case,answer\n" + sheet)
    key = "".join(f"{case:02},log,{case},serious,side\n" for case in range(10))
    (tmp_path / "key.csv").write_text("case,log,conflict,severity,kind\n" + key)
    sheets = [tmp_path / f"answers_{reader}.csv" for reader in (0, 1)]
    printed = script(agreement, *sheets, "--key", tmp_path / "key.csv")
    by_chance = 0.6 * 0.4 + 0.2 * 0.3 + 0.2 * 0.3
    assert f"kappa {(0.7 - by_chance) / (1 - by_chance):.2f} [" in printed
    assert "| near miss | 0 | 4 | 2 | 0 |" in printed and "| serious (10) | 1 | 60 %" in printed


def test_a_crash_is_worse_than_a_near_miss_and_counted_with_it(tmp_path: Path) -> None:
    both = [("crash", "near miss"), ("crash", "crash"), ("near miss", "near miss"), ("not", "not")]
    for reader in (0, 1):
        sheet = "".join(f"{case:02},{answers[reader]}\n" for case, answers in enumerate(both))
        (tmp_path / f"answers_{reader}.csv").write_text("case,answer\n" + sheet)
    key = "".join(f"{case:02},log,{case},critical,side\n" for case in range(4))
    (tmp_path / "key.csv").write_text("case,log,conflict,severity,kind\n" + key)
    sheets = [tmp_path / f"answers_{reader}.csv" for reader in (0, 1)]
    printed = script(agreement, *sheets, "--key", tmp_path / "key.csv")
    assert "a crash counted as a near miss: kappa 1.00" in printed
    assert "| crash | 1 | 1 | 0 | 0 |" in printed and "| critical (4) | 1 | 75 %" in printed


@pytest.mark.parametrize("recording", ["crashes/8360.csv", "free/ngsim_us101.csv"])
def test_the_kept_recordings_can_be_inspected(recording: str) -> None:
    done = closecall("inspect", VALIDATION / recording)
    assert done.returncode == 0 and "a table" in done.stdout, done.stderr
