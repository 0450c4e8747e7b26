"""How many entities a document describes, by what has changed of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from semmap.nodes.kb_node.documents import abox_document
from semmap.nodes.kb_node.documents.replacement import Replacement
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import vocabulary as v
from semmap.schemas import changes
from semmap.schemas.commits import Commit, Effects
from semmap.schemas.entities import Entity


def find_known(
    semantic_map: SemanticMap, filtered: abox_document.FilteredDocument, replaced: Replacement
) -> dict[str, Entity]:
    """Return the entities of the map that a document describes, by name."""
    same = {o for _, p, o in filtered.triples if p == v.OWL_SAME_AS}
    found = filter(None, map(semantic_map.find_by_individual, same.union(replaced.known)))
    return {entity.name: entity for entity in found}


def count_described(
    known: Mapping[str, Entity], commits: Sequence[Commit | Effects], after: Mapping[str, Entity]
) -> dict[str, int]:
    """Count the entities that a document describes: those of the commits, and the others that were known.

    An entity that became the same as another one is not counted.
    """
    concerned = dict.fromkeys(name for commit in commits for name in described_names(commit))
    gone = {departed.name for commit in commits for departed in commit.removed}
    described = ((known.get(name), after[name]) for name in concerned if name in after)
    unchanged = ((known[name], None) for name in known.keys() - concerned.keys() - gone)
    return changes.count_kinds((*described, *unchanged))


def described_names(commit: Commit | Effects) -> Iterator[str]:
    """Yield the entities that a load describes; others may only have changed classes because of it."""
    return (entity.name for entity in commit.changed if entity.provenance.commit == commit.seq)
