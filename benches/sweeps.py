"""What a sweep costs beside its runs, and how much faster two workers are than one.

    python benches/sweeps.py [--runs N]

The runs are the first 60 s of sumo_nets/left_turn with as many seeds. The overhead of a run is the sweep's wall time
with one worker, over the number of its runs, minus that of `closecall run` alone with the options that a sweep sets.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
from pathlib import Path

from scenarios import BIN, measured

CONFIG = "sumo_nets/left_turn/left_turn.sumocfg"
END = ["--end", "60"]
ALONE = 15


def seconds(*words: str) -> float:
    """The wall time of a command of closecall."""
    return measured([str(BIN / "closecall"), *words])[0]


def main() -> None:
    """Print the overhead of a run and the gain of two workers."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=40)
    runs = parser.parse_args().runs
    print("what,scene,method,size,value,unit")
    with tempfile.TemporaryDirectory() as name:
        log = ["--out", str(Path(name) / "log"), "--force", "--quiet", "--threads", "1", "--log-clips", "none"]
        alone = statistics.median(seconds("run", CONFIG, *END, *log) for _ in range(ALONE))

        def sweep(workers: int) -> float:
            out = ["--out", str(Path(name) / str(workers)), "--quiet", "--workers", str(workers)]
            return seconds("sweep", CONFIG, "--seeds", f"1-{runs}", *out, *END)

        one, two = sweep(1), sweep(2)
    print(f"run alone,left_turn,sweep,{runs},{alone * 1e3:.0f},ms")
    print(f"overhead of a run,left_turn,sweep,{runs},{(one / runs - alone) * 1e3:.1f},ms")
    print(f"gain of two workers,left_turn,sweep,{runs},{one / two:.3f},times")


if __name__ == "__main__":
    main()
