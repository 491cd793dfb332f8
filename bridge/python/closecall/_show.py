"""A clip in sumo-gui: the road users of a log are moved to where they were, and the conflict is painted as in a run.

The net is the run's; nothing is simulated, so that recordings are shown too.
"""

from __future__ import annotations

import json
import math
import sys
import time
from typing import Any

from . import _sumo
from ._paint import Painter, Pair, User
from ._shapes import Colour

SLOWER = 2.0
"""How many times slower than in reality it plays."""
HALTS = 3.0
"""How long it halts at the worst step where Enter cannot be pressed, in s."""
HALF_VIEW = 40.0
"""Half the width of what is shown around the conflict, in m."""
OTHERS: Colour = (215, 219, 224, 255)
DEGREES_NORTH = 90.0
OFF_ROAD = 2
"""`moveToXY` with this puts a road user exactly at the given place, on a road or not."""
UNKNOWN = "O"


def show(scene: str, colours: dict[str, tuple[int, int, int]], label: bool, quit_on_end: bool) -> None:
    """Play the clip of a scene, as `closecall::analysis::playback::Show` writes it; again for each Enter."""
    Player(json.loads(scene), colours, label, is_asked=not quit_on_end and sys.stdin.isatty()).play_again()


class Player:
    """A clip in sumo-gui."""

    def __init__(
        self, scene: dict[str, Any], colours: dict[str, tuple[int, int, int]], label: bool, is_asked: bool
    ) -> None:
        """Start sumo-gui on the net of the scene."""
        self.scene, self.clip, self.is_asked = scene, scene["clip"], is_asked
        times = self.clip["times"]
        apart = [after - before for before, after in zip(times, times[1:])]
        self.step = max(round(min(apart, default=0.1), 3), 0.001)
        words = ["--net-file", scene["net"], "--begin", str(times[0]), "--step-length", str(self.step)]
        # Nothing may happen but what the clip holds.
        words += ["--no-warnings", "--no-step-log", "--collision.action", "none", "--time-to-teleport", "-1"]
        self.sumo = _sumo.start(words, gui=True)
        self.painter = Painter(self.sumo, colours, label)
        self.painter.is_shown = True
        x, y = scene["at"]
        self.sumo.gui.setBoundary("View #0", x - HALF_VIEW, y - HALF_VIEW, x + HALF_VIEW, y + HALF_VIEW)
        self.lights = {signal["light"] for signal in self.clip.get("signals", [])}
        self.road = next(edge for edge in self.sumo.edge.getIDList() if not edge.startswith(":"))
        self.present: set[str] = set()
        self.worst_so_far: list[str | None] = []
        worst = next(iter(colours))
        for severity in self.clip["severity"]:
            worst = max(worst, severity or worst, key=list(colours).index)
            self.worst_so_far.append(severity and worst)
        for number, user in enumerate(self.clip["users"]):
            for part, outline in enumerate(user.get("outlines", [])):
                name = f"closecall.obstacle.{number}.{part}"
                self.sumo.polygon.add(name, outline, (127, 85, 57, 255), True, "closecall.obstacle", 50)

    def play_again(self) -> None:
        """Play the clip until the user has seen enough of it."""
        while True:
            self._play()
            if not self.is_asked or input("Enter plays it again, q and Enter closes sumo-gui: ").strip():
                return

    def _play(self) -> None:
        times = self.clip["times"]
        worst = min(range(len(times)), key=lambda place: abs(times[place] - self.scene["time"]))
        for place in range(len(times)):
            begun = time.monotonic()
            self._move(place)
            self.sumo.simulationStep()
            self.painter.paint(self._pairs(place))
            if place == worst:
                self._halt()
            time.sleep(max(0.0, begun + SLOWER * self.step - time.monotonic()))

    def _halt(self) -> None:
        if self.is_asked:
            input(f"the worst step, {self.scene['time']} s; Enter goes on: ")
        else:
            time.sleep(HALTS)

    def _move(self, place: int) -> None:
        for number, user in enumerate(self.clip["users"]):
            if user["category"] == "obstacle":
                continue
            name, users = user["id"], getattr(self.sumo, user["category"])
            is_here, was_here = user["x"][place] is not None, name in self.present
            if was_here and not is_here:
                users.remove(name)
                self.present.discard(name)
            if not is_here:
                continue
            if not was_here:
                self._enter(number, user)
            angle = DEGREES_NORTH - math.degrees(user["heading"][place])
            if user["category"] == "vehicle":
                users.setSpeed(name, user["speed"][place])
                users.moveToXY(name, "", -1, user["x"][place], user["y"][place], angle, OFF_ROAD)
            else:
                users.moveToXY(name, "", user["x"][place], user["y"][place], angle, OFF_ROAD)
        for light in self.lights:
            state = list(self.sumo.trafficlight.getRedYellowGreenState(light))
            for signal in self.clip["signals"]:
                if signal["light"] == light and signal["index"] < len(state) and signal["states"][place] != UNKNOWN:
                    state[signal["index"]] = signal["states"][place]
            self.sumo.trafficlight.setRedYellowGreenState(light, "".join(state))

    def _enter(self, number: int, user: dict[str, Any]) -> None:
        name, kind = user["id"], f"closecall.{number}"
        if user["category"] == "person":
            self.sumo.person.add(name, self.road, 0.0)
            self.sumo.person.appendWaitingStage(name, 1e6)
            self.sumo.person.setColor(name, OTHERS)
        else:
            if kind not in self.sumo.vehicletype.getIDList():
                self.sumo.vehicletype.copy("DEFAULT_VEHTYPE", kind)
                self.sumo.vehicletype.setLength(kind, user["length"])
                self.sumo.vehicletype.setWidth(kind, user["width"])
            self.sumo.vehicle.add(name, "", typeID=kind)
            self.sumo.vehicle.setSpeedMode(name, 0)
            self.sumo.vehicle.setLaneChangeMode(name, 0)
            self.sumo.vehicle.setColor(name, OTHERS)
        self.present.add(name)

    def _pairs(self, place: int) -> list[Pair]:
        severity = self.worst_so_far[place]
        ego, foe = (self._user(number, place) for number in (0, 1))
        if severity is None or ego is None or foe is None:
            return []
        at, kind = tuple(self.scene["at"]), self.scene["kind"]
        return [Pair(ego, foe, severity, kind, at, self.clip["time_left"][place])]

    def _user(self, number: int, place: int) -> User | None:
        user = self.clip["users"][number]
        domain = None if user["category"] == "obstacle" else user["category"]
        if domain is not None and user["x"][place] is None:
            return None
        path = [tuple(point) for point in self.scene["paths"][number]]
        return User(user["id"], domain, user["length"], user["width"], False, path)
