"""The runs of `closecall sweep --scheduler`: each is a task on a Dask cluster that its user has started."""

from __future__ import annotations

import logging
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path

from distributed import Client, as_completed, get_worker

from .sweep_run import ATTEMPTS, Task, message, run


def on_cluster(tasks: list[Task], folder: str, scheduler: str) -> Iterator[tuple[str, str | None]]:
    """Do the tasks on the workers of the scheduler at this address; otherwise as `closecall.sweep.results`."""
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with Client(scheduler) as client:
        # A running scheduler may know a run of the same name from an earlier sweep.
        sweep = uuid.uuid4().hex
        here = str(Path.cwd())
        names = {}
        for task in tasks:
            key = f"closecall-{task[0]}-{sweep}"
            future = client.submit(run_here, *task, folder, here, key=key, retries=ATTEMPTS - 1, pure=False)
            names[future] = task[0]
        try:
            for future in as_completed(list(names)):
                error = future.exception()
                yield names.pop(future), None if error is None else message(error)
                future.release()
        finally:
            client.cancel(list(names), force=True)


def run_here(name: str, words: list[str], task: str, folder: str, here: str) -> None:
    """Do one run, on a worker."""
    run(name, words, task, folder, here, wanted())


def wanted() -> Callable[[], bool]:
    """A function that tells whether this thread's task is still wanted.

    When a sweep is gone, Dask forgets its tasks but does not stop them.
    """
    worker = get_worker()
    key = worker.get_current_task()

    def is_wanted() -> bool:
        task = worker.state.tasks.get(key)
        return task is not None and task.state in ("executing", "long-running")

    return is_wanted
