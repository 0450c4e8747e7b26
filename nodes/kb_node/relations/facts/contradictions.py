"""Said against seen: which of the things that somebody said of a place do not hold as things stand."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from semmap.nodes.geometry.polygons import distance
from semmap.nodes.kb_node.entities.alignments import shipped
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures
from semmap.nodes.kb_node.relations.measuring.phrases import PHRASES, explain_measure, format_length
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.relations import Relation, RelationName

PROPERTIES: Final[dict[Term, tuple[RelationName, bool]]] = {
    v.dm("isOn"): ("isOn", False),
    v.dm("supports"): ("isOn", True),
    v.dm("isInside"): ("isInside", False),
    v.dm("holds"): ("isInside", True),
    v.dm("isLocatedIn"): ("isLocatedIn", False),
    v.dm("contains"): ("isLocatedIn", True),
    **{p: (name, False) for known in shipped() for name, p in known.relations.items()},
}
"""The properties that say where a thing is, as relations; of the inverse ones the object is the thing.

They are the household's and those of the vocabularies that there is an alignment with.
"""


def fact_of(triple: Triple) -> Fact | None:
    """What a triple says of where a thing is; None for one about anything else."""
    s, p, o = triple
    if p not in PROPERTIES or o.startswith('"'):
        return None
    relation, is_inverse = PROPERTIES[p]
    thing, other = v.entity_name(s), v.entity_name(o)
    return (other, relation, thing) if is_inverse else (thing, relation, other)


def find_contradictions(space: Space, said: Iterable[Fact]) -> Iterator[Relation]:
    """Those of the facts that geometry denies, once each, with the reason."""
    for fact in dict.fromkeys(said):
        relation = find_contradiction(space, fact)
        if relation is not None:
            yield relation


def find_contradiction(space: Space, said: Fact) -> Relation | None:
    """Why a fact does not hold as things stand; None where geometry agrees, or cannot tell.

    It cannot where a position or a size is missing, or the whole map is flat. It does not deny that what
    hangs is on a wall, nor what is a matter of a few centimetres, nor what is on what in a crowd.
    """
    name, relation, other_name = said
    solid, other = space.solids.get(name), space.solids.get(other_name)
    if name == other_name:
        reason: str | None = "nothing is on, in or inside itself"
    elif solid is None or other is None or not other.is_measured:
        return None
    else:
        reason = _against(space, relation, solid, other)
    if reason is None:
        return None
    spoken = PHRASES[relation].replace("is ", "to be ", 1)
    return Relation(
        relation=relation,
        subject=name,
        object=other_name,
        holds=False,
        gap_m=0.0 if solid is None or other is None else round(measures.gap(solid, other), 4),
        share=0.0,
        text=f"{name} was said {spoken} {other_name}; {reason}",
    )


def _against(space: Space, relation: RelationName, solid: Solid, other: Solid) -> str | None:
    limits = space.limits
    if relation == "isLocatedIn":
        made = measures.within(solid, other, limits)
        if made is None or made.holds:
            return None
        apart = measures.gap(solid, other)
        return (
            explain_measure(relation, solid, other, made)
            if apart < limits.touch_m
            else _stands_off(solid, apart)
        )
    if other.is_place or solid.is_place or not solid.is_measured or space.is_flat:
        return None
    if space.is_crowded(solid) and distance(solid.outline, other.outline) <= limits.gap_m:
        return None  # it may be borne by what is not looked at
    if other in _bearers(space, solid):
        return None
    apart = measures.gap(solid, other)
    if apart > limits.gap_m:
        return _stands_off(solid, apart)
    if relation == "isInside":
        share = _share_within_box(solid, other, limits.gap_m)
        return f"{share:.0%} of its volume is within it" if share < limits.inside_share else None
    carrier = space.spatial_relations(solid)
    is_borne = bool(carrier.supports) or carrier.container is not None
    if not other.supports or not (is_borne or solid.bottom <= other.bottom + limits.gap_m):
        return None  # it may hang or lean there
    made = measures.over(solid, other, limits)
    return (
        f"it is over no surface of {other.name}"
        if made is None
        else explain_measure(relation, solid, other, made)
    )


def _bearers(space: Space, solid: Solid) -> set[Solid]:
    """What it is on or inside, what that is on or inside, and so on."""
    found: set[Solid] = set()
    waiting = [solid]
    while waiting:
        container, supports, _ = space.spatial_relations(waiting.pop())
        below = {other for other, _ in (*filter(None, (container,)), *supports)} - found
        found |= below
        waiting += below
    return found


def _share_within_box(inner: Solid, outer: Solid, margin_m: float) -> float:
    """The share of a volume that is within the other's box: its hollow may not be known."""
    x, y, z = (extent / 2 + margin_m for extent in outer.size)
    points = [outer.to_own(point) for point in inner.samples]
    within = sum(abs(px) <= x and abs(py) <= y and abs(pz - z + margin_m) <= z for px, py, pz in points)
    return within / len(points)


def _stands_off(solid: Solid, apart_m: float) -> str:
    return f"it {'stands' if solid.is_upright else 'lies'} {format_length(apart_m)} from it"
