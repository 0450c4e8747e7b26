"""What no camera can see, because it is inside something that is closed."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final

from nodes.kb_node.relations.geometry.opening import joint_at
from nodes.kb_node.relations.measuring.measures import hollow_around
from ontology import vocabulary as v
from schemas import wording
from schemas.entities import Entity
from schemas.joints import IS_OPEN, OPEN_FROM

if TYPE_CHECKING:
    from nodes.kb_node.semantic_map import SemanticMap

_IS_INSIDE: Final = v.dm("isInside")


def closed_around(semantic_map: SemanticMap, entity: Entity) -> Entity | None:
    """The closed thing that an entity is inside, as far as the map says; of several the innermost."""
    seen = {entity.name}
    inside = [entity]
    while inside:
        inner = inside.pop(0)
        around = semantic_map.reasoner.given(v.iri(inner.iri), _IS_INSIDE, None)
        for name in sorted(v.entity_name(outer) for _, _, outer in around):
            outer = semantic_map.find(name)
            if outer is None or name in seen:
                continue
            if _is_shut_around(semantic_map, inner, outer):
                return outer
            seen.add(name)
            inside.append(outer)
    return None


def _is_shut_around(semantic_map: SemanticMap, inner: Entity, outer: Entity) -> bool:
    """Whether a thing is said to be closed, or at least all that closes the hollow with the other in it."""
    is_open = outer.properties.get(IS_OPEN)
    if is_open is not True:
        return is_open is False
    solids = semantic_map.places.space().solids
    one, around = solids.get(inner.name), solids.get(outer.name)
    if one is None or around is None or not around.form.joints or not around.hollows:
        return False
    hollow, form = hollow_around(one, around), around.form
    closing = {*hollow.behind, *filter(None, (hollow.carried_by,))}
    shares = [
        joint_at(leaf, position).openness
        for leaf, position in zip(form.shape.leaves, form.joints, strict=True)
        if leaf.name in closing
    ]
    return bool(shares) and all(share is not None and share <= OPEN_FROM for share in shares)


def in_words(closed: Entity) -> str:
    """`it cannot be seen there: fridge1 has been closed since commit 7, 5 min ago`."""
    said = closed.joint_provenance or closed.provenance
    ago = wording.duration((time.time_ns() - said.stamp_ns) / 1e9)
    return f"it cannot be seen there: {closed.name} has been closed since commit {said.commit}, {ago} ago"
