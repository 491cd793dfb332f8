"""The tables of docs/validation.md, made of the results."""

from __future__ import annotations

import sys
from pathlib import Path

Result = dict[str, str]

MARKS = ("<!-- make validation: begin {} -->\n", "<!-- make validation: end {} -->")
LEADS = ("0", "0.5", "1")
SETTINGS = {
    ("driven", "no"): "driven",
    ("driven", "yes"): "smoothed",
    ("arc", "no"): "arc",
    ("arc", "yes"): "arc, smoothed",
}


def interval(row: Result) -> str:
    """A value with its interval."""
    return f"{float(row['value']):.3f} [{float(row['low']):.2f}, {float(row['high']):.2f}]"


def table(header: list[str], lines: list[list[str]]) -> str:
    """A table in Markdown."""
    rows = [header, ["---"] * len(header), *lines]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


class Results:
    """Rows by what they are of."""

    def __init__(self, rows: list[Result], recordings: str) -> None:
        self.rows = {
            (row["path"], row["smooth"], row["name"], row["kind"], row.get("lead", "")): row
            for row in rows
            if row["recordings"] == recordings
        }

    def names(self, path: str, kind: str) -> list[str]:
        """The names that there are rows of, in their order."""
        return list(dict.fromkeys(key[2] for key in self.rows if key[0] == path and key[3] == kind))

    def row(self, path: str, smooth: str, name: str, kind: str, lead: str = "") -> Result | None:
        """One row."""
        return self.rows.get((path, smooth, name, kind, lead))


def measures(results: Results) -> str:
    """AUC by lead, and AUPRC half a second ahead, along the paths driven."""
    lines = []
    for path, mark in (("driven", "`{}`"), ("SSMsOnPlane", "{}, SSMsOnPlane")):
        for name in results.names(path, "AUC"):
            cells = [results.row(path, "no", name, "AUC", lead) for lead in LEADS]
            cells.append(results.row(path, "no", name, "AUPRC", "0.5"))
            lines.append([mark.format(name), *(interval(cell) if cell else "–" for cell in cells)])
    return table(["", "AUC, 0 s", "AUC, 0.5 s", "AUC, 1 s", "AUPRC, 0.5 s"], lines)


def settings(results: Results) -> str:
    """AUC and AUPRC half a second ahead, by path and smoothing."""
    lines = []
    for name in results.names("driven", "AUC"):
        cells = []
        for path, smooth in SETTINGS:
            both = [results.row(path, smooth, name, kind, "0.5") for kind in ("AUC", "AUPRC")]
            cells.append(" / ".join(f"{float(row['value']):.3f}" if row else "–" for row in both))
        lines.append([f"`{name}`", *cells])
    return table(["AUC / AUPRC, 0.5 s", *SETTINGS.values()], lines)


def rules(results: Results, hours: bool = True) -> str:
    """What each rule finds, how early, and how often it is wrong."""
    lines = []
    for path, smooth in SETTINGS:
        for name in results.names(path, "found"):
            found = [results.row(path, smooth, name, "found", lead) for lead in LEADS]
            early, false = (results.row(path, smooth, name, kind) for kind in ("lead time", "false alarms"))
            if not all(found) or not false:
                continue
            of = ", ".join(row["value"] for row in found if row)
            ahead = f"{early['value']} ({early['low']} to {early['high']})" if early else "–"
            rate = float(false["value"]) / float(false["hours"])
            lines.append([name, SETTINGS[path, smooth], of, ahead, f"{rate:.1f} ({false['value']})"])
    header = ["rule", "paths", "found at 0, 0.5, 1 s", "lead time in s", "false pairs per vehicle-hour (pairs)"]
    return table(header, lines)


def write_tables(page: Path, rows: list[Result]) -> None:
    """Put the tables between the marks of the page."""
    text = page.read_text()
    labels = list(dict.fromkeys(row["recordings"] for row in rows))
    for label in labels:
        results = Results(rows, label)
        prefix = "" if label == "kept" else f"{label}: "
        for name, content in (("measures", measures), ("settings", settings), ("rules", rules)):
            begin, end = (mark.format(prefix + name) for mark in MARKS)
            if begin not in text:
                if not prefix:
                    sys.exit(f'{page}: it lacks "{begin.strip()}"')
                continue
            before, _, rest = text.partition(begin)
            _, closing, after = rest.partition(end)
            if not closing:
                sys.exit(f'{page}: "{end}" is missing after "{begin.strip()}"')
            text = before + begin + content(results) + end + after
    page.write_text(text)
