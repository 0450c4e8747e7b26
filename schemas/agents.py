"""Names in commits: those that a certificate has proved, and those that were merely claimed.

Between the coordinator and the knowledge base a proved name carries a mark, which nobody can claim. A commit
has the bare name and says which of the two it is.
"""

from __future__ import annotations

from typing import Final

_MARK: Final = "@"


def proved(name: str) -> str:
    """A name that a certificate has proved, marked."""
    return f"{_MARK}{name}"


def is_proved(agent: str) -> bool:
    """Is it marked?"""
    return agent.startswith(_MARK)


def name_of(agent: str) -> str:
    """The name without the mark."""
    return agent.removeprefix(_MARK)
