"""Waiting in tests of the page, by its status attributes and never by time."""

from __future__ import annotations

from typing import Any

from tests.conftest import until


def mark(tab: Any, name: str) -> str:
    """Return a status attribute of the page, such as `commit`."""
    return str(tab.locator(".semmap-marks").get_attribute(f"data-{name}"))


def commit_of(tab: Any) -> int:
    """Return the commit that the tab shows."""
    return int(mark(tab, "commit"))


def has_commit(tab: Any, commit: int) -> None:
    """Wait until the tab shows this commit or a later one."""
    until(lambda: commit_of(tab) >= commit, f"the tab shows commit {commit}")


def settle(tab: Any) -> None:
    """Wait until the page has processed all input and shows the result."""
    tab.evaluate("semmapSettled()")
