"""The truth in a step: the definitions in docs/model.md on the paths that both road users drove afterwards.

Written from the definitions alone, without closecall's code: poses every `SPACING` m along the driven path, separating
axes between all of them, μ as the maximum over many moments. The error is up to two spacings, well below the 0.75 m
within which pairs are excluded.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from recording import Numbers, Profile, Recording, Track

SPACING = 0.15
EPSILON = 0.5
NEAR = 0.75
"""Pairs this close to a limit are excluded, in m."""
SIDEWAYS = 0.6
"""A front that moves further than this across its heading in one step was moved by SUMO, not driven; in m."""

Mask = NDArray[np.bool_]


def travel(speed: float, profile: Profile, at_once: bool, times: Numbers) -> Numbers:
    """Distance in m that a braking road user travels in these times."""
    response, build_up = (0.0, 0.0) if at_once else (profile.response, profile.build_up)
    a = profile.decel
    ramp = min(build_up, math.sqrt(2 * speed * build_up / a))
    rest = max(speed - a * build_up / 2, 0.0) / a if ramp >= build_up else 0.0
    on_ramp = np.clip(times - response, 0, ramp)
    after = np.clip(times - response - ramp, 0, rest)
    distance = speed * (np.minimum(times, response) + on_ramp)
    if build_up > 0:
        distance = distance - a * on_ramp**3 / (6 * build_up)
    slower = speed - a * build_up / 2
    return distance + slower * after - a * after**2 / 2


def stopping(speed: float, profile: Profile) -> float:
    """Stopping distance in m."""
    return float(travel(speed, profile, False, np.array([1e6]))[0])


def minimal(ego: tuple[float, Profile], foe: tuple[float, Profile], sigma: float) -> float:
    """μ in m: the maximum of travel_ego − σ travel_foe over time, plus ε."""
    longest = max(v / p.decel + p.response + p.build_up for v, p in (ego, foe))
    times = np.linspace(0, longest, 3000)
    ahead = travel(*ego, False, times) - sigma * travel(*foe, sigma > 0, times)
    return max(float(ahead.max()), 0.0) + EPSILON


@dataclass
class Course:
    """A road user from a step on: evenly spaced poses along the path it drove, for `wanted` m or to the path's end."""

    profile: Profile
    speed: float
    distances: Numbers
    centres: Numbers
    axes: Numbers
    known: float
    jumps: float
    """Distance along the path at which SUMO first moves it sideways; infinite if it never does, 0 if it just has.

    Half a step before, the moment to which its speed belongs, one that just has was still beside its path.
    """


def moves_sideways(x: Numbers, y: Numbers, heading: Numbers) -> Mask:
    """Whether SUMO moves a road user sideways from each of these steps to the next."""
    dx, dy = np.diff(x), np.diff(y)
    middle = (heading[1:] + heading[:-1]) / 2
    forward = np.maximum(dx * np.cos(middle) + dy * np.sin(middle), 0.0)
    across = np.abs(dy * np.cos(middle) - dx * np.sin(middle))
    sideways: Mask = across > np.maximum(SIDEWAYS, 0.8 * forward)
    return sideways


def course(track: Track, step: int, wanted: float, recording: Recording) -> Course:
    """The course of a road user from a step on."""
    at = step - track.first
    x, y, heading = track.x[at:], track.y[at:], np.unwrap(track.heading[at:])
    driven = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    leaps = np.flatnonzero(moves_sideways(x, y, heading))
    jumps = float(driven[leaps[0]]) if len(leaps) else math.inf
    last = slice(max(at - 1, 0), at + 1)
    if moves_sideways(track.x[last], track.y[last], np.unwrap(track.heading[last])).any():
        jumps = 0.0
    keep = np.concatenate([[True], np.diff(driven) > 1e-6])
    known = float(driven[-1])
    distances = np.append(np.arange(0, min(wanted, known), SPACING), min(wanted, known))
    front = np.stack([np.interp(distances, driven[keep], values[keep]) for values in (x, y)], -1)
    angles = np.interp(distances, driven[keep], heading[keep])
    axes = np.stack([np.cos(angles), np.sin(angles)], -1)
    # A road user that has left the scene drove to the end of its path.
    known = math.inf if track.left else known
    centres = front - axes * track.profile.length / 2
    return Course(track.profile, float(track.speed[at]), distances, centres, axes, known, jumps)


