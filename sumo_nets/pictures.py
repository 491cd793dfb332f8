"""Takes the pictures in the scenarios' READMEs: sumo-gui at the worst step of the most striking conflict.

    xvfb-run -a .venv/bin/python sumo_nets/pictures.py [NAME ...]

The first picture of the repository's README is a clip: `pictures.py --clip`.

Some scenarios have no conflict; the picture then shows the step with the most vehicles.
"""

from __future__ import annotations

import csv
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
RANK = {"critical": 2, "serious": 1, "caution": 0}


def find_spot(config: Path) -> tuple[float, float, float] | None:
    """Time and position of the most striking conflict, or None without conflicts."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "closecall", "run", str(config), "--quiet", "--out", folder]
        options = config.with_name("closecall.toml")
        command += ["--config", str(options)] if options.exists() else []
        subprocess.run([*command, "--", "--no-warnings"], check=True)
        with (Path(folder) / "conflicts.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
    if not rows:
        return None
    order = {"rear_end": 0, "side": 1, "frontal": 1}
    worst = max(rows, key=lambda row: (order[row["kind"]], RANK[row["severity"]], -float(row["margin"])))
    return float(worst["time"]), float(worst["x"]), float(worst["y"])


def shoot(config: Path, spot: tuple[float, float, float] | None) -> None:
    """Run the scenario in sumo-gui up to that time and take the picture."""
    from closecall import Checker, _sumo

    sumo = _sumo.start(["-c", str(config), "--no-warnings", "--window-size", "800,520"], gui=True)
    checker = Checker(sumo)
    step, busiest = sumo.simulation.getDeltaT(), 0
    picture = str(config.with_suffix(".png"))
    if spot is not None:
        # Rings are as large as the view was when they were painted.
        look_at(sumo, spot[1], spot[2])
    while sumo.simulation.getMinExpectedNumber() > 0:
        sumo.simulationStep()
        checker.step()
        time = sumo.simulation.getTime() - step
        vehicles = sumo.vehicle.getIDList()
        if spot is not None and abs(time - spot[0]) < step / 2:
            _, x, y = spot
        elif spot is None and len(vehicles) > busiest:
            busiest = len(vehicles)
            x, y = sumo.vehicle.getPosition(vehicles[0])
        else:
            continue
        look_at(sumo, x, y)
        sumo.gui.screenshot("View #0", picture)
        sumo.simulationStep()
        if spot is not None:
            break
    _sumo.close(gui=True)


def look_at(sumo: Any, x: float, y: float) -> None:
    """Show a place and 50 m around it."""
    sumo.gui.setBoundary("View #0", x - 50, y - 30, x + 50, y + 30)


def draw_clip() -> None:
    """Draw a car of `left_turn` that turns before an oncoming one."""
    with tempfile.TemporaryDirectory() as folder:
        closecall = [sys.executable, "-m", "closecall"]
        config = HERE / "left_turn" / "left_turn.sumocfg"
        run = ["run", config, "--seed", "42", "--step-length", "0.1", "--end", "230", "--quiet", "--out", folder]
        subprocess.run([*closecall, *map(str, run), "--", "--no-warnings"], check=True)
        with (Path(folder) / "conflicts.csv").open(newline="") as file:
            sides = [row for row in csv.DictReader(file) if row["kind"] == "side" and row["severity"] != "caution"]
        picture = HERE.parent / "docs" / "pictures" / "near_miss.svg"
        subprocess.run([*closecall, "clip", folder, sides[-1]["id"], "-o", str(picture)], check=True)


def main() -> None:
    """Take the pictures, each in a process of its own, because libsumo allows one simulation per process."""
    if sys.argv[1:2] == ["--clip"]:
        draw_clip()
        return
    if sys.argv[1:2] == ["--shoot"]:
        words = sys.argv[2:]
        shoot(Path(words[0]), tuple(map(float, words[1:])) if words[1:] else None)  # type: ignore[arg-type]
        return
    named = sorted(path.parent.name for path in HERE.glob("*/*.sumocfg") if path.stem == path.parent.name)
    for name in sys.argv[1:] or named:
        config = HERE / name / f"{name}.sumocfg"
        spot = find_spot(config)
        command = [sys.executable, __file__, "--shoot", str(config), *map(str, spot or ())]
        done = subprocess.run(command, timeout=60, check=False)
        print(name, spot, "done" if done.returncode == 0 else f"exit status {done.returncode}", flush=True)


if __name__ == "__main__":
    main()
