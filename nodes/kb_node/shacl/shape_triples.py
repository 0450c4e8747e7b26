"""The statements of a document that define SHACL shapes, and those of SHACL that are not evaluated."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from typing import Final

from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

SHACL: Final = "http://www.w3.org/ns/shacl#"
_PREFIX: Final = f"<{SHACL}"
_SHAPES: Final = {v.iri(f"{SHACL}NodeShape"), v.iri(f"{SHACL}PropertyShape")}
_OF_SHAPES: Final = frozenset(
    v.iri(SHACL + name)
    for name in ("property", "targetClass", "targetNode", "targetSubjectsOf", "targetObjectsOf")
)
"""Properties of shapes, which need no type."""
PATTERNS_OF_SHAPES: Final[tuple[tuple[Term, Term | None], ...]] = (
    *((p, None) for p in sorted(_OF_SHAPES)),
    *((v.RDF_TYPE, o) for o in sorted(_SHAPES)),
)
"""Properties and values of the triples by which `find_shapes` finds shapes; None stands for any value."""
REFERENCES: Final = frozenset(
    (
        v.RDF_FIRST,
        v.RDF_REST,
        *(
            v.iri(SHACL + name)
            for name in ("property", "node", "not", "qualifiedValueShape", "and", "or", "xone")
        ),
    )
)
"""Properties from a shape, or a list of shapes, to another one."""
COMPARISONS: Final = frozenset(
    v.iri(SHACL + name) for name in ("equals", "disjoint", "lessThan", "lessThanOrEquals")
)
"""Constraints that compare the values of a path with those of another property."""
CLOSED: Final = v.iri(f"{SHACL}closed")
TARGETED_VALUES: Final = v.iri(f"{SHACL}targetObjectsOf")
_UNSUPPORTED: Final = {
    v.iri(SHACL + name): kind
    for name, kind in (
        ("rule", "SHACL rule"),
        ("sparql", "SHACL SPARQL constraint"),
        ("validator", "SHACL constraint component"),
        ("nodeValidator", "SHACL constraint component"),
        ("propertyValidator", "SHACL constraint component"),
        ("target", "SHACL custom target"),
        ("js", "SHACL JavaScript constraint"),
        ("expression", "SHACL expression constraint"),
    )
}
"""Properties that need SPARQL, JavaScript or the advanced features. SPARQL could read other servers."""


def find_shapes(triples: Iterable[Triple]) -> set[Term]:
    """Return the nodes that have the type or a property of a shape."""
    return {s for s, p, o in triples if p in _OF_SHAPES or (p == v.RDF_TYPE and o in _SHAPES)}


def find_unsupported(triples: Iterable[Triple]) -> set[tuple[str, Term]]:
    """Return the constraints and rules of SHACL that are not evaluated, each with its kind."""
    return {
        (kind, s if "component" in kind else o)
        for s, p, o in triples
        if (kind := _UNSUPPORTED.get(p)) is not None
    }


def find_cycle(triples: Iterable[Triple]) -> list[Term]:
    """Return shapes, and lists of shapes, each of which refers to the next, and the last to the first.

    The recommendation leaves open whether an individual conforms to such a shape.
    """
    references: dict[Term, set[Term]] = {}
    for s, p, o in triples:
        if p in REFERENCES:
            references.setdefault(s, set()).add(o)
    try:
        TopologicalSorter(references).prepare()
    except CycleError as error:
        found: list[Term] = error.args[1]
        return found
    return []


def read_list(node: Term, values: Mapping[tuple[Term, Term], Term]) -> Iterator[Term]:
    """Yield the members of an RDF list. `values` has the triples of lists, by subject and property."""
    seen = set[Term]()
    while node not in seen and (node, v.RDF_FIRST) in values:
        seen.add(node)
        yield values[node, v.RDF_FIRST]
        node = values.get((node, v.RDF_REST), v.RDF_NIL)


def select_shapes(triples: Iterable[Triple]) -> list[Triple]:
    """Return the statements that define shapes, without those that are not evaluated."""
    triples = list(triples)
    shapes = find_shapes(triples)
    return [
        (s, p, o)
        for s, p, o in triples
        if (p.startswith(_PREFIX) and p not in _UNSUPPORTED)
        or p in (v.RDF_FIRST, v.RDF_REST)
        or (p == v.RDF_TYPE and (o in _SHAPES or (s in shapes and o in (v.OWL_CLASS, v.RDFS_CLASS))))
    ]
