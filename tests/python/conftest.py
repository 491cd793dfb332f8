"""Helpers and fixtures shared by the tests of the command and the Python module."""

from __future__ import annotations

import csv
import fcntl
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any, Callable

import psutil
import pytest
from closecall._closecall import main
from playwright import sync_api

NETS = Path(__file__).parents[2] / "sumo_nets"

Row = dict[str, str]

TIMEOUT = 300
"""In s: after it a process that a test waits for is taken to hang, even on a machine that is busy with other work."""

# Tests started in the background by a shell ignore Ctrl-C, and so would every process that they start.
signal.signal(signal.SIGINT, signal.default_int_handler)


def forbid_skip(report: Any) -> None:
    """With CLOSECALL_SKIP_NOTHING set, turn a skip into a failure."""
    if report.skipped and os.environ.get("CLOSECALL_SKIP_NOTHING"):
        report.outcome = "failed"


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: Any, call: Any) -> Any:
    """A skipped test."""
    outcome = yield
    forbid_skip(outcome.get_result())


@pytest.hookimpl(hookwrapper=True)
def pytest_make_collect_report(collector: Any) -> Any:
    """A skipped file."""
    outcome = yield
    forbid_skip(outcome.get_result())


def closecall(*words: str | Path) -> subprocess.CompletedProcess[str]:
    """Call the library with the words of a command, in this process, with what it prints captured."""
    texts = list(map(str, words))
    with captured() as said:
        status = main(["closecall", *texts])
    return subprocess.CompletedProcess(texts, status, *said)


@contextmanager
def captured() -> Iterator[list[str]]:
    """Collects what is printed meanwhile, by C++ and Rust too: standard output, then standard error."""
    said: list[str] = []
    with ExitStack() as restored:
        files = []
        for number, redirect in ((1, redirect_stdout), (2, redirect_stderr)):
            file = restored.enter_context(tempfile.TemporaryFile("w+"))
            kept = os.dup(number)
            restored.callback(os.close, kept)
            restored.callback(os.dup2, kept, number)
            os.dup2(file.fileno(), number)
            restored.enter_context(redirect(file))
            files.append(file)
        yield said
        for file in files:
            file.flush()
            file.seek(0)
            said.append(file.read())


def closecall_apart(*words: str | Path, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run the command to its end in a process of its own, with its output captured."""
    started = [sys.executable, "-m", "closecall", *map(str, words)]
    return subprocess.run(started, capture_output=True, text=True, timeout=TIMEOUT, check=False, **options)


def python(script: str, *words: str | Path, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run a script in a process of its own: libsumo allows one simulation per process."""
    command = [sys.executable, "-c", script, *map(str, words)]
    beside = {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    environment = {**os.environ, **beside}
    return subprocess.run(
        command, capture_output=True, text=True, timeout=TIMEOUT, check=False, env=environment, **options
    )


def begin(*words: str | Path) -> subprocess.Popen[str]:
    """Start the command in a session of its own, as from another terminal, and do not wait for it."""
    command = [sys.executable, "-m", "closecall", *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)


def until(condition: Callable[[], object], seconds: float = 60) -> None:
    """Wait until the condition holds."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def wait_for_rows(log: Path, process: subprocess.Popen[str], count: int) -> None:
    """Wait until the log has `count` lines on disk."""
    end = time.monotonic() + 60
    while not log.exists() or log.read_bytes().count(b"\n") < count:
        assert process.poll() is None
        assert time.monotonic() < end
        time.sleep(0.005)


def is_alive(process: psutil.Process) -> bool:
    """Whether a process is running."""
    try:
        return bool(process.status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False


def rows(path: Path) -> list[Row]:
    """The rows of a CSV file."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def counted(log: Path) -> list[Row]:
    """The conflicts of a log folder that count: those that are traffic's."""
    return [row for row in rows(log / "conflicts.csv") if not row["artefact"]]


def parked(stops: Path) -> Callable[[str, float], bool]:
    """Whether a vehicle is parked off the road at a time, from SUMO's stop-output."""
    spans: dict[str, list[tuple[float, float]]] = {}
    for stop in ET.parse(stops).getroot().findall("stopinfo"):
        if stop.get("parking") == "1":
            ended = float(stop.get("ended", "-1"))
            span = float(stop.get("started", "nan")), ended if ended >= 0 else float("inf")
            spans.setdefault(stop.get("id", ""), []).append(span)
    return lambda name, time: any(begin - 1e-6 <= time < end - 1e-6 for begin, end in spans.get(name, []))


def is_one_message(stderr: str) -> bool:
    """Whether the command said one thing: a line, with clap's usage below it if a word was wrong."""
    has_usage = stderr.endswith("\nFor more information, try '--help'.\n")
    return stderr.startswith("closecall: ") and (has_usage or stderr.count("\n") == 1)


Once = Callable[[str, Callable[[Path], None]], Path]


@pytest.fixture(scope="session")
def once(tmp_path_factory: pytest.TempPathFactory) -> Once:
    """Fills a folder once for all workers of pytest-xdist: the first that needs it fills it, the others wait."""
    own = tmp_path_factory.getbasetemp()
    base = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own

    def make(name: str, fill: Callable[[Path], None]) -> Path:
        folder, complete = base / name, base / f"{name}.complete"
        with (base / f"{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not complete.exists():
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir()
                fill(folder)
                complete.touch()
        return folder

    return make


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """Headless Chromium, a package of the system, which .ci/run installs."""
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("Chromium is not installed: apt install chromium")
    with sync_api.sync_playwright() as driver:
        # Chromium refuses to run as root with its sandbox, which containers do not support either.
        browser = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def browser(chromium: Any) -> Iterator[Any]:
    """Chromium for one test, whose pages are closed after it: they would go on drawing."""
    yield chromium
    for context in chromium.contexts:
        context.close()


@pytest.fixture(scope="module")
def town(once: Once) -> Path:
    """A folder with the log of a minute of the town, what the run said, and the report on it."""

    def fill(folder: Path) -> None:
        config = NETS / "town" / "town.sumocfg"
        words = ("--end", "60", "--log-clips", "serious")
        done = closecall("run", config, *words, "--out", folder / "log", "--", "--no-warnings")
        assert done.returncode == 0, done.stderr
        (folder / "said").write_text(done.stdout)
        made = closecall("report", folder / "log", "-o", folder / "report.html")
        assert made.returncode == 0, made.stderr

    return once("town", fill)


@pytest.fixture
def scenario(tmp_path: Path) -> Callable[[str], Path]:
    """Copies a scenario of sumo_nets, which the test may change, and returns the path of its configuration."""

    def copy(name: str) -> Path:
        folder = tmp_path / name
        shutil.copytree(NETS / name, folder, ignore=shutil.ignore_patterns("expected", "closecall-out"))
        return folder / f"{name}.sumocfg"

    return copy
