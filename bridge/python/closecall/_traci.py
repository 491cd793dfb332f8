"""What a script does through traci of which SUMO would complain because of the checker."""

from __future__ import annotations

from functools import wraps
from typing import Any


def unsubscribe_at_removal(domain: Any) -> None:
    """End the subscription of a vehicle or person before a script removes it, in all connections.

    SUMO asks in the next step for all that is subscribed, and prints an error for each value of one that is gone. It
    tells the checker of that step only afterwards.
    """
    kind = type(domain)
    remove = getattr(kind, "remove", None)
    if remove is None or hasattr(remove, "__wrapped__"):
        return

    @wraps(remove)
    def unsubscribe_and_remove(self: Any, *words: Any, **named: Any) -> Any:
        removed = words[0] if words else named.get("vehID", named.get("personID"))
        if removed in self.getAllSubscriptionResults():
            self.unsubscribe(removed)
        return remove(self, *words, **named)

    kind.remove = unsubscribe_and_remove
