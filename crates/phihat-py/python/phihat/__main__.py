"""``python -m phihat crosscheck STUDY``: a study in MuJoCo too, beside phihat's simulator."""

from __future__ import annotations

import sys

COMMAND = """\
python -m phihat crosscheck STUDY   runs a study in MuJoCo too and compares

The phihat command is a program of its own: `cargo install --path crates/phihat-cli` installs it. What it does, this package
does by functions: phihat.design, verify, simulate, report, faults, compare, reproduce."""


def main() -> int:
    """Run the cross-check with the process's arguments; returns its exit code."""
    if sys.argv[1:2] == ["crosscheck"]:
        from ._crosscheck import main as crosscheck

        return crosscheck(sys.argv[2:])
    asked = sys.argv[1:] in ([], ["-h"], ["--help"])
    print(COMMAND, file=sys.stdout if asked else sys.stderr)
    return 0 if asked else 2


if __name__ == "__main__":
    sys.exit(main())
