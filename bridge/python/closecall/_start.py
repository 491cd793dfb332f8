"""Starting closecall in a process of its own."""

from __future__ import annotations

import sys


def command(module: str) -> list[str]:
    """The command line that starts the `main` of one of closecall's modules, to be followed by its arguments.

    The module is imported from where this interpreter imports it, never from the working directory.
    """
    start = f"import sys; sys.path[:] = filter(None, sys.path); from closecall.{module} import main; sys.exit(main())"
    return [sys.executable, "-c", start]
