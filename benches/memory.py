"""Bytes that an attached run holds per road user, beside SUMO's own: the system's allocator is asked, before every step
of the same simulation, how much is in use, with the checker and without.

    python benches/memory.py

The figure is the growth of the difference from the first step with a tenth of the most road users to the one with the
most: this cancels what does not depend on the traffic (the net, the program). Both are run nine times, of which the
median counts: with other addresses SUMO alone holds up to 50 kB less. Python's own allocator is switched off, so that
what it holds is counted too, and so is glibc's cache per thread: what is free in it counts as in use. glibc only.
"""

from __future__ import annotations

import ctypes
import os
import statistics
import subprocess
import tempfile
from pathlib import Path

from scenarios import attached, plain, scenarios


class MallInfo(ctypes.Structure):
    """glibc's struct mallinfo2."""

    names = "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost"
    _fields_ = [(name, ctypes.c_size_t) for name in names.split()]


def sample() -> None:
    """In the process that is measured: every step says how many road users there are and what is in use."""
    import libsumo

    glibc = ctypes.CDLL(None)
    glibc.mallinfo2.restype = MallInfo
    step = libsumo.simulationStep
    path = Path(os.environ["CLOSECALL_SAMPLES"])

    def counted(*words: float) -> object:
        info = glibc.mallinfo2()
        users = libsumo.vehicle.getIDCount() + libsumo.person.getIDCount()
        with path.open("a") as file:
            file.write(f"{users} {info.uordblks + info.hblkhd}\n")
        return step(*words)

    libsumo.simulationStep = counted


def median(command: list[str], folder: Path) -> list[tuple[int, float]]:
    """Road users and bytes before every step, in the median of nine runs."""
    runs = [samples(command, folder) for _ in range(9)]
    return [(step[0][0], statistics.median(held for _, held in step)) for step in zip(*runs)]


def samples(command: list[str], folder: Path) -> list[list[int]]:
    """Road users and bytes before every step of a run."""
    path = folder / "samples.txt"
    path.unlink(missing_ok=True)
    (folder / "sitecustomize.py").write_text("import memory; memory.sample()\n")
    search = os.pathsep.join([str(folder), str(Path(__file__).parent)])
    allocators = {"PYTHONMALLOC": "malloc", "GLIBC_TUNABLES": "glibc.malloc.tcache_count=0"}
    environment = {"PYTHONPATH": search, "CLOSECALL_SAMPLES": str(path), **allocators}
    subprocess.run(command, env={**os.environ, **environment}, check=True, stdout=subprocess.DEVNULL)
    return [[int(word) for word in line.split()] for line in path.read_text().splitlines()]


def main() -> None:
    """Print one line per scenario."""
    print("what,scene,method,size,value,unit")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for scene, config in scenarios(folder).items():
            without = median(plain(config), folder)
            checked = median(attached(config, folder / "out", "--threads", "1"), folder)
            beside = [(users, held - alone) for (users, held), (_, alone) in zip(checked, without)]
            most = max(beside)
            first = next(moment for moment in beside if moment[0] >= most[0] / 10)
            per_user = (most[1] - first[1]) / (most[0] - first[0])
            print(f"held,{scene},closecall,{most[0]},{per_user:.0f},bytes per road user", flush=True)


if __name__ == "__main__":
    main()
