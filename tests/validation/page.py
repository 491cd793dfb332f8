"""The tables of docs/validation.md, made of the results."""

from __future__ import annotations

import sys
from pathlib import Path

Result = dict[str, str]

MARKS = ("<!-- make validation: begin {} -->\n", "<!-- make validation: end {} -->")
LEADS = ("0", "0.5", "1")
# Paths, and whether smoothed.
SETTINGS = {
    ("driven", "no"): "driven",
    ("driven", "yes"): "driven, smoothed",
    ("arc", "no"): "arc",
    ("arc", "yes"): "arc, smoothed",
}
# The sets of recordings, as results.csv names them.
NGSIM, BOTH = "kept", "with INTERACTION"


def interval(row: Result | None) -> str:
    """A value with its interval."""
    if row is None:
        return "–"
    value, low, high = (float(row[part]) for part in ("value", "low", "high"))
    return f"{value:.3f} [{low:.2f}–{high:.2f}]"


def table(header: list[str], lines: list[list[str]]) -> str:
    """A table in Markdown."""
    rows = [header, ["---"] * len(header), *lines]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


class Results:
    """Rows by what they are of."""

    def __init__(self, rows: list[Result]) -> None:
        parts = ("recordings", "path", "smooth", "name", "kind", "lead")
        self.rows = {tuple(row.get(part, "") for part in parts): row for row in rows}

    def names(self, path: str, kind: str) -> list[str]:
        """The names that there are rows of, in their order."""
        return list(dict.fromkeys(key[3] for key in self.rows if key[:2] == (NGSIM, path) and key[4] == kind))

    def row(self, of: tuple[str, str, str], name: str, kind: str, lead: str = "") -> Result | None:
        """One row, of recordings, path and smoothing."""
        return self.rows.get((*of, name, kind, lead))


def measures(results: Results) -> str:
    """AUC by lead, and AUPRC half a second ahead, along the paths driven."""
    lines = []
    for path, mark in (("driven", "`{}`"), ("SSMsOnPlane", "{}, SSMsOnPlane")):
        for name in results.names(path, "AUC"):
            kept = [results.row((NGSIM, path, "no"), name, "AUC", lead) for lead in LEADS]
            kept.append(results.row((NGSIM, path, "no"), name, "AUPRC", "0.5"))
            more = [results.row((BOTH, path, "no"), name, kind, "0.5") for kind in ("AUC", "AUPRC")]
            lines.append([mark.format(name), *map(interval, kept + more)])
    header = ["AUC, 0 s", "AUC, 0.5 s", "AUC, 1 s", "AUPRC, 0.5 s"]
    return table(["NGSIM", *header, f"{BOTH}: AUC, 0.5 s", "AUPRC, 0.5 s"], lines)


def settings(results: Results) -> str:
    """AUC and AUPRC half a second ahead, by path and smoothing."""
    lines = []
    for name in results.names("driven", "AUC"):
        cells = []
        for setting in SETTINGS:
            both = [results.row((NGSIM, *setting), name, kind, "0.5") for kind in ("AUC", "AUPRC")]
            cells.append("/".join(f"{float(row['value']):.2f}" if row else "–" for row in both))
        lines.append([f"`{name}`", *cells])
    return table(["AUC/AUPRC, 0.5 s", *SETTINGS.values()], lines)


def rate(row: Result | None) -> str:
    """False alarms per vehicle-hour."""
    return f"{float(row['value']) / float(row['hours']):.1f}" if row else "–"


def rules(results: Results) -> str:
    """What each rule finds, how early, and how often it is wrong."""
    lines = []
    for name in results.names("driven", "found"):
        found = [results.row((NGSIM, "driven", "no"), name, "found", lead) for lead in LEADS]
        early = results.row((NGSIM, "driven", "no"), name, "lead time")
        ahead = f"{early['value']} ({early['low']}–{early['high']})" if early else "–"
        half = [results.row((NGSIM, *setting), name, "found", "0.5") for setting in SETTINGS]
        cells = [", ".join(row["value"] for row in found if row), ahead]
        cells.append("/".join(row["value"] if row else "–" for row in half))
        for recordings in (NGSIM, BOTH):
            false = [results.row((recordings, *setting), name, "false alarms") for setting in SETTINGS]
            cells.append("/".join(map(rate, false)))
        lines.append([name, *cells])
    header = ["rule", "found at 0, 0.5, 1 s", "lead time, s", "found at 0.5 s, four ways"]
    return table([*header, "false per vehicle-hour, NGSIM", BOTH], lines)


TABLES = {"measures": measures, "settings": settings, "rules": rules}


def write_tables(page: Path, rows: list[Result]) -> None:
    """Put the tables between the marks of the page."""
    text = page.read_text()
    results = Results(rows)
    for name, content in TABLES.items():
        begin, end = (mark.format(name) for mark in MARKS)
        before, opening, rest = text.partition(begin)
        _, closing, after = rest.partition(end)
        if not opening or not closing:
            sys.exit(f'{page}: it lacks "{(end if opening else begin).strip()}"')
        text = before + begin + content(results) + end + after
    page.write_text(text)