def touching(a: Course, b: Course, rows: NDArray[np.intp], columns: NDArray[np.intp], grown: float = 0.0) -> Mask:
    """Whether pose `rows[i]` of a is within about `grown` m of pose `columns[i]` of b, by separating axes."""
    between = b.centres[columns] - a.centres[rows]
    first, second = a.axes[rows], b.axes[columns]
    cosine = np.abs((first * second).sum(-1))
    sine = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    hit = np.ones(len(rows), bool)
    for axis, (own, other) in ((first, (a.profile, b.profile)), (second, (b.profile, a.profile))):
        normal = np.stack([-axis[:, 1], axis[:, 0]], -1)
        half = np.array([own.length, own.width, other.length, other.width]) / 2
        reach_along = half[0] + half[2] * cosine + half[3] * sine + grown
        reach_across = half[1] + half[2] * sine + half[3] * cosine + grown
        hit &= np.abs((between * axis).sum(-1)) <= reach_along
        hit &= np.abs((between * normal).sum(-1)) <= reach_across
    return hit


def contacts(a: Course, b: Course, a_until: float, b_until: float) -> Mask:
    """The matrix of contacts between the poses of both up to these distances."""
    rows, columns = int((a.distances <= a_until + 1e-9).sum()), int((b.distances <= b_until + 1e-9).sum())
    near = math.hypot(a.profile.length, a.profile.width) / 2 + math.hypot(b.profile.length, b.profile.width) / 2
    gaps = a.centres[:rows, None] - b.centres[None, :columns]
    close = np.argwhere((gaps**2).sum(-1) <= near**2)
    matrix = np.zeros((rows, columns), bool)
    if len(close):
        matrix[close[:, 0], close[:, 1]] = touching(a, b, close[:, 0], close[:, 1])
    return matrix


def first_touch(ego: Course, foe: Course, at: int, foe_stop: float) -> tuple[float, Course]:
    """The ego's distance to the area that the foe covers until it stops, to the millimetre, and the ego's pose there.

    The ego's pose `at` touches that area, and the one before it does not.
    """
    columns = np.arange(max(int((foe.distances <= foe_stop + 1e-9).sum()), 1))
    low, high = (at - 1, at) if at > 0 else (0, 0)

    def pose(part: float) -> Course:
        def between(values: Numbers) -> Numbers:
            return values[low : low + 1] * (1 - part) + values[high : high + 1] * part

        axis = between(ego.axes)
        axis /= np.linalg.norm(axis)
        return Course(ego.profile, ego.speed, between(ego.distances), between(ego.centres), axis, 0.0, 0.0)

    before, after = 0.0, 1.0
    for _ in range(8):
        middle = (before + after) / 2
        touches = touching(pose(middle), foe, np.zeros_like(columns), columns).any()
        before, after = (before, middle) if touches else (middle, after)
    return float(pose(after).distances[0]), pose(after)


@dataclass
class Verdict:
    """The truth about a pair in a step; `excluded` is why the pair is excluded, or empty."""

    ego: str
    foe: str
    kind: str
    margin: float
    gap: float
    excluded: str


def kind_of(angle: float) -> str:
    """The kind of a conflict at an angle in rad."""
    return "rear_end" if angle < math.pi / 6 else "frontal" if angle > 5 * math.pi / 6 else "side"


