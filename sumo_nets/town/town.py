"""Generates the plain sources and the demand of `town`, always the same bytes: python3 town.py

The town is a bent grid of junctions: arterial roads with two lanes each way, collectors, and streets, of which some are
left out. The centre has pavements. netconvert builds the net from these sources (`sumo_nets/build.sh town`).
"""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).parent
COLUMNS, ROWS = 13, 9
SPACING = 115.0
"""Distance of neighbouring junctions in the grid before it is distorted, in m."""
ARTERIAL_COLUMNS, ARTERIAL_ROWS = {3, 9}, {2, 6}
COLLECTOR_COLUMNS, COLLECTOR_ROWS = {0, 6, 12}, {4}
CENTRE = {(column, row) for column in range(4, 9) for row in range(3, 6)}
"""Junctions whose roads have pavements."""
END = 600
"""End of the demand in s."""
VEHICLES_AT_START = 440
VEHICLES_PER_SECOND = 1.7
WALKERS, WALKERS_AT_START = 150, 60

NETCONVERT = """<configuration>
    <node-files value="town.nod.xml"/>
    <edge-files value="town.edg.xml"/>
    <type-files value="town.typ.xml"/>
    <offset.disable-normalization value="true"/>
    <crossings.guess value="true"/>
    <no-turnarounds.except-deadend value="true"/>
    <tls.default-type value="static"/>
    <junctions.corner-detail value="2"/>
</configuration>
"""

EDGE_TYPES = """<types>
    <!-- Two lanes each way, no bicycles. -->
    <type id="arterial" numLanes="2" speed="13.89" priority="9" disallow="bicycle pedestrian"/>
    <type id="collector" numLanes="1" speed="13.89" priority="6"/>
    <type id="street" numLanes="1" speed="8.33" priority="3"/>
    <!-- The centre has pavements. -->
    <type id="collector_walk" numLanes="1" speed="13.89" priority="6" sidewalkWidth="2"/>
    <type id="street_walk" numLanes="1" speed="8.33" priority="3" sidewalkWidth="2"/>
</types>
"""

VEHICLE_TYPES = """<routes>
    <vTypeDistribution id="cars">
        <vType id="car" length="4.6" width="1.8" speedDev="0.1" sigma="0.5" probability="0.6"/>
        <vType id="hurried_car" length="4.6" width="1.8" tau="0.7" minGap="1.5" speedFactor="1.15" speedDev="0.05" sigma="0.7" probability="0.25"/>
        <vType id="small_car" length="3.7" width="1.65" speedDev="0.1" sigma="0.5" probability="0.15"/>
    </vTypeDistribution>
    <vType id="van" vClass="delivery" length="6.2" width="2.0"/>
    <vType id="truck" vClass="truck" length="9.5" width="2.5"/>
    <vType id="bus" vClass="bus" length="12" width="2.5"/>
    <vType id="motorcycle" vClass="motorcycle"/>
    <vType id="bicycle" vClass="bicycle"/>
    <vType id="walker" vClass="pedestrian" speedFactor="normc(1,0.15,0.6,1.5)"/>

    <!-- Two bus lines, there and back along the arterial roads. -->
"""  # noqa: E501

CONFIGURATION = f"""<configuration>
    <net-file value="town.net.xml"/>
    <route-files value="town.rou.xml"/>
    <additional-files value="town.add.xml"/>
    <begin value="0"/>
    <end value="{END}"/>
    <step-length value="0.5"/>
    <seed value="42"/>
    <xml-validation value="never"/>
    <no-step-log value="true"/>
    <time-to-teleport value="120"/>
    <collision.action value="warn"/>
    <collision.check-junctions value="true"/>
</configuration>
"""

Junction = tuple[int, int]
"""Column and row in the grid."""
Item = tuple[float, str]
"""Departure in s and XML of one entry of the route file."""


class Edge(NamedTuple):
    """One direction of a road."""

    start: Junction
    end: Junction
    road: str
    """arterial, collector or street"""
    has_pavement: bool

    @property
    def id(self) -> str:
        """Its id in the net."""
        return name(self.start) + name(self.end)

    @property
    def type(self) -> str:
        """Its type in the net."""
        return self.road + "_walk" * self.has_pavement


