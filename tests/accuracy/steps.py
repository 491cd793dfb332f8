"""How far SUMO's step length decides what is found, with and without `--align`: the tables in README.md beside it.

python tests/accuracy/steps.py FOLDER [SCENARIO ...] [--seeds 1-5]

Runs `closecall study` on scenarios of sumo_nets/, once with `--align auto` and once with `--align never`, at steps of
1, 0.5, 0.2, 0.1 and 0.05 s, and prints the tables as Markdown. `town` ends after 200 s, has no steps of 0.05 s and
three seeds. What FOLDER has already is not run again.
"""

from __future__ import annotations

import argparse
import csv
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pyarrow.parquet as parquet

NETS = Path(__file__).parents[2] / "sumo_nets"
SCENARIOS = ("roundabout", "priority", "signals", "left_turn", "reckless", "overtaking", "crowd", "motorway", "town")
# Those in the first table; they are run with both integrations, except the large one.
IN_RATES = ("left_turn", "signals", "roundabout", "reckless", "town")
ALIGN = ("never", "auto")
STEPS = ("1", "0.5", "0.2", "0.1")
TRUTH = "0.1"
MEASURES = ("conflicts", "serious or critical", "TTC below 1.5 s", "DRAC above 3.4 m/s²", "risk index")
RATE = "conflicts_per_vehicle_hour"


def study(scenario: str, align: str, folder: Path, seeds: str) -> Path:
    """Run the study of a scenario, or what is missing of it."""
    out = folder / f"{scenario}_{align}"
    is_large = scenario == "town"
    steps = ",".join(STEPS) if is_large else ",".join((*STEPS, "0.05"))
    words = [str(NETS / scenario / f"{scenario}.sumocfg"), "--align", align, "--threads", "1", "--out", str(out)]
    words += ["--vary", f"step-length={steps}", "--seeds", "1-3" if is_large else seeds]
    if is_large:
        words += ["--end", "200"]
    elif scenario in IN_RATES:
        words += ["--vary", "sumo:step-method.ballistic=true,false"]
    subprocess.run([sys.executable, "-m", "closecall", "study", *words], stdout=subprocess.DEVNULL, check=True)
    return out


def rows(out: Path) -> list[dict[str, str]]:
    """The rows of study.csv."""
    with (out / "study.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def own_step(out: Path) -> str:
    """The step length of the scenario as it is."""
    return next(row["value"] for row in rows(out) if row["axis"] == "step-length" and row["own"] == "true")


def counts(out: Path, step: str) -> Counter[str]:
    """The mean over seeds of what is found at a step length."""
    folders = sorted(
        (out / "conflicts").glob("run=seed-*" if step == own_step(out) else f"run=step-length-{step}_seed-*")
    )
    names = ["severity", "ttc", "drac", "unavoidable", "crash_probability"]
    found: Counter[str] = Counter()
    for folder in folders:
        table = parquet.read_table(folder / "conflicts.parquet", columns=names, partitioning=None).to_pylist()
        found["conflicts"] += len(table)
        found["serious or critical"] += sum(str(row["severity"]) != "caution" for row in table)
        found["TTC below 1.5 s"] += sum(row["ttc"] is not None and row["ttc"] < 1.5 for row in table)
        strong = (row["unavoidable"] or (row["drac"] is not None and row["drac"] > 3.4) for row in table)
        found["DRAC above 3.4 m/s²"] += sum(strong)
        found["risk index"] += sum(row["crash_probability"] for row in table)
    return Counter({name: value / len(folders) for name, value in found.items()})


def percent(text: str, digits: int) -> str:
    """A share as a signed percentage."""
    value = 100 * float(text)
    return f"{value:+.{digits if abs(value) < 10 else 0}f}".replace("-", "−")


def short(value: float) -> str:
    """A count with two or more digits."""
    return f"{value:.0f}" if value >= 100 else f"{value:.2g}"


def rates(scenario: str, align: str, out: Path) -> Iterator[str]:
    """The lines of the first table: errors of the rate of conflicts, for each integration."""
    of_rate = [row for row in rows(out) if row["measure"] == RATE and row["value"] != "extrapolated"]
    for axis in sorted({row["axis"] for row in of_rate if row["axis"].startswith("step-length")}):
        by_step = {row["value"]: row for row in of_rate if row["axis"] == axis}
        finest = min(by_step, key=float)
        cells = [f"{float(by_step[finest]['mean']):.3g}"]
        for step in reversed(STEPS):
            row = by_step[step]
            bounds = ", ".join(percent(row[name], 1) for name in ("error_low", "error_high"))
            cells.append("–" if step == finest else f"{percent(row['relative_error'], 1)} % [{bounds}]")
        name = f"`{scenario}`" + axis.removeprefix("step-length")
        yield f"| {name} | {align} | " + " | ".join(cells) + " |"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("folder", type=Path)
    parser.add_argument("scenarios", nargs="*", default=SCENARIOS)
    parser.add_argument("--seeds", default="1-5")
    options = parser.parse_args()
    outs = {(s, a): study(s, a, options.folder, options.seeds) for s in options.scenarios for a in ALIGN}
    print("| scenario | align | at the finest | 0.1 s | 0.2 s | 0.5 s | 1 s |\n|---|---|---|---|---|---|---|")
    for (scenario, align), out in outs.items():
        if scenario in IN_RATES:
            print("\n".join(rates(scenario, align, out)))
    found = {(*key, step): counts(out, step) for key, out in outs.items() for step in STEPS}
    print(
        "\n| scenario | "
        + " | ".join(f"{name}, `{a}`" for name in MEASURES[:2] for a in ALIGN)
        + " |\n|---|---|---|---|---|"
    )
    for scenario in options.scenarios:
        cells = [
            ", ".join(f"{short(found[scenario, a, step][name])}" for step in STEPS)
            for name in MEASURES[:2]
            for a in ALIGN
        ]
        print(f"| `{scenario}` | " + " | ".join(cells) + " |")
    print("\n| step | " + " | ".join(MEASURES) + " |\n|---|---|---|---|---|---|")
    for step in STEPS[:-1]:
        for align in ALIGN:
            cells = []
            for name in MEASURES:
                truth = {s: found[s, "auto", TRUTH][name] for s in options.scenarios}
                off = sum(abs(found[s, align, step][name] - truth[s]) for s in options.scenarios)
                shares = sorted(abs(found[s, align, step][name] / truth[s] - 1) for s in truth if truth[s] > 0)
                cells.append(f"{off / sum(truth.values()):.2f} ({shares[len(shares) // 2]:.2f})")
            print(f"| {step} s, `{align}` | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
