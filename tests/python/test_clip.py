"""`closecall clip` in a real browser: the picture moves without a script, and shows the conflict while it lasts."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
from conftest import closecall
from numpy.typing import NDArray
from PIL import Image

Copy = Callable[[str], Path]

SEVERITIES = [(0x6F, 0xA8, 0xDC), (0xFF, 0xAB, 0x40), (0xFF, 0x5C, 0x6C)]
SIZE = {"width": 960, "height": 600}
PANEL = 84
"""The height of what is below the roads, the legend included."""
LOOP = 8
"""About the length of the loop, in s."""


def drawn(config: Path, folder: Path, *more: str) -> Path:
    """The picture of the worst conflict of a scenario."""
    log, picture = folder / "log", folder / "clip.svg"
    done = closecall("run", config, "--quiet", "--out", log, "--log-clips", "caution", *more)
    assert done.returncode == 0, done.stderr
    done = closecall("clip", log, "--worst", "1", "-o", picture)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("conflict ") and str(picture) in done.stdout
    return picture


def coloured(pixels: NDArray[np.int_]) -> int:
    """The number of pixels of the roads that have a severity's colour."""
    roads = pixels[: SIZE["height"] - PANEL]
    return sum(int((np.abs(roads - colour).max(-1) < 12).sum()) for colour in SEVERITIES)


@pytest.mark.parametrize("kind", ["rear_end", "side"])
def test_the_conflict_is_coloured_while_it_lasts(kind: str, browser: Any, scenario: Copy, tmp_path: Path) -> None:
    picture = drawn(scenario(kind), tmp_path)
    page = browser.new_page(viewport=SIZE)
    complaints: list[str] = []
    requests: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(picture.as_uri())

    def pixels(time: float) -> NDArray[np.int_]:
        move = "time => { document.documentElement.pauseAnimations(); document.documentElement.setCurrentTime(time); }"
        page.evaluate(move, time)
        return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(int)

    begin = pixels(0.0)
    worst = max((pixels(time) for time in range(1, LOOP)), key=coloured)
    assert coloured(begin) < 20
    assert coloured(worst) > 600
    assert (np.abs(begin - worst).max(-1) > 40).sum() > 1000
    assert complaints == []
    assert requests == [picture.as_uri()]


def test_the_picture_plays_as_an_image_of_a_page(browser: Any, scenario: Copy, tmp_path: Path) -> None:
    # As in a README: there no script runs, and nothing is fetched.
    picture = drawn(scenario("rear_end"), tmp_path)
    page = browser.new_page(viewport=SIZE)
    (tmp_path / "page.html").write_text(f'<body style="margin:0"><img src="{picture.name}" width="960"></body>')
    page.goto((tmp_path / "page.html").as_uri())
    first = page.screenshot()
    page.wait_for_timeout(600)
    assert page.screenshot() != first
