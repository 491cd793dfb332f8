"""The site's gallery: clips and reports of the scenarios in sumo_nets/, made by the installed closecall in seconds.

`pages.py` calls it in each build; it makes them again after closecall has been installed again.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from closecall import _closecall

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "target/gallery"
PAGE = "gallery.md"

# A clip of the worst conflict of a scenario each, and what is seen.
CLIPS = {
    "overtaking": "A hurried driver overtakes; the oncoming one is closer than it thought.",
    "crowd": "A person walks over a crossing, and the car that has to wait does not.",
    "reckless": "A car turns left across the path of another that comes towards it.",
    "priority": "A car comes out of a side road before another on the main road.",
    "roundabout": "A car enters a roundabout close to one that is in it.",
    "left_turn": "A car turns left through a gap that is too small.",
}
# A report each: its file, its title, and the words of `closecall report`.
REPORTS = {
    "town.html": ("A town of 117 junctions", ["town"]),
    "town_summary.html": ("The same on one page, to print", ["town", "--summary"]),
    "crowd.html": ("Many persons cross a street", ["crowd"]),
    "change.html": (
        "A junction before and after its left turns have a phase of their own",
        ["protected", "--against", "left_turn"],
    ),
}
RUNS = {name: f"sumo_nets/{name}/{name}.sumocfg" for name in [*CLIPS, "town"]}
RUNS["protected"] = "sumo_nets/left_turn/protected.sumocfg"
END = "250"


def closecall(*words: str) -> None:
    """Run a command; the pages name folders as they are seen from the repository's root."""
    subprocess.run([sys.executable, "-m", "closecall", *words], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)


def make() -> None:
    """Fill the folder, if it does not have what this closecall writes."""
    page = FOLDER / PAGE
    made_of = max(Path(path).stat().st_mtime for path in (__file__, _closecall.__file__))
    if page.exists() and page.stat().st_mtime > made_of:
        return
    folder = FOLDER.relative_to(ROOT).as_posix()
    for name, scenario in RUNS.items():
        options = ["--end", END, "--log-clips", "caution", "--force", "--quiet", "--out", f"{folder}/logs/{name}"]
        closecall("run", scenario, *options, "--", "--no-warnings")
    for name in CLIPS:
        closecall("clip", f"{folder}/logs/{name}", "--worst", "1", "--out", f"{folder}/{name}.svg")
    for file, (_, words) in REPORTS.items():
        logs = [word if word.startswith("-") else f"{folder}/logs/{word}" for word in words]
        closecall("report", *logs, "--out", f"{folder}/{file}")
    page.write_text(text(), encoding="utf-8")


def text() -> str:
    """The page with links to all of it."""
    clips = "".join(f"\n![{seen}](gallery/{name}.svg)\n\n{seen}\n" for name, seen in CLIPS.items())
    reports = "".join(f"- [{title}](gallery/{file})\n" for file, (title, _) in REPORTS.items())
    made = "All of this is made by the build of this site, from the scenarios in the folder `sumo_nets`."
    how = "[`closecall clip`](watch.md) draws the clips, [`closecall report`](report.md) writes the reports."
    return f"# Gallery\n\n{made} {how}\n\n## Reports\n\n{reports}\n## Clips\n{clips}"


def files() -> list[Path]:
    """What the page links to."""
    return [FOLDER / f"{name}.svg" for name in CLIPS] + [FOLDER / file for file in REPORTS]
