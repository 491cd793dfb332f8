"""Checks that every relative link in the project's Markdown files leads somewhere."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

LINK = re.compile(r"\]\(([^)#\s]+)(#[^)\s]*)?\)")


def broken(page: Path) -> list[str]:
    """The links of one page that lead nowhere."""
    targets = [match.group(1) for match in LINK.finditer(page.read_text(encoding="utf-8"))]
    local = [target for target in targets if not re.match(r"[a-z]+:", target)]
    return [f"{page}: {target}" for target in local if not (page.parent / target).exists()]


def main() -> int:
    """Exit status 1 if any link is broken."""
    listed = subprocess.run(["git", "ls-files", "*.md"], capture_output=True, text=True, check=True)
    found = [line for page in listed.stdout.split() for line in broken(Path(page))]
    print("\n".join(found) or "no broken links")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
