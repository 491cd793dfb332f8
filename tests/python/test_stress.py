"""`closecall stress`: its output and its exit status."""

from __future__ import annotations

import signal
import time

import psutil
from conftest import begin, closecall, until


def test_the_same_seed_gives_the_same_table() -> None:
    first = closecall("stress", "--cases", "100", "--seed", "5")
    assert first.returncode == 0, first.stdout
    assert closecall("stress", "--cases", "100", "--seed", "5").stdout == first.stdout
    assert "all " in first.stdout.splitlines()[-1]


def test_one_group_can_be_chosen() -> None:
    lines = closecall("stress", "--cases", "600", "--only", "braking").stdout.splitlines()
    assert {line.split()[0] for line in lines[1:-1]} == {"braking"}


def test_zero_cases_are_refused() -> None:
    run = closecall("stress", "--cases", "0")
    assert run.returncode == 2
    assert run.stderr.startswith("closecall: invalid value '0' for '--cases <N>'")


def test_ctrl_c_ends_stress_at_once() -> None:
    process = begin("stress", "--cases", "1000000000")
    until(lambda: psutil.Process(process.pid).cpu_times().user > 0.3)
    begun = time.monotonic()
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=30) == ("", "")
    assert process.returncode == -signal.SIGINT
    assert time.monotonic() - begun < 5
