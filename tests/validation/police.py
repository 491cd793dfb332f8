"""Crashes that the police reported at junctions, against conflicts there: Spearman's rank correlation.

python tests/validation/police.py --net NET.net.xml --crashes FILE.csv ... LOG ...

The crashes are those of Germany's Unfallatlas (dl-de/by-2-0): tables with semicolons and the columns XGCSWGS84 and
YGCSWGS84, degrees. Each LOG is a folder of `closecall run` on the net. A crash or conflict belongs to the nearest
junction within 40 m; conflicts with an artefact are left out. The interval is the percentiles of 2,000 resamples of
the junctions. Nothing of the net is kept.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from pyproj import Proj
from scipy.spatial import cKDTree
from scipy.stats import rankdata

WITHIN = 40.0
RESAMPLES = 2_000
SEED = 1
SEVERE = ("serious", "critical")


class Junctions:
    """The junctions of a net, inner ones and dead ends left out."""

    def __init__(self, net: Path) -> None:
        root = ET.parse(net).getroot()
        found = [item for item in root.iter("junction") if item.get("type") not in ("internal", "dead_end")]
        self.names = [item.get("id", "") for item in found]
        self.lights = np.array([item.get("type", "").startswith("traffic_light") for item in found])
        self.tree = cKDTree([(float(item.get("x", 0)), float(item.get("y", 0))) for item in found])
        location = root.find("location")
        if location is None or location.get("projParameter", "!") == "!":
            sys.exit(f"{net}: it has no projection, so that degrees cannot be converted")
        self.projection = Proj(location.get("projParameter"))
        self.offset = np.array([float(part) for part in location.get("netOffset", "0,0").split(",")])

    def metres(self, longitudes: list[float], latitudes: list[float]) -> np.ndarray:
        """Places of the net, in its metres."""
        return np.asarray(np.column_stack(self.projection(longitudes, latitudes)) + self.offset)

    def counts(self, places: np.ndarray, weights: np.ndarray | None = None) -> np.ndarray:
        """How many places each junction has, or the sum of their weights."""
        if not len(places):
            return np.zeros(len(self.names))
        distance, nearest = self.tree.query(places)
        near = distance <= WITHIN
        return np.bincount(nearest[near], weights if weights is None else weights[near], len(self.names))


def crashes(files: list[Path], junctions: Junctions) -> np.ndarray:
    """The number of crashes of each junction."""
    longitudes, latitudes = [], []
    for file in files:
        with file.open(newline="", encoding="utf-8-sig") as lines:
            for row in csv.DictReader(lines, delimiter=";"):
                longitudes.append(float(row["XGCSWGS84"].replace(",", ".")))
                latitudes.append(float(row["YGCSWGS84"].replace(",", ".")))
    return junctions.counts(junctions.metres(longitudes, latitudes))


def conflicts(logs: list[Path], junctions: Junctions) -> dict[str, np.ndarray]:
    """What the logs count at each junction."""
    rows: list[dict[str, str]] = []
    entered = np.zeros(len(junctions.names))
    for log in logs:
        with (log / "conflicts.csv").open(newline="") as lines:
            rows += [row for row in csv.DictReader(lines) if not row.get("artefact")]
        of_junction = json.loads((log / "run.json").read_text())["summary"].get("entered", {})
        entered += [of_junction.get(name, 0) for name in junctions.names]
    places = np.array([(float(row["x"]), float(row["y"])) for row in rows]).reshape(-1, 2)
    severe = np.array([row["severity"] in SEVERE for row in rows], dtype=bool)
    crossing = np.array([row["kind"] != "rear_end" for row in rows], dtype=bool)
    probability = np.array([float(row["crash_probability"] or 0) for row in rows])
    counted = {"conflicts": places, "frontal and side": places[crossing], "serious or critical": places[severe]}
    found = {name: junctions.counts(of) for name, of in counted.items()}
    return found | {"sum of crash probabilities": junctions.counts(places, probability), "vehicles entered": entered}


def spearman(one: np.ndarray, other: np.ndarray, given: np.ndarray | None = None) -> float:
    """Spearman's ρ, or the partial one where a third is given; not a number where one of them does not vary."""
    columns = [one, other] if given is None else [one, other, given]
    ranks = np.array([rankdata(column) for column in columns])
    if (ranks.std(axis=1) == 0).any():
        return float("nan")
    rho = np.corrcoef(ranks)
    if given is None:
        return float(rho[0, 1])
    rest = (1 - rho[0, 2] ** 2) * (1 - rho[1, 2] ** 2)
    return float((rho[0, 1] - rho[0, 2] * rho[1, 2]) / np.sqrt(rest)) if rest > 1e-12 else float("nan")


def correlation(*columns: np.ndarray) -> str:
    """ρ with its 95 % interval."""
    chance = np.random.default_rng(SEED)
    count = len(columns[0])
    chosen = (chance.integers(count, size=count) for _ in range(RESAMPLES))
    drawn = [spearman(*(column[at] for column in columns)) for at in chosen]
    if np.isnan(drawn).all() or np.isnan(spearman(*columns)):
        return "–"
    low, high = np.nanpercentile(drawn, [2.5, 97.5])
    return f"{spearman(*columns):.2f} [{low:.2f}, {high:.2f}]"


def main() -> None:
    """Print a table of correlations: over all junctions, and over those with traffic lights."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--net", type=Path, required=True)
    parser.add_argument("--crashes", type=Path, nargs="+", required=True)
    parser.add_argument("logs", type=Path, nargs="+", metavar="LOG")
    arguments = parser.parse_args()
    junctions = Junctions(arguments.net)
    reported = crashes(arguments.crashes, junctions)
    counted = conflicts(arguments.logs, junctions)
    # A junction without entering vehicles may be at the rim of the net.
    used = counted["vehicles entered"] > 0
    print(f"{int(reported[used].sum())} crashes within {WITHIN:g} m of {int(used.sum())} junctions\n")
    groups = {"all": used, "with traffic lights": used & junctions.lights}
    header = [f"{name} ({int(group.sum())})" for name, group in groups.items()]
    print("| | " + " | ".join([*header, "all, given the vehicles entered"]) + " |\n|---|---|---|---|")
    for name, values in counted.items():
        cells = [correlation(reported[group], values[group]) for group in groups.values()]
        entered = counted["vehicles entered"]
        cells.append("–" if values is entered else correlation(reported[used], values[used], entered[used]))
        print(f"| {name} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
