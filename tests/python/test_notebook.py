"""The first tutorial as a notebook: made from its page, run by Jupyter, with the output that the page shows."""

from __future__ import annotations

import doctest
import importlib.util
import json
import sys
from importlib import metadata
from pathlib import Path
from typing import Any

import nbformat
import pytest
from conftest import NETS
from nbclient import NotebookClient
from test_docs import BLOCK, SUMO, commands

ROOT = NETS.parent
PAGE = ROOT / "docs/tutorials/first.md"


def notebook_of(page: str) -> Any:
    """The notebook as the site's build makes it."""
    spec = importlib.util.spec_from_file_location("notebook", ROOT / ".ci/notebook.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return nbformat.from_dict(json.loads(module.notebook(page)))


def test_the_first_tutorial_runs_as_a_notebook(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=":")
    page = PAGE.read_text(encoding="utf-8")
    notebook = notebook_of(page)
    nbformat.validate(notebook)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    blocks = [block for block in BLOCK.finditer(page) if block["language"] == "console" and not block["why"]]
    assert len(cells) == len(blocks) > 3
    for cell in cells:
        cell.source += "\nassert _exit_code == 0"
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    for cell, block in zip(cells, blocks):
        shown = "".join(text for _, text in commands(block["text"]))
        said = "".join(output.text for output in cell.outputs).replace("\r\n", "\n")
        same = doctest.OutputChecker().check_output(shown, said, doctest.ELLIPSIS)
        assert same or not shown or not metadata.version("libsumo").startswith(SUMO), said


def test_a_notebook_has_no_link_that_leads_nowhere() -> None:
    text = "".join(cell.source for cell in notebook_of(PAGE.read_text(encoding="utf-8")).cells)
    assert ".md)" not in text and ".png)" not in text and "not traffic's: SUMO has just" in text
