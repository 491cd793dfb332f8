"""Checks that the target of every relative link in the project's Markdown files exists, and so does each file that
ARCHITECTURE.md names, with the names in it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ARCHITECTURE = Path("ARCHITECTURE.md")
NAMED = re.compile(r"(?:`(\w+)` in )?`([\w./{}-]+(?:/|\.(?:rs|py|js|toml|yml|md)))`")
LINK = re.compile(r"\]\(([^)#\s]+)(#[^)\s]*)?\)")


def broken(page: Path) -> list[str]:
    """The broken links of a page."""
    targets = [match.group(1) for match in LINK.finditer(page.read_text(encoding="utf-8"))]
    local = [target for target in targets if not re.match(r"[a-z]+:", target)]
    return [f"{page}: {target}" for target in local if not (page.parent / target).exists()]


def untrue(page: Path, files: list[str]) -> list[str]:
    """The files that a page names and that do not exist, or lack what it says is in them."""
    found = []
    for name, path in NAMED.findall(page.read_text(encoding="utf-8")):
        at = [file for file in files if file == path or file.endswith(f"/{path}") or f"/{path}" in f"/{file}"]
        if not at:
            found.append(f"{page}: there is no {path}")
        elif name and not any(re.search(rf"\b{name}\b", Path(file).read_text(encoding="utf-8")) for file in at):
            found.append(f"{page}: there is no {name} in {path}")
    return found


def main() -> int:
    """Print the broken links; exit status 1 if there are any."""
    files = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True).stdout.split()
    found = [line for page in files if page.endswith(".md") for line in broken(Path(page))]
    found += untrue(ARCHITECTURE, files)
    print("\n".join(found) or "no broken links")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
