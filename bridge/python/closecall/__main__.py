"""The command `closecall`."""

from __future__ import annotations

import sys

from ._closecall import main as _main


def main() -> int:
    """Run the command with the arguments of this process and return its exit status."""
    return _main(["closecall", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
