"""The version of semmap that runs."""

from __future__ import annotations

from functools import cache


@cache
def version() -> str:
    """As it is installed; empty where it is not, as in a checkout that is only on the path."""
    from importlib.metadata import PackageNotFoundError  # takes a tenth of what a command line takes to begin
    from importlib.metadata import version as installed

    try:
        return installed("semmap")
    except PackageNotFoundError:
        return ""


def difference(system: str) -> str:
    """`the system runs semmap 0.3.0, this client is 0.2.0`; nothing when they are the same.

    `system` is what its status says, where versions before 0.2.0 say nothing.
    """
    ours = version()
    if not ours or system == ours:
        return ""
    return f"the system runs semmap {system or 'before 0.2.0'}, this client is {ours}"
