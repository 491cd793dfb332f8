"""Conflicts in sumo-gui, while they last.

Each of a pair has the colour of the worst severity of its conflicts, and a ring in a colour of the pair: thick around
the ego, thin around the foe. A line leads from each to the conflict point, and their predicted paths lie on the road.
Rings and lines are at least a fixed share of the view, so that they are seen at any zoom.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

Point = tuple[float, float]
Colour = tuple[int, int, int, int]

POLYGON_TYPE = "closecall"
"""The type of all polygons that are painted."""

PAIR_COLOURS: list[Colour] = [(255, 255, 255, 255), (240, 228, 66, 255), (0, 158, 115, 255), (204, 121, 167, 255)]
"""Of Okabe and Ito's colours, which every eye tells apart, those that no severity has, and white."""

RING_MARGIN = 2.0
"""The distance between a road user and its ring, in m."""
CORNERS = 34
"""The corners of a ring's side, as many as SUMO gives its own."""
RING_OF_VIEW = 0.014
"""The least radius of a ring, as a share of the view's width."""
LINE_OF_VIEW = 0.0015
"""The least width of a line, as a share of the view's width."""
THIN = 0.25
"""The width of a line and of the foe's ring, in m; the ego's ring is four times as wide."""
LABEL_ABOVE = 7.0
"""How far above the conflict point its label is, in m."""
ROAD: Colour = (70, 75, 81, 255)
"""As in gui-settings.xml."""
PATH_SHARE = {"ego": 0.6, "foe": 0.35}
"""The share of the severity's colour in that of a path; the rest is road. sumo-gui draws what is half transparent over
its background, not over the road."""

ON_ROAD = 50
"""The layer of paths: above lanes and junctions, below vehicles."""
ABOVE_VEHICLES = 1000

AROUND = 60.0
"""Half the width of the view at the begin, in m."""
PLACE_OF_LEGEND = (0.05, 0.06, 0.08)
"""From the left and the top, and from one to the next, as shares of the view."""


class User(NamedTuple):
    """One of a pair: its domain of libsumo, or None for an obstacle, its size, and where it will go."""

    id: str
    domain: str | None
    length: float
    width: float
    is_articulated: bool
    path: list[Point]


class Pair(NamedTuple):
    """A conflict in this step."""

    ego: User
    foe: User
    severity: str
    kind: str
    at: Point
    time_left: float | None


@dataclass
class Shown:
    """What is drawn of a pair."""

    number: int
    colour: Colour
    polygons: dict[str, tuple[Colour, float]] = field(default_factory=dict)


