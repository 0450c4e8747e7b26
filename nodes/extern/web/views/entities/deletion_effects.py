"""The effects of a deletion, from the reply to its dry run."""

from __future__ import annotations

import re
from typing import Final

from semmap.schemas import wording
from semmap.schemas.replies import Changed

_FEW: Final = 4


_PAST: Final = re.compile(r"^((?:On|Inside) \S+) (was|were) ")


def describe_effects(tried: Changed) -> tuple[str, ...]:
    """Return sentences: the notes of the dry run, and the inferred facts that other entities would lose."""
    deleted = set(tried.names)
    others = [fact for fact in tried.no_longer_follows if fact.partition(" ")[0] not in deleted]
    sentences = [_PAST.sub(_to_present, f"{note[:1].upper()}{note[1:]}.") for note in tried.notes]
    if others:
        rest = len(others) - _FEW
        more = f", and {wording.counted(rest, 'more fact')}" if rest > 0 else ""
        sentences.append(f"Lost inferences: {'; '.join(others[:_FEW])}{more}.")
    return tuple(sentences)


def own_facts(tried: Changed) -> tuple[str, ...]:
    """Return the inferred facts about the deleted entities themselves."""
    deleted = set(tried.names)
    return tuple(fact for fact in tried.no_longer_follows if fact.partition(" ")[0] in deleted)


def _to_present(match: re.Match[str]) -> str:
    """Return the present tense: nothing is deleted yet when the user is asked."""
    return f"{match[1]} {'is' if match[2] == 'was' else 'are'} "
