"""Takes docs/pictures/report_*.png: the report of 200 s of the town, in real Chromium.

    .venv/bin/python docs/pictures/report.py

It needs the packages of tests/requirements.txt and `chromium`.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright import sync_api

HERE = Path(__file__).parent
# Sizes of the window, in the page's pixels; a picture has SCALE of them.
SHOTS = {"desktop": (1100, 1560, "light"), "phone": (390, 2080, "dark")}
SCALE = 0.75


def main() -> None:
    with tempfile.TemporaryDirectory() as name, sync_api.sync_playwright() as driver:
        page = Path(name, "report.html")
        run = ["run", "sumo_nets/town/town.sumocfg", "--end", "200", "--quiet", "--out", f"{name}/log"]
        for words in ([*run, "--", "--no-warnings"], ["report", f"{name}/log", "--out", str(page), "--quiet"]):
            subprocess.run([sys.executable, "-m", "closecall", *words], cwd=HERE.parents[1], check=True)
        # Chromium refuses to run as root with its sandbox.
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for shot, (width, height, scheme) in SHOTS.items():
            viewport = {"width": width, "height": height}
            context = browser.new_context(viewport=viewport, device_scale_factor=SCALE, color_scheme=scheme)
            opened = context.new_page()
            opened.goto(page.as_uri())
            opened.wait_for_selector("html[data-ready]", state="attached")
            opened.wait_for_timeout(2000)
            picture = HERE / f"report_{shot}.png"
            opened.screenshot(path=picture)
            # A palette that keeps rare colours: a third of the bytes.
            few = (
                Image.open(picture).convert("RGB").quantize(method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
            )
            few.save(picture, optimize=True)
        browser.close()


if __name__ == "__main__":
    main()
