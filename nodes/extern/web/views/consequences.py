"""What would go with things that are deleted, as a dry run tells it."""

from __future__ import annotations

from typing import Final

from schemas import wording
from schemas.replies import Changed

_FEW: Final = 4


def consequences(tried: Changed) -> tuple[str, ...]:
    """A sentence each: what the dry run notes, what of other things no longer follows, and how much else."""
    gone = set(tried.names)
    own = [fact for fact in tried.no_longer_follows if fact.partition(" ")[0] in gone]
    others = [fact for fact in tried.no_longer_follows if fact.partition(" ")[0] not in gone]
    said = [f"{note[:1].upper()}{note[1:]}." for note in tried.notes]
    if others:
        rest = len(others) - _FEW
        more = f", and {wording.counted(rest, 'more fact')}" if rest > 0 else ""
        said.append(f"No longer so: {'; '.join(others[:_FEW])}{more}.")
    if own:
        said.append(
            f"With it {'goes' if len(own) == 1 else 'go'} {wording.counted(len(own), 'inferred fact')}."
        )
    return tuple(said)
