"""The runs of `closecall sweep` on Dask: each a task, and in it a process of its own.

libsumo allows one simulation per process, and a simulation that crashes must not take the worker along. On this machine
the workers are therefore threads of the sweep, which wait for their processes: processes of Dask's own would each have
to start and to import Dask before the first run, and would then only wait too.
"""

from __future__ import annotations

import logging
import os
import subprocess
import tempfile
import threading
import uuid
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

from . import _start
from ._closecall import finish_run

Task = tuple[str, list[str], str]
"""A run: its name, the words of `closecall run`, and what `finish_run` needs to know."""

ASKED_EVERY = 0.2
"""Seconds after which Dask is asked again whether a run is still wanted."""


def results(
    tasks: list[Task], folder: str | os.PathLike[str], workers: int, scheduler: str | None
) -> Iterator[tuple[str, str | None]]:
    """Do the tasks; yields the name of each as it ends, with what it said if it failed twice.

    Logs that are not finished lie in `folder`. Without the address of a scheduler this machine does the work, so many
    tasks at once. Whatever ends the iteration, nothing of it goes on running.

    Raises:
        ImportError: Dask is not installed.
        OSError: there is no scheduler at the address.
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
                dashboard_address=None,
                silence_logs=logging.CRITICAL,
            )
            stack.enter_context(cluster)
        client = stack.enter_context(Client(scheduler or cluster))
        # A scheduler that is there already may know the same run from before.
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
                yield names.pop(future), None if error is None else said(error)
                future.release()
        finally:
            client.cancel(list(names), force=True)


def said(error: BaseException) -> str:
    """What an exception says, in one line."""
    return " ".join(str(error).split()) or type(error).__name__


def run(name: str, words: list[str], task: str, folder: str, here: str) -> None:
    """Do one run, on a worker.

    Raises:
        RuntimeError: the run failed, with what it said.
    """
    Path(folder).mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f"{name}.", dir=folder) as unfinished:
        log, told = Path(unfinished, "log"), Path(unfinished, "stderr.txt")
        command = [*_start.command("_child"), "run", "--quiet", "--out", str(log), *words]
        with (
            told.open("wb") as stderr,
            subprocess.Popen(
                command,
                cwd=here,
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=stderr,
                # Ctrl-C is for the sweep, which then ends its runs.
                start_new_session=True,
            ) as process,
        ):
            wait(process, wanted())
        if process.returncode != 0:
            raise RuntimeError(failure(told.read_text(errors="replace"), process.returncode))
        finish_run(task, str(log))


def wait(process: subprocess.Popen[bytes], is_wanted: Callable[[], bool]) -> None:
    """Wait until the process has ended; it is killed when nobody wants it any more."""
    ended = threading.Event()

    def watch() -> None:
        while not ended.wait(ASKED_EVERY):
            if not is_wanted():
                process.kill()

    # Popen.wait with a timeout looks only every 50 ms whether the process has ended: hence a thread that asks.
    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    process.wait()
    ended.set()
    watcher.join()


def wanted() -> Callable[[], bool]:
    """Whether this thread's task is still wanted: Dask forgets it, but does not stop it, where its sweep is gone."""
    from distributed import get_worker

    worker = get_worker()
    key = worker.get_current_task()

    def is_wanted() -> bool:
        task = worker.state.tasks.get(key)
        return task is not None and task.state in ("executing", "long-running")

    return is_wanted


def failure(text: str, status: int) -> str:
    """Why a run failed: its own last word, or its last line, or how it ended."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    own = [line.removeprefix("closecall: ") for line in lines if line.startswith("closecall: ")]
    if own or lines:
        return (own or lines)[-1]
    return f"killed by signal {-status}" if status < 0 else f"closecall run ended with exit status {status}"
