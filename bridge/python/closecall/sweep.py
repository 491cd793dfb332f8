"""The runs of `closecall sweep`: on this machine, or on a Dask cluster."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from .sweep_run import ATTEMPTS, Task, message, run


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
