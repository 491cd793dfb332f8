"""One run of `closecall sweep`, in a process of its own.

libsumo allows one simulation per process, and a simulation that crashes must not take the sweep or a worker along. The
process needs no socket: it ends when its standard input does.
"""

from __future__ import annotations

import os
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable
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


def message(error: BaseException) -> str:
    """The message of an exception, in one line."""
    return " ".join(str(error).split()) or type(error).__name__


def run(name: str, words: list[str], task: str, folder: str, here: str, is_wanted: Callable[[], bool]) -> None:
    """Do one run, and stop it when it is no longer wanted.

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