def name(junction: Junction) -> str:
    """The id of a junction: a letter for the column and a number for the row."""
    column, row = junction
    return f"{'ABCDEFGHIJKLM'[column]}{row + 1}"


def place_junctions(chance: random.Random) -> dict[Junction, tuple[float, float]]:
    """The positions of the junctions in m: a grid, distorted at random, less so along arterial roads, and bent."""
    positions = {}
    for column in range(COLUMNS):
        for row in range(ROWS):
            in_arterial_column, in_arterial_row = column in ARTERIAL_COLUMNS, row in ARTERIAL_ROWS
            spread = 0.13 if in_arterial_column or in_arterial_row else 0.2
            dx, dy = chance.uniform(-spread, spread) * SPACING, chance.uniform(-spread, spread) * SPACING
            dx *= 0.3 if in_arterial_column else 1
            dy *= 0.3 if in_arterial_row else 1
            x = column * SPACING + dx
            y = row * SPACING + dy + 25 * math.sin(column / 2.2)
            positions[column, row] = (round(x, 1), round(y, 1))
    return positions


def road_between(a: Junction, b: Junction) -> str:
    """The kind of the road between two neighbouring junctions."""
    same_column, same_row = a[0] == b[0], a[1] == b[1]
    if (same_column and a[0] in ARTERIAL_COLUMNS) or (same_row and a[1] in ARTERIAL_ROWS):
        return "arterial"
    if (same_column and a[0] in COLLECTOR_COLUMNS) or (same_row and a[1] in COLLECTOR_ROWS):
        return "collector"
    return "street"


def choose_roads(chance: random.Random) -> list[tuple[Junction, Junction, str]]:
    """The roads of the grid, without up to a fifth of the streets; each junction keeps at least three roads."""
    links: list[tuple[Junction, Junction]] = []
    for column in range(COLUMNS):
        for row in range(ROWS):
            if column + 1 < COLUMNS:
                links.append(((column, row), (column + 1, row)))
            if row + 1 < ROWS:
                links.append(((column, row), (column, row + 1)))
    degrees: dict[Junction, int] = {}
    for junction in (end for link in links for end in link):
        degrees[junction] = degrees.get(junction, 0) + 1
    chance.shuffle(links)
    roads = []
    for a, b in links:
        road = road_between(a, b)
        if road == "street" and chance.random() < 0.2 and degrees[a] > 3 and degrees[b] > 3:
            degrees[a] -= 1
            degrees[b] -= 1
        else:
            roads.append((a, b, road))
    return sorted(roads)


def junction_type(roads: list[str], chance: random.Random) -> str:
    """The right of way at a junction of these roads."""
    arterials, collectors = roads.count("arterial"), roads.count("collector")
    if (arterials >= 2 and collectors) or arterials == 4 or collectors == 4:
        return "traffic_light"
    if arterials >= 2 and len(roads) == 4 and chance.random() < 0.4:
        return "traffic_light"
    return "priority" if arterials or collectors else "right_before_left"


