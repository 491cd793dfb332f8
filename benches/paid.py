"""What a user pays for what closecall does, from the lines of the benches."""

from __future__ import annotations

from collections.abc import Callable

from goals import DENSE, SCENARIOS, Lines


def between(values: list[float], form: str = ".2f") -> str:
    """The least and the largest of the values."""
    return f"{min(values):{form}} to {max(values):{form}}"


def runs(lines: Lines, what: str, method: str) -> str:
    """The ratios of the bench's simulations."""
    return between([lines(what, scene, method) for scene in SCENARIOS])


def attached(lines: Lines) -> str:
    """What attached runs take."""
    over, program = runs(lines, "over plain", "closecall"), runs(lines, "over program", "closecall")
    return f"{over} times SUMO through libsumo; {program} times the program `sumo`, which is faster than libsumo"


def traci(lines: Lines) -> str:
    """What a script with traci takes."""
    ratios = [lines("over plain", scene, "traci") for scene in ("grid", "town")]
    return f"{between(ratios)} times the same script, also with traci, without the checker"


def frames(lines: Lines) -> str:
    """What a step with a frame takes, and how much of it reads the frame."""
    step, read = (
        between([lines("step", scene, method, 10**4) / 1e3 for scene in DENSE]) for method in ("frames", "frames read")
    )
    return f"{step} µs per road user and step in dense traffic, of which {read} take the table over"


def replay(lines: Lines) -> str:
    """The speed of a replay."""
    csv, xml = (
        between([lines("replay", scene, form) / 1e6 for scene in ("sparse", "platoons")], ".1f")
        for form in ("CSV", "XML")
    )
    gain = between([lines("gain of two threads", scene, "replay") for scene in ("grid", "town")])
    return (
        f"{csv} (CSV) and {xml} (XML) million vehicle-steps per second on one core; two cores are {gain} times as fast"
    )


def statistics(lines: Lines) -> str:
    """What the statistics of many conflicts take."""
    seconds, memory = (lines(what, "town", "closecall") for what in ("statistics", "statistics memory"))
    return f"{seconds:.0f} s, {memory:.0f} MB"


def sweep(lines: Lines) -> str:
    """What a run takes by itself and in a sweep."""
    what = ("run alone", "overhead of a run", "gain of two workers")
    alone, overhead, gain = (lines(each, "left_turn", "sweep") for each in what)
    return (
        f"{alone + overhead:.0f} ms per run with one worker, {(alone + overhead) / gain:.0f} ms with two; the same run "
        f"by itself: {alone:.0f} ms"
    )


def net(lines: Lines) -> str:
    """What a large net takes."""
    time, memory = (
        [lines(what, "big net", method) for method in ("SUMO", "closecall")] for what in ("loading", "memory")
    )
    return (
        f"{time[1] - time[0]:.1f} s more than SUMO's {time[0]:.1f} s, "
        f"{memory[1] - memory[0]:.0f} MB more than SUMO's {memory[0]:.0f} MB"
    )


PAID: list[tuple[str, Callable[[Lines], str]]] = [
    ("`closecall run`, or your script with libsumo", attached),
    (
        "for comparison: SUMO's `device.ssm`, TTC alone",
        lambda lines: f"{runs(lines, 'over plain', 'device.ssm')} times SUMO through libsumo",
    ),
    ("your script with traci", traci),
    ("frames: tables of states from your own Python program", frames),
    ("`closecall replay`", replay),
    ("`closecall stats` of ten million conflicts in Parquet", statistics),
    ("`closecall sweep`", sweep),
    (
        "memory of an attached run",
        lambda lines: (
            f"{between([lines('held', scene, 'closecall') for scene in SCENARIOS], '.0f')} bytes per road user in the "
            "scene; no more after a day than after an hour"
        ),
    ),
    ("a net of 100,000 lanes", net),
]
