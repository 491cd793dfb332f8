"""Every figure of paper.md, from the results that the repository holds and from commands.

    python docs/paper/figures.py [--check]

Measures the figures, writes them to figures.md with machine and date, and compares paper.md with them. With --check it
runs no command and writes nothing: figures of commands are those of figures.md. Exit status 1 if the text has another
figure, or one that nothing here explains.
"""

from __future__ import annotations

import csv
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from datetime import date
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PAPER, FIGURES = HERE / "paper.md", HERE / "figures.md"

Values = tuple[str, ...]


class Figure(NamedTuple):
    """Figures that stand together in the paper."""

    sentence: str
    """Occurs in the paper, with the figures in place of `{}`."""
    source: str
    """A file of the repository, or a command."""
    find: Callable[[str], Values]
    """Finds the figures in the file, or in what the command prints."""


def pattern(text: str) -> Callable[[str], Values]:
    """Finds the groups of a regular expression, whatever the line breaks."""

    def find(source: str) -> Values:
        found = re.search(text, " ".join(source.split()))
        if found is None:
            raise LookupError(f"no {text!r}")
        return found.groups()

    return find


def percent(share: str) -> str:
    """A share in percent, to a tenth."""
    return f"{100 * float(share):.1f}"


def row(column: str, of: dict[str, str], form: Callable[[str], str] = str) -> Callable[[str], Values]:
    """Finds a value in the only row of a table with these values in other columns."""

    def find(source: str) -> Values:
        (value,) = (
            row[column]
            for row in csv.DictReader(source.splitlines())
            if all(row[name] == wanted for name, wanted in of.items())
        )
        return (form(value),)

    return find


def several(*finders: Callable[[str], Values]) -> Callable[[str], Values]:
    """Finds the figures of each."""
    return lambda source: tuple(value for find in finders for value in find(source))


def approved(_: str) -> Values:
    """The scenarios, the seeds of each, and their conflicts without artefacts."""
    scenarios = sorted((ROOT / "sumo_nets").glob("*/expected/conflicts.csv"))
    conflicts = [[row for row in csv.DictReader(path.open(encoding="utf-8"))] for path in scenarios]
    (seeds,) = {len(re.findall(r'"seed":', path.with_name("summary.json").read_text())) for path in scenarios}
    count = sum(not row["artefact"] for rows in conflicts for row in rows)
    return str(len(scenarios)), str(seeds), f"{count:,}"


def sources(text: str) -> Values:
    """The numbers from others, and how many of them were read in the text that is cited."""
    checked = [line.split("|")[3] for line in text.split("\n## ")[0].splitlines() if line.startswith("| ")][1:]
    return str(len(checked)), str(sum("primary" in cell for cell in checked))


CRASHES = {
    "recordings": "kept",
    "path": "driven",
    "smooth": "no",
    "name": "crash_probability",
    "kind": "AUC",
    "lead": "0.5",
}
STUDY, VALIDATION, RESULTS = "docs/study/study.csv", "docs/validation.md", "tests/validation/results.csv"
LEFT_TURN = "sumo_nets/left_turn/left_turn.sumocfg"
CROSSING = {"axis": "volume", "parameter": "cross"}
ON_STRAIGHT_PATHS = {
    "axis": "path",
    "method": "straight",
    "parameter": "roundabout",
    "error_name": "share of conflicts missed or invented",
}

