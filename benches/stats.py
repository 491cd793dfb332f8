"""`closecall stats` on ten million conflicts in Parquet, beside DuckDB and Polars doing the same aggregation.

    python benches/stats.py

The conflicts are those of the town, in as many runs as it takes; the files are links to one. Times are those of whole
processes, the better of two; memory is the largest of each.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from scenarios import BIN, attached, measured

CONFLICTS = 10**7
ROUNDS = 2
MEASURES = ["ttc", "pet", "margin", "greatest(ego_delta_v, foe_delta_v)"]

DUCKDB = """
import duckdb, sys
files = f"read_parquet('{sys.argv[1]}/*/conflicts.parquet')"
quantiles = ", ".join(f"quantile_cont({name}, [0.05, 0.25, 0.5, 0.75, 0.95])" for name in sys.argv[2:])
crashes = f"count(*), sum(crash_probability) as crashes from {files} group by"
for query in (
    f"select kind, count(*), {quantiles} from {files} group by kind",
    f"select edge, {crashes} edge order by crashes desc limit 10",
    f"select junction, {crashes} junction order by crashes desc limit 10",
    f"select * from {files} order by severity, crash_probability desc limit 10",
):
    duckdb.sql(query).fetchall()
"""

POLARS = """
import polars, sys
table = polars.scan_parquet(f"{sys.argv[1]}/*/conflicts.parquet")
delta_v = polars.max_horizontal("ego_delta_v", "foe_delta_v").alias("delta_v")
measures = [polars.col("ttc"), polars.col("pet"), polars.col("margin"), delta_v]
shares = [0.05, 0.25, 0.5, 0.75, 0.95]
kinds = [measure.quantile(share, "linear").name.suffix(str(share)) for measure in measures for share in shares]
crashes = polars.col("crash_probability").sum().alias("crashes")
polars.collect_all([
    table.group_by("kind").agg(polars.len(), *kinds),
    *[table.group_by(name).agg(polars.len(), crashes).top_k(10, by="crashes") for name in ("edge", "junction")],
    table.top_k(10, by="crash_probability"),
])
"""


def runs(folder: Path) -> int:
    """Fill the folder with runs of the town; returns how many conflicts they have."""
    log = folder / "town"
    subprocess.run(attached(Path("sumo_nets/town/town.sumocfg"), log, "--log-format", "parquet"), check=True)
    record = json.loads((log / "run.json").read_text())
    conflicts = int(sum(count["count"] for count in record["summary"]["conflicts"]))
    many = -(-CONFLICTS // conflicts)
    for seed in range(many):
        run = folder / "runs" / f"seed{seed}"
        run.mkdir(parents=True)
        os.link(log / "conflicts.parquet", run / "conflicts.parquet")
        (run / "run.json").write_text(json.dumps({**record, "seed": str(seed)}))
    return many * conflicts


def main() -> None:
    """Print the time and the memory of each."""
    print("what,scene,method,size,value,unit")
    with tempfile.TemporaryDirectory(dir="target") as name:
        conflicts = runs(Path(name))
        logs = str(Path(name) / "runs")
        commands = {
            "closecall": [str(BIN / "closecall"), "stats", logs],
            "closecall --by edge": [str(BIN / "closecall"), "stats", logs, "--by", "edge"],
            "DuckDB": [sys.executable, "-c", DUCKDB, logs, *MEASURES],
            "Polars": [sys.executable, "-c", POLARS, logs],
        }
        for method, command in commands.items():
            rounds = [measured(command) for _ in range(ROUNDS)]
            print(f"statistics,town,{method},{conflicts},{min(seconds for seconds, _ in rounds):.2f},s")
            print(f"statistics memory,town,{method},{conflicts},{max(size for _, size in rounds):.0f},MB", flush=True)


if __name__ == "__main__":
    main()
