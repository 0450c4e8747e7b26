"""When entities were last seen, and which are missing or out of sight: the command `last-seen`.

Commits record where an entity was last placed or observed. Nothing is committed while it stays there. The
time of the last observation therefore comes from the messages of perception, and is kept in memory only. No
camera can observe what is inside a closed container.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final, NamedTuple

from msgspec import structs

from semmap.nodes.kb_node.relations.geometry.opening import joint_at
from semmap.nodes.kb_node.relations.measuring.containment import hollow_around
from semmap.nodes.kb_node.storage.history import HistoryReader, make_sighting
from semmap.ontology import vocabulary as v
from semmap.schemas import wording
from semmap.schemas.entities import Entity, Provenance
from semmap.schemas.joints import IS_OPEN, OPEN_FROM
from semmap.schemas.perception import DISPLACED, MISSING, Observations
from semmap.schemas.replies import Sighting

if TYPE_CHECKING:
    from semmap.nodes.kb_node.semantic_map import SemanticMap

_JUST_NOW_S: Final = 10.0
_IS_INSIDE: Final = v.dm("isInside")


class Sightings:
    """The times of observations. `record`, `is_missing` and `describe_present` are for the node's thread."""

    def __init__(self, past: HistoryReader) -> None:
        self._past = past
        self._seen_ns: dict[str, int] = {}

    def record(self, seen: Observations) -> None:
        """Store the observations of one frame."""
        self._seen_ns.update((one.entity, seen.stamp_ns) for one in seen.observations if one.entity)

    def is_missing(self, entity: Entity) -> bool:
        """Return whether perception has reported that an entity is not where it should be."""
        return entity.conflict in (MISSING, DISPLACED)

    def describe_present(self, entity: Entity) -> Sighting:
        """Return where an entity of the map is, as far as is known."""
        return self._describe(make_sighting(entity, None), None)

    def describe_removed(self, name: str, entity: Entity | None) -> Sighting:
        """Return where a removed or missing entity was. For any thread. Raises UnknownName."""
        if entity is not None:
            return self._describe(
                make_sighting(entity, None), self._past.in_conflict_since(entity), entity.conflict
            )
        found = self._past.last_seen(name)
        by_sight = found.removed is not None and found.removed.source == "perception"
        return self._describe(found, found.removed if by_sight else None)

    def _describe(self, found: Sighting, missing: Provenance | None, how: str = "") -> Sighting:
        seen_ns = self._seen_ns.get(found.name)
        if seen_ns is not None and seen_ns <= found.provenance.stamp_ns:
            seen_ns = None  # of its former place
        now_ns = time.time_ns()
        if missing is not None:
            text = f"reported missing {_at(missing, now_ns)}: {how or missing.reason}"
        elif found.removed is not None:
            text = f"removed {_at(found.removed, now_ns)} by {_author(found.removed)}"
        else:
            text = _describe_observed(found.provenance, seen_ns, now_ns)
        return structs.replace(found, gone=missing, seen_ns=seen_ns, text=text)


def _describe_observed(placed: Provenance, seen_ns: int | None, now_ns: int) -> str:
    if seen_ns is not None:
        ago_s = (now_ns - seen_ns) / 1e9
        if ago_s < _JUST_NOW_S:
            return "in view of a camera now"
        return f"last in view {wording.duration(ago_s)} ago; not seen since, not reported missing"
    if not placed.commit:
        return "never seen, not reported missing"
    how = "last seen" if placed.source == "perception" else f"placed by {_author(placed)}"
    return f"{how} {_at(placed, now_ns)}; not seen since, not reported missing"


def _at(provenance: Provenance, now_ns: int) -> str:
    """Return `at commit 7, 12 min ago`."""
    return f"at commit {provenance.commit}, {wording.duration((now_ns - provenance.stamp_ns) / 1e9)} ago"


def _author(provenance: Provenance) -> str:
    by = {"operator": "an operator", "file": "a file", "scene": "the scene"}.get(
        provenance.source, provenance.source
    )
    return f"{provenance.source}/{provenance.agent}" if provenance.agent else by


class Closed(NamedTuple):
    """A closed container: the whole entity, or only the part that these joints close."""

    entity: Entity
    joints: tuple[str, ...] = ()


def find_closed_container(semantic_map: SemanticMap, entity: Entity) -> Closed | None:
    """Return the innermost closed container that an entity is inside, as far as the map states it.

    A fixture in the top of a closed counter is in view, and so are its contents.
    """
    seen = {entity.name}
    inside = [entity]
    while inside:
        inner = inside.pop(0)
        around = semantic_map.reasoner.given(v.iri(inner.iri), _IS_INSIDE, None)
        for name in sorted(v.entity_name(outer) for _, _, outer in around):
            outer = semantic_map.find(name)
            if outer is None or name in seen or _is_let_into_top(semantic_map, inner, outer):
                continue
            if outer.properties.get(IS_OPEN) is False:
                return Closed(outer)
            if shut := _find_closing_joints(semantic_map, inner, outer):
                return Closed(outer, shut)
            seen.add(name)
            inside.append(outer)
    return None


def _is_let_into_top(semantic_map: SemanticMap, inner: Entity, outer: Entity) -> bool:
    """Return whether an entity is a fixture that is let into the top of another one."""
    space = semantic_map.places.space()
    solid = space.solids.get(inner.name)
    container = None if solid is None else space.spatial_relations(solid).container
    return container is not None and container[0].name == outer.name and container[1].by_edge


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


def describe_closed(closed: Closed) -> str:
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
