"""The runs of `closecall sweep`, each in a process of its own.

libsumo allows one simulation per process, and a simulation that crashes must not take the sweep or a worker along. A
pool of threads waits for these processes, without a socket: a process ends when its standard input does.
"""

from __future__ import annotations

import os
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import suppress
from pathlib import Path

from . import _start
from ._closecall import finish_run

Task = tuple[str, list[str], str]
"""A run: its name, the arguments of `closecall run`, and the task for `finish_run`."""

ATTEMPTS = 2
"""How often a run that fails is tried."""

ASKED_EVERY = 0.2
"""Interval in s at which it is asked whether a run is still wanted."""

MOST_SAID = 1 << 16
"""Bytes of a run's messages that are kept."""


def results(
    tasks: list[Task], folder: str | os.PathLike[str], workers: int, scheduler: str | None
) -> Iterator[tuple[str, str | None]]:
    """Do the tasks; yields the name of each as it ends, with the error message if it failed twice.

    Unfinished logs are in `folder`. Without the address of a scheduler this machine does the work, with `workers` tasks
    at once. No run outlives the iteration, however it ends.

    Raises:
        ImportError: there is the address of a scheduler, but Dask is not installed.
        OSError: no scheduler answers at the address.
    """
    if scheduler is None:
        return on_this_machine(tasks, str(folder), workers)
    from .sweep_cluster import on_cluster

    return on_cluster(tasks, str(folder), scheduler)


def on_this_machine(tasks: list[Task], folder: str, workers: int) -> Iterator[tuple[str, str | None]]:
    """Do the tasks with `workers` processes at once."""
    here = str(Path.cwd())
    ended = threading.Event()

    def attempts(task: Task) -> tuple[str, str | None]:
        error = None
        for _ in range(ATTEMPTS):
            if ended.is_set():
                break
            try:
                run(*task, folder, here, lambda: not ended.is_set())
            except Exception as failed:
                error = message(failed)
            else:
                return task[0], None
        return task[0], error

    pool = ThreadPoolExecutor(workers)
    try:
        for future in as_completed([pool.submit(attempts, task) for task in tasks]):
            yield future.result()
    finally:
        ended.set()
        pool.shutdown(cancel_futures=True)


def message(error: BaseException) -> str:
    """The message of an exception, in one line."""
    return " ".join(str(error).split()) or type(error).__name__


def run(name: str, words: list[str], task: str, folder: str, here: str, is_wanted: Callable[[], bool]) -> None:
    """Do one run, and give it up once it is no longer wanted.

    Raises:
        RuntimeError: the run failed, with its error message.
    """
    Path(folder).mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f"{name}.", dir=folder) as unfinished:
        log = Path(unfinished, "log")
        begun = time.perf_counter()
        command = [*_start.command("_child"), "run", "--quiet", "--out", str(log), *words]
        with subprocess.Popen(
            command,
            cwd=here,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            # Not a file: the reason of a failed run may be that the disk is full.
            stderr=subprocess.PIPE,
            # Ctrl-C must reach only the sweep, which then ends its runs.
            start_new_session=True,
        ) as process:
            said, cpu = wait(process, is_wanted)
        wall = time.perf_counter() - begun
        if process.returncode != 0:
            raise RuntimeError(failure(said.decode(errors="replace"), process.returncode))
        finish_run(task, str(log), wall, cpu)


def wait(process: subprocess.Popen[bytes], is_wanted: Callable[[], bool]) -> tuple[bytes, float]:
    """Wait until the process has ended, and kill it once it is no longer wanted.

    Returns:
        The end of what it said, and its processor time in s.
    """
    ended = threading.Event()

    def watch() -> None:
        while not ended.wait(ASKED_EVERY):
            if not is_wanted():
                # Not Popen.kill, which might take the end of the process from the wait below.
                with suppress(ProcessLookupError):
                    os.kill(process.pid, signal.SIGKILL)

    # A wait with a timeout notices the end up to 50 ms late, so that a thread asks instead.
    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    said = b""
    assert process.stderr
    while block := process.stderr.read1(MOST_SAID):  # type: ignore[attr-defined]
        said = (said + block)[-MOST_SAID:]
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    ended.set()
    watcher.join()
    return said, used.ru_utime + used.ru_stime


def failure(text: str, status: int) -> str:
    """Why a run failed: closecall's last message, or else the last line, or else how the process ended."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    own = [line.removeprefix("closecall: ") for line in lines if line.startswith("closecall: ")]
    if own or lines:
        return (own or lines)[-1]
    return f"killed by signal {-status}" if status < 0 else f"closecall run ended with exit status {status}"
