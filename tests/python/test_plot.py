"""The charts of `closecall plot`."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import closecall
from report_page import made_up


@pytest.mark.parametrize("form", ["png", "svg"])
def test_plot_draws_every_chart_reproducibly(town: Path, tmp_path: Path, form: str) -> None:
    for out in ("first", "second"):
        done = closecall("plot", town / "log", "-o", tmp_path / out, "--format", form)
        assert done.returncode == 0, done.stderr
    names = ["delta_v", "drac", "map", "margin", "pet", "time", "ttc"]
    assert sorted(path.name for path in (tmp_path / "first").iterdir()) == [f"{name}.{form}" for name in names]
    for name in names:
        first, second = ((tmp_path / out / f"{name}.{form}").read_bytes() for out in ("first", "second"))
        assert first == second
        assert first.startswith(b"\x89PNG" if form == "png" else b"<svg")
        assert len(first) > 5_000


def test_plot_names_what_it_cannot_write(tmp_path: Path) -> None:
    done = closecall("plot", made_up(tmp_path / "log", 2), "-o", "/proc/plots")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "/proc/plots: " in done.stderr


@pytest.mark.parametrize("form", ["png", "svg"])
def test_plot_reports_a_full_disk(form: str, tmp_path: Path) -> None:
    (tmp_path / f"map.{form}").symlink_to("/dev/full")
    done = closecall("plot", made_up(tmp_path / "log", 2), "-o", tmp_path, "--format", form)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert f"map.{form}: " in done.stderr and "No space left" in done.stderr


def test_a_picture_for_a_paper_is_as_wide_as_a_column(town: Path, tmp_path: Path) -> None:
    words = ("plot", town / "log", "-o", tmp_path, "--style", "paper")
    assert closecall(*words).returncode == 0
    text = (tmp_path / "ttc.svg").read_text(encoding="utf-8")
    assert text.startswith('<svg width="85mm"')
    assert "Time to collision" in text and "#D95F02" in text
    # 8 pt in pixels of which four are one of CSS's.
    sizes = {float(size) for size in re.findall(r'font-size="([0-9.]+)"', text)}
    assert list(sizes) == [pytest.approx(8 / 72 * 96 * 4, rel=0.01)]
    refused = closecall(*words, "--format", "png")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "--style paper is for --format svg" in refused.stderr


def test_plot_draws_what_passes_the_filter(town: Path, tmp_path: Path) -> None:
    for name, words in (("all", ()), ("critical", ("--severity", "critical"))):
        assert closecall("plot", town / "log", "-o", tmp_path / name, *words).returncode == 0
    texts = {name: (tmp_path / name / "time.svg").read_text(encoding="utf-8") for name in ("all", "critical")}
    bars = {name: text.count('fill="#467DB5"') for name, text in texts.items()}
    assert bars["critical"] == 1 < bars["all"], "the legend's patch is left"
