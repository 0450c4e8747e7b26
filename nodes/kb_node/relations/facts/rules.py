"""The relations that are stored as facts: a table, with a row for those computed together.

A new relation is a new row. Its facts must depend only on the solids around an object. Then a restart,
another order of commits, or a past state gives the same facts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import containment
from semmap.nodes.kb_node.relations.measuring.arrangement import find_attachments
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.survey import NO_ROW, Survey
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term
from semmap.schemas.relations import RelationName

About = tuple[RelationName, str]
"""The part of a fact without its subject: ("isOn", "table1")."""


_SPATIAL: Final[tuple[RelationName, RelationName, RelationName]] = ("isInside", "isOn", "isLocatedIn")
_ROUNDING = 1e-6
"""Tolerance of the pre-check, which may accept too much."""


class Rule(NamedTuple):
    """How some relations are computed, and when they must be computed again."""

    relations: tuple[RelationName, ...]
    """Each is a property with this name in the namespace of the household TBox."""
    facts: Callable[[Space, Solid], Iterator[About]]
    """Yields the facts of an object. It is not called for places."""
    of_many: Callable[[Survey], list[tuple[About, ...] | None]]
    """The same for each surveyed object. None means that `facts` must be called."""
    concerns: Callable[[Space, Solid, Solid], bool]
    """Whether a new or removed first solid may change facts of the second, even facts not about the first.

    It must be fast and may return True too often. Then all rules are evaluated again. It is called for
    solids whose bounds are within the margins. Facts about a moved or removed object are always computed
    again.
    """
    margin_m: Callable[[Thresholds], float] = lambda limits: 0.0
    """The greatest distance between the bounds of two related objects [m]."""


def _spatial_facts(space: Space, solid: Solid) -> Iterator[About]:
    if solid.name in space.holders:
        return  # it is where its holder is
    container, supports, place = space.spatial_relations(solid)
    if container is not None:
        yield "isInside", container[0].name
    for support, _ in supports:
        yield "isOn", support.name
    if place is not None:
        yield "isLocatedIn", place[0].name


def _spatial_facts_of_many(survey: Survey) -> list[tuple[About, ...] | None]:
    rows = list(zip(survey.container.tolist(), survey.support.tolist(), survey.place.tolist(), strict=True))
    solids = survey.solids
    known = {
        some: tuple(
            (relation, solids[row].name)
            for relation, row in zip(_SPATIAL, some, strict=True)
            if row != NO_ROW
        )
        for some in set(rows)
    }
    found: list[tuple[About, ...] | None] = [known[some] for some in rows]
    for row in survey.is_open.nonzero()[0].tolist():
        found[row] = None
    return _without_attached(survey, found)


def _without_attached(
    survey: Survey, found: list[tuple[About, ...] | None]
) -> list[tuple[About, ...] | None]:
    if holders := survey.holders:
        for row, solid in enumerate(survey.solids):
            if solid.name in holders:
                found[row] = ()
    return found


def _attachments(space: Space, solid: Solid) -> Iterator[About]:
    for other in find_attachments(space, solid):
        yield "isAttachedTo", other.name


def _attachments_of_many(survey: Survey) -> list[tuple[About, ...] | None]:
    found: list[tuple[About, ...] | None] = [()] * len(survey.may_hang)
    for row in survey.may_hang.nonzero()[0].tolist():
        found[row] = None
    for row, others in survey.hangs_on.items():
        found[row] = tuple(("isAttachedTo", name) for name in sorted(survey.solids[k].name for k in others))
    return _without_attached(survey, found)


def _may_attach(space: Space, solid: Solid, other: Solid) -> bool:
    """Return whether `other` may be attached to `solid`. Loss of support is covered by `_may_support`."""
    return solid.is_place or solid.bottom < other.bottom <= solid.top + space.limits.gap_m


def _may_support(space: Space, solid: Solid, other: Solid) -> bool:
    """Return whether `other` may be on, inside or in `solid`."""
    if solid.is_place:
        return True
    limits = space.limits
    gap = limits.gap_m + _ROUNDING
    if other.bottom > solid.top + gap or other.top < solid.bottom - gap:
        return False
    if containment.may_be_inside(other, solid, limits) or not (other.is_level and solid.is_level):
        return True
    if other.bottom < solid.bottom - limits.contact_m:
        return False
    return solid.form.has_slopes or other.highest_bottom >= solid.lowest_top - gap


RULES: Final[tuple[Rule, ...]] = (
    Rule(_SPATIAL, _spatial_facts, _spatial_facts_of_many, _may_support),
    Rule(
        ("isAttachedTo",), _attachments, _attachments_of_many, _may_attach, lambda limits: limits.attached_m
    ),
)  # fmt: skip

COMPUTED: Final[dict[Term, RelationName]] = {v.dm(name): name for rule in RULES for name in rule.relations}
"""The properties that are computed if a TBox declares them."""
