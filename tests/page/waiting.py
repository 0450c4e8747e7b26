"""What tests of the page wait for: marks of the page itself, never time."""

from __future__ import annotations

from typing import Any

from tests.conftest import until


def mark(tab: Any, name: str) -> str:
    """One of the attributes that the page keeps for those who wait for it, such as `commit`."""
    return str(tab.locator(".semmap-marks").get_attribute(f"data-{name}"))


def commit_of(tab: Any) -> int:
    """The commit that the tab shows."""
    return int(mark(tab, "commit"))


def has_commit(tab: Any, commit: int) -> None:
    """Wait until the tab shows this commit or a later one."""
    until(lambda: commit_of(tab) >= commit, f"the tab shows commit {commit}")


def settle(tab: Any) -> None:
    """Wait until the page has taken in all that was done in the tab, and shows what came of it."""
    tab.evaluate("semmapSettled()")
