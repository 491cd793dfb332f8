"""The legend of sumo-gui's view: a panel in its upper left corner, wherever it looks."""

from __future__ import annotations

from typing import Any

from ._shapes import ABOVE_VEHICLES, ROAD, Colour, Point, ring

PALE: Colour = (215, 219, 224, 255)
"""The rings in the legend that stand for any severity."""

WIDTH = 0.13
"""The width of the legend, as a share of the view's width."""
ROW = 0.065
"""The height of one of its rows, as a share of the view's height; other lengths in the legend are shares of a row."""
MARGIN = 0.4
RING = 0.28


class Legend:
    """The rings of the severities, then the ego's and the foe's."""

    def __init__(self, sumo: Any, colours: dict[str, Colour]) -> None:
        """A legend of severities in these colours."""
        self.sumo, self.colours = sumo, colours
        self.drawn: list[tuple[Any, str]] = []

    def draw(self, view: tuple[Point, Point]) -> None:
        """Draw it in a view, or move it there."""
        (left, low), (right, top) = view
        row = ROW * (top - low)
        entries = [*((text, colour, True) for text, colour in self.colours.items()), ("ego", PALE, True)]
        entries.append(("foe", PALE, False))
        x, y, width = left + MARGIN * row, top - MARGIN * row, WIDTH * (right - left)
        bottom = y - (len(entries) + MARGIN) * row
        self._polygon("panel", [(x, y), (x + width, y), (x + width, bottom), (x, bottom)], ROAD, 1)
        for number, (text, colour, is_thick) in enumerate(entries):
            middle = x + 0.7 * row, y - (number + 0.5 + MARGIN / 2) * row
            outer = RING * row
            inner = outer * (0.55 if is_thick else 0.85)
            self._polygon(f"ring.{number}", ring(middle, inner, outer), colour, 2)
            self._text(number, text, (x + 0.6 * width, middle[1] + RING * row))

    def _polygon(self, name: str, shape: list[Point], colour: Colour, layer: int) -> None:
        full, polygons = f"closecall.legend.{name}", self.sumo.polygon
        if (polygons, full) in self.drawn:
            polygons.setShape(full, shape)
        else:
            polygons.add(full, shape, colour, True, "closecall.legend", ABOVE_VEHICLES + layer, 1.0)
            self.drawn.append((polygons, full))

    def _text(self, number: int, text: str, at: Point) -> None:
        """The text of a point of interest, which has the colour of the panel itself."""
        full, points = f"closecall.legend.{number}", self.sumo.poi
        if (points, full) in self.drawn:
            points.setPosition(full, *at)
        else:
            points.add(full, *at, ROAD, text, ABOVE_VEHICLES + 3)
            self.drawn.append((points, full))

    def clear(self) -> None:
        """Remove it."""
        for domain, name in self.drawn:
            domain.remove(name)
        self.drawn = []