PAPER_FIGURES = [
    Figure(
        "of {} pairs that `device.ssm` reports on six networks, `closecall` logs {}, and each of the other {}",
        "docs/from_device_ssm.md",
        pattern(r"Of ([\d,]+) pairs that the device reports on six nets, closecall logs ([\d,]+); the other (\d+)"),
    ),
    Figure(
        "takes {} to {} times as long as SUMO through libsumo, for TTC alone; with `closecall`, {} to {} times ({}).",
        "docs/bench.md",
        several(
            pattern(r"device.ssm`, TTC alone \| ([\d.]+) to ([\d.]+) times SUMO through libsumo"),
            pattern(r"with libsumo \| ([\d.]+) to ([\d.]+) times SUMO through libsumo"),
            pattern(r"Measured on: (.*?)\. <!--"),
        ),
    ),
    Figure(
        "misses {} % of pairs that cross, the exact predicate {} %",
        STUDY,
        several(
            row("false_negative_rate", {"method": "vertex in side (paper)", **CROSSING}, percent),
            row("false_negative_rate", {"method": "exact predicate", **CROSSING}, percent),
        ),
    ),
    Figure(
        "In a roundabout, {} % of the conflicts on straight paths are invented",
        STUDY,
        row("false_positive_rate", ON_STRAIGHT_PATHS, percent),
    ),
    Figure("{} bounds hold", "closecall stress --cases 100000", pattern(r"all (\d+) bounds hold")),
    Figure("most of them against {}-bit arithmetic", "docs/study.md", pattern(r"Most references have (\d+) bits")),
    Figure("of {} entries in the list of what is taken from others, {} could", "docs/sources.md", sources),
    Figure(
        "of {} trials without a change, at a level of {} %, {}, {} and {} were false alarms on three networks",
        "docs/compare.md",
        several(
            pattern(r"Of ([\d,]+) trials each"),
            lambda text: (percent(pattern(r"false_alarm = ([\d.]+) ")(text)[0]),),
            pattern(r"(\d+) were false alarms in `priority`, (\d+) in `motorway`, (\d+) in `roundabout`"),
        ),
    ),
    Figure(
        "{} scenarios with {} seeds each state what must be found, and reproduce {} conflicts", "sumo_nets", approved
    ),
    Figure(
        "before {} real rear-end crashes, the crash probability tells them from {} crash-free pairs with an AUC of {} "
        "(95 % interval {} to {})",
        RESULTS,
        several(*(row(column, CRASHES) for column in ("crashes", "free", "value", "low", "high"))),
    ),
    Figure(
        "the level `likely` finds {} of them, `serious` {}",
        VALIDATION,
        several(
            pattern(r"nearness: likely or near_certain \| \d+, (\d+), \d+ \|"),
            pattern(r"severity: serious or critical \| \d+, (\d+), \d+ \|"),
        ),
    ),
    Figure(
        "called {} % and {} % of {} severe conflicts at least borderline",
        VALIDATION,
        several(
            pattern(r"\*\*Two readers\*\* call (\d+) and (\d+) %"),
            pattern(r"judged (\d+) of \d+ severe conflicts"),
        ),
    ),
    Figure(
        "in roll-outs of {} conflicts, a mean probability of {} of followers became contacts in a share of {}, "
        "but one of {} of left turns in {}",
        "docs/whatif.md",
        lambda text: (
            *pattern(r"rolled out (\d+) conflicts")(text),
            *pattern(r"\| `following` \| \d+ \| ([\d.]+) \| ([\d.]+) ")(text),
            *pattern(r"\| `left_turn_across` \| \d+ \| ([\d.]+) \| ([\d.]+) ")(text),
        ),
    ),
]


def is_command(figure: Figure) -> bool:
    """Whether the figures come from a command."""
    return figure.source.startswith("closecall ")


def measured(figure: Figure) -> Values:
    """The figures, from their source."""
    path = ROOT / figure.source
    if not is_command(figure):
        return figure.find("" if path.is_dir() else path.read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        command = figure.source.replace(LEFT_TURN, str(ROOT / LEFT_TURN))
        done = subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, text=True, check=True)
    return figure.find(done.stdout)


def sentence(figure: Figure) -> str:
    """The words of the paper with the figures measured now."""
    return figure.sentence.format(*measured(figure))


def kept(figure: Figure) -> str:
    """The words of the paper with the figures of figures.md."""
    rows = [line.strip("| \n").split(" | ") for line in FIGURES.read_text(encoding="utf-8").splitlines()]
    return next(words for words, *source in rows if source == [f"`{figure.source}`"])


def faults(paper: str, sentences: list[str]) -> list[str]:
    """What the text lacks, and its figures that are in none of the sentences."""
    text = " ".join(paper.split("\n---\n", 1)[1].split())
    found = [f"paper.md lacks: {words}" for words in sentences if words not in text]
    for words in sentences:
        text = text.replace(words, "")
    # Names with a digit, and code.
    text = re.sub(r"`[^`]*`|\[@[^\]]*\]|@\w+|TTC2D", "", text)
    by_hand = [text[max(at.start() - 40, 0) : at.end() + 20] for at in re.finditer(r"\d[\d.,]*", text)]
    return [*found, *(f"paper.md has a figure by hand: …{words}…" for words in by_hand)]


def machine() -> str:
    """The processor and the versions."""
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    model = next(
        (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "unknown processor"
    )
    return f"{model}, closecall {metadata.version('closecall')}, SUMO {metadata.version('libsumo')}"


def sentences(only_check: bool) -> list[str]:
    """The words of the paper with their figures; those of commands from figures.md if only checking."""
    return [kept(figure) if only_check and is_command(figure) else sentence(figure) for figure in PAPER_FIGURES]


def main(words: list[str]) -> int:
    """Compare, and write unless only checking."""
    only_check = "--check" in words
    right = sentences(only_check)
    if not only_check:
        rows = [f"| {said} | `{figure.source}` |\n" for figure, said in zip(PAPER_FIGURES, right)]
        FIGURES.write_text(
            "# The figures of the paper\n\n`make paper` writes this file and compares the text with it.\n\n"
            f"On {date.today():%-d %B %Y}: {machine()}.\n\n| words of the paper | from |\n|---|---|\n{''.join(rows)}",
            encoding="utf-8",
        )
    table = FIGURES.read_text(encoding="utf-8")
    found = [f"figures.md lacks: {said}" for said in right if said not in table]
    found += faults(PAPER.read_text(encoding="utf-8"), right)
    print("\n".join(found) or f"paper.md has the figures of {len(right)} sources, and no other")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
