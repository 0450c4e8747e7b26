"""What the knowledge base answers to the questions of `semmap/bridge`: pure functions of the map."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from nodes.kb_node.documents import rdf
from nodes.kb_node.owlrl.second_opinion import owlrl_faults
from nodes.kb_node.reasoner import Inconsistent, Reasoner
from nodes.kb_node.semantic_map import SemanticMap
from nodes.kb_node.sparql.text import PREFIXES
from ontology import vocabulary as v
from schemas import errors
from schemas.commands import Explain, RdfFormat
from schemas.entities import Entity
from schemas.explanations import Explanation, Term, Triple
from schemas.replies import Checked, Document, Inferred


def entities_of(semantic_map: SemanticMap, class_name: str | None) -> tuple[Entity, ...]:
    """The entities of a class, given by its exact name. Raises UnknownClass."""
    return tuple(semantic_map.entities(_class_iri(semantic_map, class_name) if class_name else None))


def infer(semantic_map: SemanticMap, name: str | None) -> Inferred:
    """What follows that was not said, without what is true of everything or of nameless classes."""
    triples = tuple(worth_saying(semantic_map.inferred(name)))
    return Inferred(triples=triples, text=tuple(v.spoken(t) for t in triples))


def worth_saying(triples: Iterable[Triple]) -> Iterator[Triple]:
    """Without what is true of everything or of nameless classes."""
    return (
        (s, p, o)
        for s, p, o in triples
        if not s.startswith('"')
        and o != v.OWL_THING
        and (p, s) != (v.OWL_SAME_AS, o)
        and not (p == v.RDF_TYPE and o.startswith("_:"))
    )


def explain(semantic_map: SemanticMap, question: Explain) -> Explanation:
    """Why a triple holds. Raises UnknownName, BadRequest for an unknown word, Refused if it does not hold."""
    subject = _subject(semantic_map, question.name)
    predicate = _predicate(semantic_map, question.predicate)
    for value in _values(semantic_map, subject, predicate, question.value):
        explanation = semantic_map.reasoner.explain((subject, predicate, value))
        if explanation is not None:
            return explanation
    relation = "is of class" if predicate == v.RDF_TYPE else question.predicate
    raise errors.Refused(f"it does not hold that {question.name} {relation} {question.value}")


class Picture(NamedTuple):
    """The map at one moment, for work beside it: what is asserted, and what of it to write."""

    asserted: list[Triple]
    written: list[Triple]
    seq: int


def picture(semantic_map: SemanticMap, inferred: bool) -> Picture:
    """The map as it is now, to be written: the ABox and, if `inferred`, what follows about those in it."""
    abox = semantic_map.abox()
    following: list[Triple] = []
    if inferred:
        individuals = {s for s, _, _ in abox} | {o for _, p, o in abox if p != v.RDF_TYPE}
        for individual in individuals - {s for s, _, _ in semantic_map.tbox}:
            following += worth_saying(semantic_map.reasoner.inferred(individual, None, None))
    return Picture([*semantic_map.tbox, *abox], abox + following, semantic_map.seq)


def export(picture: Picture, syntax: RdfFormat) -> Document:
    """The map as a document. Raises Inconsistent, or Refused for a text that the syntax cannot hold."""
    checked = check(picture.asserted, "semmap")
    if not checked.consistent:
        raise errors.Inconsistent(checked.text, explanation=checked.explanation)
    return Document(
        content=rdf.serialise(picture.written, syntax),
        media_type=rdf.MEDIA_TYPES[syntax],
        triples=len(picture.written),
        seq=picture.seq,
    )


def check(triples: Iterable[Triple], engine: str) -> Checked:
    """Are the triples (TBox and ABox) consistent? Worked out from nothing, so that it is a check."""
    triples = list(triples)
    start = time.perf_counter()
    explanation = None
    if engine == "owlrl":
        faults = owlrl_faults(triples)
        reason = "; ".join(faults)
    else:
        try:
            Reasoner(triples)
        except Inconsistent as error:
            explanation = error.explanation
        reason = explanation.text if explanation else ""
    return Checked(
        consistent=not reason,
        engine=engine,
        triples=len(triples),
        elapsed_s=round(time.perf_counter() - start, 4),
        text=f"inconsistent: {reason}" if reason else "consistent",
        explanation=explanation,
    )


def _class_iri(semantic_map: SemanticMap, name: str) -> Term:
    iris = semantic_map.classes.iris
    if name not in iris:
        raise errors.UnknownClass(f"unknown class '{name}'{errors.did_you_mean(name, iris)}")
    return iris[name]


def _term(word: str) -> Term | None:
    """A term as it is written, or a name with a prefix that queries know; None for another word."""
    prefix, colon, name = word.partition(":")
    if word.startswith(("<", '"', "_:")):
        return word
    return v.iri(PREFIXES[prefix] + name) if colon and prefix in PREFIXES else None


def _subject(semantic_map: SemanticMap, word: str) -> Term:
    """An entity, or another individual or a class that the map or its TBox names. Raises UnknownName."""
    if (entity := semantic_map.find(word)) is not None:
        return v.iri(entity.iri)
    others = (term,) if (term := _term(word)) is not None else (v.entity_iri(word), v.dm(word))
    for known in others:
        if semantic_map.reasoner.mentioned({known}):
            return known
    return v.iri(semantic_map.entity(word).iri)


def _predicate(semantic_map: SemanticMap, word: str) -> Term:
    if word in ("a", "type"):
        return v.RDF_TYPE
    if (term := _term(word)) is not None:
        return term
    kinds = (v.OWL_OBJECT_PROPERTY, v.OWL_DATATYPE_PROPERTY, v.OWL_ANNOTATION_PROPERTY)
    names = {
        v.local_name(p): p
        for kind in kinds
        for p, _, _ in semantic_map.reasoner.asserted(None, v.RDF_TYPE, kind)
    }
    if word not in names:
        hint = errors.did_you_mean(word, names) or "; there are type and the properties of the TBox"
        raise errors.BadRequest(f"unknown property '{word}'{hint}")
    return names[word]


def _values(semantic_map: SemanticMap, subject: Term, predicate: Term, word: str) -> list[Term]:
    """The terms that `word` may stand for as the object of this subject and predicate."""
    if (term := _term(word)) is not None:
        return [term]
    if predicate == v.RDF_TYPE:
        return [_class_iri(semantic_map, word)]
    held = (
        *semantic_map.reasoner.asserted(subject, predicate),
        *semantic_map.reasoner.inferred(subject, predicate),
    )
    named = [o for _, _, o in held if (v.lexical(o) if o.startswith('"') else v.local_name(o)) == word]
    return named or [v.entity_iri(word)]
