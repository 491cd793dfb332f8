"""Bytes per road user that an attached run holds in addition to SUMO's.

    python benches/memory.py

Before every step of the same simulation, with the checker and without, the system's allocator reports the bytes in use.
The figure is the growth of the difference, per road user, from the first step with a tenth of the maximal number of
road users to the step with the maximum, so that the program and the net cancel out. Both simulations run three times
and the median counts, because SUMO alone holds up to 50 kB less with other addresses. Python's allocator is off, so
that its blocks count too, and so is glibc's per-thread cache, whose free blocks would count as in use. Needs glibc.
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
    """Make every step of this process append the number of road users and the bytes in use to a file."""
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
    """Road users and bytes before every step: the median of three runs."""
    runs = [samples(command, folder) for _ in range(3)]
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
