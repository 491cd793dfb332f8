"""commonroad-drivability-checker on the scenes of benches/detector.rs: which rectangles collide in the current step.

    python benches/commonroad.py FOLDER

FOLDER contains the scenes (`cargo bench --bench detector -- --scenes FOLDER`). The bench uses the batch query of all
rectangles against all through Box2D's tree, which tells for each rectangle whether it touches any, itself included. The
query knows no braking, no path ahead and no kind of conflict. Building its objects is not timed.
"""

from __future__ import annotations

import csv
import importlib.util
import os
import statistics
import sys
import time
from pathlib import Path

ROUNDS = 21


def main() -> None:
    """Print one line per scene."""
    print("what,scene,method,size,value,unit")
    if importlib.util.find_spec("commonroad_dc") is None:
        sys.exit("commonroad-drivability-checker is not installed: it has no wheel for this Python or system")
    from commonroad_dc import pycrcc
    from commonroad_dc.collision.trajectory_queries.trajectory_queries import trajectories_collision_dynamic_obstacles

    for path in sorted(Path(sys.argv[1]).glob("*-*.csv")):
        scene, size = path.stem.split("-")
        objects = []
        with path.open() as file:
            for row in csv.DictReader(file):
                x, y, heading, length, width = (float(row[name]) for name in ("x", "y", "heading", "length", "width"))
                moving = pycrcc.TimeVariantCollisionObject(0)
                moving.append_obstacle(pycrcc.RectOBB(length / 2, width / 2, heading, x, y))
                objects.append(moving)
        times = []
        for _ in range(ROUNDS):
            started = time.perf_counter()
            trajectories_collision_dynamic_obstacles(objects, objects, method="box2d")
            times.append(time.perf_counter() - started)
        each = statistics.median(times) / len(objects) * 1e9
        print(f"step,{scene},commonroad,{size},{each:.1f},ns per road user")
    # The clean-up at exit would print a line per object.
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
