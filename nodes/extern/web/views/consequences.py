"""What would go with things that are deleted, as a dry run tells it."""

from __future__ import annotations

import re
from typing import Final

from semmap.schemas import wording
from semmap.schemas.replies import Changed

_FEW: Final = 4


_PAST: Final = re.compile(r"^((?:On|Inside) \S+) (was|were) ")


def consequences(tried: Changed) -> tuple[str, ...]:
    """A sentence each: what the dry run notes, and what of other things would no longer follow."""
    gone = set(tried.names)
    others = [fact for fact in tried.no_longer_follows if fact.partition(" ")[0] not in gone]
    said = [_PAST.sub(_is, f"{note[:1].upper()}{note[1:]}.") for note in tried.notes]
    if others:
        rest = len(others) - _FEW
        more = f", and {wording.counted(rest, 'more fact')}" if rest > 0 else ""
        said.append(f"No longer so then: {'; '.join(others[:_FEW])}{more}.")
    return tuple(said)


def facts_of(tried: Changed) -> tuple[str, ...]:
    """The facts about the deleted things themselves that follow no longer."""
    gone = set(tried.names)
    return tuple(fact for fact in tried.no_longer_follows if fact.partition(" ")[0] in gone)


def _is(stood: re.Match[str]) -> str:
    """What the dry run says was so before is still so while somebody is asked."""
    return f"{stood[1]} {'is' if stood[2] == 'was' else 'are'} "