class Demand:
    """The trips, drawn at random, between edges far enough apart."""

    def __init__(
        self, edges: list[Edge], positions: dict[Junction, tuple[float, float]], chance: random.Random
    ) -> None:
        self.edges, self.positions, self.chance = edges, positions, chance
        by_road = {
            "truck": {"arterial": 5, "collector": 2, "street": 0.3},
            "bicycle": {"arterial": 0, "collector": 1.5, "street": 2},
            "": {"arterial": 3, "collector": 1.5, "street": 1},
        }
        self.weights = {kind: [weights[edge.road] for edge in edges] for kind, weights in by_road.items()}
        self.trips: list[tuple[float, str, str, str]] = []

    def middle(self, edge: Edge) -> tuple[float, float]:
        """The middle of an edge."""
        (x, y), (u, v) = self.positions[edge.start], self.positions[edge.end]
        return (x + u) / 2, (y + v) / 2

    def is_bikable(self, origin: Edge, destination: Edge) -> bool:
        """Whether a bicycle gets from one edge to the other without arterial roads and turnarounds."""
        seen = {(origin.start, origin.end)}
        open_ends = list(seen)
        while open_ends:
            start, end = open_ends.pop()
            if (start, end) == (destination.start, destination.end):
                return True
            for edge in self.edges:
                follows = edge.start == end and edge.end != start and edge.road != "arterial"
                if follows and (edge.start, edge.end) not in seen:
                    seen.add((edge.start, edge.end))
                    open_ends.append((edge.start, edge.end))
        return False

    def add(self, time: float) -> None:
        """Add a trip of a random vehicle type at a time in s."""
        kinds = ["car", "van", "truck", "motorcycle", "bicycle"]
        kind = self.chance.choices(kinds, [70, 9, 7, 3, 11])[0]
        weights = self.weights.get(kind, self.weights[""])
        shortest, longest = (300, 900) if kind == "bicycle" else (500, 1500)
        while True:
            origin, destination = (self.chance.choices(self.edges, weights)[0] for _ in range(2))
            (x, y), (u, v) = self.middle(origin), self.middle(destination)
            is_way_back = (origin.start, origin.end) == (destination.end, destination.start)
            if not shortest < math.hypot(x - u, y - v) < longest or is_way_back:
                continue
            if kind != "bicycle" or self.is_bikable(origin, destination):
                break
        self.trips.append((time, kind, origin.id, destination.id))

    def items(self) -> list[Item]:
        """The trips as XML."""
        found = []
        for number, (time, kind, origin, destination) in enumerate(self.trips):
            vehicle = ("t" if kind == "truck" else kind[0]) + str(number)
            position = ' departPos="random_free"' if time == 0 else ""
            found.append(
                (
                    time,
                    f'    <trip id="{vehicle}" type="{"cars" if kind == "car" else kind}" depart="{time:g}"{position} '
                    f'departLane="best" departSpeed="max" from="{origin}" to="{destination}"/>\n',
                )
            )
        return found


def bus_lines() -> dict[str, list[str]]:
    """The edges of the two bus lines in both directions: along an arterial row and an arterial column."""
    row, column = [(at, 2) for at in range(COLUMNS)], [(9, at) for at in range(ROWS)]
    junctions = {
        "line1_east": row,
        "line1_west": row[::-1],
        "line2_north": column,
        "line2_south": column[::-1],
    }
    return {line: [name(a) + name(b) for a, b in zip(path, path[1:])] for line, path in junctions.items()}


def walkers(edges: list[Edge], chance: random.Random) -> list[Item]:
    """Persons that walk between edges with pavements."""
    pavements = [edge for edge in edges if edge.has_pavement]
    found = []
    for number in range(WALKERS):
        origin, destination = chance.choice(pavements), chance.choice(pavements)
        time = 0.0 if number < WALKERS_AT_START else round(chance.uniform(0, END - 60), 1)
        found.append(
            (
                time,
                f'    <person id="w{number}" type="walker" depart="{time:g}" departPos="random">'
                f'<walk from="{origin.id}" to="{destination.id}"/></person>\n',
            )
        )
    return found


def parked_cars(lots: list[Edge], edges: list[Edge], chance: random.Random) -> list[Item]:
    """Cars that are parked at the start; some leave, some stay to the end."""
    found: list[Item] = []
    for edge in lots:
        for _ in range(4):
            if chance.random() >= 0.7:
                continue
            duration = chance.choice([END, END, chance.randrange(120, 500, 10)])
            onward = chance.choice([other for other in edges if other.start == edge.end and other.end != edge.start])
            found.append(
                (
                    0.0,
                    f'    <vehicle id="p{len(found)}" type="cars" depart="0" departPos="stop">'
                    f'<route edges="{edge.id} {onward.id}"/>'
                    f'<stop parkingArea="lot_{edge.id}" duration="{duration}"/></vehicle>\n',
                )
            )
    return found


