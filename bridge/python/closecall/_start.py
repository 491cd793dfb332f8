"""How closecall is started in a process of its own."""

from __future__ import annotations

import sys


def command(module: str) -> list[str]:
    """The words that start the `main` of one of closecall's modules, to which its arguments are added.

    It is imported from wherever this interpreter imports it, never from the folder in which it is started.
    """
    start = f"import sys; sys.path[:] = filter(None, sys.path); from closecall.{module} import main; sys.exit(main())"
    return [sys.executable, "-c", start]
