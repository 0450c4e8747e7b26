"""What no camera can see, because it is inside something that is closed."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final

from ontology import vocabulary as v
from schemas import wording
from schemas.entities import Entity
from schemas.joints import IS_OPEN

if TYPE_CHECKING:
    from nodes.kb_node.semantic_map import SemanticMap

_IS_INSIDE: Final = v.dm("isInside")


def closed_around(semantic_map: SemanticMap, entity: Entity) -> Entity | None:
    """The closed thing that an entity is inside, as far as the map says; of several the innermost."""
    seen: set[str] = set()
    around = [entity.name]
    while around:
        inner = semantic_map.find(around.pop(0))
        if inner is None or inner.name in seen:
            continue
        seen.add(inner.name)
        if inner is not entity and inner.properties.get(IS_OPEN) is False:
            return inner
        outer = semantic_map.reasoner.given(v.iri(inner.iri), _IS_INSIDE, None)
        around += sorted(v.entity_name(o) for _, _, o in outer)
    return None


def in_words(closed: Entity) -> str:
    """`it cannot be seen there: fridge1 has been closed since commit 7, 5 min ago`."""
    said = closed.joint_provenance or closed.provenance
    ago = wording.duration((time.time_ns() - said.stamp_ns) / 1e9)
    return f"it cannot be seen there: {closed.name} has been closed since commit {said.commit}, {ago} ago"
