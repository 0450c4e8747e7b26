"""The failed tests of a pytest run, in a file for the process that started it."""

from __future__ import annotations

from pathlib import Path

import msgspec


class Failure(msgspec.Struct, frozen=True):
    """A test that failed."""

    name: str
    """As pytest names it: `tests/test_flow.py::test_something`."""
    needs_process: bool
    """Whether it is marked `process`."""
    message: str
    """The first line of what went wrong."""


def write_failures(path: Path, failures: list[Failure]) -> None:
    """Write these to a file."""
    path.write_bytes(msgspec.json.encode(failures))


def read_failures(path: Path) -> list[Failure] | None:
    """Return those that were written; None if pytest did not come to its end."""
    return msgspec.json.decode(path.read_bytes(), type=list[Failure]) if path.exists() else None
