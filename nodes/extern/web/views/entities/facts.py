"""The facts about one entity in three groups: asserted, inferred and computed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple

from semmap.nodes.extern.phrasing import english
from semmap.nodes.kb_node.reasoner.explain.sentences import triple_clause
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.ontology import vocabulary as v
from semmap.schemas.changes import value_in_words
from semmap.schemas.entities import Entity, PropertyInfo, Value
from semmap.schemas.explanations import Triple
from semmap.schemas.relations import FACTS, PHRASES, Relation

_MEASURED: Final = frozenset(map(v.dm, PHRASES)) - {v.dm("isLocatedIn")}
"""Properties that are only computed from poses; `isLocatedIn` can also be inferred."""
_NEAR: Final = v.dm("isNear")
_PARTS: Final = frozenset(
    (
        *map(v.dm, ("hasReference", "hasPosition", "hasSize")),
        *(v.HAS_PREFERRED_REFERENCE, v.HAS_ALTERNATIVE_REFERENCE),
    )
)
"""Predicates of the entity triples that other parts of the details show."""


class ExplainArgs(NamedTuple):
    """Arguments of `explain` for a fact."""

    name: str
    predicate: str
    value: str


class Fact(NamedTuple):
    """One fact, in words."""

    text: str
    why: ExplainArgs | None = None
    """The request for its explanation; None if there is no explanation."""
    other: str = ""
    """The name of the other entity in the fact."""
    measured: str = ""
    """The measurement in words."""
    removable: tuple[str, Value] | None = None
    """The asserted property and value, if they can be unset."""


class Facts(NamedTuple):
    """The three groups."""

    asserted: tuple[Fact, ...]
    inferred: tuple[Fact, ...]
    computed: tuple[Fact, ...]


def group_facts(
    entity: Entity,
    properties: Mapping[str, PropertyInfo],
    follows: Iterable[Triple],
    relations: Iterable[Relation],
    words: Words,
) -> Facts:
    """Return the facts from the replies to `infer` (`follows`) and `relations`."""
    follows, relations = tuple(follows), tuple(relations)
    next_to = {frozenset((r.subject, r.object)) for r in relations if r.relation == "isNextTo"}
    relations = tuple(
        r for r in relations if r.relation != "isNear" or frozenset((r.subject, r.object)) not in next_to
    )
    measured = {(v.entity_iri(r.subject), v.dm(r.relation), v.entity_iri(r.object)) for r in relations}
    rest = [t for t in follows if t not in measured and (t[2], t[1], t[0]) not in measured]
    rest = [t for t in rest if t[1] != _NEAR or frozenset(map(v.entity_name, (t[0], t[2]))) not in next_to]
    others = [t for t in rest if t[1] in _MEASURED and t[2].startswith("<")]
    return Facts(
        asserted_facts(entity, properties),
        inferred_facts(entity, (t for t in rest if t not in others), words, properties),
        (*computed_facts(entity, relations), *inferred_facts(entity, others, words, properties)),
    )


def exclude_asserted(entity: Entity, triples: Iterable[Triple]) -> tuple[Triple, ...]:
    """Return those of the triples of an entity that were not asserted."""
    asserted = {(v.local_name(v.RDF_TYPE), entity.class_)}
    for property_, stated in entity.properties.items():
        for value in stated if isinstance(stated, tuple) else (stated,):
            asserted.add((property_, value_in_words(value)))

    def is_asserted(triple: Triple) -> bool:
        _, predicate, value = triple
        stated = (v.local_name(predicate), _value_text(triple))
        return predicate in _PARTS or value == v.OWL_THING or stated in asserted

    return tuple(triple for triple in triples if not is_asserted(triple))


def _value_text(triple: Triple) -> str:
    """Return the value of a triple as commands read it: a literal, a class or the name of an individual."""
    _, predicate, value = triple
    if value.startswith('"'):
        return v.lexical(value)
    return v.local_name(value) if predicate == v.RDF_TYPE else v.entity_name(value)


def asserted_facts(entity: Entity, properties: Mapping[str, PropertyInfo]) -> tuple[Fact, ...]:
    """Return the class and the asserted properties, with their labels."""
    name = entity.name
    found = [Fact(f"class: {entity.class_}", ExplainArgs(name, "type", entity.class_))]
    for property_, stated in entity.properties.items():
        known = properties.get(property_)
        label = english(known.labels) if known is not None else property_
        for value in stated if isinstance(stated, tuple) else (stated,):
            text = value_in_words(value)
            value_label = known.values.get(str(value), "") if known is not None else ""
            is_name = known is not None and known.kind == "object"
            found.append(
                Fact(
                    f"{label or property_}: {value_label or text}",
                    ExplainArgs(name, property_, text),
                    other=text if is_name and not value_label else "",
                    removable=(property_, value),
                )
            )
    return tuple(found)


def inferred_facts(
    entity: Entity, follows: Iterable[Triple], words: Words, properties: Mapping[str, PropertyInfo]
) -> tuple[Fact, ...]:
    """Return the inferred facts that are not computed: classes first, then by text."""
    name = entity.name
    found: list[tuple[bool, str, Fact]] = []
    for triple in follows:
        subject, predicate, value = triple
        if v.entity_name(subject) != name or predicate in _PARTS:
            continue
        is_class = predicate == v.RDF_TYPE
        text = triple_clause(triple, words).removeprefix(f"{name} ")
        args = ExplainArgs(name, v.local_name(predicate), _value_text(triple))
        known = properties.get(args.predicate)
        if known is not None and (value_label := known.values.get(args.value, "")):
            text = f"{english(known.labels) or known.name} {value_label}"
        other = "" if is_class or value.startswith('"') else v.entity_name(value)
        found.append((not is_class, text, Fact(text, args, other=other)))
    return tuple(fact for *_, fact in sorted(found, key=lambda item: item[:2]))


def computed_facts(entity: Entity, relations: Iterable[Relation]) -> tuple[Fact, ...]:
    """Return the computed relations with their measurements, also those with the entity as object."""
    found = []
    for relation in relations:
        is_subject = relation.subject == entity.name
        clause, _, measured = relation.text.partition(": ")
        text = clause.removeprefix(f"{entity.name} ") if is_subject else clause
        other = relation.object if is_subject else relation.subject
        is_fact = relation.holds and relation.relation in FACTS and bool(relation.object)
        why = ExplainArgs(relation.subject, relation.relation, relation.object) if is_fact else None
        found.append(Fact(text, why, other=other, measured=measured))
    return tuple(found)
