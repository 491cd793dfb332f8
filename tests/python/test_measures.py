"""The measures that a log has if they are chosen, recomputed from the steps of a run and against SUMO's device."""

from __future__ import annotations

import csv
import io
import json
import math
import xml.etree.ElementTree as ET
from collections import defaultdict
from functools import cache
from pathlib import Path
from typing import Any, Callable, NamedTuple

import closecall as cc
import numpy as np
import pytest
import shapely
from closecall._closecall import read_log
from conftest import NETS, Once, Row, closecall, rows
from shapely.affinity import translate

CONDITION = "margin < 0 or ttc < 3"
NEAR = 2e-3
"""What six decimals of speeds leave in doubt, relative or absolute: an acceleration is a difference of two of them."""


class Run(NamedTuple):
    """A log with all measures, and the accelerations of all road users by time and id."""

    conflicts: list[Row]
    steps: dict[str, list[Row]]
    accelerations: dict[tuple[float, str], float]
    step_length: float


def run_all(net: str, out: Path, *words: str) -> None:
    more = ("--measures", "all", "--log-series", "--log", CONDITION, "--end", "100")
    sumo = ("--no-warnings", "--fcd-output", str(out.parent / f"{net}.fcd.xml"), "--precision", "6")
    done = closecall("run", NETS / net / f"{net}.sumocfg", "--out", out, "--quiet", *more, *words, "--", *sumo)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def measured(once: Once) -> Callable[[str], Run]:
    """Runs a scenario once, with all measures."""

    @cache
    def found(net: str) -> Run:
        folder = once(f"measures_{net}", lambda out: run_all(net, out / "log"))
        steps: dict[str, list[Row]] = defaultdict(list)
        for row in rows(folder / "log" / "series.csv"):
            steps[row["conflict"]].append(row)
        accelerations: dict[tuple[float, str], float] = {}
        last: dict[str, float] = {}
        length = json.loads((folder / "log" / "run.json").read_text())["step_length"]
        for step in ET.parse(folder / f"{net}.fcd.xml").getroot():
            now = {one.get("id", ""): float(one.get("speed", "nan")) for one in step}
            for name, speed in now.items():
                if name in last:
                    accelerations[round(float(step.get("time", "nan")), 3), name] = (speed - last[name]) / length
            last = now
        return Run(rows(folder / "log" / "conflicts.csv"), dict(steps), accelerations, length)

    return found


def number(row: Row, name: str) -> float | None:
    return float(row[name]) if row[name] else None


def rss_distance(row: Row) -> float | None:
    own, other = (float(row[name]) for name in ("ego_speed", "foe_speed"))

    def stop(speed: float) -> float:
        return speed * 1.0 + 3.5 / 2 + (speed + 3.5) ** 2 / 8

    if row["kind"] == "side":
        return None
    return stop(own) + stop(other) if row["kind"] == "frontal" else max(stop(own) - other**2 / 16, 0)


def mttc(gap: float, speeds: tuple[float, float], accelerations: tuple[float, float]) -> float | None:
    """By small steps; none after 10 s."""
    time = np.arange(0, 10, 1e-3)

    def way(speed: float, acceleration: float) -> Any:
        moving = np.minimum(time, speed / -acceleration) if acceleration < 0 else time
        return speed * moving + acceleration * moving**2 / 2

    used = way(speeds[0], accelerations[0]) - way(speeds[1], accelerations[1]) >= gap
    return float(time[used][0]) if used.any() else None


BRAKES = 9.0
"""SUMO's emergencyDecel of cars, which the followers are, in m/s²."""
MOST_BRAKING = 12.68
"""The largest deceleration that a measure gives, in m/s²."""


def a_long_req(gap: float, speeds: tuple[float, float], leader_acceleration: float) -> float:
    """By halving, on courses in small steps until both stand; 0 where no braking is needed."""
    # A leader that hardly brakes stands after minutes.
    time = np.concatenate((np.arange(0, 60, 2e-3), np.arange(60, 3600, 0.1)))

    def way(speed: float, deceleration: float) -> Any:
        moving = np.minimum(time, speed / deceleration) if deceleration > 0 else time
        return speed * moving - deceleration * moving**2 / 2

    leader = way(speeds[1], max(-leader_acceleration, 0.0))
    low, high = 0.0, MOST_BRAKING
    if (way(speeds[0], low) - leader).max() <= gap:
        return 0.0
    if (way(speeds[0], high) - leader).max() > gap:
        return MOST_BRAKING
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (low, middle) if (way(speeds[0], middle) - leader).max() <= gap else (middle, high)
    return high


