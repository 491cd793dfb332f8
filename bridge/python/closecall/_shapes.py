"""The outlines that are painted in sumo-gui, their colours and their layer."""

from __future__ import annotations

import math

Point = tuple[float, float]
Colour = tuple[int, int, int, int]

ROAD: Colour = (70, 75, 81, 255)
"""As in gui-settings.xml."""
ABOVE_VEHICLES = 1000
"""The layer of what is seen above the traffic."""

CORNERS = 34
"""The corners of a ring's side, as many as SUMO gives its own."""


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
