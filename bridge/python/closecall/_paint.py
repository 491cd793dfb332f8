"""Conflicts in sumo-gui, while they last.

Each of a pair has the colour of the worst severity of its conflicts, and a ring in the colour of this one: thick around
the ego, thin around the foe, with dark edges, so that it is seen among cars of any colour. A line leads from the front
of each to the conflict point, and their predicted paths lie on the road. Rings and lines are at least a fixed share of
the view, so that they are seen at any zoom.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ._legend import Legend
from ._shapes import ABOVE_VEHICLES, ROAD, Colour, Point, band, mixed, ring

POLYGON_TYPE = "closecall"
"""The type of all polygons that are painted."""

EDGE: Colour = (27, 31, 35, 255)
"""Of rings and lines: darker than the road."""
RING_MARGIN = 2.0
"""The distance between a road user and its ring, in m."""
RING_OF_VIEW = 0.014
"""The least radius of a ring, as a share of the view's width."""
LINE_OF_VIEW = 0.0015
"""The least width of a line, as a share of the view's width."""
THIN = 0.25
"""The width of a line and of the foe's ring, in m; the ego's ring is four times as wide."""
LABEL_OF_VIEW = 0.02
"""How far above both rings the label is, as a share of the view's width."""
PATH_SHARE = {"ego": 0.6, "foe": 0.35}
"""The share of the severity's colour in that of a path; the rest is road. sumo-gui draws what is half transparent over
its background, not over the road."""

ON_ROAD = 50
"""The layer of paths: above lanes and junctions, below vehicles."""
AROUND = 60.0
"""Half the width of the view at the begin, in m."""
SHOWN_WITHIN = 1.0
"""How long sumo-gui may take to draw a new view, in s."""
HALTS = 3.0
"""How long a run halts where Enter cannot be pressed, in s."""


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
        self.halted: set[tuple[str, str]] = set()
        self.last_number = 0
        self.view = self._view()
        self.legend = Legend(sumo, self.colours)
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
                self.last_number += 1
                self.shown[key] = Shown(self.last_number)
            self._draw(self.shown[key], pair, present)

    def clear(self) -> None:
        """Remove all that was painted."""
        self.paint([])
        self.legend.clear()

    def halt(self, pairs: list[Pair], least: str) -> None:
        """Halt at each conflict that is this severe for the first time, in its view, until the user presses Enter."""
        rank = list(self.colours).index
        severe = [pair for pair in pairs if rank(pair.severity) >= rank(least)]
        new = [pair for pair in severe if (pair.ego.id, pair.foe.id) not in self.halted]
        self.halted = {(pair.ego.id, pair.foe.id) for pair in severe}
        if not new:
            return
        worst = max(new, key=lambda pair: rank(pair.severity))
        self._show(worst.at)
        self.is_shown = True
        # Rings and legend depend on the view.
        self.paint(pairs)
        if sys.stdin is None or not sys.stdin.isatty():
            time.sleep(HALTS)
            return
        # As in the window and the log: the time of the step, not of the next one.
        now = self.sumo.simulation.getTime() - self.sumo.simulation.getDeltaT()
        kind = worst.kind.replace("_", "-")
        pair = f"{worst.ego.id} (ego) and {worst.foe.id} (foe)"
        # The progress bar has not ended its line.
        input(f"\n{now:g} s: a {worst.severity} {kind} conflict of {pair}; Enter goes on: ")

    def _show(self, place: Point) -> None:
        """Look at a place, and wait until sumo-gui does."""
        before = self.sumo.gui.getBoundary(self.view)
        self._look_at(place)
        end = time.monotonic() + SHOWN_WITHIN
        while self.sumo.gui.getBoundary(self.view) == before and time.monotonic() < end:
            time.sleep(0.02)

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
        tops = [pair.at[1]]

        def polygon(name: str, shape: list[Point], colour: Colour, fill: bool, layer: int, width: float) -> None:
            drawn.add(name)
            self._polygon(shown, name, shape, colour, fill, layer, width)

        for name, user, width in (("ego", pair.ego, 4 * thin), ("foe", pair.foe, thin)):
            if len(user.path) > 1:
                colour = mixed(severity, ROAD, PATH_SHARE[name])
                polygon(f"{name}_path", band(user.path, user.width), colour, True, ON_ROAD, 1.0)
            if user.domain is None or user.id not in present[user.domain]:
                continue
            middle, front, reach = self._place(user, pair.at)
            inner = max(reach, view * RING_OF_VIEW)
            outer = inner + width
            edge = ring(middle, inner - thin / 2, outer + thin / 2)
            polygon(f"{name}_edge", edge, EDGE, True, ABOVE_VEHICLES - 1, 1.0)
            polygon(f"{name}_ring", ring(middle, inner, outer), severity, True, ABOVE_VEHICLES, 1.0)
            polygon(f"{name}_line", [front, pair.at], severity, False, ABOVE_VEHICLES, thin)
            tops.append(middle[1] + outer)
        polygon("point_edge", ring(pair.at, 0.0, 2.5 * thin), EDGE, True, ABOVE_VEHICLES - 1, 1.0)
        polygon("point", ring(pair.at, 0.0, 2 * thin), severity, True, ABOVE_VEHICLES, 1.0)
        if self.label:
            self._label(shown, pair, max(tops) + LABEL_OF_VIEW * view)
        for name in [name for name in shown.polygons if name not in drawn]:
            self._remove_polygon(shown, name)

    def _place(self, user: User, at: Point) -> tuple[Point, Point, float]:
        """The middle of the ring, where the front is, and the ring's radius.

        The ring is around the conflict for an articulated vehicle, as that may bend.
        """
        if user.is_articulated:
            return at, at, RING_MARGIN + 2.5
        vehicles = getattr(self.sumo, str(user.domain))
        x, y = vehicles.getPosition(user.id)
        angle = math.radians(90.0 - vehicles.getAngle(user.id))
        back = user.length / 2.0
        return (x - back * math.cos(angle), y - back * math.sin(angle)), (x, y), back + RING_MARGIN

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

    def _label(self, shown: Shown, pair: Pair, y: float) -> None:
        """A point of interest whose type is the text that sumo-gui writes: above both rings, it hides neither."""
        left = "" if pair.time_left is None else f", {pair.time_left:.1f} s left"
        text = pair.kind.replace("_", "-") + left
        poi, points = self._name(shown, "label"), self.sumo.poi
        x = pair.at[0]
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
        if self.view is not None and self.own_view:
            self.legend.draw(self.sumo.gui.getBoundary(self.view))
