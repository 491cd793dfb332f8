"""What the wheel ships besides code."""

from __future__ import annotations

import json
from importlib import metadata
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_the_wheel_lists_its_crates_in_a_bill_of_materials() -> None:
    [bill] = [file for file in metadata.files("closecall") or [] if file.name.endswith(".cyclonedx.json")]
    parts = {part["name"] for part in json.loads(Path(bill.locate()).read_text(encoding="utf-8"))["components"]}
    assert {"closecall", "parry2d-f64", "parquet", "pyo3"} <= parts


def test_the_wheel_ships_the_licences_of_what_it_embeds() -> None:
    shipped = [file for file in metadata.files("closecall") or [] if file.name == "THIRD-PARTY.txt"]
    assert len(shipped) == 1
    text = shipped[0].read_text(encoding="utf-8")
    assert text == (ROOT / "THIRD-PARTY.txt").read_text(encoding="utf-8")
    for work in ("Apache ECharts", "ZRender", "d3", "DejaVu Sans", "Rust's standard library", "parquet", "numpy"):
        assert f"\n{work} " in text or f"\n{work}," in text, work
