"""closecall as a child of a sweep's worker or of regress; a module of its own: each run waits for what is imported."""

from __future__ import annotations

import os
import threading

from . import __main__


def main() -> int:
    """The command; it ends when its parent does, which holds the other end of standard input."""

    def watch() -> None:
        os.read(0, 1)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
    return __main__.main()
