"""Resolution of words in queries to terms: names, labels, prefixed names, IRIs and literals."""

from __future__ import annotations

from typing import Final

from semmap.nodes.kb_node.entities import property_values
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.data_ranges import read_common
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.sparql.queries.text import query_prefixes
from semmap.ontology import prefixes
from semmap.ontology import vocabulary as v
from semmap.ontology.name_index import Ambiguous
from semmap.schemas import errors
from semmap.schemas.entities import composed
from semmap.schemas.explanations import Term

RELATIONS: Final = {
    "a": v.RDF_TYPE,
    "type": v.RDF_TYPE,
    "sameas": v.OWL_SAME_AS,
    "differentfrom": v.OWL_DIFFERENT_FROM,
    "subclassof": v.RDFS_SUB_CLASS_OF,
    "equivalentclass": v.iri(f"{v.OWL}equivalentClass"),
    "disjointwith": v.iri(f"{v.OWL}disjointWith"),
}
"""Relations that every map has in addition to the properties of its TBox, in lower case."""
OF_CLASSES: Final = frozenset(RELATIONS.values()) - {v.OWL_SAME_AS, v.OWL_DIFFERENT_FROM}
"""Relations whose value is a class."""
_VOCABULARY: Final = tuple(f"<{namespace}" for namespace in (v.OWL, v.RDF, v.RDFS, v.XSD))


def resolve_class(semantic_map: SemanticMap, word: str) -> Term:
    """Return the class that a word means. Raises UnknownClass."""
    classes = semantic_map.classes
    if word in classes.iris:
        return classes.iris[word]
    try:
        name = classes.index.find(word)
    except Ambiguous as error:
        raise errors.UnknownClass(f"'{word}' is ambiguous: {error}; say which class") from None
    if name is None:
        hint = classes.index.did_you_mean(word) or "; see: semmap classes"
        raise errors.UnknownClass(f"unknown class '{word}'{hint}")
    return classes.iris[name]


def _class_or_built_in(semantic_map: SemanticMap, word: str) -> Term:
    """Return a class of the TBox or of the OWL vocabulary (`owl:Thing`). Raises UnknownClass."""
    found = parse_term(semantic_map, word)
    return found if found is not None and found.startswith(_VOCABULARY) else resolve_class(semantic_map, word)


def parse_term(semantic_map: SemanticMap, word: str) -> Term | None:
    """Return a term that is written as such or with a known prefix, or None for another word."""
    prefix, colon, name = word.partition(":")
    if word.startswith(("<", '"', "_:")):
        return word
    known = query_prefixes(semantic_map.classes.prefixes)
    return v.iri(known[prefix] + name) if colon and prefix in known else None


def resolve_individual(semantic_map: SemanticMap, word: str) -> Term:
    """Return an entity, another individual or a class that the map or its TBox names.

    An entity may be given by a label or class that no other has. Raises UnknownName; BadRequest for an
    ambiguous word.
    """
    if (entity := semantic_map.find(composed(word))) is not None:
        return v.iri(entity.iri)
    reasoner = semantic_map.reasoner
    if (found := parse_term(semantic_map, word)) is not None:
        if reasoner.mentioned({found}):
            return found
    else:
        for usual in (v.entity_iri(word), v.dm(word), v.iri(word)):
            if reasoner.mentioned({usual}):
                return usual
        namespaces = semantic_map.classes.prefixes
        there = reasoner.mentioned({v.iri(namespace + word) for namespace in namespaces.values()})
        if len(there) > 1:
            names = sorted(prefixes.prefixed(term, namespaces) for term in there)
            raise errors.BadRequest(f"'{word}' is ambiguous: {errors.enumerated(names)}; say which")
        if there:
            return there.pop()
    iri = v.iri(semantic_map.resolve(composed(word)).iri)
    same = (one for one in reasoner.equals(iri) if v.entity_name(one) == composed(word))
    return next(same, iri)  # the individual of that name, of those that the entity is


def resolve_end(semantic_map: SemanticMap, predicate: Term, word: str) -> Term:
    """Return the individual or class that is the subject or object of a statement.

    The name of a class means its only entity if the statement relates individuals. Raises UnknownName;
    BadRequest for an ambiguous word.
    """
    may_be_class = predicate in RELATIONS.values() or _is_data(semantic_map.reasoner, predicate)
    if word in semantic_map.classes.iris and not may_be_class:
        return v.iri(semantic_map.resolve(composed(word)).iri)
    return resolve_individual(semantic_map, word)


def resolve_property(semantic_map: SemanticMap, word: str) -> Term:
    """Return the property that a word means: a name, a label, an IRI or one of RELATIONS.

    Raises BadRequest.
    """
    relation = RELATIONS.get(word.casefold())
    if relation is not None:
        return relation
    if (found := parse_term(semantic_map, word)) is not None:
        return found
    names = semantic_map.classes.property_names
    if (known := names.find(word)) is None:
        hint = names.did_you_mean(word) or "; use type or a property of the TBox"
        raise errors.BadRequest(f"unknown property '{word}'{hint}")
    return known


def resolve_values(semantic_map: SemanticMap, subject: Term, predicate: Term, word: str) -> list[Term]:
    """Return the terms that `word` may stand for as the object of this subject and predicate."""
    if predicate in OF_CLASSES and not word.startswith("_:"):
        return [_class_or_built_in(semantic_map, word)]
    if (found := parse_term(semantic_map, word)) is not None:
        return [found]
    if predicate in RELATIONS.values():
        return [resolve_individual(semantic_map, word)]
    held = (
        *semantic_map.reasoner.asserted(subject, predicate),
        *semantic_map.reasoner.inferred(subject, predicate),
    )
    named = [o for _, _, o in held if (v.lexical(o) if o.startswith('"') else v.entity_name(o)) == word]
    return named or [resolve_value(semantic_map, predicate, word)]


def resolve_value(semantic_map: SemanticMap, predicate: Term, word: str) -> Term:
    """Return an individual, or a literal of the property's range. Raises UnknownName, BadRequest."""
    if predicate in OF_CLASSES and not word.startswith("_:"):
        return _class_or_built_in(semantic_map, word)
    if (found := parse_term(semantic_map, word)) is not None:
        return found
    if _is_data(semantic_map.reasoner, predicate):
        return _literal(semantic_map, predicate, word)
    return resolve_end(semantic_map, predicate, word)


def _is_data(reasoner: Reasoner, predicate: Term) -> bool:
    kinds = (v.OWL_DATATYPE_PROPERTY, v.OWL_ANNOTATION_PROPERTY)
    return any(reasoner.holds((predicate, v.RDF_TYPE, kind)) for kind in kinds)


def _literal(semantic_map: SemanticMap, predicate: Term, text: str) -> Term:
    """Return the literal for `text`, as `set` reads it; a plain string if the property has no range."""
    table = semantic_map.classes.property_table
    if (known := table.by_iri.get(predicate)) is not None:
        return property_values.literal(known.name, known.data_range, text)
    data_range = read_common(table.ranges(predicate), semantic_map.reasoner.asserted)
    if data_range is None:
        return v.literal(text)
    return property_values.literal(v.local_name(predicate), data_range, text)
