"""Grouping of many triples by property."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

from semmap.schemas.explanations import Term, Triple


def group_by_property(triples: Iterable[Triple]) -> dict[Term, list[Triple]]:
    """Return the triples of each property, in their order."""
    found = defaultdict[Term, list[Triple]](list)
    for triple in triples:
        found[triple[1]].append(triple)
    return dict(found)