def judge(names: tuple[str, str], a: Course, b: Course) -> Verdict | None:
    """The truth about a pair; None where the two do not meet."""
    stops = [stopping(course.speed, course.profile) for course in (a, b)]
    excluded = ""
    if min(a.known - stops[0], b.known - stops[1]) < EPSILON:
        excluded = "path not known"
    if a.jumps < stops[0] + EPSILON or b.jumps < stops[1] + EPSILON:
        excluded = "moved sideways"
    reach_a, reach_b = stops[0] + EPSILON + NEAR, stops[1] + EPSILON + NEAR
    matrix = contacts(a, b, reach_a, reach_b)
    if matrix[0, 0]:
        first, second = sorted(names)
        return Verdict(first, second, "", -EPSILON, 0.0, excluded)
    met = []
    for ego, foe, table, foe_stop, order in ((a, b, matrix, stops[1], names), (b, a, matrix.T, stops[0], names[::-1])):
        if ego.speed <= 0 and foe.speed <= 0:
            continue
        columns = int((foe.distances <= foe_stop + 1e-9).sum())
        hits = np.flatnonzero(table[:, : max(columns, 1)].any(1))
        if len(hits):
            met.append((float(ego.distances[hits[0]]), order, ego, foe, int(hits[0]), table))
    if not met:
        return Verdict(*names, "", math.inf, math.inf, excluded) if excluded else None
    met.sort(key=lambda found: (-found[0], found[1][0]))
    _, order, ego, foe, at, table = met[0]
    foe_stop = stops[1] if foe is b else stops[0]
    ego_distance, pose = first_touch(ego, foe, at, foe_stop)
    if abs(ego_distance - (stops[0] if ego is a else stops[1]) - EPSILON) <= NEAR:
        # Whether the two meet depends on where the ego stops.
        excluded = excluded or "near the limit"
    everywhere = np.arange(len(foe.distances))
    there = touching(pose, foe, np.zeros_like(everywhere), everywhere, grown=0.02)
    arrives = int(np.flatnonzero(there)[0])
    cosine = float(np.clip((pose.axes[0] * foe.axes[arrives]).sum(), -1, 1))
    foe_distance = float(foe.distances[arrives])
    if cosine > 0:
        out = np.flatnonzero(~there[arrives:])
        foe_distance = float(foe.distances[arrives + out[0]]) if len(out) else float(foe.distances[-1])
        if not len(out) and not math.isinf(foe.known):
            excluded = excluded or "path not known"
        if arrives == 0 and foe_distance <= 2 * SPACING:
            foe_distance = 0.0
        if foe.jumps < foe_distance:
            excluded = excluded or "moved sideways"
    gap = max(ego_distance - cosine * foe_distance, 0.0)
    mu = minimal((ego.speed, ego.profile), (foe.speed, foe.profile), cosine)
    return Verdict(*order, kind_of(math.acos(cosine)), gap - mu, gap, excluded)


def step_truth(recording: Recording, step: int) -> dict[frozenset[str], Verdict]:
    """The truth about every pair that meets in a step."""
    present = [
        (user, track)
        for user, tracks in recording.tracks.items()
        for track in tracks
        if track.first <= step < track.first + len(track.x)
    ]
    courses = []
    for _, track in present:
        at = step - track.first
        stop = stopping(float(track.speed[at]), track.profile)
        courses.append(course(track, step, stop + EPSILON + 30.0, recording))
    radii = [
        stopping(c.speed, c.profile) + EPSILON + math.hypot(c.profile.length, c.profile.width) / 2 for c in courses
    ]
    centres = np.array([c.centres[0] for c in courses]).reshape(-1, 2)
    found = {}
    reach = np.array(radii)
    for first in range(len(courses)):
        apart = np.hypot(*(centres[first + 1 :] - centres[first]).T)
        for second in np.flatnonzero(apart <= reach[first] + reach[first + 1 :]) + first + 1:
            a, b = courses[first], courses[second]
            if (a.profile.person and b.profile.person) or (a.speed <= 0 and b.speed <= 0):
                continue
            names = (present[first][0], present[second][0])
            verdict = judge(names, a, b)
            if verdict:
                found[frozenset(names)] = verdict
    return found
