"""The commands and scripts of the README and the tutorials run as printed, and give the output that the pages show.

A block ```console has commands behind `$ ` and what each prints, `...` for what is left out. A block with a title
becomes the file of that name. A block that cannot run has a comment above it, `<!-- not run: why -->`.
"""

from __future__ import annotations

import doctest
import os
import re
import runpy
import shutil
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest
from conftest import NETS, TIMEOUT, Once

ROOT = NETS.parent
PAGES = [
    str(page.relative_to(ROOT))
    for page in [ROOT / "README.md", *sorted(ROOT.glob("docs/*.md")), *sorted(ROOT.glob("docs/tutorials/*.md"))]
]

SUMO = "1.28"
"""The version whose output the pages show; another one makes other traffic."""

BLOCK = re.compile(
    r"^(?:<!-- not run: (?P<why>[^\n]+) -->\n)?"
    r'^```(?P<language>\w+)(?: title="(?P<title>[^"\n]+)")?\n(?P<text>.*?)^```$',
    re.MULTILINE | re.DOTALL,
)

CONFIG = """<configuration>
    <input><net-file value="town.net.xml"/><route-files value="town.rou.xml"/></input>
    <time><end value="60"/><step-length value="0.2"/></time>
</configuration>
"""


def prepare(folder: Path) -> None:
    """What a reader has: the repository's scenarios; its own, with a recording, logs and a net to be tested."""
    for name in ("left_turn", "side", "town"):
        shutil.copytree(
            NETS / name, folder / "sumo_nets" / name, ignore=shutil.ignore_patterns("expected", "closecall-out")
        )
    shutil.copytree(ROOT / "examples", folder / "examples")
    for kind in ("net", "rou"):
        shutil.copy(NETS / f"left_turn/left_turn.{kind}.xml", folder / f"town.{kind}.xml")
    for name in ("town", "before", "after"):
        (folder / f"{name}.sumocfg").write_text(CONFIG, encoding="utf-8")
    run("sumo -c town.sumocfg --no-step-log --fcd-output town.fcd.xml.gz", folder)
    run("closecall run town.sumocfg --quiet", folder)
    for log in ("run1", "run2", "runs/before/1", "runs/after/1"):
        shutil.copytree(folder / "closecall-out", folder / log)
    shutil.copytree(folder / "sumo_nets/left_turn", folder / "nets/left_turn")
    (folder / "nets/left_turn/closecall.toml").write_text("end = 30\n[regress]\nseeds = [1]\n", encoding="utf-8")


def run(command: str, folder: Path) -> str:
    """What a command of the shell prints; the test fails with all of it if the command does."""
    own = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        env={**own, "PATH": path},
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def commands(text: str) -> list[tuple[str, str]]:
    """The commands of a block, each with the output that the page shows; none where it shows none."""
    parts = re.split(r"^\$ ", text, flags=re.MULTILINE)
    assert not parts[0], f"output before the first command: {text}"
    return [(command, shown) for command, _, shown in (part.partition("\n") for part in parts[1:])]


@pytest.mark.parametrize("page", PAGES)
def test_a_page_does_what_it_says(page: str, once: Once, tmp_path: Path) -> None:
    folder = tmp_path / "reader"
    shutil.copytree(once("reader", prepare), folder)
    has_output = metadata.version("libsumo").startswith(SUMO)
    for block in BLOCK.finditer((ROOT / page).read_text(encoding="utf-8")):
        if block["why"]:
            continue
        if block["title"]:
            (folder / block["title"]).parent.mkdir(parents=True, exist_ok=True)
            (folder / block["title"]).write_text(block["text"], encoding="utf-8")
        elif block["language"] == "python":
            (folder / "script.py").write_text(block["text"], encoding="utf-8")
            run("python script.py", folder)
        elif block["language"] == "console":
            for command, shown in commands(block["text"]):
                said = run(command, folder)
                same = doctest.OutputChecker().check_output(shown, said, doctest.ELLIPSIS)
                assert same or not shown or not has_output, f"{page}: {command} printed\n{said}"


def test_a_release_has_no_placeholder_and_no_relative_link(tmp_path: Path) -> None:
    address = runpy.run_path(str(ROOT / ".ci/address.py"))
    files = [tmp_path / name for name in address["FILES"]]
    for file in files:
        file.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / file.relative_to(tmp_path), file)
        lines = file.read_text(encoding="utf-8").splitlines()
        assert not [line for line in lines if "OWNER" in line and not line.startswith("# released: ")]
    command = [sys.executable, str(ROOT / ".ci/address.py"), "somebody/near-misses", "v0.1.0"]
    subprocess.run(command, cwd=tmp_path, check=True)
    for file in files:
        text = file.read_text(encoding="utf-8")
        assert "OWNER/" not in text and "# released" not in text
    assert "github.com/somebody/near-misses" in (tmp_path / "pyproject.toml").read_text(encoding="utf-8")
    assert not re.search(r"\]\((?!https?://)", (tmp_path / "README.md").read_text(encoding="utf-8"))


@pytest.mark.parametrize("page", PAGES)
def test_each_block_of_code_has_a_kind(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    assert len(BLOCK.findall(text)) * 2 == len(re.findall(r"^ *```", text, re.MULTILINE))
    assert not re.search(r"^ {4}\$? ?(closecall|make|pip) ", text, re.MULTILINE), "a command outside a block"


def test_what_a_release_publishes_names_one_version() -> None:
    found = {
        name: re.search(r'^ *version(?: =|:) "?(\d+\.\d+\.\d+)"?$', (ROOT / name).read_text("utf-8"), re.MULTILINE)
        for name in ("Cargo.toml", "CITATION.cff", ".ci/recipe.yaml")
    }
    assert len({version and version[1] for version in found.values()}) == 1, found
