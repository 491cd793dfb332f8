"""Checks that the target of every relative link in the project's Markdown files exists."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

LINK = re.compile(r"\]\(([^)#\s]+)(#[^)\s]*)?\)")


def broken(page: Path) -> list[str]:
    """The broken links of a page."""
    targets = [match.group(1) for match in LINK.finditer(page.read_text(encoding="utf-8"))]
    local = [target for target in targets if not re.match(r"[a-z]+:", target)]
    return [f"{page}: {target}" for target in local if not (page.parent / target).exists()]


def main() -> int:
    """Print the broken links; exit status 1 if there are any."""
    listed = subprocess.run(["git", "ls-files", "*.md"], capture_output=True, text=True, check=True)
    found = [line for page in listed.stdout.split() for line in broken(Path(page))]
    print("\n".join(found) or "no broken links")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
