"""closecall as a child process of a sweep's worker or of regress.

A separate module, because every run waits for what it imports.
"""

from __future__ import annotations

import os
import threading

from . import __main__


def main() -> int:
    """Run the command, and exit at once if the parent ends, which holds the other end of standard input."""

    def watch() -> None:
        os.read(0, 1)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
    return __main__.main()
