"""The version of semmap that runs."""

from __future__ import annotations

from functools import cache


@cache
def version() -> str:
    """Return the installed version; empty in a checkout that is not installed."""
    from importlib.metadata import PackageNotFoundError  # slow: a tenth of the start of a command line
    from importlib.metadata import version as installed

    try:
        return installed("semmap")
    except PackageNotFoundError:
        return ""


def difference(system: str) -> str:
    """Return a note if the versions of system and client differ, else "".

    `system` is the version in its status; systems before 0.2.0 have none.
    """
    ours = version()
    if not ours or system == ours:
        return ""
    return f"the system runs semmap {system or 'before 0.2.0'}, this client is {ours}"
