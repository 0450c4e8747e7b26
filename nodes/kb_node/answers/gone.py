"""When such a thing as was described was last there: what was removed since, and what has been moved away."""

from __future__ import annotations

import time
from collections.abc import Iterator, Set
from itertools import islice
from typing import Final

from semmap.nodes.kb_node.answers.differences import spells
from semmap.nodes.kb_node.answers.speakable import item
from semmap.nodes.kb_node.relations.measuring.phrases import SPOKEN
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.history import Past
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.language.reference_resolution.missing import Missing
from semmap.schemas import errors
from semmap.schemas.commands import WasWhen

_MOST: Final = 3
"""Sentences of each sort."""
_LOOKED_AT: Final = 200
"""So many of those that went last are looked at."""


def gone(
    journal: Journal, past: Past, sought: Missing, there: Set[str], limits: Thresholds
) -> tuple[str, ...]:
    """Sentences on when it was last there, the newest first; for any thread. there: who is there now."""
    removed = islice(_removed(journal, past, sought, there), _MOST)
    moved = islice(_moved(journal, past, sought, limits), _MOST)
    return (*removed, *moved)


def _removed(journal: Journal, past: Past, sought: Missing, there: Set[str]) -> Iterator[str]:
    """Those of that kind that somebody took out of the map."""
    touched = [(seq, name) for name, seq in journal.last_touches(past.last) if name not in there]
    for seq, name in sorted(touched, reverse=True)[:_LOOKED_AT]:
        try:
            entity = past.entity(name, seq - 1)
        except (errors.UnknownName, errors.Refused):  # it came and went at once, or before the history begins
            continue
        if sought.is_such(item(entity)):
            yield f"{name} was there until commit {seq}, {_at(journal, seq)}"


def _moved(journal: Journal, past: Past, sought: Missing, limits: Thresholds) -> Iterator[str]:
    """Those that are there, and were where they were said to be."""
    for name, relation, other in sought.pairs:
        asked = WasWhen(name=name, relation=relation, other=other)
        held = spells(journal, past, asked, limits).spells
        if held and (until := held[-1].until) is not None:
            where = SPOKEN[relation].removeprefix("is ")
            yield f"{name} was {where} {other} until commit {until}, {_at(journal, until)}"


def _at(journal: Journal, seq: int) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(journal.stamps.of(seq) / 1e9))
