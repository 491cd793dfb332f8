"""Logs of a few conflicts, each written as a test needs it."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

COLUMNS = [
    "id",
    "ego",
    "foe",
    "kind",
    "severity",
    "artefact",
    "manoeuvre",
    "cause",
    "nearness",
    "consequence",
    "begin",
    "end",
    "time",
    "gap",
    "mu",
    "margin",
    "clearance",
    "ttc",
    "drac",
    "pet",
    "delta_v",
    "crash_probability",
    "ego_speed",
    "foe_speed",
    "angle",
    "x",
    "y",
    "lane",
    "collision",
]
SNAPSHOTS = [f"{role}_{what}" for role in ("ego", "foe") for what in ("x", "y", "heading", "length", "width", "path")]
USUAL: dict[str, Any] = {
    "kind": "rear_end",
    "severity": "serious",
    "artefact": "",
    "manoeuvre": "following",
    "cause": "too_close",
    "nearness": "likely",
    "consequence": "moderate",
    "gap": 3.0,
    "mu": 8.0,
    "margin": -5.0,
    "clearance": 1.0,
    "ttc": 1.2,
    "drac": 4.0,
    "pet": "",
    "delta_v": 4.0,
    "crash_probability": 0.6,
    "ego_speed": 10.0,
    "foe_speed": 5.0,
    "angle": 0.1,
    "lane": "a_0",
    "collision": "false",
    "ego_heading": 0,
    "foe_heading": 0,
    "ego_length": 5,
    "foe_length": 5,
    "ego_width": 2,
    "foe_width": 2,
}


def small_log(folder: Path, conflicts: list[dict[str, Any]], **record: Any) -> Path:
    """A log of these conflicts; what they do not say is usual. The record's `summary` may name what differs, too."""
    folder.mkdir(parents=True)
    with (folder / "conflicts.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS + SNAPSHOTS, lineterminator="\n")
        table.writeheader()
        for number, conflict in enumerate(conflicts, 1):
            at = {
                "id": number,
                "ego": f"e{number}",
                "foe": f"f{number}",
                "begin": number,
                "time": number + 1,
                "end": number + 2,
            }
            place = {
                "x": 10.0 * number,
                "y": 0.0,
                "ego_x": 10.0 * number,
                "ego_y": 0.0,
                "foe_x": 10.0 * number + 9,
                "foe_y": 0.0,
            }
            table.writerow({**USUAL, **at, **place, **conflict})
    counts: dict[tuple[str, str, str | None], int] = {}
    for conflict in conflicts:
        row = {**USUAL, **conflict}
        key = (row["kind"], row["severity"], row["artefact"] or None)
        counts[key] = counts.get(key, 0) + 1
    summary = {
        "begin": 0.0,
        "end": 3599.0,
        "steps": 3600,
        "conflicts": [
            {"kind": kind, "severity": severity, "artefact": artefact, "count": count}
            for (kind, severity, artefact), count in sorted(counts.items(), key=str)
        ],
        "collisions": sum({**USUAL, **conflict}["collision"] == "true" for conflict in conflicts),
        "risk_index": sum(float({**USUAL, **conflict}["crash_probability"] or 0) for conflict in conflicts),
        "left_out": [],
        "exposure": {"vehicles": 500, "persons": 0, "vehicle_kilometres": 50.0, "vehicle_hours": 2.0},
        **record.pop("summary", {}),
    }
    whole = {
        "versions": {"closecall": "0.1.0", "sumo": "SUMO 1"},
        "scenario": "plan.sumocfg",
        "seed": "1",
        "step_length": 1.0,
        "sumo_words": [],
        "inputs": [],
        "options": {},
        "complete": True,
        "summary": summary,
        **record,
    }
    (folder / "run.json").write_text(json.dumps(whole), encoding="utf-8")
    return folder
