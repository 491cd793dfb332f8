"""`closecall stats` against an independent script: plain Python and scipy on the CSV log and SUMO's fcd-output."""

from __future__ import annotations

import csv
import json
import math
import shutil
import statistics
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
from conftest import NETS, Once, closecall, counted, is_one_message, parked, rows
from scipy import stats as scipy_stats

Copy = Callable[[str], Path]


def simulate(config: Path, out: Path, *words: str | Path, sumo: tuple[str | Path, ...] = ()) -> Path:
    """Run a configuration and return the folder of its log."""
    done = closecall("run", config, "--quiet", "--out", out, *words, "--", "--no-warnings", *sumo)
    assert done.returncode == 0, done.stderr
    return out


def stats(*words: str | Path) -> Any:
    """The JSON output of `closecall stats`."""
    done = closecall("stats", *words, "--format", "json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def plans(once: Once) -> Path:
    """Runs of both signal programs of left_turn: sixteen seeds of `left_turn`, eight of `protected`."""

    def fill(folder: Path) -> None:
        for plan, seeds in (("left_turn", range(1, 17)), ("protected", range(1, 9))):
            for seed in seeds:
                half = "first" if seed <= 8 else "second"
                out = folder / plan / half / f"seed={seed}"
                # Few of them are late enough to be serious by default.
                rule = ("--severity-rule", "time-left", "--serious-probability", "0.1", "--serious-delta-v", "0")
                words = ("--seed", str(seed), "--log-clips", "serious", "--end", "150", *rule)
                simulate(NETS / "left_turn" / f"{plan}.sumocfg", out, *words)

    return once("plans", fill)


def test_statistics_equal_those_of_an_independent_script(tmp_path: Path) -> None:
    fcd = tmp_path / "fcd.xml"
    words = ("--end", "60", "--log-series")
    stops = tmp_path / "stops.xml"
    unfinished = ("--stop-output", stops, "--stop-output.write-unfinished")
    record = ("--fcd-output", fcd, "--precision", "6", *unfinished)
    log = simulate(NETS / "town" / "town.sumocfg", tmp_path / "log", *words, sumo=record)
    found = stats(log, "--by", "severity")

    # Traffic from SUMO's own recording, without vehicles that are parked off the road.
    is_parked = parked(stops)
    times: list[float] = []
    vehicles: set[str] = set()
    persons: set[str | None] = set()
    driven = 0.0
    for step in ET.parse(fcd).getroot():
        time = float(step.get("time", "nan"))
        times.append(time)
        speeds = {vehicle.get("id", ""): float(vehicle.get("speed", "nan")) for vehicle in step.findall("vehicle")}
        driven += 0.5 * sum(speed for name, speed in speeds.items() if not is_parked(name, time))
        vehicles |= speeds.keys()
        persons |= {person.get("id") for person in step.findall("person")}
    traffic = found["traffic"]
    assert traffic["hours"] == pytest.approx(len(times) * 0.5 / 3600)
    assert traffic["vehicle_kilometres"] == pytest.approx(driven / 1000, rel=1e-6)
    assert (traffic["vehicles"], traffic["persons"]) == (len(vehicles), len(persons))

    # Counts from the rows of conflicts.csv.
    logged = counted(log)
    assert len(logged) > 200
    groups = {group["group"]: group for group in found["groups"]}
    severities = {row["severity"] for row in logged}
    assert {"caution", "serious"} <= severities
    for name in ("all", *severities):
        wanted = [row for row in logged if name in ("all", row["severity"])]
        group = groups[name]
        assert group["count"] == len(wanted)
        assert group["per_hour"]["value"] == pytest.approx(len(wanted) / traffic["hours"])
        assert group["per_vehicle_kilometre"]["value"] == pytest.approx(len(wanted) / (driven / 1000), rel=1e-6)
        assert group["per_1000_vehicles"]["value"] == pytest.approx(1000 * len(wanted) / len(vehicles))
        for measure in ("ttc", "pet", "margin", "delta_v"):
            if measure == "delta_v":
                values = [max(float(row["ego_delta_v"]), float(row["foe_delta_v"])) for row in wanted]
            else:
                values = [float(row[measure]) for row in wanted if row[measure]]
            assert group[measure]["count"] == len(values)
            for key, share in (("q05", 5), ("q25", 25), ("q50", 50), ("q75", 75), ("q95", 95)):
                quantile = np.percentile(values, share) if values else None
                assert group[measure][key] == (pytest.approx(quantile, abs=1e-9) if values else None)
        low, high = (scipy_stats.chi2.ppf(p, 2 * n) / 2 for p, n in ((0.025, len(wanted)), (0.975, len(wanted) + 1)))
        assert group["per_hour"]["method"] == "poisson_exact"
        assert group["per_hour"]["low"] == pytest.approx(low / traffic["hours"], rel=1e-6)
        assert group["per_hour"]["high"] == pytest.approx(high / traffic["hours"], rel=1e-6)
    # Smallest margin and TTC of each conflict from the steps in series.csv.
    steps: dict[frozenset[str], list[dict[str, str]]] = {}
    for row in rows(log / "series.csv"):
        steps.setdefault(frozenset((row["ego"], row["foe"])), []).append(row)
    margins, nearest = [], []
    for row in logged:
        pair = steps[frozenset((row["ego"], row["foe"]))]
        own = [step for step in pair if float(row["begin"]) <= float(step["time"]) <= float(row["end"])]
        margins.append(min(float(step["margin"]) for step in own))
        nearest += [min(times) for times in [[float(step["ttc"]) for step in own if step["ttc"]]] if times]
    assert groups["all"]["margin"]["q50"] == pytest.approx(statistics.median(margins), abs=1e-9)
    assert groups["all"]["ttc"]["q50"] == pytest.approx(statistics.median(nearest), abs=1e-9)


def test_groups_and_hot_spots_add_up(tmp_path: Path) -> None:
    log = simulate(NETS / "town" / "town.sumocfg", tmp_path / "log", "--end", "60")
    logged = counted(log)
    of: dict[str, Callable[[dict[str, str]], str]] = {
        "kind": lambda row: row["kind"],
        "edge": lambda row: row["lane"].rpartition("_")[0] or "(none)",
        "type": lambda row: f"{row['ego_type']}/{row['foe_type']}",
        "hour": lambda row: str(math.floor(float(row["time"]) / 3600)),
        "junction": lambda row: row["lane"][1:].rsplit("_", 2)[0] if row["lane"].startswith(":") else "(none)",
    }
    for by, group_of in of.items():
        counts: dict[str, int] = {}
        for row in logged:
            counts[group_of(row)] = counts.get(group_of(row), 0) + 1
        found = stats(log, "--by", by, "--top", "1000")
        assert {group["group"]: group["count"] for group in found["groups"][1:]} == counts
        if by in ("edge", "junction"):
            counts.pop("(none)", None)
            assert {spot["id"]: spot["count"] for spot in found[f"{by}s"]} == counts
    entered = json.loads((log / "run.json").read_text())["summary"]["entered"]
    for spot in found["junctions"]:
        per_entering = spot["risk_index_per_1000_entering"]
        for end in ("value", "low", "high"):
            assert per_entering[end] == pytest.approx(1000 * spot["risk_index"][end] / entered[spot["id"]])
    assert {"car", "walker"} <= {name for row in logged for name in (row["ego_type"], row["foe_type"])}


def test_the_worst_conflicts_come_first_in_sorted_rows(plans: Path) -> None:
    found = stats(plans / "left_turn", "--top", "500")["worst"]
    every = [row for log in sorted(plans.glob("left_turn/*/*")) for row in counted(log)]
    order = ["caution", "serious", "critical"]

    def rank(row: dict[str, str]) -> tuple[bool, int, float, float, float, float]:
        ttc = float(row["ttc"]) if row["ttc"] else math.inf
        collides = row["collision"] == "true"
        delta_v = max(float(row["ego_delta_v"]), float(row["foe_delta_v"])) if collides else 0.0
        probability = float(row["crash_probability"])
        return not collides, -order.index(row["severity"]), -delta_v, -probability, ttc, float(row["margin"])

    wanted = sorted(every, key=rank)[:500]
    assert [(one["ego"], one["foe"], one["time"]) for one in found] == [
        (row["ego"], row["foe"], float(row["time"])) for row in wanted
    ]
    first = found[0]
    assert first["command"] == f"closecall show {first['folder']} {first['id']}"
    mild = next(one for one in found if one["severity"] == "caution")
    assert f"--seed {mild['seed']} " in mild["command"] and "sumo-gui -c " in mild["command"]
    assert "--breakpoints" in mild["command"] and "\n" not in mild["command"] and "$" not in mild["command"]


def test_intervals_over_seeds_follow_students_t(plans: Path) -> None:
    found = stats(plans / "protected")
    runs = sorted(plans.glob("protected/*/*"))
    counts = [len(counted(run)) for run in runs]
    records = [json.loads((run / "run.json").read_text())["summary"] for run in runs]
    hours = {record["end"] - record["begin"] + 0.2 for record in records}
    assert len(hours) == 1 and found["runs"] == 8
    per_hour = [count / hours.copy().pop() * 3600 for count in counts]
    error = statistics.stdev(per_hour) / math.sqrt(8)
    low, high = scipy_stats.t.interval(0.95, 7, statistics.mean(per_hour), error)
    rate = found["groups"][0]["per_hour"]
    assert (rate["value"], rate["low"], rate["high"]) == pytest.approx((statistics.mean(per_hour), low, high), rel=1e-6)


def test_a_protected_left_turn_has_fewer_side_conflicts(plans: Path) -> None:
    found = stats(plans / "protected", "--against", plans / "left_turn" / "first")["comparison"]
    rates = {row["group"]: row for row in found["rates"]}
    for group in ("all", "side", "serious"):
        row = rates[group]
        assert row["difference"] < 0 and row["ratio"]["high"] < 1
        assert row["significance"]["p_holm"] < 0.05, row
    # The signal program does not change rear-end conflicts.
    assert rates["rear_end"]["significance"]["p_holm"] > 0.05
    margin = next(row for row in found["measures"] if row["measure"] == "margin")
    assert margin["cliffs_delta"] > 0
    # Of all splits into 8 and 8 runs, two are as extreme.
    assert rates["side"]["significance"]["p"] == pytest.approx(2 / math.comb(16, 8))
    assert rates["side"]["significance"]["test"] == "exact_permutation"


def test_two_sets_of_seeds_of_one_plan_do_not_differ(plans: Path) -> None:
    found = stats(plans / "left_turn" / "first", "--against", plans / "left_turn" / "second")["comparison"]
    significances = [row["significance"] for row in found["rates"] + found["measures"]]
    assert [one for one in significances if one and one["p_holm"] < 0.05] == []
    assert len([one for one in significances if one]) >= 6


def test_permutation_test_and_cliffs_delta_equal_scipys(plans: Path) -> None:
    first, second = plans / "left_turn" / "first", plans / "left_turn" / "second"
    found = stats(first, "--against", second)["comparison"]
    values = {
        half: [[float(row["margin"]) for row in counted(log)] for log in sorted(half.glob("*"))]
        for half in (first, second)
    }
    medians = [[statistics.median(run) for run in values[half]] for half in (first, second)]

    def difference(one: Any, other: Any, axis: int = -1) -> Any:
        return np.mean(one, axis=axis) - np.mean(other, axis=axis)

    wanted = scipy_stats.permutation_test(medians, difference, vectorized=True, n_resamples=20_000)
    margin = next(row for row in found["measures"] if row["measure"] == "margin")
    assert margin["significance"]["p"] == pytest.approx(wanted.pvalue, abs=1e-9)
    pooled = [[value for run in values[half] for value in run] for half in (first, second)]
    u = scipy_stats.mannwhitneyu(*pooled).statistic
    assert margin["cliffs_delta"] == pytest.approx(2 * u / len(pooled[0]) / len(pooled[1]) - 1, abs=1e-9)


COLUMNS = """id ego foe kind severity begin end time gap mu margin clearance ttc drac pet delta_v
ego_speed foe_speed angle x y lane collision ego_type foe_type"""


def made(folder: Path, ttcs: list[float], hours: float = 1.0, **record_changes: Any) -> Path:
    """A log folder with one conflict for each TTC."""
    folder.mkdir(parents=True)
    with (folder / "conflicts.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS.split())
        for number, ttc in enumerate(ttcs, 1):
            seen = [number, "<b>", "b", "side", "caution", 0, 1, 1, 1, 2, -1, 1, ttc, 1, "", 1, 1, 1, 1, 0, 0]
            writer.writerow([*seen, "e_0", "false", "car", "car"])
    record: dict[str, Any] = {
        "versions": {"closecall": "0.1.0", "sumo": None},
        "scenario": "made",
        "seed": None,
        "step_length": 0.1,
        "sumo_words": [],
        "inputs": [],
        "options": {},
        "complete": True,
        "summary": {
            "begin": 0.0,
            "end": 3600 * hours - 0.1,
            "steps": 10,
            "conflicts": [{"kind": "side", "severity": "caution", "count": len(ttcs)}],
            "collisions": 0,
            "exposure": {"vehicles": 100, "persons": 0, "vehicle_kilometres": 50.0, "vehicle_hours": 2.0},
        },
    }
    (folder / "run.json").write_text(json.dumps({**record, **record_changes}), encoding="utf-8")
    return folder


def simulated(folder: Path, conflicts: int, seed: int, *words: str, **options: Any) -> Path:
    """A log folder as of a run of SUMO."""
    versions = {"closecall": "0.1.0", "sumo": "SUMO 1.28.0"}
    sumo_words = ["-c", "plan.sumocfg", "--seed", str(seed), *words]
    more: dict[str, Any] = {"versions": versions, "seed": str(seed), "sumo_words": sumo_words, "options": options}
    return made(folder, [1.0] * conflicts, **more)


def test_variants_have_rates_of_their_own_and_are_paired_by_seed(tmp_path: Path) -> None:
    counts = {"1": [20, 100, 205], "1.5": [30, 154, 300]}
    for scale, of_seeds in counts.items():
        for seed, conflicts in enumerate(of_seeds, 1):
            simulated(tmp_path / f"{scale}-{seed}", conflicts, seed, f"--scale={scale}", epsilon=0.5)
    found = stats(tmp_path)
    assert found["varied"] == ["sumo:scale"] and found["runs"] == 6
    assert [(one["name"], one["runs"]) for one in found["variants"]] == [("sumo:scale=1", 3), ("sumo:scale=1.5", 3)]
    groups = {(group["variant"], group["group"]): group for group in found["groups"]}
    for scale, of_seeds in counts.items():
        rate = groups[(f"sumo:scale={scale}", "all")]["per_hour"]
        error = statistics.stdev(of_seeds) / math.sqrt(3)
        low, high = scipy_stats.t.interval(0.95, 2, statistics.mean(of_seeds), error)
        wanted = (statistics.mean(of_seeds), max(low, 0), high)
        assert (rate["value"], rate["low"], rate["high"]) == pytest.approx(wanted, rel=1e-6)
    # The delta method on the logarithm, seed by seed.
    first, second = (np.array(counts[scale]) / np.mean(counts[scale]) for scale in ("1", "1.5"))
    reach = scipy_stats.t.ppf(0.975, 2) * np.std(second - first, ddof=1) / math.sqrt(3)
    value = sum(counts["1.5"]) / sum(counts["1"])
    ratio = groups[("sumo:scale=1.5", "all")]["ratio"]
    assert ratio["method"] == "t_over_pairs" and groups[("sumo:scale=1", "all")]["ratio"] is None
    wanted = (value, value * math.exp(-reach), value * math.exp(reach))
    assert (ratio["value"], ratio["low"], ratio["high"]) == pytest.approx(wanted, rel=1e-6)
    assert all(crashes["crashes"] is None and "differ" in crashes["refused"] for crashes in found["extremes"])
    assert all(spot["per_hour"] is None for spot in found["edges"])
    text = closecall("stats", tmp_path).stdout
    assert "the runs differ in sumo:scale: each variant has rates of its own" in text and "COMPARED VARIANTS" in text


def test_variants_without_the_same_seeds_are_independent(tmp_path: Path) -> None:
    for epsilon, seeds in ((0.5, (1, 2, 3)), (1.0, (2, 3, 4))):
        for seed in seeds:
            simulated(tmp_path / f"{epsilon}-{seed}", 5 + seed, seed, epsilon=epsilon)
    ratios = [group["ratio"] for group in stats(tmp_path)["groups"] if group["ratio"]]
    assert [ratio["method"] for ratio in ratios] == ["t_over_runs", "t_over_runs"]


def two_plans(folder: Path) -> tuple[Path, Path]:
    """Eight runs of each of two plans, with 40 to 75 and with 30 to 51 conflicts."""
    for seed in range(1, 9):
        simulated(folder / "before" / str(seed), 35 + 5 * seed, seed, epsilon=0.5)
        simulated(folder / "after" / str(seed), 27 + 3 * seed, 10 + seed, epsilon=0.5)
    return folder / "after", folder / "before"


def test_a_plan_says_how_many_runs_a_ratio_needs(tmp_path: Path) -> None:
    after, before = two_plans(tmp_path)
    counts = [35 + 5 * seed for seed in range(1, 9)]
    (one,) = [group for group in stats(before, "--plan", "1.3")["plan"]["groups"] if group["group"] == "all"]
    assert one["spread"] == pytest.approx(statistics.stdev(counts) / statistics.mean(counts))
    assert one["low"] < one["runs"] < one["high"] and one["power"] is None
    found = stats(after, "--against", before, "--plan", "1.3")
    both = found["plan"]["groups"][0]
    assert 0 < both["power"] < 1
    detectable = found["comparison"]["rates"][0]["detectable"]
    assert (detectable < 1.3) == (both["power"] > 0.8)
    assert (both["runs"] <= 8) == (both["power"] >= 0.8)
    text = closecall("stats", before, "--plan", "1.3").stdout
    assert "RUNS NEEDED IN EACH SET" in text and "to find a ratio of 1.3 or 0.7692" in text


def test_observed_crashes_are_carried_over_by_the_ratio(tmp_path: Path) -> None:
    after, before = two_plans(tmp_path)
    found = stats(after, "--against", before, "--observed", "14", "--years", "5")
    ratio = found["comparison"]["rates"][0]["ratio"]
    crashes = found["transferred"]
    ends = scipy_stats.gamma.ppf([0.025, 0.5, 0.975], 14.5, scale=1 / 5)
    against = [crashes["against"][end] for end in ("low", "value", "high")]
    assert against == pytest.approx(list(ends), rel=0.02)
    answer, slower, faster = crashes["powers"]
    assert (answer["power"], slower["power"], faster["power"]) == (1, 0.5, 1.5)
    assert answer["value"] == pytest.approx(ratio["value"] * ends[1], rel=0.02)
    assert faster["value"] < answer["value"] < slower["value"] < against[1]
    assert crashes["by_ratio"]["low"] > answer["low"] and crashes["by_observed"]["high"] < answer["high"]
    assert stats(after, "--against", before)["transferred"] is None
    for words in (("--observed", "14"), ("--observed", "14", "--years", "5"), ("--years", "5"), ("--plan", "1")):
        done = closecall("stats", after, *words)
        assert done.returncode == 2 and is_one_message(done.stderr), done.stderr


def test_the_risk_index_has_its_old_name_in_old_logs(tmp_path: Path) -> None:
    log = simulated(tmp_path / "log", 5, 1, epsilon=0.5)
    assert "expected_crashes" not in closecall("stats", log).stdout
    record = json.loads((log / "run.json").read_text())
    record["summary"]["expected_crashes"] = 2.5
    (log / "run.json").write_text(json.dumps(record))
    text = closecall("stats", log).stdout
    assert text.count("logs of earlier versions call the risk index expected_crashes") == 1


def test_a_repeated_run_counts_once(tmp_path: Path) -> None:
    for name, conflicts, complete in (("a", 2, False), ("b", 3, True), ("c", 3, True), ("d", 4, True)):
        folder = simulated(tmp_path / name, conflicts, 1, epsilon=0.5)
        record = json.loads((folder / "run.json").read_text())
        (folder / "run.json").write_text(json.dumps({**record, "complete": complete}))
    done = closecall("stats", tmp_path, "--format", "json")
    found = json.loads(done.stdout)
    # a is b without its end, c is b again; of d something is not recorded.
    assert found["runs"] == 2 and found["groups"][0]["count"] == 7
    assert f"{tmp_path}/a: left out: it did not reach its end, and is repeated by {tmp_path}/b" in done.stderr
    assert f"{tmp_path}/c: left out: it repeats {tmp_path}/b" in done.stderr
    assert f"{tmp_path}/d: counted, but compare {tmp_path}/b: same settings and seed" in done.stderr


@pytest.mark.parametrize("shape", [-0.3, -0.1, 0.1])
def test_the_crash_frequency_matches_scipys_fit(shape: float, tmp_path: Path) -> None:
    # No excess reaches 2 s: a TTC below 0 is none that a run writes.
    excesses = scipy_stats.genpareto.rvs(shape, scale=0.25, size=400, random_state=2)
    ttcs = [round(2 - float(excess), 6) for excess in excesses]
    found = stats(made(tmp_path / "log", ttcs, hours=10.0))["extremes"]
    ttc = next(one for one in found if one["quantity"] == "ttc")["crashes"]
    below = sorted(ttcs)[: ttc["below"]]
    assert ttc["threshold"] == sorted(ttcs)[ttc["below"]]
    sample = [ttc["threshold"] - value for value in below]
    c, _, scale = scipy_stats.genpareto.fit(sample, floc=0)
    # scipy's search stops at a looser tolerance: closecall's fit must be as likely, and close to it.
    ours = scipy_stats.genpareto.logpdf(sample, ttc["shape"], scale=ttc["scale"]).sum()
    assert ours >= scipy_stats.genpareto.logpdf(sample, c, scale=scale).sum() - 1e-6
    assert (ttc["shape"], ttc["scale"]) == pytest.approx((c, scale), abs=5e-3)
    wanted = len(below) / 10 * scipy_stats.genpareto.sf(ttc["threshold"], ttc["shape"], scale=ttc["scale"])
    assert ttc["low"] <= wanted <= ttc["high"] and ttc["low"] <= ttc["per_hour"] <= ttc["high"]
    truth = 400 / 10 * scipy_stats.genpareto.sf(2, shape, scale=0.25)
    assert ttc["low"] <= truth <= ttc["high"]
    known = scipy_stats.genpareto(ttc["shape"], scale=ttc["scale"])
    a, n = sorted(sample), len(sample)
    terms = [(2 * i + 1) * (known.logcdf(a[i]) + known.logsf(a[n - 1 - i])) for i in range(n)]
    assert ttc["anderson_darling"] == pytest.approx(-n - sum(terms) / n, rel=1e-6)


def test_extremes_need_sixty_conflicts(tmp_path: Path) -> None:
    found = stats(made(tmp_path / "log", [1.0] * 59))["extremes"]
    assert found[0]["crashes"] is None
    assert found[0]["refused"] == "too few conflicts have this measure: 59, and at least 60 are needed"


def test_a_run_without_conflicts_is_a_result(tmp_path: Path) -> None:
    found = stats(made(tmp_path / "log", []))
    rate = found["groups"][0]["per_hour"]
    assert (rate["value"], rate["low"], rate["high"]) == (0, 0, pytest.approx(3.688879, rel=1e-6))
    for form in ("text", "csv", "html"):
        assert closecall("stats", tmp_path / "log", "--format", form).returncode == 0


def test_every_format_prints_the_same_numbers(tmp_path: Path) -> None:
    log = made(tmp_path / "log", [1.25, 1.5, 1.75])
    text, html = (closecall("stats", log, "--format", form).stdout for form in ("text", "html"))
    values = list(csv.DictReader(closecall("stats", log, "--format", "csv").stdout.splitlines()))
    median = next(v for v in values if (v["table"], v["name"], v["column"]) == ("quantiles", "all", "50 %"))
    assert float(median["value"]) == 1.5 and "1.500" in text and "1.500" in html
    assert "<b>" not in html and "&lt;b&gt;" in html


def test_an_unusable_log_gets_one_clear_line(tmp_path: Path) -> None:
    good = made(tmp_path / "good", [1.0, 2.0])
    text = (good / "conflicts.csv").read_text()

    def broken(name: str, content: str) -> Path:
        folder = tmp_path / name
        shutil.copytree(good, folder)
        (folder / "conflicts.csv").write_text(content)
        return folder

    cases = [
        ((tmp_path / "gone",), "gone: No such file"),
        ((broken("empty", ""),), "it is empty"),
        ((broken("cut", text[:-9]),), "its last row is cut short"),
        ((broken("short", text + "3,a,b\n"),), "line 4: the row has 3 cells, not 25"),
        ((good, broken("old", text.replace(",ego_type", ",an_ego_type"))), "line 1: its columns are not those of"),
        ((broken("schema", text.replace("margin", "slack")),), 'line 1: the column "margin" is missing'),
        ((broken("word", text.replace(",1.0,", ",soon,")),), "line 2: ttc:"),
        ((good, "--against", tmp_path / "gone"), "gone: No such file"),
        ((good, "--by", "colour"), "--by"),
    ]
    unrun = tmp_path / "unrun"
    shutil.copytree(good, unrun)
    (unrun / "run.json").unlink()
    for words, message in [*cases, ((unrun,), "run.json: No such file")]:
        done = closecall("stats", *words)
        assert done.returncode == 2 and message in done.stderr, (words, done)
        assert is_one_message(done.stderr) and not done.stdout, done


def test_a_killed_run_is_left_out_and_reported(tmp_path: Path) -> None:
    good, killed = made(tmp_path / "all" / "good", [1.0]), made(tmp_path / "all" / "killed", [2.0])
    record = json.loads((killed / "run.json").read_text())
    record["complete"], record["summary"]["steps"] = False, 0
    (killed / "run.json").write_text(json.dumps(record))
    done = closecall("stats", tmp_path / "all", "--format", "json")
    assert done.returncode == 0 and "killed" in done.stderr
    assert json.loads(done.stdout)["runs"] == 1
    assert closecall("stats", killed).returncode == 2
    assert stats(good)["groups"][0]["count"] == 1
