"""The runs of `closecall sweep` on Dask: each is a task that starts a process of its own.

libsumo allows one simulation per process, and a simulation that crashes must not take its worker along. Local workers
are therefore threads of the sweep that wait for these processes. Worker processes of Dask would first have to start and
import Dask, and then only wait as well.
"""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import tempfile
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

from . import _start
from ._closecall import finish_run

Task = tuple[str, list[str], str]
"""A run: its name, the arguments of `closecall run`, and the task for `finish_run`."""

ASKED_EVERY = 0.2
"""Interval in s at which Dask is asked whether a run is still wanted."""

MOST_SAID = 1 << 16
"""Bytes of a run's messages that are kept."""


def results(
    tasks: list[Task], folder: str | os.PathLike[str], workers: int, scheduler: str | None
) -> Iterator[tuple[str, str | None]]:
    """Do the tasks; yields the name of each as it ends, with the error message if it failed twice.

    Unfinished logs are in `folder`. Without the address of a scheduler this machine does the work, with `workers` tasks
    at once. No run outlives the iteration, however it ends.

    Raises:
        ImportError: Dask is not installed.
        OSError: no scheduler answers at the address.
    """
    from distributed import Client, LocalCluster, as_completed

    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with ExitStack() as stack:
        if scheduler is None:
            cluster = LocalCluster(
                n_workers=1,
                threads_per_worker=workers,
                processes=False,
                memory_limit=0,
                # The scheduler's server always listens; on its usual port it would warn of another sweep's.
                dashboard_address="127.0.0.1:0",
                scheduler_kwargs={"dashboard": False},
                silence_logs=logging.CRITICAL,
            )
            stack.enter_context(cluster)
        client = stack.enter_context(Client(scheduler or cluster))
        # A running scheduler may know a run of the same name from an earlier sweep.
        sweep = uuid.uuid4().hex
        here = str(Path.cwd())
        names = {}
        for name, words, task in tasks:
            key = f"closecall-{name}-{sweep}"
            future = client.submit(run, name, words, task, str(folder), here, key=key, retries=1, pure=False)
            names[future] = name
        try:
            for future in as_completed(list(names)):
                error = future.exception()
                yield names.pop(future), None if error is None else message(error)
                future.release()
        finally:
            client.cancel(list(names), force=True)


def message(error: BaseException) -> str:
    """The message of an exception, in one line."""
    return " ".join(str(error).split()) or type(error).__name__


def run(name: str, words: list[str], task: str, folder: str, here: str) -> None:
    """Do one run, on a worker.

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
            said, cpu = wait(process, wanted())
        wall = time.perf_counter() - begun
        if process.returncode != 0:
            raise RuntimeError(failure(said.decode(errors="replace"), process.returncode))
        finish_run(task, str(log), wall, cpu)


def wait(process: subprocess.Popen[bytes], is_wanted: Callable[[], bool]) -> tuple[bytes, float]:
    """Wait until the process has ended, and kill it once it is no longer wanted.

    Returns the end of what it said and its processor time in s.
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


def wanted() -> Callable[[], bool]:
    """A function that tells whether this thread's task is still wanted.

    When a sweep is gone, Dask forgets its tasks but does not stop them.
    """
    from distributed import get_worker

    worker = get_worker()
    key = worker.get_current_task()

    def is_wanted() -> bool:
        task = worker.state.tasks.get(key)
        return task is not None and task.state in ("executing", "long-running")

    return is_wanted


def failure(text: str, status: int) -> str:
    """Why a run failed: closecall's last message, or else the last line, or else how the process ended."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    own = [line.removeprefix("closecall: ") for line in lines if line.startswith("closecall: ")]
    if own or lines:
        return (own or lines)[-1]
    return f"killed by signal {-status}" if status < 0 else f"closecall run ended with exit status {status}"
