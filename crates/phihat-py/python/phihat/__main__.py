"""``python -m phihat``: the ``phihat`` command."""

from __future__ import annotations

import sys

from . import _phihat


def main() -> int:
    """Run the command with the process's arguments; returns its exit code."""
    if sys.argv[1:2] == ["crosscheck"]:
        from ._crosscheck import main as crosscheck

        return crosscheck(sys.argv[2:])
    return _phihat.command(["phihat", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
