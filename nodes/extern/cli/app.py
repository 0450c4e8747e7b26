"""`semmap`: the entry point of the command line.

It imports what it is made of when it is called, so that Ctrl-C ends it quietly while it still starts, too.
"""

from __future__ import annotations

import gc
import sys

_KEPT = 50_000
"""Objects that an import makes and keeps: looking for garbage among them finds none."""


def main() -> None:
    """Run the command line; exit with 0 done, 1 refused, 2 bad request, 3 no answer."""
    gc.set_threshold(_KEPT)
    sys.exit(execute(sys.argv[1:]))


def execute(arguments: list[str]) -> int:
    """Run one command line and return its exit status; what is wrong goes to stderr in one line."""
    try:
        from semmap.nodes.extern.cli.all_commands import app
        from semmap.nodes.extern.cli.common import run_arguments

        return run_arguments(app, arguments)
    except KeyboardInterrupt:
        return 130
