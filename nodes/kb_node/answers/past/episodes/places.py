"""Where an entity is after commits: what it is in, on and located in."""

from __future__ import annotations

from collections.abc import Iterator

from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline
from semmap.nodes.kb_node.answers.past.fact_intervals import with_present_names
from semmap.nodes.kb_node.answers.past.renames import Renames
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import places
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.relation_cache import RelationCache
from semmap.schemas.relations import RelationName

Places = tuple[tuple[RelationName, str], ...]


def find_places(space: Space, name: str) -> Places:
    """Return what an entity is in, on and located in, the innermost place first."""
    found: list[tuple[RelationName, str]] = list(RelationCache(space).spatial_relations(name))
    if (innermost := next((other for how, other in found if how == "isLocatedIn"), None)) is not None:
        inner = space.solids[innermost]
        around = (s for s in space.solids.values() if s.is_place and s is not inner)
        outer = [s for s in around if _is_within(space, inner, s)]
        outer.sort(key=lambda solid: solid.footprint)
        found += [("isLocatedIn", solid.name) for solid in outer]
    return tuple(found)


def follow(timeline: Timeline, name: str) -> Iterator[tuple[int, Places]]:
    """Yield the commits that touched an entity, in order, each with its places after it.

    The first one is the one before the history, if the entity existed then. The journal is read once, because
    the map after each single commit would take a time that grows with the square of its length.
    """
    renames = Renames.of(timeline.past, (name,))
    seqs = {seq for seq, _ in timeline.past.touching(name)}
    at_first = timeline.past.initial_entities().values()
    space = Space((with_present_names(PlacedEntity.of(e), 0, renames) for e in at_first), timeline.limits)
    if name in space.solids:
        yield timeline.journal.first - 1, find_places(space, name)
    for moves in timeline.pose_changes():
        for gone in moves.removed:
            space.remove(renames.present(gone.name, moves.seq))
        for stood in moves.changed:
            space.put(with_present_names(stood.placed, moves.seq, renames))
        if moves.seq in seqs:
            yield moves.seq, find_places(space, name) if name in space.solids else ()


def _is_within(space: Space, inner: Solid, outer: Solid) -> bool:
    """Return whether a place is within another one."""
    made = places.within(inner, outer, space.limits, also_places=True)
    return made is not None and made.holds