class Painter:
    """Paints in the sumo-gui of libsumo or of a traci connection."""

    def __init__(
        self, sumo: Any, colours: dict[str, tuple[int, int, int]], label: bool = False, own_view: bool = True
    ) -> None:
        """Paint severities, mildest first, in these colours.

        `label` writes beside each conflict what it is. In a view of closecall's own there is a legend, and it begins at
        the traffic.
        """
        self.sumo = sumo
        self.colours = {severity: (*colour, 255) for severity, colour in colours.items()}
        self.label, self.own_view = label, own_view
        self.shown: dict[tuple[str, str], Shown] = {}
        self.former: dict[tuple[str, str], Colour] = {}
        self.legend: list[str] = []
        self.last_number = 0
        self.view = self._view()
        self.first_view: Any = None
        self.is_at_traffic = False
        self.is_shown = False

    def paint(self, pairs: list[Pair]) -> None:
        """Paint these conflicts, and remove what was painted of others."""
        if not pairs and not self.shown and not self.former:
            self._begin([])
            self._draw_legend()
            return
        present = {domain: set(getattr(self.sumo, domain).getIDList()) for domain in ("vehicle", "person")}
        self._begin(pairs)
        self._fill(pairs, present)
        self._draw_legend()
        now = {(pair.ego.id, pair.foe.id): pair for pair in pairs}
        for key in [key for key in self.shown if key not in now]:
            self._remove(self.shown.pop(key))
        for key, pair in now.items():
            if key not in self.shown:
                self.shown[key] = self._new()
            self._draw(self.shown[key], pair, present)

    def clear(self) -> None:
        """Remove all that was painted."""
        self.paint([])
        for poi in self.legend:
            self.sumo.poi.remove(poi)
        self.legend = []

    def _view(self) -> str | None:
        try:
            views = self.sumo.gui.getIDList()
        except Exception:
            # libsumo and traci have exceptions of their own for a SUMO without a window.
            return None
        return views[0] if views else None

    def _width_of_view(self) -> float:
        if self.view is None:
            return 0.0
        (left, _), (right, _) = self.sumo.gui.getBoundary(self.view)
        return float(right - left)

    def _begin(self, pairs: list[Pair]) -> None:
        """Show the traffic at the begin, and then the first conflict, unless the user has moved the view meanwhile."""
        if self.view is None or self.is_shown or not self.own_view:
            return
        now = self.sumo.gui.getBoundary(self.view)
        if self.is_at_traffic and self.first_view is None:
            # sumo-gui changes its view only when it draws.
            self.first_view = now
        is_moved = self.first_view is not None and now != self.first_view
        vehicles = self.sumo.vehicle.getIDList()
        if pairs and not is_moved:
            self._look_at(pairs[0].at)
        elif vehicles and not self.is_at_traffic:
            self._look_at(self.sumo.vehicle.getPosition(vehicles[0]))
            self.is_at_traffic = True
        self.is_shown = bool(pairs) or is_moved

    def _look_at(self, place: Point) -> None:
        x, y = place
        self.sumo.gui.setBoundary(self.view, x - AROUND, y - AROUND, x + AROUND, y + AROUND)

    def _new(self) -> Shown:
        self.last_number += 1
        used = [shown.colour for shown in self.shown.values()]
        return Shown(self.last_number, min(PAIR_COLOURS, key=used.count))

    def _fill(self, pairs: list[Pair], present: dict[str, set[str]]) -> None:
        rank = list(self.colours)
        worst: dict[tuple[str, str], str] = {}
        for pair in pairs:
            for user in (pair.ego, pair.foe):
                if user.domain is not None and user.id in present[user.domain]:
                    key = user.domain, user.id
                    worst[key] = max(worst.get(key, rank[0]), pair.severity, key=rank.index)
        for key in [key for key in self.former if key not in worst]:
            colour = self.former.pop(key)
            if key[1] in present[key[0]]:
                getattr(self.sumo, key[0]).setColor(key[1], colour)
        for key, severity in worst.items():
            vehicles = getattr(self.sumo, key[0])
            if key not in self.former:
                self.former[key] = vehicles.getColor(key[1])
            vehicles.setColor(key[1], self.colours[severity])

    def _draw(self, shown: Shown, pair: Pair, present: dict[str, set[str]]) -> None:
        view = self._width_of_view()
        thin = max(THIN, view * LINE_OF_VIEW)
        severity = self.colours[pair.severity]
        drawn = set()

        def polygon(name: str, shape: list[Point], colour: Colour, fill: bool, layer: int, width: float) -> None:
            drawn.add(name)
            self._polygon(shown, name, shape, colour, fill, layer, width)

        for name, user, width in (("ego", pair.ego, 4 * thin), ("foe", pair.foe, thin)):
            if len(user.path) > 1:
                colour = mixed(severity, ROAD, PATH_SHARE[name])
                polygon(f"{name}_path", band(user.path, user.width), colour, True, ON_ROAD, 1.0)
            if user.domain is None or user.id not in present[user.domain]:
                continue
            middle, reach = self._place(user, pair.at)
            radius = max(reach, view * RING_OF_VIEW)
            polygon(f"{name}_ring", ring(middle, radius, radius + width), shown.colour, True, ABOVE_VEHICLES, 1.0)
            polygon(f"{name}_line", [middle, pair.at], shown.colour, False, ABOVE_VEHICLES, thin)
        radius = 2 * thin
        polygon("point", ring(pair.at, 0.0, radius), shown.colour, True, ABOVE_VEHICLES, 1.0)
        if self.label:
            self._label(shown, pair)
        for name in [name for name in shown.polygons if name not in drawn]:
            self._remove_polygon(shown, name)

    def _place(self, user: User, at: Point) -> tuple[Point, float]:
        """The middle and the radius of the ring: around the conflict for an articulated vehicle, as that may bend."""
        if user.is_articulated:
            return at, RING_MARGIN + 2.5
        vehicles = getattr(self.sumo, str(user.domain))
        x, y = vehicles.getPosition(user.id)
        angle = math.radians(90.0 - vehicles.getAngle(user.id))
        back = user.length / 2.0
        return (x - back * math.cos(angle), y - back * math.sin(angle)), back + RING_MARGIN

    def _polygon(
        self, shown: Shown, name: str, shape: list[Point], colour: Colour, fill: bool, layer: int, width: float
    ) -> None:
        polygons, known = self.sumo.polygon, shown.polygons.get(name)
        full = self._name(shown, name)
        if known is None:
            polygons.add(full, shape, colour, fill, POLYGON_TYPE, layer, width)
        else:
            polygons.setShape(full, shape)
            if known[0] != colour:
                polygons.setColor(full, colour)
            if known[1] != width:
                polygons.setLineWidth(full, width)
        shown.polygons[name] = colour, width

    def _label(self, shown: Shown, pair: Pair) -> None:
        """A point of interest without a body, whose type is the text that sumo-gui writes."""
        left = "" if pair.time_left is None else f", {pair.time_left:.1f} s left"
        text = pair.kind.replace("_", "-") + left
        poi, points = self._name(shown, "label"), self.sumo.poi
        x, y = pair.at[0], pair.at[1] + max(LABEL_ABOVE, 1.5 * RING_OF_VIEW * self._width_of_view())
        if poi in points.getIDList():
            points.setPosition(poi, x, y)
            points.setType(poi, text)
        else:
            points.add(poi, x, y, self.colours[pair.severity], text, ABOVE_VEHICLES + 1)

    def _remove(self, shown: Shown) -> None:
        for name in list(shown.polygons):
            self._remove_polygon(shown, name)
        poi = self._name(shown, "label")
        if self.label and poi in self.sumo.poi.getIDList():
            self.sumo.poi.remove(poi)

    def _remove_polygon(self, shown: Shown, name: str) -> None:
        del shown.polygons[name]
        self.sumo.polygon.remove(self._name(shown, name))

    @staticmethod
    def _name(shown: Shown, name: str) -> str:
        return f"closecall.{shown.number}.{name}"

    def _draw_legend(self) -> None:
        """Points of interest in the upper left corner, wherever the view is."""
        if self.view is None or not self.own_view:
            return
        (left, bottom), (right, top) = self.sumo.gui.getBoundary(self.view)
        width, height = right - left, top - bottom
        entries = [
            *self.colours.items(),
            ("ego: thick ring", (255, 255, 255, 255)),
            ("foe: thin ring", (255, 255, 255, 255)),
        ]
        for number, (text, colour) in enumerate(entries):
            poi = f"closecall.legend.{number}"
            from_left, from_top, apart = PLACE_OF_LEGEND
            x, y = left + from_left * width, top - (from_top + number * apart) * height
            if poi in self.legend:
                self.sumo.poi.setPosition(poi, x, y)
            else:
                self.sumo.poi.add(poi, x, y, colour, text, ABOVE_VEHICLES + 1)
                self.legend.append(poi)


