"""`closecall run` on real scenarios, through real libsumo."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Callable

import pytest
from conftest import NETS, Once, begin, closecall, closecall_apart, python, rows, wait_for_rows

CONFLICT_COLUMNS = (
    "id,ego,foe,kind,severity,nearness,consequence,artefact,begin,end,time,gap,mu,margin,clearance,ttc,drac,unavoidable,pet,"
    "ego_delta_v,foe_delta_v,ego_speed,foe_speed,angle,x,y,lane,collision,collision_sumo,ego_type,foe_type,"
    "ego_x,ego_y,ego_heading,ego_length,ego_width,ego_path,foe_x,foe_y,foe_heading,foe_length,foe_width,foe_path,"
    "headway,overlap,response_left,ttb,crash_probability,crash_probability_braking,injury_probability,extended_delta_v,"
    "manoeuvre,cause,lane_change_reason,ego_lane,ego_lane_position,foe_lane,foe_lane_position,edge,junction,lon,lat"
)
SERIES_COLUMNS = (
    "conflict,ego,foe,kind,severity,nearness,consequence,artefact,time,gap,mu,margin,clearance,ttc,drac,unavoidable,"
    "ego_delta_v,foe_delta_v,ego_speed,foe_speed,angle,x,y,lane,collision,ego_x,ego_y,ego_heading,foe_x,foe_y,foe_heading,headway,overlap,response_left,ttb,"
    "crash_probability,crash_probability_braking,injury_probability,extended_delta_v,manoeuvre,cause,"
    "lane_change_reason,ego_lane,ego_lane_position,foe_lane,foe_lane_position,edge,junction,lon,lat"
)

Copy = Callable[[str], Path]


@pytest.mark.parametrize("kind", ["frontal", "rear_end", "side"])
def test_each_kind_is_found_in_its_own_scene(kind: str, scenario: Copy) -> None:
    config = scenario(kind)
    done = closecall("run", config)
    assert done.returncode == 0, done.stderr
    found = rows(config.parent / "closecall-out" / "conflicts.csv")
    assert [row["kind"] for row in found] == [kind]
    assert float(found[0]["margin"]) < 0
    assert kind in done.stdout


def test_the_log_has_the_promised_columns_and_counts(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    out = tmp_path / "log"
    done = closecall("run", "-c", config, "--out", out, "--log-series", "--quiet", "-e", "8")
    assert (done.returncode, done.stdout) == (0, ""), done.stderr
    assert (out / "conflicts.csv").read_text().splitlines()[0] == CONFLICT_COLUMNS
    assert (out / "series.csv").read_text().splitlines()[0] == SERIES_COLUMNS
    record = json.loads((out / "run.json").read_text())
    assert record["complete"] is True
    assert record["options"]["epsilon"] == 0.5
    assert record["versions"]["sumo"].startswith("SUMO 1.")
    assert {Path(file["path"]).name for file in record["inputs"]} == {
        "rear_end.sumocfg",
        "rear_end.net.xml",
        "rear_end.rou.xml",
    }
    assert sum(count["count"] for count in record["summary"]["conflicts"]) == len(rows(out / "conflicts.csv"))
    steps = rows(out / "series.csv")
    assert all(float(row["margin"]) < 0 for row in steps)
    conflict = rows(out / "conflicts.csv")[0]
    assert float(conflict["margin"]) == min(float(row["margin"]) for row in steps)


@pytest.fixture(scope="module")
def reckless(once: Once) -> Path:
    """A folder with the log of the reckless drivers, what the run said, and the collisions that SUMO reported."""

    def fill(folder: Path) -> None:
        words = ("--out", folder / "log", "--", "--collision-output", folder / "collisions.xml")
        done = closecall("run", NETS / "reckless" / "reckless.sumocfg", *words)
        assert done.returncode == 0, done.stderr
        (folder / "said").write_text(done.stdout)

    return once("reckless", fill)


def test_equal_input_gives_equal_bytes(reckless: Path, scenario: Copy, tmp_path: Path) -> None:
    assert closecall("run", scenario("reckless"), "--out", tmp_path / "again").returncode == 0
    first, second = ((log / "conflicts.csv").read_bytes() for log in (reckless / "log", tmp_path / "again"))
    assert first == second
    assert len(first.splitlines()) > 10


def test_every_collision_that_sumo_reports_was_announced(reckless: Path) -> None:
    said, found = (reckless / "said").read_text(), rows(reckless / "log" / "conflicts.csv")
    collisions = ET.parse(reckless / "collisions.xml").getroot().findall("collision")
    assert len(collisions) >= 3
    for collision in collisions:
        pair = {collision.get("collider"), collision.get("victim")}
        when = float(collision.get("time", "nan"))
        announced = [row for row in found if {row["ego"], row["foe"]} == pair and float(row["begin"]) <= when]
        assert any(row["collision_sumo"] == "true" for row in announced), (pair, when, announced)
    pairs = {frozenset((collision.get("collider"), collision.get("victim"))) for collision in collisions}
    marked = [row for row in found if row["collision_sumo"] == "true"]
    assert {frozenset((row["ego"], row["foe"])) for row in marked} == pairs
    summary = json.loads((reckless / "log" / "run.json").read_text())["summary"]
    assert summary["collisions_sumo"] == {"reported": len(pairs), "in_conflict": len(marked)}
    overlaps = [row for row in found if row["collision"] == "true" and not row["artefact"]]
    assert f"{len(overlaps)} overlaps; SUMO counts " in said
    assert "skipped" not in said and len(said.partition("\nconflicts ")[2].splitlines()) <= 10


def test_typed_options_override_those_of_the_toml_file(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    settings = tmp_path / "closecall.toml"
    settings.write_text('epsilon = 2.0\nmu = "at-rest"\n[type.truck]\nbuild_up = 0.2\n')
    assert closecall("run", config, "--config", settings, "--mu", "minimal", "--out", tmp_path / "o").returncode == 0
    options = json.loads((tmp_path / "o" / "run.json").read_text())["options"]
    assert (options["epsilon"], options["mu"], options["types"]["truck"]["build_up"]) == (2.0, "minimal", 0.2)
    settings.write_text("epsilom = 2.0\n")
    refused = closecall("run", config, "--config", settings)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "epsilom" in refused.stderr


def test_a_filter_keeps_only_conflicts_inside_it(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("side")
    wanted = tmp_path / "selection.txt"
    wanted.write_text("junction:crossing\n")
    assert closecall("run", config, "--filter", wanted, "--out", tmp_path / "in").returncode == 0
    assert len(rows(tmp_path / "in" / "conflicts.csv")) == 1
    wanted.write_text("edge:no_such_edge\n")
    refused = closecall("run", config, "--filter", wanted, "--out", tmp_path / "out")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "no_such_edge" in refused.stderr


def test_the_net_is_the_one_that_sumo_runs_on(scenario: Copy, tmp_path: Path) -> None:
    config, other = scenario("side"), scenario("frontal")
    net = config.with_name("side.net.xml")
    assert closecall("run", config, "-o", tmp_path / "named").returncode == 0
    config.write_text(config.read_text().replace('"side.net.xml"', f'"{other.with_name("frontal.net.xml")}"'))
    done = closecall("run", config, "--out", tmp_path / "overridden", "--", "--net-file", net)
    assert done.returncode == 0, done.stderr
    named, overridden = [(tmp_path / out / "conflicts.csv").read_bytes() for out in ("named", "overridden")]
    assert named == overridden
    assert rows(tmp_path / "overridden" / "conflicts.csv")[0]["lane"]


def test_paper_mode_runs_the_flow_chart_as_printed(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    assert closecall("run", config, "--mode", "paper", "--out", tmp_path / "paper").returncode == 0
    found = rows(tmp_path / "paper" / "conflicts.csv")
    assert [row["kind"] for row in found] == ["rear_end"]


def test_polygons_of_the_named_types_are_obstacles(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("obstacles")
    assert closecall("run", config, "--out", tmp_path / "without").returncode == 0
    assert closecall("run", config, "--obstacles", "obstacle", "--out", tmp_path / "with").returncode == 0
    without, with_them = (rows(tmp_path / out / "conflicts.csv") for out in ("without", "with"))
    polygons = {row["foe"] for row in with_them} - {row["foe"] for row in without}
    assert polygons
    assert all(row["kind"] == "frontal" for row in with_them if row["foe"] in polygons)


def test_a_vehicle_parked_off_the_road_is_ignored(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("rear_end")
    routes = config.parent / "rear_end.rou.xml"
    stop = '<stop lane="road_0" endPos="{}" duration="900" parking="{}"/>'
    for parking, expected in (("true", 0), ("false", 1)):
        routes.write_text(
            '<routes><vType id="car"/><route id="r" edges="road"/>'
            f'<vehicle id="parked" type="car" route="r" depart="0" departPos="20">{stop.format(40, parking)}</vehicle>'
            '<vehicle id="passing" type="car" route="r" depart="8" departPos="5" departSpeed="20" '
            'insertionChecks="none"/></routes>'
        )
        out = tmp_path / parking
        assert closecall("run", config, "--end", "20", "--out", out).returncode == 0
        pairs = [row for row in rows(out / "conflicts.csv") if "parked" in (row["ego"], row["foe"])]
        assert bool(pairs) == bool(expected), (parking, pairs)


@pytest.mark.parametrize("asked", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_and_sigterm_end_a_run_cleanly(asked: signal.Signals, scenario: Copy) -> None:
    config = scenario("town")
    process = begin("run", config)
    out = config.parent / "closecall-out"
    wait_for_rows(out / "conflicts.csv", process, 50)
    process.send_signal(asked)
    _, message = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted at" in message
    assert "Traceback" not in message
    record = json.loads((out / "run.json").read_text())
    assert record["complete"] is False
    assert sum(count["count"] for count in record["summary"]["conflicts"]) == len(rows(out / "conflicts.csv"))


def test_a_seed_chosen_by_sumo_is_recorded_as_unknown(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("curves")
    outs = [tmp_path / name for name in ("a", "b")]
    for out in outs:
        done = closecall("run", config, "--end", "5", "--quiet", "--out", out, "--", "--random")
        assert (done.returncode, done.stderr) == (0, "")
        assert json.loads((out / "run.json").read_text())["seed"] is None
    stats = closecall("stats", *outs)
    assert stats.returncode == 0 and "repeats" not in stats.stdout + stats.stderr
    refused = closecall("run", config, "--seed", "3", "--out", tmp_path / "c", "--", "--random")
    assert refused.returncode == 2
    assert "option random is on" in refused.stderr and refused.stderr.count("\n") == 1
    assert not (tmp_path / "c").exists()


def test_settings_for_unused_types_are_reported(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("curves")
    routes = config.with_suffix(".rou.xml")
    kinds = sorted(set(re.findall(r'<vType id="(\w+)"', routes.read_text())))
    settings = tmp_path / "settings.toml"
    settings.write_text("".join(f"[type.'{kind}']\ndecel = 5.0\n" for kind in [*kinds, "cra", "car@one"]))
    words = ("--config", settings, "--obstacles", "kiosk", "--out", tmp_path)
    done = closecall("run", config, *words)
    reported = [line for line in done.stdout.splitlines() if "no road user of this type" in line]
    assert [line.split(":")[0] for line in reported] == ["[type.car@one]", "[type.cra]", "obstacles kiosk"]
    quiet = closecall("run", config, *words, "--quiet")
    assert (quiet.returncode, quiet.stdout) == (0, "")


def test_a_configuration_for_traci_runs_without_a_client(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("curves")
    config.write_text(config.read_text().replace("</configuration>", '<remote-port value="18813"/></configuration>'))
    assert closecall("run", config, "--end", "5", "--out", tmp_path).returncode == 0
    assert json.loads((tmp_path / "run.json").read_text())["summary"]["steps"] == 25


def test_a_last_option_without_value_is_left_to_sumo(scenario: Copy, tmp_path: Path) -> None:
    done = closecall_apart("run", scenario("curves"), "--end", "5", "--", "--fcd-output", cwd=tmp_path)
    # SUMO takes the missing value as "true", a file name here.
    assert done.returncode == 0 and (tmp_path / "true").is_file(), done.stderr


@pytest.mark.parametrize("end", ["1", "1.05", "1.15", "1.2"])
def test_the_last_step_is_sumos_own(end: str, scenario: Copy, tmp_path: Path) -> None:
    config = scenario("curves")
    done = closecall(
        "run", config, "--end", end, "--quiet", "--out", tmp_path, "--", "--fcd-output", tmp_path / "fcd.xml"
    )
    assert done.returncode == 0, done.stderr
    sumos = [float(step.get("time", "nan")) for step in ET.parse(tmp_path / "fcd.xml").getroot()]
    record = json.loads((tmp_path / "run.json").read_text())["summary"]
    assert (record["steps"], record["end"]) == (len(sumos), pytest.approx(sumos[-1]))
    assert sumos[-1] < float(end) <= sumos[-1] + 0.2 + 1e-9


def test_a_killed_runs_log_is_a_prefix_of_the_whole(scenario: Copy, town: Path, tmp_path: Path) -> None:
    config = scenario("town")
    process = begin("run", config, "--end", "60", "--out", tmp_path / "killed")
    log = tmp_path / "killed" / "conflicts.csv"
    wait_for_rows(log, process, 200)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate(timeout=60)
    killed = log.read_text()
    whole = Path(shutil.copytree(town / "log", tmp_path / "whole"))
    assert (whole / "conflicts.csv").read_text().startswith(killed)

    # A kill may cut the last row short, but too rarely for a test: cut it here.
    log.write_text(killed.rstrip()[:-1])
    report = closecall("report", tmp_path / "killed", "-o", tmp_path / "report.html")
    assert report.returncode == 0, report.stderr
    counts = re.findall(r"(\d+) conflicts of|set aside (\d+)", report.stdout + report.stderr)
    assert sum(int(one or other) for one, other in counts) == killed.rstrip().count("\n") - 1
    stats = closecall("stats", tmp_path)
    assert stats.returncode == 0, stats.stderr
    assert "killed: the run has no result: it was killed, or is still running" in stats.stdout + stats.stderr


def test_a_libsumo_that_needs_a_blocked_module_gets_it() -> None:
    # This libsumo cannot be imported without traci; another version may need a module that closecall blocks.
    script = """
from closecall import _sumo
_sumo.UNUSED = (*_sumo.UNUSED, "traci")
print(_sumo.import_libsumo().simulation.getVersion())
"""
    done = python(script)
    assert done.returncode == 0, done.stderr
    assert "SUMO 1." in done.stdout, done.stdout
