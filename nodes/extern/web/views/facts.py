"""What holds of one thing, in three groups: what somebody said, what follows, and what is measured."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple, get_args

from semmap.nodes.extern.phrasing import english
from semmap.nodes.kb_node.reasoner.explain.sentences import triple_clause
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.ontology import vocabulary as v
from semmap.schemas.changes import value_in_words
from semmap.schemas.entities import Entity, PropertyInfo, Value
from semmap.schemas.explanations import Triple
from semmap.schemas.relations import Relation, RelationName

_MEASURED: Final = frozenset(v.dm(name) for name in get_args(RelationName)) - {v.dm("isLocatedIn")}
"""Properties that poses tell; where a thing is located also follows from where others are."""
_NEAR: Final = v.dm("isNear")
_PARTS: Final = frozenset(
    (
        *map(v.dm, ("hasReference", "hasPosition", "hasSize")),
        *(v.HAS_PREFERRED_REFERENCE, v.HAS_ALTERNATIVE_REFERENCE),
    )
)
"""Predicates of the parts of a star, which the rest of the detail shows."""
_VIEWER: Final = frozenset(("isLeftOf", "isRightOf", "isInFrontOf", "isBehind", "isBetween", "isVisibleFrom"))
"""Relations that are no facts of the map: they depend on who looks, or are of three things."""


class Question(NamedTuple):
    """What `explain` is asked to tell why something holds."""

    name: str
    predicate: str
    value: str


class Fact(NamedTuple):
    """One fact, in words."""

    text: str
    why: Question | None = None
    """How to ask why it holds; None where there is nothing to ask."""
    other: str = ""
    """Another entity that it is about."""
    measured: str = ""
    """What was measured, in words."""
    taken_back: tuple[str, Value] | None = None
    """The property and value that were stated, where they can be unset."""


class Facts(NamedTuple):
    """The three groups."""

    asserted: tuple[Fact, ...]
    inferred: tuple[Fact, ...]
    computed: tuple[Fact, ...]


def facts(
    entity: Entity,
    properties: Mapping[str, PropertyInfo],
    follows: Iterable[Triple],
    relations: Iterable[Relation],
    words: Words,
) -> Facts:
    """`follows` is what `infer` answers, and `relations` what the command of that name does."""
    follows, relations = tuple(follows), tuple(relations)
    beside = {frozenset((r.subject, r.object)) for r in relations if r.relation == "isNextTo"}
    relations = tuple(
        r for r in relations if r.relation != "isNear" or frozenset((r.subject, r.object)) not in beside
    )
    told = {(v.entity_iri(r.subject), v.dm(r.relation), v.entity_iri(r.object)) for r in relations}
    rest = [t for t in follows if t not in told and (t[2], t[1], t[0]) not in told]
    rest = [t for t in rest if t[1] != _NEAR or frozenset(map(v.entity_name, (t[0], t[2]))) not in beside]
    untold = [t for t in rest if t[1] in _MEASURED and t[2].startswith("<")]
    return Facts(
        asserted(entity, properties),
        inferred(entity, (t for t in rest if t not in untold), words, properties),
        (*computed(entity, relations), *inferred(entity, untold, words, properties)),
    )


def followed(entity: Entity, held: Iterable[Triple]) -> tuple[Triple, ...]:
    """Of all that held of an entity, what had not been said of it."""
    said = {(v.local_name(v.RDF_TYPE), entity.class_)}
    for property_, stated in entity.properties.items():
        for value in stated if isinstance(stated, tuple) else (stated,):
            said.add((property_, value_in_words(value)))

    def is_said(triple: Triple) -> bool:
        _, predicate, value = triple
        text = v.lexical(value) if value.startswith('"') else v.local_name(value)
        return predicate in _PARTS or value == v.OWL_THING or (v.local_name(predicate), text) in said

    return tuple(triple for triple in held if not is_said(triple))


def asserted(entity: Entity, properties: Mapping[str, PropertyInfo]) -> tuple[Fact, ...]:
    """The class, and the properties that were stated, with labels."""
    name = entity.name
    found = [Fact(f"class: {entity.class_}", Question(name, "type", entity.class_))]
    for property_, stated in entity.properties.items():
        known = properties.get(property_)
        label = english(known.labels) if known is not None else property_
        for value in stated if isinstance(stated, tuple) else (stated,):
            spoken = value_in_words(value)
            called = known.values.get(str(value), "") if known is not None else ""
            is_name = known is not None and known.kind == "object"
            found.append(
                Fact(
                    f"{label or property_}: {called or spoken}",
                    Question(name, property_, spoken),
                    other=spoken if is_name and not called else "",
                    taken_back=(property_, value),
                )
            )
    return tuple(found)


def inferred(
    entity: Entity, follows: Iterable[Triple], words: Words, properties: Mapping[str, PropertyInfo]
) -> tuple[Fact, ...]:
    """What follows of it, without what is measured: classes first, then the rest, in the order of words."""
    name = entity.name
    found: list[tuple[bool, str, Fact]] = []
    for triple in follows:
        subject, predicate, value = triple
        if v.entity_name(subject) != name or predicate in _PARTS:
            continue
        is_class = predicate == v.RDF_TYPE
        text = triple_clause(triple, words).removeprefix(f"{name} ")
        known = properties.get(v.local_name(predicate))
        if known is not None and (called := known.values.get(v.local_name(value), "")):
            text = f"{english(known.labels) or known.name} {called}"
        if value.startswith('"'):
            question = Question(name, v.local_name(predicate), v.lexical(value))
        else:
            question = Question(name, v.local_name(predicate), v.local_name(value))
        other = "" if is_class or value.startswith('"') else v.entity_name(value)
        found.append((not is_class, text, Fact(text, question, other=other)))
    return tuple(fact for *_, fact in sorted(found, key=lambda item: item[:2]))


def computed(entity: Entity, relations: Iterable[Relation]) -> tuple[Fact, ...]:
    """What is measured of it, with the measurement; what it bears as well."""
    found = []
    for relation in relations:
        is_subject = relation.subject == entity.name
        clause, _, measured = relation.text.partition(": ")
        text = clause.removeprefix(f"{entity.name} ") if is_subject else clause
        other = relation.object if is_subject else relation.subject
        is_asked = relation.holds and relation.relation not in _VIEWER and bool(relation.object)
        why = Question(relation.subject, relation.relation, relation.object) if is_asked else None
        found.append(Fact(text, why, other=other, measured=measured))
    return tuple(found)
