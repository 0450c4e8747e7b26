"""Which relations are kept as facts of the map: a table, one row for those that are worked out together.

A further relation is a further row. What a row yields must be a function of the solids around a thing alone,
so that a restart, another order of commits and a past moment give the same facts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.arrangement import find_attachments
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.survey import NO_ROW, Survey
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term
from semmap.schemas.relations import RelationName

About = tuple[RelationName, str]
"""What a fact says of its subject: ("isOn", "table1")."""


_WHEREABOUTS: Final[tuple[RelationName, RelationName, RelationName]] = ("isInside", "isOn", "isLocatedIn")
_ROUNDING = 1e-6
"""What is asked for here may be asked for in vain."""


class Rule(NamedTuple):
    """How some relations are worked out, and when they have to be worked out again."""

    relations: tuple[RelationName, ...]
    """Each is a property of its name in the namespace of the household TBox."""
    facts: Callable[[Space, Solid], Iterator[About]]
    """What holds of a thing. It is not asked of places."""
    of_many: Callable[[Survey], list[tuple[About, ...] | None]]
    """The same for each of those who were surveyed; None where `facts` has to be asked."""
    concerns: Callable[[Space, Solid, Solid], bool]
    """Whether something may come to hold of the second, or cease to, because of the first, who is new there
    or went, and of whom it need not speak.

    It must be quick, and may say yes too often: then all rules are asked anew. It is asked of those whose
    bounds are within the margins. What speaks of somebody who moved or went is worked out again in any case.
    """
    margin_m: Callable[[Thresholds], float] = lambda limits: 0.0
    """Between the bounds of two whom the relations may join [m]."""


def _whereabouts(space: Space, solid: Solid) -> Iterator[About]:
    if solid.name in space.holders:
        return  # where that is which grasps it
    container, supports, place = space.spatial_relations(solid)
    if container is not None:
        yield "isInside", container[0].name
    for support, _ in supports:
        yield "isOn", support.name
    if place is not None:
        yield "isLocatedIn", place[0].name


def _whereabouts_of_many(survey: Survey) -> list[tuple[About, ...] | None]:
    rows = list(zip(survey.container.tolist(), survey.support.tolist(), survey.place.tolist(), strict=True))
    solids = survey.solids
    known = {
        some: tuple(
            (relation, solids[row].name)
            for relation, row in zip(_WHEREABOUTS, some, strict=True)
            if row != NO_ROW
        )
        for some in set(rows)
    }
    found: list[tuple[About, ...] | None] = [known[some] for some in rows]
    for row in survey.is_open.nonzero()[0].tolist():
        found[row] = None
    return _of_nobody_held(survey, found)


def _of_nobody_held(survey: Survey, found: list[tuple[About, ...] | None]) -> list[tuple[About, ...] | None]:
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
    return _of_nobody_held(survey, found)


def _may_hold(space: Space, solid: Solid, other: Solid) -> bool:
    """Whether the other may hang on the solid; who may not hang there any more is who that may bear."""
    return solid.is_place or solid.bottom < other.bottom <= solid.top + space.limits.gap_m


def _may_bear(space: Space, solid: Solid, other: Solid) -> bool:
    """Whether the other may be on the solid, inside it or in it."""
    if solid.is_place:
        return True
    limits = space.limits
    gap = limits.gap_m + _ROUNDING
    if other.bottom > solid.top + gap or other.top < solid.bottom - gap:
        return False
    if not (other.is_level and solid.is_level) or (other.volume < solid.volume and solid.hollows):
        return True
    return other.bottom >= solid.bottom - limits.contact_m and other.highest_bottom >= solid.lowest_top - gap


RULES: Final[tuple[Rule, ...]] = (
    Rule(_WHEREABOUTS, _whereabouts, _whereabouts_of_many, _may_bear),
    Rule(
        ("isAttachedTo",), _attachments, _attachments_of_many, _may_hold, lambda limits: limits.attached_m
    ),
)  # fmt: skip

COMPUTED: Final[dict[Term, RelationName]] = {v.dm(name): name for rule in RULES for name in rule.relations}
"""The properties that are computed, where a TBox has them."""
