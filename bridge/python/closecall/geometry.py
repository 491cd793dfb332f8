"""Contact and distance of rectangles: rows of `x, y, heading, length, width`, with the centre and sizes in m, rad."""

from ._closecall import distance, touches

__all__ = ["distance", "touches"]
