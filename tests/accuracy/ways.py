"""Where a road user was between its steps: on its lanes, as SUMO drives it, or else on a curve through its places."""

from __future__ import annotations

import numpy as np
from recording import Lane, Numbers, Recording, Track

BETWEEN = 10
"""Moments per step."""
SIDEWAYS = 0.5
"""A road user that is further beside where its speed takes it has changed lanes within the step, in m."""
STRAIGHT = 0.1
"""One that turns by more than this within a step does not go straight on, in rad."""
ON_ITS_LANE = 0.3
"""One that is further from where its lane and position put it is beside its lane, in m."""
MOST_LANES = 12
"""Lanes that are tried for a way from one step to the next."""


class Way:
    """The places and headings of a road user at moments that are a part of a step apart.

    SUMO moves it along its lane and those that follow, and puts it on another lane when the step ends. Where its lanes
    do not say how it came to its next place, it is on a curve between its places, and goes straight on where SUMO moves
    it to another lane.
    """

    def __init__(self, track: Track, recording: Recording) -> None:
        self.track, self.step = track, recording.step
        self.places, self.headings = curved(track, recording.step)
        behind = np.empty((0, 2))
        for at in range(len(track.x) - 1):
            line = driven(track, recording, at, behind)
            if line is None:
                behind = np.empty((0, 2))
                continue
            poses, behind = line
            span = slice(at * BETWEEN, (at + 1) * BETWEEN)
            self.places[span], self.headings[span] = poses[:, :2], near(poses[:, 2], self.headings[span])

    def poses(self, first: int, last: int) -> Numbers:
        """The poses from one step of the recording to another."""
        span = slice((first - self.track.first) * BETWEEN, (last - self.track.first) * BETWEEN + 1)
        return np.column_stack([self.places[span], self.headings[span]])


def near(angles: Numbers, others: Numbers) -> Numbers:
    """The same angles within half a turn of others."""
    whole: Numbers = others + (angles - others + np.pi) % (2 * np.pi) - np.pi
    return whole


def curved(track: Track, step: float) -> tuple[Numbers, Numbers]:
    """The places on a curve through those of the steps, and the headings."""
    places, headings = np.stack([track.x, track.y], -1), np.unwrap(track.heading)
    moved, jump = np.diff(places, axis=0), jumps(track, step)
    # The slope at a place is that from the one before to the one after, but not across a jump or an end.
    slopes = (moved[1:] + moved[:-1]) / 2
    smooth = (jump[1:] == 0) & (jump[:-1] == 0)
    begins, ends = moved.copy(), moved.copy()
    begins[1:][smooth], ends[:-1][smooth] = slopes[smooth], slopes[smooth]
    normals = np.stack([-np.sin(headings[1:]), np.cos(headings[1:])], -1)
    straight = moved - jump[:, None] * normals
    parts = np.arange(BETWEEN)[:, None, None] / BETWEEN
    curve = (parts**3 - 2 * parts**2 + parts) * begins + (parts**3 - parts**2) * ends
    curve += (3 * parts**2 - 2 * parts**3) * moved
    curve = np.where(jump[:, None] != 0, parts * straight, curve) + places[:-1]
    all_places = np.concatenate([curve.swapaxes(0, 1).reshape(-1, 2), places[-1:]])
    return all_places, np.interp(np.arange(len(all_places)) / BETWEEN, np.arange(len(headings)), headings)


def jumps(track: Track, step: float) -> Numbers:
    """How far SUMO moves a road user to the side at the end of each step but the first; 0 where it turns.

    It stands or drives on its former lane until then.
    """
    moved = np.stack([np.diff(track.x), np.diff(track.y)], -1)
    turned = np.abs(np.diff(np.unwrap(track.heading)))
    heading = np.stack([np.cos(track.heading[1:]), np.sin(track.heading[1:])], -1)
    rest = moved - heading * (track.speed[1:] * step)[:, None]
    along = (rest * heading).sum(-1)
    aside = rest[:, 1] * heading[:, 0] - rest[:, 0] * heading[:, 1]
    return np.where((turned < STRAIGHT) & (np.abs(aside) > SIDEWAYS) & (np.abs(along) < np.abs(aside)), aside, 0.0)


