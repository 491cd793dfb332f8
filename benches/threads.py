"""How much faster a replay is with two threads than with one, and how fast it reads what is gzipped.

    python benches/threads.py

Wall times of `closecall replay` on recordings of the town and of the grid, in turns; the better of two.
"""

from __future__ import annotations

import gzip
import shutil
import subprocess
import tempfile
from pathlib import Path

import sumo
from scenarios import BIN, end, grid, measured

ROUNDS = 2


def recording(config: Path, path: Path) -> None:
    """Record the simulation, and the same gzipped."""
    program = str(Path(sumo.SUMO_HOME) / "bin" / "sumo")
    words = ["-c", str(config), "--end", end(config), "--step-length", "0.2", "--no-warnings", "--no-step-log"]
    subprocess.run([program, *words, "--fcd-output", str(path)], check=True)
    with path.open("rb") as plain, gzip.open(f"{path}.gz", "wb", compresslevel=6) as packed:
        shutil.copyfileobj(plain, packed)


def main() -> None:
    """Print the gain of two threads and the price of gzip."""
    print("what,scene,method,size,value,unit")
    with tempfile.TemporaryDirectory(dir="target") as name:
        folder = Path(name).resolve()
        town = Path("sumo_nets/town/town.sumocfg")
        for scene, config in {"grid": grid(folder), "town": town}.items():
            path = folder / f"{scene}.csv"
            recording(config, path)
            net = config.with_suffix(".net.xml")
            out = ["--quiet", "--force", "--out", str(folder / "out")]
            replay = [str(BIN / "closecall"), "replay", "--net", str(net), *out]
            commands = {
                "1 thread": [*replay, "--threads", "1", str(path)],
                "2 threads": [*replay, "--threads", "2", str(path)],
                "2 threads, gzipped": [*replay, "--threads", "2", f"{path}.gz"],
            }
            best = dict.fromkeys(commands, float("inf"))
            for _ in range(ROUNDS):
                best = {method: min(best[method], measured(command)[0]) for method, command in commands.items()}
            gain, packed = (best["1 thread"] / best["2 threads"], best["2 threads"] / best["2 threads, gzipped"])
            print(f"gain of two threads,{scene},replay,,{gain:.3f},times")
            print(f"gzipped over plain,{scene},replay,,{packed:.3f},times", flush=True)


if __name__ == "__main__":
    main()
