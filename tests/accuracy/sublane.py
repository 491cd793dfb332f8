"""Writes a left-hand and a right-hand grid with mixed traffic that moves within its lanes (SUMO's sublane model).

python tests/accuracy/sublane.py FOLDER
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

TYPES = """
    <vTypeDistribution id="mix">
        <vType id="car" vClass="passenger" probability="0.3" tau="0.6" sigma="0.7" lcPushy="0.3"/>
        <vType id="free" vClass="passenger" probability="0.2" tau="0.6" sigma="0.7" latAlignment="nice"/>
        <vType id="motorcycle" vClass="motorcycle" probability="0.25" tau="0.5" minGapLat="0.2" latAlignment="compact"/>
        <vType id="bicycle" vClass="bicycle" probability="0.2"/>
        <vType id="truck" vClass="truck" probability="0.05"/>
    </vTypeDistribution>
"""
NET = {
    "grid.number": 3,
    "grid.length": 130,
    "grid.attach-length": 130,
    "default.lanenumber": 2,
    "default.speed": 13.9,
    "default-junction-type": "priority",
}
FRINGE = [f"{side}{place}" for side in ("left", "right", "top", "bottom") for place in range(3)]
NODES = {"left": "A{}", "right": "C{}", "bottom": "{}0", "top": "{}2"}


def node(fringe: str) -> str:
    """The inner junction of a fringe junction."""
    side, place = fringe[:-1], int(fringe[-1])
    return NODES[side].format(place if side in ("left", "right") else "ABC"[place])


def write(folder: Path, name: str, resolution: float, options: list[str]) -> None:
    """Write the scenario `name`."""
    net = folder / f"{name}.net.xml"
    words = ["--grid", *(f"--{option}={value}" for option, value in NET.items()), *options, f"--output-file={net}"]
    subprocess.run(["netgenerate", *words], check=True, stdout=subprocess.DEVNULL)
    flows = [
        f'    <flow id="{begin}_{end}" type="mix" begin="{k}" end="400" period="50" from="{begin}{node(begin)}" '
        f'to="{node(end)}{end}" departLane="random" departSpeed="max" departPosLat="random"/>'
        for k, begin in enumerate(FRINGE)
        for end in FRINGE[k % 2 :: 2]
        if end != begin
    ]
    flows.sort(key=lambda flow: int(flow.split('begin="')[1].split('"')[0]))
    (folder / f"{name}.rou.xml").write_text("<routes>" + TYPES + "\n".join(flows) + "\n</routes>\n")
    (folder / f"{name}.sumocfg").write_text(
        f'<configuration><net-file value="{name}.net.xml"/><route-files value="{name}.rou.xml"/>'
        f'<lateral-resolution value="{resolution}"/></configuration>\n'
    )


def main() -> None:
    """Write both scenarios."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    write(folder, "left_hand", 0.6, ["--lefthand"])
    write(folder, "right_hand", 0.8, [])


if __name__ == "__main__":
    main()
