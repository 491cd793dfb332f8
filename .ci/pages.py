"""What MkDocs does besides: pages at the top of the repository become pages of the site, links find their way,
a tutorial becomes a notebook, and there is a gallery.

The pages are written for GitHub. A link to a file that is no page of the site goes to the repository; before the first
release, whose address is filled in (`.ci/address.py`), it is text alone.
"""

from __future__ import annotations

import posixpath
import re
import sys
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File

# MkDocs loads this file by its path.
sys.path.insert(0, str(Path(__file__).parent))
import gallery
from notebook import notebook

ROOT = Path(__file__).parents[1]

# The pages at the top, each with its name on the site.
TOP = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "ARCHITECTURE.md": "architecture.md",
}

# The pages that are notebooks, too.
NOTEBOOKS = ["tutorials/first.md"]

LINK = re.compile(r"(?<=\]\()(?![a-z]+:|#)([^)#\s]+)")
WHOLE_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?![a-z]+:|#)([^)#\s]+)[^)]*\)")


def on_files(files: Any, config: Any) -> Any:
    """Add the pages at the top, the notebooks and the gallery."""
    for name, page in TOP.items():
        files.append(File.generated(config, page, content=(ROOT / name).read_text(encoding="utf-8")))
    for page in NOTEBOOKS:
        text = notebook((ROOT / "docs" / page).read_text(encoding="utf-8"))
        files.append(File.generated(config, page.replace(".md", ".ipynb"), content=text))
    gallery.make()
    files.append(
        File.generated(config, gallery.PAGE, content=(gallery.FOLDER / gallery.PAGE).read_text(encoding="utf-8"))
    )
    for path in gallery.files():
        files.append(File.generated(config, f"gallery/{path.name}", abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Point the links of a page to where their targets are on the site, or else in the repository."""
    name = page.file.src_uri
    source = next((top for top, own in TOP.items() if own == name), f"docs/{name}")

    def on_site(target: str) -> str | None:
        full = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
        own = TOP.get(full, full.removeprefix("docs/"))
        file = files.get_file_from_path(own) if full in TOP or full.startswith("docs/") else None
        is_page = file is not None and file.inclusion.is_included()
        return posixpath.relpath(own, posixpath.dirname(name) or ".") if is_page else None

    def where(link: re.Match[str]) -> str:
        in_repository = posixpath.normpath(posixpath.join(posixpath.dirname(source), link[1]))
        return on_site(link[1]) or f"{config.repo_url}/blob/main/{in_repository}"

    if name in NOTEBOOKS:
        heading, rest = markdown.split("\n", 1)
        own = posixpath.basename(name).replace(".md", ".ipynb")
        markdown = f"{heading}\n\n[This page as a Jupyter notebook]({own})\n{rest}"
    if not config.repo_url:
        markdown = WHOLE_LINK.sub(lambda link: link[0] if on_site(link[2]) else link[1], markdown)
    return LINK.sub(where, markdown)