def driven(track: Track, recording: Recording, at: int, behind: Numbers) -> tuple[Numbers, Numbers] | None:
    """The poses in a step along the lanes, and the line that leads to where it ends; `behind` leads to where it begins.

    None where the lanes do not lead from its place to the next one.
    """
    begin, end = int(track.lane[at]), int(track.lane[at + 1])
    if begin < 0 or end < 0:
        return None
    names = [recording.lane_names[number] for number in (begin, end)]
    chain = leading(recording.lanes, names[0], names[1])
    if not chain:
        return None
    lanes = [recording.lanes[name] for name in chain]
    # Distances as drawn, and in SUMO's metres, at the begin of each lane.
    drawn = np.cumsum([0.0, *(length(lane.shape) for lane in lanes)])
    sumo = np.cumsum([0.0, *(lane.length for lane in lanes)])
    line = np.concatenate([lane.shape for lane in lanes])
    ways = track.position[at] + np.arange(BETWEEN + 1) / BETWEEN * track.speed[at + 1] * recording.step
    fronts = np.interp(ways, sumo, drawn)
    place = np.array([track.x[at], track.y[at]])
    if np.hypot(*(along(line, fronts[:1])[0] - place)) > ON_ITS_LANE:
        return None
    before = np.concatenate([behind, line]) if len(behind) else line
    offset = length(before) - length(line)
    points = along(before, fronts + offset)
    rears = along(before, fronts + offset - track.profile.length)
    towards = points - rears
    headings = np.arctan2(towards[:, 1], towards[:, 0])
    is_there = np.hypot(*(points[-1] - [track.x[at + 1], track.y[at + 1]])) <= ON_ITS_LANE
    if chain[-1] == names[1] and not is_there:
        return None
    # SUMO's own headings differ a little from these, with long vehicles by some degrees.
    ends = near(track.heading[[at, at + 1]] - headings[[0, -1]], np.zeros(2))
    headings = headings + np.interp(np.arange(BETWEEN + 1), [0, BETWEEN], ends if is_there else ends[[0, 0]])
    # The next step begins on this line, unless it begins on another lane.
    last = np.searchsorted(drawn, fronts[-1], side="right") - 1
    led = np.concatenate([lane.shape for lane in lanes[: max(int(last), 0)]] or [np.empty((0, 2))])
    kept = np.concatenate([behind, led])[-100:] if is_there else np.empty((0, 2))
    return np.column_stack([points, headings])[:-1], kept


def leading(lanes: dict[str, Lane], begin: str, end: str) -> list[str]:
    """The lanes from one to another, or else to one of its edge; empty where none is short."""
    edge = lanes[end].edge
    chains, found = [[begin]], []
    for chain in chains:
        if chain[-1] == end:
            return chain
        if lanes[chain[-1]].edge == edge:
            found.append(chain)
        elif len(chains) < MOST_LANES:
            chains.extend([*chain, name] for name in lanes[chain[-1]].following)
    return found[0] if found else []


def length(line: Numbers) -> float:
    """How long a line is."""
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def along(line: Numbers, distances: Numbers) -> Numbers:
    """The points at these distances along a line; straight on before it begins and after it ends."""
    steps = np.diff(line, axis=0)
    lengths = np.hypot(*steps.T)
    line, steps, lengths = line[np.concatenate([[True], lengths > 0])], steps[lengths > 0], lengths[lengths > 0]
    reached = np.concatenate([[0.0], np.cumsum(lengths)])
    at = np.clip(np.searchsorted(reached, distances, side="right") - 1, 0, len(steps) - 1)
    points: Numbers = line[at] + steps[at] * ((distances - reached[at]) / lengths[at])[:, None]
    return points
