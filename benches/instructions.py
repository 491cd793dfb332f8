"""Instructions of a replay per road user and step, compared with those of the last state that landed.

    python benches/instructions.py [--bless]

Times differ by a tenth and more from one minute to the next; instructions do not. valgrind counts those of two replays
of one recording, of which one goes on for longer: the difference is what the additional steps take, without Python's
start and the net. Exits with 1 if a scene takes over a tenth more than benches/instructions.csv says; `--bless` writes
that file.
"""

from __future__ import annotations

import argparse
import csv
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from scenarios import PLAIN

LANDED = Path(__file__).with_name("instructions.csv")
MOST = 1.1
"""A scene may take this many times what it took when it landed."""
SCENES = {"town": (20, 40), "signals": (60, 120), "crowd": (30, 60)}
"""Folders of sumo_nets, each with the ends of the short and the long replay in s."""


def record(scene: str, folder: Path) -> Path:
    """Let SUMO write where the road users of a scene are, until the end of the long replay."""
    config, recording = Path("sumo_nets") / scene / f"{scene}.sumocfg", folder / f"{scene}.xml"
    words = ["-c", config, "--end", SCENES[scene][1], "--fcd-output", recording, "--no-warnings"]
    subprocess.run([sys.executable, "-c", PLAIN, *map(str, words)], check=True, stdout=subprocess.DEVNULL)
    return recording


def until(recording: Path, end: int) -> tuple[Path, int]:
    """The recording until a time in s, and its number of road users, summed over the steps."""
    text = recording.read_text(encoding="utf-8")
    later = re.search(rf'<timestep time="{end}\.', text)
    text = text if later is None else text[: later.start()] + "</fcd-export>\n"
    short = recording.with_name(f"{recording.stem}-{end}.xml")
    short.write_text(text, encoding="utf-8")
    return short, text.count("<vehicle ") + text.count("<person ")


def instructions(scene: str, recording: Path) -> int:
    """The instructions of a replay."""
    net = Path("sumo_nets") / scene / f"{scene}.net.xml"
    words = ["-m", "closecall", "replay", recording, "--net", net, "--threads", "1", "--quiet"]
    with tempfile.TemporaryDirectory() as out:
        command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", sys.executable]
        command += [*map(str, words), "--out", f"{out}/log"]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    return int(re.findall(r"Collected : (\d+)", done.stderr)[0])


def measured(scene: str) -> float:
    """Instructions per road user and step."""
    with tempfile.TemporaryDirectory() as folder:
        recording = record(scene, Path(folder))
        short, long = (until(recording, end) for end in SCENES[scene])
        return (instructions(scene, long[0]) - instructions(scene, short[0])) / (long[1] - short[1])


def main() -> None:
    """Print a line per scene."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--bless", action="store_true", help="write the figures to benches/instructions.csv")
    bless = parser.parse_args().bless
    with ThreadPoolExecutor(2) as pool:
        found = dict(zip(SCENES, pool.map(measured, SCENES), strict=True))
    if bless:
        lines = [f"{scene},{count:.0f}\n" for scene, count in found.items()]
        LANDED.write_text("scene,instructions\n" + "".join(lines), encoding="utf-8")
    with LANDED.open(newline="", encoding="utf-8") as file:
        landed = {row["scene"]: float(row["instructions"]) for row in csv.DictReader(file)}
    for scene, count in found.items():
        print(f"{scene}: {count:,.0f} instructions per road user and step, {count / landed[scene]:.3f} of the landed")
    worse = [scene for scene, count in found.items() if count > MOST * landed[scene]]
    if worse:
        sys.exit(f"more than a tenth worse: {', '.join(worse)}")


if __name__ == "__main__":
    main()
