"""When an entity that matches a description was last there: removed or moved entities."""

from __future__ import annotations

import time
from collections.abc import Iterator, Set
from itertools import islice
from typing import Final

from semmap.nodes.kb_node.answers.differences import find_spells
from semmap.nodes.kb_node.answers.search_vocabulary import item
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.language.reference_resolution.missing import Missing
from semmap.schemas import errors
from semmap.schemas.commands import WasWhen
from semmap.schemas.relations import PHRASES

_MOST: Final = 3
"""Sentences of each kind."""
_LOOKED_AT: Final = 200
"""Recently removed entities that are checked."""


def describe_missing(
    journal: Journal, past: HistoryReader, missing: Missing, present: Set[str], limits: Thresholds
) -> tuple[str, ...]:
    """Return sentences on when it was last there, newest first.

    For any thread. `present` are the present names.
    """
    removed = islice(_removed(journal, past, missing, present), _MOST)
    moved = islice(_moved(journal, past, missing, limits), _MOST)
    return (*removed, *moved)


def _removed(journal: Journal, past: HistoryReader, missing: Missing, present: Set[str]) -> Iterator[str]:
    """Yield sentences on removed entities of that kind."""
    touched = [(seq, name) for name, seq in journal.last_touches(past.last) if name not in present]
    for seq, name in sorted(touched, reverse=True)[:_LOOKED_AT]:
        try:
            entity = past.entity(name, seq - 1)
        except (
            errors.UnknownName,
            errors.Refused,
        ):  # it existed only briefly, or before the history begins
            continue
        if missing.is_such(item(entity)):
            yield f"{name} was there until commit {seq}, {_at(journal, seq)}"


def _moved(journal: Journal, past: HistoryReader, missing: Missing, limits: Thresholds) -> Iterator[str]:
    """Yield sentences on present entities that were at the described location before."""
    for name, relation, other in missing.pairs:
        asked = WasWhen(name=name, relation=relation, other=other)
        held = find_spells(journal, past, asked, limits).spells
        if held and (until := held[-1].until) is not None:
            where = PHRASES[relation].removeprefix("is ")
            yield f"{name} was {where} {other} until commit {until}, {_at(journal, until)}"


def _at(journal: Journal, seq: int) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(journal.stamps.of(seq) / 1e9))