def rectangle(row: Row, who: str, size: Row) -> Any:
    length, width = (float(size[f"{who}_{name}"]) for name in ("length", "width"))
    x, y, heading = (float(row[f"{who}_{name}"]) for name in ("x", "y", "heading"))
    ahead = np.array([math.cos(heading), math.sin(heading)])
    left = np.array([-ahead[1], ahead[0]]) * width / 2
    front = np.array([x, y])
    return shapely.Polygon([front + left, front - left, front - left - ahead * length, front + left - ahead * length])


def velocity(row: Row, who: str) -> Any:
    heading = float(row[f"{who}_heading"])
    return float(row[f"{who}_speed"]) * np.array([math.cos(heading), math.sin(heading)])


def act(row: Row, size: Row) -> float | None:
    ego, foe = (rectangle(row, who, size) for who in ("ego", "foe"))
    step = 1e-6 * (velocity(row, "ego") - velocity(row, "foe"))
    now = ego.distance(foe)
    decrease = (now - translate(ego, *step).distance(foe)) / 1e-6
    return now / decrease if now > 0 and decrease > 0 else None


def ei(row: Row, size: Row) -> float | None:
    ego, foe = (rectangle(row, who, size) for who in ("ego", "foe"))
    relative = velocity(row, "foe") - velocity(row, "ego")
    speed = float(np.hypot(*relative))
    if speed == 0:
        return None
    across = np.array([-relative[1], relative[0]]) / speed
    between = np.array(foe.centroid.coords[0]) - np.array(ego.centroid.coords[0])
    tdm = -float(between @ relative) / speed**2
    spans = [np.array(one.exterior.coords) @ across for one in (ego, foe)]
    depth = sum(float(span.max() - span.min()) / 2 for span in spans) - abs(float(between @ across))
    return depth / tdm if tdm > 0 and depth > 0 else None


def of_step(row: Row, size: Row, run: Run) -> dict[str, float | None]:
    """The measures of a step, formulas written anew."""
    gap, own, other, angle = (float(row[name]) for name in ("gap", "ego_speed", "foe_speed", "angle"))
    time = round(float(row["time"]), 3)
    a, b = (run.accelerations.get((time, row[who]), 0.0) for who in ("ego", "foe"))
    follows = row["kind"] == "rear_end"
    leader, leader_a = other * math.cos(angle), b * math.cos(angle)
    closing = own - leader
    wait = gap / closing - 1 if closing > 0 else math.inf
    found = {
        "rss_distance": rss_distance(row),
        "thw": (gap + float(size["foe_length"])) / own if follows and own > 0 else None,
        "sgap": gap if follows else None,
        "br": -a if a < 0 else None,
        "mdrac": (min(closing / 2 / wait, 12.68) if wait > 0 else 12.68) if follows and closing > 0 else None,
        "max_s": max(own, other),
        "delta_s": float(np.hypot(*(velocity(row, "ego") - velocity(row, "foe")))) if row["ttc"] else None,
        "max_d": a,
        "max_braking": max((braking for braking in (-a, -b) if braking >= 1.3), default=None),
        "act": act(row, size),
        "ei": ei(row, size),
        "mttc": mttc(gap, (own, leader), (a, leader_a)) if follows else None,
    }
    if follows:
        needed = a_long_req(gap, (own, leader), leader_a)
        found |= {"a_long_req": needed, "btn": needed / BRAKES}
    later = found["mttc"]
    if later:
        ends = (max(own + a * later, 0), max(leader + leader_a * later, 0))
        found["crash_index"] = (ends[0] ** 2 - ends[1] ** 2) / 2 / later
    return found


EDGES: dict[str, tuple[float, float]] = {
    "mttc": (9.9, 10.1),
    "act": (1e3, math.inf),
    "br": (0, 1e-4),
    "max_braking": (1.2999, 1.3001),
    "ei": (0, 1e-3),
}
"""Values that rounding may leave empty on one side."""


def is_near(ours: float | None, theirs: float | None, name: str) -> bool:
    if ours is None or theirs is None:
        low, high = EDGES.get(name, (math.nan, math.nan))
        return ours is theirs or low <= (ours if theirs is None else theirs) <= high  # type: ignore[operator]
    return math.isclose(ours, theirs, rel_tol=10 * NEAR if name == "crash_index" else NEAR, abs_tol=NEAR)


