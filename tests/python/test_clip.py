"""`closecall clip` in a real browser and as a film: the picture moves, and shows the conflict while it lasts."""

from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path
from typing import Any, Callable

import av
import numpy as np
import pytest
from conftest import closecall, is_one_message
from numpy.typing import NDArray
from PIL import Image

Copy = Callable[[str], Path]

SEVERITIES = [(0x6F, 0xA8, 0xDC), (0xFF, 0xAB, 0x40), (0xFF, 0x5C, 0x6C)]
SIZE = {"width": 960, "height": 600}
PANEL = 84
"""The height of what is below the roads, the legend included."""
LOOP = 8
"""About the length of the loop, in s."""


def drawn(config: Path, folder: Path, name: str = "clip.svg", *more: str) -> Path:
    """The picture of the worst conflict of a scenario."""
    log, picture = folder / "log", folder / name
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


STILLS = [
    f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 64 40"><rect width="64" height="40" fill="#dfe5d8"/>'
    f'<rect x="{x}" width="16" height="40" fill="#ff5c6c"/></svg>'
    for x in (0, 0, 16, 32)
]
"""A bar that stands for two pictures, then moves to the right."""


@pytest.mark.parametrize("file_format", ["webp", "mp4"])
def test_readers_see_every_picture_of_a_film(file_format: str) -> None:
    from closecall._film import film

    file = io.BytesIO(film(STILLS, 20, file_format, b""))
    if file_format == "webp":
        animated: Any = Image.open(file)
        shown = []
        for place in range(animated.n_frames):
            animated.seek(place)
            shown.append((np.asarray(animated.convert("RGB")).astype(int), animated.info["duration"]))
        assert [time for _, time in shown] == [100, 50, 50], "equal ones are one"
        pictures = [picture for picture, time in shown for _ in range(time // 50)]
    else:
        with av.open(file, "r") as reader:
            assert reader.streams.video[0].average_rate == 20
            pictures = [frame.to_ndarray(format="rgb24").astype(int) for frame in reader.decode(video=0)]
    assert len(pictures) == len(STILLS)
    for picture, x in zip(pictures, (0, 0, 16, 32)):
        bar = np.abs(picture[20] - SEVERITIES[2]).max(-1) < 30
        assert bar[x + 2 : x + 14].all() and not bar[: max(x - 2, 0)].any() and not bar[x + 18 :].any()
        assert np.abs(picture[20, 60] - (0xDF, 0xE5, 0xD8)).max() < 6, "colours are those of the picture"


def test_a_film_is_that_of_the_conflict(scenario: Copy, tmp_path: Path) -> None:
    # Logged from the first step on: a film of three steps and two halts.
    words = ("--end", "0.3", "--log", "gap < 1000")
    with av.open(str(drawn(scenario("rear_end"), tmp_path, "clip.mp4", *words)), "r") as reader:
        frames = list(reader.decode(video=0))
    assert len(frames) == (0.2 + 1 + 1) * 20
    for frame in frames[:: len(frames) - 1]:
        picture = frame.to_ndarray(format="rgb24").astype(int)
        assert picture.shape == (SIZE["height"], SIZE["width"], 3)
        # What the picture shows is tested above; colours of a film differ by a little.
        assert (np.abs(picture - SEVERITIES[0]).max(-1) < 30).sum() > 300


def test_without_its_packages_a_film_is_refused_in_one_line(scenario: Copy, tmp_path: Path) -> None:
    script = "import sys; sys.modules['av'] = None; from closecall.__main__ import main; sys.exit(main())"
    log = drawn(scenario("rear_end"), tmp_path).parent / "log"
    words = [sys.executable, "-c", script, "clip", str(log), "--worst", "1", "-o", str(tmp_path / "a.mp4")]
    refused = subprocess.run(words, capture_output=True, text=True)
    assert refused.returncode == 2 and is_one_message(refused.stderr)
    assert "pip install 'closecall[video]'" in refused.stderr
    refused = closecall("clip", log, "--worst", "1", "-o", tmp_path / "a.gif")
    assert refused.returncode == 2 and ".webp or an .mp4" in refused.stderr