def delivery_vans(edges: list[Edge], is_long: dict[Edge, bool], chance: random.Random) -> list[Item]:
    """Vans that stop in a lane of an arterial road."""
    arterials = [edge for edge in edges if edge.road == "arterial" and is_long[edge]]
    found = []
    for number in range(10):
        edge = chance.choice(arterials)
        main = [other for other in edges if other.road != "street"]
        before = chance.choice([other for other in main if other.end == edge.start and other.start != edge.end])
        after = chance.choice([other for other in main if other.start == edge.end and other.end != edge.start])
        time = 20 + number * 45
        found.append(
            (
                float(time),
                f'    <trip id="d{number}" type="van" depart="{time}" departLane="best" departSpeed="max" '
                f'from="{before.id}" to="{after.id}"><stop lane="{edge.id}_0" endPos="70" duration="30"/></trip>\n',
            )
        )
    return found


def write(suffix: str, *lines: str) -> None:
    """Write one of the town's files."""
    (FOLDER / f"town.{suffix}").write_text("".join(lines))


def main() -> None:
    """Write all files; the order of the random draws decides what the town looks like."""
    chance = random.Random(7)
    positions = place_junctions(chance)
    roads = choose_roads(chance)
    meeting: dict[Junction, list[str]] = {}
    for a, b, road in roads:
        meeting.setdefault(a, []).append(road)
        meeting.setdefault(b, []).append(road)
    nodes = [
        f'    <node id="{name(junction)}" x="{x}" y="{y}" type="{junction_type(meeting[junction], chance)}"/>\n'
        for junction, (x, y) in sorted(positions.items())
    ]
    write("nod.xml", "<nodes>\n", *nodes, "</nodes>\n")
    edges = [
        Edge(start, end, road, has_pavement=a in CENTRE and b in CENTRE)
        for a, b, road in roads
        for start, end in ((a, b), (b, a))
    ]
    drawn = [
        f'    <edge id="{edge.id}" from="{name(edge.start)}" to="{name(edge.end)}" type="{edge.type}"/>\n'
        for edge in edges
    ]
    write("edg.xml", "<edges>\n", *drawn, "</edges>\n")
    write("typ.xml", EDGE_TYPES)
    write("netccfg", NETCONVERT)

    demand = Demand(edges, positions, chance)
    for _ in range(VEHICLES_AT_START):
        demand.add(0.0)
    time = chance.expovariate(VEHICLES_PER_SECOND)
    while time <= END:
        demand.add(round(time, 1))
        time += chance.expovariate(VEHICLES_PER_SECOND)

    lines = bus_lines()
    stops = {line: path[1::3] for line, path in lines.items()}
    routes = [
        f'    <route id="{line}" edges="{" ".join(path)}">\n'
        + "".join(f'        <stop busStop="stop_{edge}" duration="12"/>\n' for edge in stops[line])
        + "    </route>\n"
        for line, path in lines.items()
    ]
    buses = [
        (
            0.0,
            f'    <flow id="{line}" type="bus" route="{line}" begin="0" end="{END}" period="90" departSpeed="max"/>\n',
        )
        for line in lines
    ]
    walks = walkers(edges, chance)

    standing = random.Random(11)
    is_long = {edge: math.dist(positions[edge.start], positions[edge.end]) > 90 for edge in edges}
    kerbs = [edge for edge in edges if edge.type in ("street", "collector") and is_long[edge]]
    lots = standing.sample(kerbs, 12)
    parked = parked_cars(lots, edges, standing)
    vans = delivery_vans(edges, is_long, standing)
    items = sorted([*buses, *demand.items(), *walks, *parked, *vans], key=lambda item: item[0])
    write("rou.xml", VEHICLE_TYPES, *routes, "\n", *(xml for _, xml in items), "</routes>\n")
    additional = [
        f'    <busStop id="stop_{edge}" lane="{edge}_0" startPos="30" endPos="55"/>\n'
        for line in lines
        for edge in stops[line]
    ]
    additional += [
        f'    <parkingArea id="lot_{edge.id}" lane="{edge.id}_0" startPos="25" endPos="55" roadsideCapacity="4" '
        'width="2.2"/>\n'
        for edge in lots
    ]
    write("add.xml", "<additional>\n", *additional, "</additional>\n")
    write("sumocfg", CONFIGURATION)


if __name__ == "__main__":
    main()