@pytest.mark.parametrize("net", ["reckless", "overtaking"])
def test_the_measures_of_a_step_are_what_its_formulas_give(net: str, measured: Callable[[str], Run]) -> None:
    run = measured(net)
    sizes = {row["id"]: row for row in run.conflicts}
    compared: dict[str, int] = defaultdict(int)
    for name, steps in run.steps.items():
        for row in steps[:: max(1, len(steps) // 4)]:
            if row["collision"] == "true" or float(row["overlap"]) > 0 or not sizes[name]["foe_path"]:
                continue
            for measure, expected in of_step(row, sizes[name], run).items():
                found = number(row, measure)
                assert is_near(found, expected, measure), (measure, found, expected, row)
                compared[measure] += found is not None
    needed = {"act", "delta_s", "ei", "max_d", "max_s", "rss_distance"}
    needed |= (
        {"a_long_req", "br", "btn", "crash_index", "max_braking", "mdrac", "mttc", "sgap", "thw"}
        if net == "reckless"
        else set()
    )
    assert all(compared[measure] >= 10 for measure in needed), compared


LEAST = ("tadv", "t2", "thw", "sgap", "mttc", "max_d", "act")
MOST = ("br", "mdrac", "crash_index", "a_long_req", "a_lat_req", "btn", "stn", "max_s", "ei", "max_braking")


def test_a_conflict_has_the_extremes_and_integrals_of_its_steps(measured: Callable[[str], Run]) -> None:
    run = measured("reckless")
    filled: dict[str, int] = defaultdict(int)
    for conflict in run.conflicts:
        steps = run.steps[conflict["id"]]
        expected: dict[str, float | None] = {}
        for names, extreme in ((LEAST, min), (MOST, max)):
            for name in names:
                values = [float(row[name]) for row in steps if row[name]]
                expected[name] = extreme(values) if values else None
        worst = min(steps, key=lambda row: (float(row["margin"]), float(row["time"])))
        expected |= {name: number(worst, name) for name in ("rss_distance", "rss_lateral_distance")}
        ttcs = [float(row["ttc"]) if row["ttc"] else math.inf for row in steps]
        lasted = [run.step_length] * len(steps)
        expected["tet"] = sum(dt for ttc, dt in zip(ttcs, lasted) if ttc <= 3)
        expected["tit"] = sum((3 - ttc) * dt for ttc, dt in zip(ttcs, lasted) if ttc <= 3)
        safe = [(number(row, "rss_distance"), float(row["gap"])) for row in steps]
        violated = [run.step_length for distance, gap in safe if distance is not None and gap < distance]
        expected["rss_violation"] = sum(violated) if any(distance is not None for distance, _ in safe) else None
        if math.isfinite(min(ttcs)):
            expected["delta_s"] = number(steps[ttcs.index(min(ttcs))], "delta_s")
        accelerations = [float(row["max_d"]) for row in steps]
        expected["dr"] = next((value for value in accelerations if value < 0), min(accelerations))
        expected |= evasion(steps, run)
        for name, value in expected.items():
            found = number(conflict, name)
            if name == "ta_level" and found is not None and value is not None:
                assert abs(found - value) <= 1, conflict["id"]
            else:
                assert (found is None) == (value is None) and math.isclose(found or 0, value or 0, abs_tol=1e-4), (
                    name,
                    found,
                    value,
                    conflict["id"],
                )
            filled[name] += found is not None
    assert all(count > 10 for count in filled.values()), filled


def evasion(steps: list[Row], run: Run) -> dict[str, float | None]:
    """TA, conflicting speed and severity level of the first step in which one brakes; TA only if they would meet."""
    for row in steps:
        time = round(float(row["time"]), 3)
        changes = {who: run.accelerations.get((time, row[who]), 0.0) for who in ("ego", "foe")}
        before = [
            float(row[f"{who}_speed"]) - change * run.step_length for who, change in changes.items() if change <= -1.3
        ]
        if before:
            ta, speed = number(row, "ttc"), max(before)
            if not ta:
                return {"ta": None, "conflicting_speed": speed, "ta_level": None}
            border = 1.5 * speed / (16.7 * math.exp(-0.0306 * 0.5 * speed))
            level = min(max(26 + math.floor((border - ta) / 0.5), 1), 30)
            return {"ta": ta, "conflicting_speed": speed, "ta_level": float(level)}
    return {"ta": None, "conflicting_speed": None, "ta_level": None}


def test_the_crash_potential_is_the_mean_probability_of_the_steps(measured: Callable[[str], Run]) -> None:
    stats = pytest.importorskip("scipy.stats")
    run = measured("reckless")
    brakes = stats.truncnorm((4.23 - 8.45) / 1.42, (12.68 - 8.45) / 1.42, 8.45, 1.42)
    compared = 0
    for conflict in run.conflicts:
        steps = run.steps[conflict["id"]]
        chances = [row["collision"] == "true" or float(brakes.cdf(float(row["drac"] or 0))) for row in steps]
        expected = sum(chances) / len(steps)
        assert float(conflict["cpi"]) == pytest.approx(expected, abs=1e-4), conflict["id"]
        compared += expected > 0.01
    assert compared > 3, compared


def log_of(net: str, out: Path, *words: str) -> bytes:
    done = closecall("run", NETS / net / f"{net}.sumocfg", "--out", out, "--quiet", *words, "--", "--no-warnings")
    assert done.returncode == 0, done.stderr
    return (out / "conflicts.csv").read_bytes()


def test_added_columns_follow_those_that_every_log_has(tmp_path: Path) -> None:
    default = log_of("side", tmp_path / "default")
    assert log_of("side", tmp_path / "named", "--measures", "default") == default
    table = list(csv.reader(io.StringIO(log_of("side", tmp_path / "all", "--measures", "all").decode())))
    chosen = list(csv.reader(io.StringIO(log_of("side", tmp_path / "two", "--measures", "ei,t2").decode())))
    common = list(csv.reader(io.StringIO(default.decode())))
    count = len(common[0])
    assert [row[:count] for row in table] == common == [row[:count] for row in chosen]
    assert [row[count:] for row in chosen] == [[row[table[0].index(name)] for name in ("t2", "ei")] for row in table]
    assert chosen[0][count:] == ["t2", "ei"] and len(table[0]) == count + 28
    options = json.loads((tmp_path / "two" / "run.json").read_text())["options"]
    assert options["measures"] == "t2,ei"
    assert "measures" not in json.loads((tmp_path / "default" / "run.json").read_text())["options"]


def test_every_reader_takes_logs_with_and_without_them(tmp_path: Path) -> None:
    for name in ("default", "all"):
        log_of("side", tmp_path / name, "--measures", name)
        for command in ("stats", "report"):
            done = closecall(command, tmp_path / name, *(("--out", tmp_path / f"{name}.html") * (command == "report")))
            assert done.returncode == 0, done.stderr
    without, with_all = (read_log(tmp_path / name) for name in ("default", "all"))
    assert [one.tadv for one in without] == [None] * len(without)
    assert any(one.t2 is not None for one in with_all)
    assert [one.margin for one in without] == [one.margin for one in with_all]


def test_a_measure_that_is_not_there_is_named(tmp_path: Path) -> None:
    done = closecall("run", NETS / "side" / "side.sumocfg", "--out", tmp_path / "out", "--measures", "t2,picud")
    assert done.returncode == 2 and 'cannot add an unknown measure "picud"' in done.stderr
    with pytest.raises(ValueError, match="unknown measure"):
        cc.Checker(measures="picud")


def test_a_scripts_conflicts_have_the_measures_that_it_chose() -> None:
    with cc.Checker(measures="mttc,sgap") as checker:
        for step in range(10):
            time = step / 10
            x = [20 * time, 40 + 5 * time]
            checker.step(time, {"id": ["a", "b"], "heading": [0, 0], "speed": [20, 5], "y": [0, 0], "x": x})
        (conflict,) = checker.conflicts
    # Cars are 5 m long: 35 m at first, 15 m/s.
    assert conflict.mttc == pytest.approx((35 - 0.9 * 15) / 15) and conflict.sgap == pytest.approx(35 - 0.9 * 15)
    assert conflict.tadv is None


def test_a_followers_measures_equal_the_devices(tmp_path: Path) -> None:
    words = ["--device.ssm.probability", "1", "--device.ssm.measures", "TTC MDRAC SGAP BR", "--precision", "6"]
    words += ["--device.ssm.thresholds", "1000 0 1000 0", "--device.ssm.range", "100", "--device.ssm.mdrac.prt", "1"]
    words += ["--device.ssm.trajectories", "true", "--device.ssm.file", str(tmp_path / "ssm.xml"), "--no-warnings"]
    more = ("--measures", "all", "--log-series", "--align", "never")
    done = closecall("run", NETS / "rear_end" / "rear_end.sumocfg", "--out", tmp_path / "log", *more, "--", *words)
    assert done.returncode == 0, done.stderr
    device: dict[tuple[float, str, str], dict[str, str]] = {}
    for conflict in ET.parse(tmp_path / "ssm.xml").getroot().findall("conflict"):
        spans = {name: conflict.find(f"{name}Span") for name in ("time", "MDRAC")}
        columns = {name: (span.get("values") or "").split() for name, span in spans.items() if span is not None}
        for time, mdrac in zip(columns["time"], columns.get("MDRAC", [])):
            device[round(float(time), 3), conflict.get("ego", ""), conflict.get("foe", "")] = {"mdrac": mdrac}
    equal = 0
    for row in rows(tmp_path / "log" / "series.csv"):
        theirs = device.get((round(float(row["time"]), 3), row["ego"], row["foe"]), {}).get("mdrac", "NA")
        if row["mdrac"] and theirs != "NA" and float(row["mdrac"]) < 12.68:
            assert float(theirs) == pytest.approx(float(row["mdrac"]), abs=1e-4), row
            equal += 1
    assert equal > 20, equal
