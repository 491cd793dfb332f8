"""Writes THIRD-PARTY.txt: the licences of everything that the wheel embeds, each text once; with --check, compares it.

These are the crates of the Python module, on every platform, and what closecall's own sources embed. Of a crate that is
"MIT OR Apache-2.0" the text of MIT is enough. A crate that ships no text gets that of the Apache License if it may be
used under it.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
OUT = ROOT / "THIRD-PARTY.txt"
APACHE = ROOT / "LICENSE"
NAMES = ("license", "licence", "copying", "notice", "unlicense", "copyright")

EMBEDDED = {
    "Apache ECharts 6.1.0 (Apache-2.0)": ["crates/analysis/src/report/vendor/NOTICE-echarts", "crates/analysis/src/report/vendor/LICENSE-echarts"],
    "ZRender 6.1.0, in Apache ECharts (BSD-3-Clause)": ["crates/analysis/src/report/vendor/LICENSE-zrender"],
    "d3, in Apache ECharts (BSD-3-Clause)": ["crates/analysis/src/report/vendor/LICENSE-d3"],
    "DejaVu Sans (Bitstream Vera, Arev)": ["crates/run/src/output/font/LICENSE-dejavu"],
}
"""What is embedded besides crates, each with its files."""

STANDARD_LIBRARY = "Rust's standard library, The Rust Project contributors (MIT OR Apache-2.0)"


def cargo(*words: str) -> str:
    """What cargo prints."""
    return subprocess.run(["cargo", *words], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout


def crates() -> dict[str, list[Path]]:
    """The crates of others in the module, each with the files of its licence."""
    known = {
        (one["name"], one["version"]): one for one in json.loads(cargo("metadata", "--format-version", "1"))["packages"]
    }
    tree = (
        "tree",
        "--package",
        "closecall-bridge",
        "--edges",
        "normal,no-proc-macro",
        "--target",
        "all",
        "--prefix",
        "none",
    )
    found = {}
    for name, version, *_ in sorted({tuple(line.split()[:2]) for line in cargo(*tree).splitlines()}):
        crate = known[name, version.removeprefix("v")]
        if crate["source"]:
            licence = crate["license"].replace("/", " OR ")
            found[f"{name} {crate['version']} ({licence})"] = texts(Path(crate["manifest_path"]).parent, licence)
    return found


def texts(folder: Path, licence: str) -> list[Path]:
    """The files of a crate's licence."""
    files = sorted(file for file in folder.iterdir() if file.is_file() and file.name.lower().startswith(NAMES))
    if not files and "Apache-2.0" in licence:
        return [APACHE]
    if not files:
        sys.exit(f"{folder} has no file with its licence, {licence}")
    has_mit = any("mit" in file.name.lower() for file in files)
    return [file for file in files if not (has_mit and "apache" in file.name.lower())]


def document() -> str:
    """The licences, each text below what it is of."""
    works = {name: [ROOT / file for file in files] for name, files in EMBEDDED.items()}
    works |= {STANDARD_LIBRARY: [APACHE]} | crates()
    owners: dict[str, list[str]] = {}
    for work, files in works.items():
        for file in files:
            text = "\n".join(line.rstrip() for line in file.read_text(encoding="utf-8").strip().splitlines())
            owners.setdefault(text, []).append(work)
    rule = "=" * 80
    parts = ["\n".join([rule, *names, rule]) + f"\n\n{text}\n" for text, names in owners.items()]
    return "The closecall wheel contains the works below, under these licences.\n\n" + "\n".join(parts)


def main() -> None:
    """Write or check the file."""
    text = document()
    if "--check" not in sys.argv:
        OUT.write_text(text, encoding="utf-8")
    elif not OUT.is_file() or OUT.read_text(encoding="utf-8") != text:
        sys.exit("THIRD-PARTY.txt is not up to date: make licences")


if __name__ == "__main__":
    main()
