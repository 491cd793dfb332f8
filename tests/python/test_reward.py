"""Rewards: what the conflicts of a step cost."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import closecall

ROOT = Path(__file__).parents[2]

CARS = {"id": ["a", "b"], "x": [0.0, 20.0], "y": [0.0, 0.0], "heading": [0.0, 0.0], "speed": [20.0, 5.0]}


def test_both_of_a_conflict_bear_its_cost_and_the_total_counts_it_once() -> None:
    checker = closecall.Checker()
    reward = closecall.Reward(checker, cost=lambda alarm: -alarm.margin)
    checker.step(0.0, CARS)
    (alarm,) = checker.active
    assert reward.costs() == {"a": -alarm.margin, "b": -alarm.margin}
    assert reward.total() == reward.of("a") == -alarm.margin > 0.0 == reward.of("c")


def test_a_conflict_counts_only_near_its_conflict_point() -> None:
    checker = closecall.Checker()
    reward = closecall.Reward(checker)
    checker.step(0.0, CARS)
    (alarm,) = checker.active
    assert 0.0 < alarm.probability <= 1.0
    assert [reward.near(alarm.x + away, alarm.y, 10.0) for away in (0.0, 9.9, 10.1)] == [alarm.probability] * 2 + [0.0]


def test_an_alarm_of_an_earlier_step_costs_nothing() -> None:
    checker = closecall.Checker()
    reward = closecall.Reward(checker)
    checker.step(0.0, CARS)
    checker.step(0.1, {**CARS, "x": [0.0, 100.0]})
    assert checker.active and reward.costs() == {}


def test_the_example_is_an_environment_that_runs() -> None:
    check = (
        "import warnings; warnings.simplefilter('ignore')\n"
        "import sys, reward\n"
        "from gymnasium.utils.env_checker import check_env\n"
        "check_env(reward.TrafficLight(sys.argv[1], 20.0), skip_render_check=True)\n"
        "sys.argv[2:] = ['--end', '60']\n"
        "reward.main()\n"
    )
    scenario = ROOT / "sumo_nets/signals/signals.sumocfg"
    command = [sys.executable, "-c", check, str(scenario)]
    done = subprocess.run(command, cwd=ROOT / "examples", capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    # pyarrow, beside libsumo, may put a line of its own before.
    assert done.stdout.splitlines()[-1].startswith("12 actions, reward -")
