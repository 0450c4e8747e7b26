"""The entry point of the command line, `semmap`.

It imports the commands only when it is called, so that Ctrl-C during the start also ends it without a
traceback.
"""

from __future__ import annotations

import gc
import sys

_GC_THRESHOLD = 50_000
"""Imports create many objects that live on, so frequent garbage collections during the start find nothing."""


def main() -> None:
    """Run the command line and exit with 0 (success), 1 (rejected), 2 (invalid usage) or 3 (no response)."""
    gc.set_threshold(_GC_THRESHOLD)
    sys.exit(execute(sys.argv[1:]))


def execute(arguments: list[str]) -> int:
    """Run one command line and return its exit status. An error is printed to stderr in one line."""
    try:
        from semmap.nodes.extern.cli.all_commands import app
        from semmap.nodes.extern.cli.common import run_arguments

        return run_arguments(app, arguments)
    except KeyboardInterrupt:
        return 130
