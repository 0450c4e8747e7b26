"""The facts of a reasoner as an RDFLib graph, without a copy of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Any, cast

from rdflib import BNode, Graph, Literal, URIRef
from rdflib.store import Store
from rdflib.term import IdentifiedNode, Node

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

Pattern = tuple[Node | None, Node | None, Node | None]


@lru_cache(maxsize=1 << 16)
def to_node(term: Term) -> IdentifiedNode | Literal:
    """Return the RDFLib node of a term, with the spelling of literals."""
    if term.startswith("<"):
        return URIRef(v.bare(term))
    if term.startswith("_:"):
        return BNode(term[2:])
    language = v.language_of(term)
    datatype = None if language is not None else URIRef(v.bare(v.datatype_of(term)))
    return Literal(v.lexical(term), datatype=datatype, lang=language, normalize=False)


def to_term(node: Node) -> Term:
    """Return the term of an RDFLib node."""
    if isinstance(node, Literal):
        datatype = None if node.datatype is None else v.iri(str(node.datatype))
        return v.literal(str(node), None if datatype == v.XSD_STRING else datatype, node.language)
    return f"_:{node}" if isinstance(node, BNode) else v.iri(str(node))


def fact_graph(reasoner: Reasoner) -> Graph:
    """Return a graph of all that holds: asserted, inferred and computed facts.

    It shows the facts as they are when it is read. Equal individuals are one node.
    """
    return Graph(store=cast(Any, _FactStore)(reasoner))


def representative(reasoner: Reasoner) -> Callable[[Term], Term]:
    """Return a function from an individual to the name under which a `fact_graph` contains it."""

    def find(term: Term) -> Term:
        equals = () if term.startswith('"') else reasoner.equals(term)
        return min(equals, default=term, key=lambda one: (one.startswith("_:"), one))

    return find


class _FactStore(Store):
    """Answers patterns from a reasoner; nothing can be added."""

    def __init__(self, reasoner: Reasoner) -> None:
        super().__init__()
        self._reasoner = reasoner
        self._find = representative(reasoner)

    def triples(self, pattern: Pattern, context: Any = None) -> Iterator[Any]:
        """Yield the facts of a pattern, each once."""
        s, p, o = (None if node is None else to_term(node) for node in pattern)
        found = dict[Triple, None]()
        for subject, predicate, value in (*self._reasoner.given(s, p, o), *self._reasoner.inferred(s, p, o)):
            found[self._find(subject), predicate, self._find(value)] = None
        for fact in found:
            yield tuple(map(to_node, fact)), iter(())

    def __len__(self, context: Any = None) -> int:
        """Return 1. pySHACL only asks whether there is a fact, and counting all of them would take long."""
        return 1
