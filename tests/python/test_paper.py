"""The paper has the figures of the repository's results, and what the Journal of Open Source Software asks for."""

from __future__ import annotations

import re
import subprocess
import sys

from conftest import NETS

FOLDER = NETS.parent / "docs/paper"
PAPER = (FOLDER / "paper.md").read_text(encoding="utf-8")
BODY = PAPER.split("\n---\n", 1)[1]

SECTIONS = [
    "Summary",
    "Statement of need",
    "State of the field",
    "Software design",
    "Research impact statement",
    "AI usage disclosure",
    "Acknowledgements",
    "References",
]
"""https://joss.readthedocs.io/en/latest/paper.html"""


def test_the_paper_has_the_figures_of_the_results() -> None:
    command = [sys.executable, str(FOLDER / "figures.py"), "--check"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_another_figure_anywhere_in_the_paper_is_found() -> None:
    sys.path.insert(0, str(FOLDER))
    import figures

    right = figures.sentences(only_check=True)
    assert not figures.faults(PAPER, right)
    outside_names = re.sub(r"`[^`]*`|\[@[^\]]*\]|@\w+|TTC2D", lambda name: "x" * len(name[0]), BODY)
    digits = [digit.start() for digit in re.finditer(r"\d", outside_names)]
    assert len(digits) > 50
    start = len(PAPER) - len(BODY)
    for at in digits:
        other = str((int(BODY[at]) + 1) % 10)
        assert figures.faults(PAPER[: start + at] + other + PAPER[start + at + 1 :], right), BODY[at - 30 : at + 30]
    assert figures.faults(PAPER.replace("# Limits\n", "# Limits\n\nSome 12 things.\n"), right)


def test_the_paper_has_the_journals_sections_and_length() -> None:
    assert set(SECTIONS) <= set(re.findall(r"^# (.+)$", BODY, re.MULTILINE))
    assert 750 <= len(BODY.split()) <= 1750


def test_each_citation_of_the_paper_has_an_entry() -> None:
    entries = set(re.findall(r"^@\w+\{(\w+),", (FOLDER / "paper.bib").read_text(encoding="utf-8"), re.MULTILINE))
    assert entries == set(re.findall(r"@(\w+)", BODY))
