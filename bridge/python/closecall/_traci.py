"""Several commands of TraCI in one message."""

from __future__ import annotations

from typing import Any


def exchange(source: Any, message: bytes) -> bytes:
    """Send commands over the connection of the module traci or of one of its connections, and return SUMO's message."""
    connection = source.simulation._connection
    with connection._lock:
        connection._string = message
        answer: bytes = connection._sendExact()._content
    return answer
