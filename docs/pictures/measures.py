"""Draws docs/pictures/measures/*.svg, one for each section of docs/measures.md, from numbers that it computes here.

    python docs/pictures/measures.py

One style: a strip of road seen from above, or a chart. Colours are chosen to be read on white and on black.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from pathlib import Path
from statistics import NormalDist

HERE = Path(__file__).parent / "measures"
EGO, FOE, MARK, GREY = "#2f81f7", "#d9822b", "#d0478a", "#808080"
WIDTH, HEIGHT = 480, 150
LENGTH, BREADTH = 5.0, 1.8


class Picture:
    """An SVG of 480 by 150 pixels, in pixels."""

    def __init__(self, title: str) -> None:
        self.parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
            'font-family="system-ui,sans-serif" font-size="13">',
            f"<title>{title}</title>",
        ]

    def add(self, part: str) -> None:
        self.parts.append(part)

    def line(self, points: Iterable[tuple[float, float]], colour: str, width: float = 2, dash: str = "") -> None:
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.add(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}"{dashed}/>')

    def area(self, points: Iterable[tuple[float, float]], colour: str) -> None:
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.add(f'<polygon points="{path}" fill="{colour}" fill-opacity="0.25" stroke="none"/>')

    def text(self, x: float, y: float, words: str, colour: str = GREY, anchor: str = "middle") -> None:
        self.add(f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" text-anchor="{anchor}">{words}</text>')

    def dot(self, x: float, y: float, colour: str = MARK) -> None:
        self.add(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}"/>')

    def car(self, x: float, y: float, colour: str, scale: float, turn: float = 0.0, faint: bool = False) -> None:
        """A car whose front bumper is here; `turn` in degrees, 0 to the right."""
        long, broad = LENGTH * scale, BREADTH * scale
        opacity = ' fill-opacity="0.25"' if faint else ""
        self.add(
            f'<g transform="translate({x:.1f} {y:.1f}) rotate({-turn:.1f})"><rect x="{-long:.1f}" y="{-broad / 2:.1f}" '
            f'width="{long:.1f}" height="{broad:.1f}" rx="3" fill="{colour}"{opacity}/></g>'
        )

    def arrow(self, x: float, y: float, dx: float, dy: float, colour: str) -> None:
        """An arrow, its length as given."""
        size = math.hypot(dx, dy)
        ux, uy = dx / size, dy / size
        tip = (x + dx, y + dy)
        self.line([(x, y), (tip[0] - 6 * ux, tip[1] - 6 * uy)], colour)
        wings = [(tip[0] - 9 * ux + side * 4 * uy, tip[1] - 9 * uy - side * 4 * ux) for side in (1, -1)]
        path = " ".join(f"{a:.1f},{b:.1f}" for a, b in (tip, *wings))
        self.add(f'<polygon points="{path}" fill="{colour}"/>')

    def span(self, left: float, right: float, y: float, words: str, colour: str = MARK, below: bool = False) -> None:
        """A dimension from left to right."""
        self.line([(left, y), (right, y)], colour, 1.5)
        for end in (left, right):
            self.line([(end, y - 5), (end, y + 5)], colour, 1.5)
        self.text((left + right) / 2, y + 17 if below else y - 7, words, colour)

    def save(self, name: str) -> None:
        (HERE / f"{name}.svg").write_text("\n".join([*self.parts, "</svg>"]) + "\n")


class Chart(Picture):
    """A chart with named axes; its methods take values."""

    LEFT, RIGHT, TOP, BOTTOM = 52, 466, 12, 116

    def __init__(self, title: str, x: tuple[str, float], y: tuple[str, float], low: float = 0.0) -> None:
        super().__init__(title)
        self.most, self.highest, self.low = x[1], y[1], low
        self.line([(self.LEFT, self.TOP), (self.LEFT, self.BOTTOM), (self.RIGHT, self.BOTTOM)], GREY, 1)
        self.text(self.RIGHT, self.BOTTOM + 30, x[0], anchor="end")
        self.add(
            f'<text transform="translate(14 {self.TOP}) rotate(-90)" fill="{GREY}" text-anchor="end">{y[0]}</text>'
        )
        for part in range(5):
            value = self.most * part / 4
            self.text(self.at(value, 0)[0], self.BOTTOM + 15, f"{value:g}")
        for part in range(3):
            value = low + (self.highest - low) * part / 2
            self.text(self.LEFT - 6, self.at(0, value)[1] + 4, f"{value:g}", anchor="end")

    def at(self, x: float, y: float) -> tuple[float, float]:
        """The place of a value."""
        across = self.LEFT + (self.RIGHT - self.LEFT) * x / self.most
        return across, self.BOTTOM - (self.BOTTOM - self.TOP) * (y - self.low) / (self.highest - self.low)

    def curve(self, of: Callable[[float], float], colour: str, begin: float = 0.0, end: float | None = None) -> None:
        """A function, where it is within the chart."""
        stop = self.most if end is None else end
        values = [(begin + (stop - begin) * part / 200) for part in range(201)]
        shown = [(x, of(x)) for x in values]
        self.line([self.at(x, y) for x, y in shown if self.low <= y <= self.highest], colour)

    def level(self, y: float, words: str, colour: str = GREY) -> None:
        """A horizontal line."""
        self.line([self.at(0, y), self.at(self.most, y)], colour, 1, "5 4")
        x, height = self.at(self.most, y)
        self.text(x, height - 4, words, colour, "end")

    def moment(self, x: float, words: str, colour: str = MARK, low: bool = False) -> None:
        """A vertical line."""
        self.line([self.at(x, self.low), self.at(x, self.highest)], colour, 1.5, "4 3")
        place, top = self.at(x, self.highest)
        self.text(place + 5, self.BOTTOM - 8 if low else top + 10, words, colour, "start")


def stop(speed: float, decel: float = 9.0, response: float = 1.05, build_up: float = 0.1) -> float:
    """The stopping distance of docs/model.md."""
    return speed * (response + build_up / 2) + speed**2 / (2 * decel) - decel * build_up**2 / 24


def following(title: str, gap: float, scale: float, y: float = 75, start: float = 60) -> tuple[Picture, float, float]:
    """A follower and its leader, the gap to scale; where the follower's front and the leader's rear are."""
    picture = Picture(title)
    front, rear = start + LENGTH * scale, start + (LENGTH + gap) * scale
    picture.line([(0, y + 24), (WIDTH, y + 24)], GREY, 1)
    picture.line([(0, y - 24), (WIDTH, y - 24)], GREY, 1)
    picture.car(front, y, EGO, scale)
    picture.car(rear + LENGTH * scale, y, FOE, scale)
    return picture, front, rear


def margin() -> None:
    # Both at 15 m/s with 9 m/s²: μ is the way of the response and the build-up, and ε.
    speed, gap, scale = 15.0, 12.0, 13.0
    mu = speed * (1.05 + 0.05) - 9 * 0.1**2 / 24 + 0.5
    picture, front, rear = following("gap, μ and margin of a follower", gap, scale, start=30)
    picture.span(front, rear, 36, f"gap {gap:g} m", EGO)
    picture.span(front, front + mu * scale, 116, f"μ {mu:.1f} m", MARK, below=True)
    picture.span(rear, front + mu * scale, 58, "", MARK)
    picture.text(front + mu * scale + 8, 63, f"margin −{mu - gap:.1f} m", MARK, "start")
    picture.save("margin")


def clearance() -> None:
    picture = Picture("the clearance of two that pass each other")
    picture.car(170, 92, EGO, 16)
    picture.car(250, 36, FOE, 16, turn=180)
    picture.arrow(176, 92, 44, 0, EGO)
    picture.arrow(244, 36, -44, 0, FOE)
    left, right = (170, 92 - BREADTH * 8), (250, 36 + BREADTH * 8)
    picture.line([left, right], MARK)
    away = math.hypot(right[0] - left[0], right[1] - left[1]) / 16
    picture.text(222, 72, f"clearance {away:.1f} m", MARK, "start")
    picture.save("clearance")


def ttc() -> None:
    # The gap of 20 m closes at 15 − 7 m/s.
    picture = Chart("TTC: when the gap is used up at the present speeds", ("s", 4), ("gap, m", 30))
    picture.curve(lambda t: 20 - 8 * t, EGO)
    picture.dot(*picture.at(2.5, 0))
    picture.moment(2.5, "TTC 2.5 s")
    picture.text(*picture.at(0.35, 20), "15 m/s behind 7 m/s", EGO, "start")
    picture.save("ttc")


def drac() -> None:
    # The same pair: with 8² / 40 = 1.6 m/s² the gap ends at 0 when the speeds are equal.
    picture = Chart("DRAC: the deceleration with which the gap just suffices", ("s", 8), ("gap, m", 20))
    picture.curve(lambda t: 20 - 8 * t, GREY)
    picture.curve(lambda t: 20 - 8 * t + 1.6 * t * t / 2, EGO)
    picture.text(*picture.at(2.2, 13), "braking with DRAC = 8²/(2 · 20) = 1.6 m/s²", EGO, "start")
    picture.text(*picture.at(0.15, 2), "not braking", GREY, "start")
    picture.dot(*picture.at(5, 0))
    picture.save("drac")


def crossing(title: str, first: str, second: str, between: str) -> Picture:
    """The shared area of two that cross, and when it is taken."""
    picture = Picture(title)
    picture.area([(96, 40), (120, 40), (120, 64), (96, 64)], MARK)
    picture.line([(108, 8), (108, 142)], GREY, 1, "4 3")
    picture.line([(16, 52), (200, 52)], GREY, 1, "4 3")
    picture.car(108, 32 - 14, FOE, 12, turn=90, faint=True)
    picture.car(78, 52, EGO, 12)
    picture.arrow(78, 52, 40, 0, EGO)
    picture.arrow(108, 18, 0, -16, FOE)
    picture.text(166, 88, "shared area", MARK)
    picture.line([(230, 96), (466, 96)], GREY, 1)
    picture.text(466, 112, "time", anchor="end")
    picture.area([(240, 78), (300, 78), (300, 96), (240, 96)], FOE)
    picture.area([(370, 78), (430, 78), (430, 96), (370, 96)], EGO)
    picture.text(270, 72, first, FOE)
    picture.text(400, 72, second, EGO)
    picture.span(300, 370, 42, between)
    return picture


def pet() -> None:
    crossing(
        "PET: from when the first leaves until the second enters", "foe is in it", "ego is in it", "PET 1.4 s"
    ).save("pet")


def tadv() -> None:
    picture = crossing(
        "TAdv and T2: the same ahead, at the present speeds", "foe would be", "ego would be", "TAdv 1.4 s"
    )
    picture.span(230, 370, 128, "T2 2.8 s from now", EGO)
    picture.save("tadv")


def headway() -> None:
    gap, speed, scale = 12.0, 15.0, 15.0
    picture, front, rear = following("headway: the gap over the speed", gap, scale)
    picture.span(front, rear, 36, f"gap {gap:g} m / {speed:g} m/s = headway {gap / speed:.1f} s")
    picture.arrow(front, 75, 60, 0, EGO)
    picture.save("headway")


def thw() -> None:
    gap, speed, scale = 12.0, 15.0, 15.0
    picture, front, rear = following("THW: from front to front, over the speed", gap, scale)
    ends = rear + LENGTH * scale
    picture.span(front, ends, 36, f"(12 m + 5 m) / {speed:g} m/s = THW {(gap + LENGTH) / speed:.2f} s")
    picture.save("thw")


def sgap() -> None:
    picture, front, rear = following("SGAP: the smallest gap", 9.0, 15.0)
    picture.span(front, rear, 36, "SGAP 9 m")
    picture.save("sgap")


def time_left() -> None:
    # 30 m behind one that stands, at 15 m/s: the wait for which the way to stop still fits.
    left = (30 - stop(15, response=0)) / 15
    picture = Chart("time left: how long full braking may wait", ("wait, s", 2), ("room, m", 60))
    picture.curve(lambda wait: stop(15, response=wait), EGO)
    picture.level(30, "", FOE)
    picture.text(*picture.at(0.1, 33), "30 m to what stands", FOE, "start")
    picture.moment(left, f"ttb {left:.2f} s", low=True)
    picture.dot(*picture.at(left, 30))
    picture.text(*picture.at(0.1, 5), "way to stop from 15 m/s", EGO, "start")
    picture.save("time_left")


def crash_probability() -> None:
    # Response times of docs/model.md's attentive driver, lognormal.
    mean, deviation, left = 0.92, 0.28, 1.2
    spread = math.sqrt(math.log(1 + (deviation / mean) ** 2))
    middle = math.log(mean) - spread**2 / 2

    def density(time: float) -> float:
        return math.exp(-(((math.log(time) - middle) / spread) ** 2) / 2) / (time * spread * math.sqrt(2 * math.pi))

    late = 1 - NormalDist(middle, spread).cdf(math.log(left))
    picture = Chart("crash probability: responses longer than the time left", ("response time, s", 4), ("density", 2.0))
    points = [(left + (4 - left) * part / 100) for part in range(101)]
    picture.area([picture.at(left, 0), *(picture.at(x, density(x)) for x in points), picture.at(4, 0)], MARK)
    picture.curve(density, EGO, begin=0.05)
    picture.moment(left, f"time left 1.2 s: {late:.0%} respond later")
    picture.save("crash_probability")


def delta_v() -> None:
    # Two that crash at a right angle and go on together: 1500 kg at 14 m/s, 1500 kg at 10 m/s.
    ego, foe, scale = (14.0, 0.0), (0.0, 10.0), 9.0
    both = ((ego[0] + foe[0]) / 2, (ego[1] + foe[1]) / 2)
    picture = Picture("ΔV: the change of each velocity when both go on together")
    origin = (150.0, 122.0)

    def to(velocity: tuple[float, float]) -> tuple[float, float]:
        return origin[0] + velocity[0] * scale, origin[1] - velocity[1] * scale

    for velocity, colour in ((ego, EGO), (foe, FOE), (both, GREY)):
        end = to(velocity)
        picture.arrow(*origin, end[0] - origin[0], end[1] - origin[1], colour)
    picture.line([to(ego), to(both)], MARK, 2, "5 3")
    picture.line([to(foe), to(both)], MARK, 2, "5 3")
    size = math.hypot(ego[0] - both[0], ego[1] - both[1])
    picture.text(to(ego)[0] + 8, 126, "ego 14 m/s", EGO, "start")
    picture.text(142, to(foe)[1] + 8, "foe 10 m/s", FOE, "end")
    picture.text(to(both)[0] + 34, to(both)[1] + 4, f"each ΔV {size:.1f} m/s", MARK, "start")
    picture.save("delta_v")


def overlap() -> None:
    picture = Picture("overlap: the shortest displacement that parts both")
    scale = 24
    picture.car(230, 84, EGO, scale, faint=True)
    picture.car(218 + LENGTH * scale, 60, FOE, scale, faint=True)
    picture.area([(218, 62.4), (230, 62.4), (230, 81.6), (218, 81.6)], MARK)
    picture.span(218, 230, 120, "", MARK)
    picture.text(224, 140, f"overlap {12 / scale:.2f} m", MARK)
    picture.save("overlap")


def rss_way(speed: float) -> float:
    """The way by RSS with the values of ad-rss-lib."""
    return speed + 3.5 / 2 + (speed + 3.5) ** 2 / 8


def rss() -> None:
    picture = Chart("RSS behind a leader at the same speed, and μ", ("speed, m/s", 40), ("m", 160))
    picture.curve(lambda v: max(rss_way(v) - v * v / 16, 0), MARK)
    picture.curve(lambda v: 1.1 * v + 0.5, EGO)
    picture.text(*picture.at(24, 100), "rss_distance", MARK, "end")
    picture.text(*picture.at(30, 20), "μ", EGO, "start")
    picture.save("rss")


def br() -> None:
    picture = Chart("BR: the largest deceleration", ("s", 4), ("a, m/s²", 2), low=-6)

    def acceleration(time: float) -> float:
        return -4.5 * math.exp(-(((time - 2) / 0.6) ** 2))

    picture.curve(acceleration, EGO)
    picture.level(0, "")
    picture.dot(*picture.at(2, -4.5))
    picture.text(*picture.at(2.1, -5.3), "BR 4.5 m/s², max_d −4.5 m/s²", MARK, "start")
    picture.save("br")


def mdrac() -> None:
    # 8 m/s faster, by the time to collision.
    picture = Chart("MDRAC and DRAC by the TTC, closing in by 8 m/s", ("TTC, s", 4), ("m/s²", 12))
    picture.curve(lambda time: 8 / (2 * (time - 1)), MARK, begin=1.05)
    picture.curve(lambda time: 8 / (2 * time), EGO, begin=0.05)
    picture.moment(1, "reaction 1 s", GREY, low=True)
    picture.text(*picture.at(2.0, 5.2), "MDRAC", MARK, "start")
    picture.text(*picture.at(0.75, 3.0), "DRAC", EGO, "end")
    picture.save("mdrac")


def mttc() -> None:
    # 20 m, both at 15 m/s, the leader brakes with 3 m/s².
    time = math.sqrt(2 * 20 / 3)
    picture = Chart("MTTC: the leader goes on braking", ("s", 4), ("gap, m", 30))
    picture.level(20, "")
    picture.text(*picture.at(0.1, 21.5), "at constant speeds the gap stays: no TTC", GREY, "start")
    picture.curve(lambda t: 20 - 3 * t * t / 2, EGO)
    picture.dot(*picture.at(time, 0))
    picture.text(*picture.at(2.9, 1.5), f"MTTC {time:.1f} s", MARK, "end")
    picture.save("mttc")


def crash_index() -> None:
    # The same pair, by the gap: both at 15 m/s, the leader brakes with 3 m/s².
    def index(gap: float) -> float:
        time = math.sqrt(2 * gap / 3)
        return (15**2 - (15 - 3 * time) ** 2) / (2 * time)

    picture = Chart("crash index, both at 15 m/s, the leader braking with 3 m/s²", ("gap, m", 40), ("m²/s³", 50))
    picture.curve(index, MARK, begin=0.2)
    picture.dot(*picture.at(20, index(20)))
    picture.text(*picture.at(20.5, index(20) + 4), f"20 m: {index(20):.0f} m²/s³", MARK, "start")
    picture.save("crash_index")


def tet() -> None:
    def time_to_collision(time: float) -> float:
        return 1.5 + 1.1 * (time - 3) ** 2

    edge = math.sqrt(1.5 / 1.1)
    picture = Chart("TET and TIT: how long, and how much, the TTC is below 3 s", ("s", 6), ("TTC, s", 6))
    below = [3 - edge + 2 * edge * part / 50 for part in range(51)]
    picture.area([picture.at(time, time_to_collision(time)) for time in below], MARK)
    picture.curve(time_to_collision, EGO)
    picture.level(3, "TTC* = 3 s")
    picture.span(picture.at(3 - edge, 0)[0], picture.at(3 + edge, 0)[0], picture.at(0, 0.5)[1], "", MARK)
    picture.text(picture.at(3 + edge, 0)[0] + 8, picture.at(0, 0.5)[1] + 4, f"TET {2 * edge:.1f} s", MARK, "start")
    picture.text(picture.at(3, 0)[0], picture.at(0, 2.2)[1], "TIT", MARK)
    picture.save("tet")


def cpi() -> None:
    brakes, needed = NormalDist(8.45, 1.42), 7.0
    picture = Chart("CPI: the share of vehicles whose brakes are weaker than the DRAC", ("m/s²", 16), ("density", 0.36))
    weak = [4.23 + (needed - 4.23) * part / 50 for part in range(51)]
    picture.area([picture.at(4.23, 0), *(picture.at(x, brakes.pdf(x)) for x in weak), picture.at(needed, 0)], MARK)
    picture.curve(brakes.pdf, EGO, begin=4.23, end=12.68)
    picture.moment(needed, "DRAC 7 m/s²", MARK)
    share = (brakes.cdf(needed) - brakes.cdf(4.23)) / (brakes.cdf(12.68) - brakes.cdf(4.23))
    picture.text(picture.at(4.4, 0)[0], picture.at(0, 0.16)[1], f"{share:.0%}", MARK, "end")
    picture.text(*picture.at(10.2, 0.18), "brakes", EGO, "start")
    picture.save("cpi")


def btn() -> None:
    # 10 m/s faster than a leader at 15 m/s that brakes with 4 m/s² and does not stand before; brakes of 9 m/s².
    picture = Chart("a_long_req and BTN by the gap", ("gap, m", 40), ("m/s²", 18))
    picture.curve(lambda gap: 25**2 / (2 * (gap + 15**2 / 8)) if gap > 0 else 99, MARK)
    picture.level(9, "BTN 1: brakes of 9 m/s²", EGO)
    picture.text(*picture.at(1.5, 15), "25 m/s behind 15 m/s that brakes with 4 m/s²", MARK, "start")
    picture.save("btn")


def stn() -> None:
    picture = Picture("a_lat_req: beside the foe at the TTC")
    scale = 14.0
    start, rear, y, lane = 80.0, 330.0, 84.0, BREADTH * 14
    picture.car(start, y, EGO, scale)
    picture.car(rear + LENGTH * scale, y, FOE, scale)
    path = [(start + (rear - start) * part / 40, y - lane * (part / 40) ** 2) for part in range(41)]
    picture.line(path, EGO, 2, "5 4")
    picture.car(rear, y - lane, EGO, scale, faint=True)
    picture.line([(rear - 80, y - lane), (rear - 80, y)], MARK, 1.5)
    picture.text(rear - 86, y - lane + 4, "y 1.8 m", MARK, "end")
    picture.text(start + 20, y + 40, f"at a TTC of 1.5 s: 2 y/TTC² = {2 * 1.8 / 1.5**2:.1f} m/s²", MARK, "start")
    picture.save("stn")


def ta() -> None:
    def border(speed: float) -> float:
        return 1.5 * speed / (16.7 * math.exp(-0.0306 * speed / 2))

    picture = Chart("levels of severity by TA and conflicting speed", ("conflicting speed, m/s", 24), ("TA, s", 6))
    for number in range(-2, 3):
        picture.curve(lambda v, more=number: border(v) + more / 2, MARK if number == 0 else GREY)
    picture.text(*picture.at(14, 4.2), "not serious", GREY, "end")
    picture.text(*picture.at(23.8, 0.3), "serious: level 26 on", MARK, "end")
    picture.dot(*picture.at(50 / 3.6, 1.5))
    picture.text(*picture.at(5.6, 3.2), "dot: 1.5 s at 50 km/h", MARK)
    picture.save("ta")


def ssam() -> None:
    # The velocities of two at a right angle.
    picture = Picture("MaxS and DeltaS of two velocities")
    origin, ego, foe = (150, 122), (126, 0), (0, -90)
    picture.arrow(*origin, *ego, EGO)
    picture.arrow(*origin, *foe, FOE)
    picture.line([(origin[0] + ego[0], origin[1]), (origin[0], origin[1] + foe[1])], MARK, 2, "5 3")
    picture.text(284, 126, "ego 14 m/s: max_s", EGO, "start")
    picture.text(142, 40, "foe 10 m/s", FOE, "end")
    picture.text(226, 70, f"delta_s {math.hypot(14, 10):.1f} m/s", MARK, "start")
    picture.save("ssam")


def act() -> None:
    picture = Picture("ACT: the distance over the speed at which it decreases")
    picture.car(140, 110, EGO, 14)
    picture.car(290, 42, FOE, 14, turn=180)
    picture.arrow(146, 110, 70, 0, EGO)
    picture.arrow(284, 42, -50, 0, FOE)
    ends = [(140.0, 110 - BREADTH * 7), (290.0, 42 + BREADTH * 7)]
    picture.line(ends, MARK)
    across, up = (ends[1][0] - ends[0][0]) / 14, (ends[0][1] - ends[1][1]) / 14
    away = math.hypot(across, up)
    nearing = (14 + 10) * across / away
    picture.text(216, 88, f"{away:.1f} m, less by {nearing:.1f} m/s: ACT {away / nearing:.2f} s", MARK, "start")
    picture.save("act")


def ei() -> None:
    picture = Picture("EI: how deep both would overlap, over the time until they are nearest")
    scale = 15.0
    picture.car(110, 84, EGO, scale)
    picture.arrow(116, 84, 60, 0, EGO)
    picture.car(375, 84, EGO, scale, faint=True)
    picture.car(300 + LENGTH * scale, 66, FOE, scale, turn=0)
    depth = BREADTH - 18 / scale
    low, high = 84 - BREADTH * scale / 2, 66 + BREADTH * scale / 2
    picture.area([(300, low), (375, low), (375, high), (300, high)], MARK)
    picture.line([(383, low), (383, high)], MARK, 3)
    picture.text(300, 124, f"{depth:.1f} m deep in 1.2 s: EI {depth / 1.2:.1f} m/s", MARK)
    picture.save("ei")


def main() -> None:
    """Draw all of them."""
    HERE.mkdir(exist_ok=True)
    for draw in (
        *(margin, clearance, ttc, drac, pet, headway, time_left, crash_probability, delta_v, overlap, tadv, rss, thw),
        *(sgap, br, mdrac, mttc, crash_index, tet, cpi, btn, stn, ta, ssam, act, ei),
    ):
        draw()


if __name__ == "__main__":
    main()