def ring(middle: Point, inner: float, outer: float) -> list[Point]:
    """The outline of a ring: its outer side, and back along its inner one."""
    turns = [2.0 * math.pi * corner / CORNERS for corner in range(CORNERS + 1)]
    side = [[(middle[0] + r * math.cos(a), middle[1] + r * math.sin(a)) for a in turns] for r in (outer, inner)]
    return side[0] + side[1][::-1] if inner > 0.0 else side[0]


def mixed(colour: Colour, other: Colour, share: float) -> Colour:
    """A colour mixed with another."""
    red, green, blue, alpha = (round(share * own + (1.0 - share) * rest) for own, rest in zip(colour, other))
    return red, green, blue, alpha


def band(path: list[Point], width: float) -> list[Point]:
    """The outline of what a road user of this width covers whose front goes along a path."""
    left, right = [], []
    for place, (x, y) in enumerate(path):
        (x0, y0), (x1, y1) = path[max(place - 1, 0)], path[min(place + 1, len(path) - 1)]
        length = math.hypot(x1 - x0, y1 - y0) or 1.0
        across = -(y1 - y0) / length * width / 2.0, (x1 - x0) / length * width / 2.0
        left.append((x + across[0], y + across[1]))
        right.append((x - across[0], y - across[1]))
    return left + right[::-1]
