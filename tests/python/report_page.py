"""A report in a real browser, and made-up logs for it."""

from __future__ import annotations

import csv
import random
from pathlib import Path
from typing import Any

from conftest import Row

ALL = "severity=caution,serious,critical"
"""The address of the view of all conflicts: cautions are left out at first."""
PALETTE = {"caution": (0x46, 0x7D, 0xB5), "serious": (0xD9, 0x5F, 0x02), "critical": (0x9B, 0x08, 0x14)}
"""The severities' colours on a light page."""
SIZES = {"desktop": {"width": 1280, "height": 900}, "phone": {"width": 390, "height": 844}}


class Opened:
    """A report in the browser, with its complaints and network requests."""

    def __init__(
        self, browser: Any, path: Path, size: str = "desktop", scheme: str = "light", view: str = "", lax: bool = False
    ) -> None:
        context = browser.new_context(viewport=SIZES[size], color_scheme=scheme, bypass_csp=lax)
        self.page = context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", lambda dialog: self.complaints.append(dialog.message))
        self.page.on("request", lambda request: self.requests.append(request.url))
        session = context.new_cdp_session(self.page)
        session.send("Performance.enable", {"timeDomain": "threadTicks"})
        self.page.goto(path.as_uri() + (f"#{view}" if view else ""))
        self.page.wait_for_selector("html[data-ready]", state="attached")
        self.milliseconds = int(self.page.evaluate("document.documentElement.dataset.ready"))
        metrics = session.send("Performance.getMetrics")["metrics"]
        # The processor time of the page's main thread until then, in s.
        self.busy = float(next(metric["value"] for metric in metrics if metric["name"] == "ThreadTime"))

    def text(self, selector: str) -> str:
        """The text of an element."""
        return str(self.page.inner_text(selector))

    def labels(self) -> list[str]:
        """The text of each chart, for a reader that does not see it."""
        return [str(chart.get_attribute("aria-label")) for chart in self.page.query_selector_all(".chart")]

    def colours(self, selector: str) -> int:
        """The number of colours on the canvas in an element; 1 where nothing is drawn."""
        script = """(element) => {
            const canvas = element.querySelector("canvas");
            const pixels = new Uint32Array(canvas.getContext("2d")
                .getImageData(0, 0, canvas.width, canvas.height).data.buffer);
            return new Set(pixels).size;
        }"""
        return int(self.page.eval_on_selector(selector, script))


def made_up(folder: Path, count: int, **changes: str) -> Path:
    """A log of random conflicts, without a simulation."""
    chance = random.Random(1)
    names = [
        "id",
        "ego",
        "foe",
        "kind",
        "severity",
        "begin",
        "end",
        "time",
        "gap",
        "mu",
        "margin",
        "clearance",
        "ttc",
        "drac",
        "pet",
        "delta_v",
    ]
    names += ["ego_speed", "foe_speed", "angle", "x", "y", "lane", "collision"]
    for role in ("ego", "foe"):
        names += [f"{role}_{what}" for what in ["x", "y", "heading", "length", "width", "path"]]
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "conflicts.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, names, lineterminator="\n")
        table.writeheader()
        for number in range(count):
            time, x, y = chance.uniform(0, 3600), chance.uniform(0, 5000), chance.uniform(0, 3000)
            mu = chance.uniform(5, 50)
            gap = chance.uniform(0, mu)
            row: dict[str, Any] = {name: f"{chance.uniform(0, 10):.6f}" for name in names}
            row |= {"id": number + 1, "ego": f"vehicle_{number % 20000}", "foe": f"vehicle_{number % 19997}"}
            row |= {"kind": chance.choice(["rear_end", "rear_end", "frontal", "side"]), "collision": "false"}
            row |= {"severity": chance.choices(["caution", "serious", "critical"], [80, 18, 2])[0]}
            row |= {"begin": f"{time:.2f}", "time": f"{time + 1:.2f}", "end": f"{time + 2:.2f}"}
            row |= {
                "gap": f"{gap:.6f}",
                "mu": f"{mu:.6f}",
                "margin": f"{gap - mu:.6f}",
                "x": f"{x:.6f}",
                "y": f"{y:.6f}",
            }
            row |= {
                "lane": f"edge{number % 500}_0",
                "ego_x": f"{x - 9:.6f}",
                "ego_y": f"{y:.6f}",
                "ego_path": f"{x + 9:.2f} {y:.2f}",
            }
            row |= {"foe_x": f"{x + 9:.6f}", "foe_y": f"{y:.6f}", "foe_path": ""}
            table.writerow(row | changes)
    return folder


def severe(found: list[Row]) -> list[Row]:
    """The conflicts that the page shows at first."""
    return [row for row in found if row["severity"] != "caution"]
