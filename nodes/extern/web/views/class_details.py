"""A class of the ontology: superclasses, subclasses, axioms, and what uses it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Final, NamedTuple

from semmap.nodes.extern.phrasing import english
from semmap.nodes.extern.web.views.entities.forms import class_choices
from semmap.nodes.kb_node.reasoner.explain.sentences import clauses
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import ClassInfo, Entity, PropertyInfo
from semmap.schemas.explanations import Explanation, Term, Triple

_PARTS: Final = (
    "(owl:intersectionOf|owl:unionOf|owl:complementOf|owl:oneOf|owl:someValuesFrom|owl:allValuesFrom|"
    "owl:onClass|owl:onDataRange|owl:onProperty|owl:inverseOf|owl:onDatatype|owl:withRestrictions|"
    "rdf:first|rdf:rest)"
)
"""The path from an anonymous class to its parts."""
_AXIOMS: Final = "(rdfs:subClassOf|owl:equivalentClass|owl:disjointWith|owl:disjointUnionOf|owl:hasKey)"


class ClassDetails(NamedTuple):
    """What the ontology and the map state about a class, by names of other classes."""

    title: str
    comment: str
    superclasses: tuple[str, ...]
    """The direct ones."""
    inherited: tuple[str, ...]
    """All others."""
    subclasses: tuple[str, ...]
    """The direct ones."""
    properties: tuple[str, ...]
    """The properties with this class as domain or range, a sentence each."""
    asserted: tuple[str, ...]
    inferred: tuple[str, ...]
    """The entities that are inferred to be of this class."""


def axioms_query(class_iri: str) -> str:
    """Return the query for the triples of the axioms about a class, with their anonymous parts."""
    term = v.iri(class_iri)
    return (
        "CONSTRUCT { ?s ?p ?o } WHERE { {"
        f" BIND({term} AS ?s) ?s ?p ?o FILTER(?p IN ({_AXIOMS[1:-1].replace('|', ', ')}))"
        " } UNION {"
        f" {term} {_AXIOMS} ?axiom FILTER(isBlank(?axiom)) ?axiom {_PARTS}* ?s FILTER(isBlank(?s))"
        " ?s ?p ?o FILTER(?p != rdf:type) } }"
    )


def users_query(class_iri: str) -> str:
    """Return the query for the classes whose axioms mention a class in an anonymous class."""
    return (
        "SELECT DISTINCT ?user WHERE {"
        " ?user (rdfs:subClassOf|owl:equivalentClass) ?axiom FILTER(isIRI(?user) && isBlank(?axiom))"
        f" ?axiom {_PARTS}+ {v.iri(class_iri)} }} ORDER BY ?user"
    )


def axiom_sentences(triples: Iterable[Triple], superclasses: Iterable[Term], words: Words) -> tuple[str, ...]:
    """Return the axioms about a class as sentences, without those about its named superclasses."""
    triples, named = list(triples), set(superclasses)
    found = clauses(triples, triples, words)
    texts = [
        clause.text
        for (_, predicate, object_), clause in found.items()
        if clause.is_axiom and not (predicate == v.RDFS_SUB_CLASS_OF and object_ in named)
    ]
    return tuple(sorted(dict.fromkeys(texts), key=str.casefold))


def class_names(rows: Iterable[Sequence[Term | None]], classes: Iterable[ClassInfo]) -> tuple[str, ...]:
    """Return the names of the classes in the first column of a result."""
    names = {v.iri(c.iri): c.name for c in classes}
    return tuple(names[row[0]] for row in rows if row and row[0] in names)


def class_options(classes: Iterable[ClassInfo], chosen: str) -> dict[str, str]:
    """Return the classes to choose from with their labels: those of physical things, and the chosen one."""
    classes = tuple(classes)
    options = class_choices(classes)
    if any(known.name == chosen for known in classes):
        options.setdefault(chosen, chosen)
    return options


def is_unsatisfiable(known: ClassInfo, proof: Explanation | None) -> bool:
    """Return whether a proof that a new entity makes the map inconsistent uses its class and axioms only.

    A proof with any other fact, such as the size of the entity or another entity, holds for this map only.
    """
    if proof is None:
        return False
    facts = [triple for triple in proof.support if not is_schema(triple)]
    return len(facts) <= 1 and all(fact[1:] == (v.RDF_TYPE, v.iri(known.iri)) for fact in facts)


def clash_sentence(known: ClassInfo, clash: errors.Inconsistent, commit: int) -> str:
    """Return the sentence about a class of which the map could not have another entity after a commit."""
    if is_unsatisfiable(known, clash.explanation):
        return "Unsatisfiable: an entity of this class contradicts the ontology."
    return f"An entity of this class cannot be added to this map (as of commit {commit}): {clash.text}"


def class_details(
    name: str,
    classes: Mapping[str, ClassInfo],
    properties: Iterable[PropertyInfo],
    entities: Iterable[Entity],
) -> ClassDetails:
    """Return what is known of a class without a request."""
    known = classes[name]
    asserted, inferred = [], []
    for entity in entities:
        if entity.class_ == name:
            asserted.append(entity.name)
        elif name in entity.types:
            inferred.append(entity.name)
    return ClassDetails(
        title=english(known.labels) or name,
        comment=known.comment,
        superclasses=tuple(sorted(known.parents)),
        inherited=tuple(sorted(set(known.ancestors) - {*known.parents, name})),
        subclasses=tuple(sorted(c.name for c in classes.values() if name in c.parents)),
        properties=tuple(sorted(_uses(name, properties))),
        asserted=tuple(sorted(asserted)),
        inferred=tuple(sorted(inferred)),
    )


def _uses(name: str, properties: Iterable[PropertyInfo]) -> Iterable[str]:
    for known in properties:
        roles = [role for role, names in (("domain", known.domain), ("range", known.range)) if name in names]
        if roles:
            yield f"{known.name}: {' and '.join(roles)}"
