"""Agent names in commits: authenticated by a certificate, or only claimed.

Between the coordinator and the knowledge base, an authenticated name has a mark that clients cannot send. A
commit has the name without the mark and the field `authenticated`.
"""

from __future__ import annotations

from typing import Final

_MARK: Final = "@"


def proved(name: str) -> str:
    """Return an authenticated name with the mark."""
    return f"{_MARK}{name}"


def is_proved(agent: str) -> bool:
    """Return whether a name has the mark."""
    return agent.startswith(_MARK)


def name_of(agent: str) -> str:
    """Return the name without the mark."""
    return agent.removeprefix(_MARK)
