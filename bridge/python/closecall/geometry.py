"""Rectangles at any angle: rows of `x, y, heading, length, width` (centre, rad, m)."""

from ._closecall import distance, touches

__all__ = ["distance", "touches"]
