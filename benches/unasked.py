"""Which share of road users nothing can reach in the next step, so that they need not be asked for their place.

    python benches/unasked.py FCD.csv STEP_LENGTH

Counted in every fifth step of an fcd-output with all road users. A road user reaches as far as it drives until it
stands, after a response of 1 s and with 4.5 m/s², and what it can gain in a step. With clips, everything within 50 m of
a conflict in the 5 s before it is recorded too. Two persons are never a pair.
"""

from __future__ import annotations

import sys

import numpy as np
import polars
from scipy.spatial import KDTree

EVERY = 5
CLIP_RADIUS, CLIP_BEFORE = 50.0, 5.0


def reach(speed: np.ndarray, is_person: np.ndarray, step: float, clips: bool) -> np.ndarray:
    """How far each of them may have a part in a conflict or in a clip after the next step, in m."""
    faster = speed + np.where(is_person, 1.0, 2.6) * step
    stand = faster * 1.0 + np.where(is_person, 1.0, faster**2 / (2 * 4.5) + 5.0)
    alone = stand + faster * step
    return np.maximum(alone, CLIP_RADIUS / 2 + faster * CLIP_BEFORE) if clips else alone


def main() -> None:
    """Print the shares of vehicles and of persons, with and without clips."""
    path, step = sys.argv[1], float(sys.argv[2])
    table = polars.read_csv(path, separator=";")
    either = {
        name: polars.coalesce([column for column in (f"vehicle_{name}", f"person_{name}") if column in table.columns])
        for name in ("x", "y", "speed")
    }
    table = table.select("timestep_time", polars.col("vehicle_lane").is_null().alias("person"), **either).drop_nulls()
    unmet = {(clips, person): [0, 0] for clips in (False, True) for person in (False, True)}
    times = table["timestep_time"].unique().sort().gather_every(EVERY)
    for _, rows in table.filter(polars.col("timestep_time").is_in(times.implode())).group_by("timestep_time"):
        places = rows.select("x", "y").to_numpy()
        is_person = rows["person"].to_numpy()
        for clips in (False, True):
            radius = reach(rows["speed"].to_numpy(), is_person, step, clips)
            one, other = KDTree(places).query_pairs(2 * radius.max(), output_type="ndarray").T
            apart = np.hypot(*(places[one] - places[other]).T)
            meets = (apart <= radius[one] + radius[other]) & ~(is_person[one] & is_person[other])
            is_met = np.zeros(len(places), dtype=bool)
            is_met[one[meets]] = is_met[other[meets]] = True
            for person in (False, True):
                of_kind = is_person == person
                unmet[clips, person][0] += int((of_kind & ~is_met).sum())
                unmet[clips, person][1] += int(of_kind.sum())
    for (clips, person), (many, of) in unmet.items():
        what = f"{'persons' if person else 'vehicles'} {'with' if clips else 'without'} clips"
        print(f"{path}: {what}: {100 * many / of:.1f} % of {of}" if of else f"{path}: {what}: none")


if __name__ == "__main__":
    main()
