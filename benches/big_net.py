"""Time and memory of the checker on a net of many lanes, beside those of SUMO's own loading.

    python benches/big_net.py [--junctions N]

netgenerate makes a grid of N by N junctions with two lanes per direction: 57 by 57 have 100,000 lanes, those within
junctions included; 178 by 178 have a million. One car drives for ten steps, so that nearly all of the time is the
loading of the net.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import tempfile
from pathlib import Path

from scenarios import BIN, attached, measured, plain

FIRST_EDGE = re.compile(r'<edge id="([^:"]+)"')


def main() -> None:
    """Print time and memory of both."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--junctions", type=int, default=57)
    junctions = parser.parse_args().junctions
    print("what,scene,method,size,value,unit")
    with tempfile.TemporaryDirectory(dir="target") as name:
        folder = Path(name).resolve()
        net, routes, config = folder / "big.net.xml", folder / "big.rou.xml", folder / "big.sumocfg"
        words = ["--grid", "--grid.number", str(junctions), "-L", "2", "-o", str(net)]
        subprocess.run([str(BIN / "netgenerate"), *words], check=True, stdout=subprocess.DEVNULL)
        text = net.read_text(encoding="utf-8")
        lanes, edge = text.count("<lane "), FIRST_EDGE.findall(text)[0]
        routes.write_text(f'<routes><trip id="a" depart="0" from="{edge}" to="{edge}"/></routes>')
        config.write_text(
            f'<configuration><net-file value="{net}"/><route-files value="{routes}"/>'
            '<begin value="0"/><end value="10"/><no-step-log value="true"/></configuration>'
        )
        for method, command in {"SUMO": plain(config), "closecall": attached(config, folder / "out")}.items():
            seconds, megabytes = measured(command)
            print(f"loading,big net,{method},{lanes},{seconds:.2f},s")
            print(f"memory,big net,{method},{lanes},{megabytes:.0f},MB", flush=True)


if __name__ == "__main__":
    main()
