"""Closed containers: no camera can observe what is inside."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final, NamedTuple

from semmap.nodes.kb_node.relations.geometry.opening import joint_at
from semmap.nodes.kb_node.relations.measuring.measures import hollow_around
from semmap.ontology import vocabulary as v
from semmap.schemas import wording
from semmap.schemas.entities import Entity
from semmap.schemas.joints import IS_OPEN, OPEN_FROM

if TYPE_CHECKING:
    from semmap.nodes.kb_node.semantic_map import SemanticMap

_IS_INSIDE: Final = v.dm("isInside")


class Closed(NamedTuple):
    """A closed container: the whole entity, or only the part that these joints close."""

    entity: Entity
    joints: tuple[str, ...] = ()


def find_closed_container(semantic_map: SemanticMap, entity: Entity) -> Closed | None:
    """Return the innermost closed container that an entity is inside, as far as the map states it."""
    seen = {entity.name}
    inside = [entity]
    while inside:
        inner = inside.pop(0)
        around = semantic_map.reasoner.given(v.iri(inner.iri), _IS_INSIDE, None)
        for name in sorted(v.entity_name(outer) for _, _, outer in around):
            outer = semantic_map.find(name)
            if outer is None or name in seen:
                continue
            if outer.properties.get(IS_OPEN) is False:
                return Closed(outer)
            if shut := _find_closing_joints(semantic_map, inner, outer):
                return Closed(outer, shut)
            seen.add(name)
            inside.append(outer)
    return None


def _find_closing_joints(semantic_map: SemanticMap, inner: Entity, outer: Entity) -> tuple[str, ...]:
    """Return the joints that close the cavity around an object, if all are shut and others are open."""
    solids = semantic_map.places.space().solids
    inner_solid, around = solids.get(inner.name), solids.get(outer.name)
    if inner_solid is None or around is None or not around.form.joints or not around.hollows:
        return ()
    hollow, form = hollow_around(inner_solid, around), around.form
    closing = {*hollow.behind, *filter(None, (hollow.carried_by,))}
    shares = {
        leaf.name: joint_at(leaf, position).openness
        for leaf, position in zip(form.shape.leaves, form.joints, strict=True)
        if leaf.name in closing
    }
    are_shut = all(share is not None and share <= OPEN_FROM for share in shares.values())
    return tuple(shares) if are_shut else ()


def describe(closed: Closed) -> str:
    """Return `not observable: fridge1 has been closed since commit 7, 5 min ago`."""
    entity, joints = closed
    provenance = entity.joint_provenance or entity.provenance
    ago = wording.duration((time.time_ns() - provenance.stamp_ns) / 1e9)
    if not joints:
        return f"not observable: {entity.name} has been closed since commit {provenance.commit}, {ago} ago"
    are = "is" if len(joints) == 1 else "are"
    return (
        f"not observable: {' and '.join(joints)} of {entity.name} {are} closed"
        f" (last stated in commit {provenance.commit}, {ago} ago)"
    )
