"""Fills in the address of the repository where lines begin with `# released: ` and OWNER stands for it.

    python3 .ci/address.py OWNER/NAME [REF]

With REF, the tag of a release, the README's links become absolute, too: PyPI and crates.io show it without the files
that it links to. Standard library only.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

FILES = [
    "pyproject.toml",
    "Cargo.toml",
    "CITATION.cff",
    "mkdocs.yml",
    "README.md",
    ".ci/recipe.yaml",
    "docs/paper/contributed.md",
]
RELEASED = "# released: "
"""What these lines begin with before, so that nothing names an address that leads nowhere."""
RELATIVE = re.compile(r"(!?)(\[[^\]]*\])\((?![a-z]+:|#)([^)\s]+)\)")


def filled(text: str, repository: str) -> str:
    """The text with the address of the repository."""
    owner, name = repository.split("/")
    text = text.replace(RELEASED, "")
    site = f"{owner}.github.io/{name}"
    return text.replace("OWNER.github.io/closecall", site).replace("OWNER/closecall", repository)


def absolute(text: str, repository: str, ref: str) -> str:
    """The text with links to the repository's files as addresses; pictures as the files themselves."""
    pages, files = (
        f"https://github.com/{repository}/blob/{ref}/",
        f"https://raw.githubusercontent.com/{repository}/{ref}/",
    )
    return RELATIVE.sub(lambda link: f"{link[1]}{link[2]}({files if link[1] else pages}{link[3]})", text)


def main() -> None:
    """Change the files in the working directory."""
    repository, *ref = sys.argv[1:]
    for path in map(Path, FILES):
        text = filled(path.read_text(encoding="utf-8"), repository)
        if ref and path.name == "README.md":
            text = absolute(text, repository, *ref)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
