"""A page of the docs as a Jupyter notebook: `python .ci/notebook.py docs/tutorials/first.md first.ipynb`.

The page is the only source: the site's build (`pages.py`) makes the notebook, tests/python/test_notebook.py runs it.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

# Commands with what they print, or a script; not those with a comment above that says why they are not run.
BLOCK = re.compile(r"(<!-- not run: [^\n]+ -->\n)?^```(console|python)\n(.*?)^```\n", re.MULTILINE | re.DOTALL)
# A picture, or a link to another page: a notebook has neither beside it.
PICTURE = re.compile(r"^!\[[^\]]*\]\((?![a-z]+:)[^)]*\)\n", re.MULTILINE)
LINK = re.compile(r"\[([^\]]*)\]\((?![a-z]+:)[^)]*\)")


def notebook(page: str) -> str:
    """The notebook of a page, without outputs."""
    cells, text, end = [], "", 0
    for block in BLOCK.finditer(page):
        text += page[end : block.start()]
        end = block.end()
        if block[1]:
            text += block[0].removeprefix(block[1])
            continue
        cells += [*markdown(text), cell("code", code(block[2], block[3]))]
        text = ""
    cells += markdown(text + page[end:])
    for number, one in enumerate(cells):
        one["id"] = f"cell-{number}"
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    whole = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, ensure_ascii=False, indent=1) + "\n"


def code(language: str, text: str) -> str:
    """A block as Python: a command behind `$ ` becomes IPython's `!`, and its output is left out."""
    if language == "python":
        return text.strip()
    return "\n".join(f"!{line[2:]}" for line in text.splitlines() if line.startswith("$ "))


def markdown(text: str) -> list[dict[str, Any]]:
    text = LINK.sub(r"\1", PICTURE.sub("", text)).strip()
    return [cell("markdown", text)] if text else []


def cell(kind: str, source: str) -> dict[str, Any]:
    more = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "metadata": {}, "source": source, **more}


if __name__ == "__main__":
    Path(sys.argv[2]).write_text(notebook(Path(sys.argv[1]).read_text(encoding="utf-8")), encoding="utf-8")
