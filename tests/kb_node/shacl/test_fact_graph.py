"""The facts of a reasoner as a graph of RDFLib."""

import pytest
from rdflib import BNode, Literal, URIRef

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.shacl.fact_graph import fact_graph, representative, to_node, to_term
from semmap.ontology import vocabulary as v
from tests.kb_node.reasoner.graphs import triple, triples

XSD = "http://www.w3.org/2001/XMLSchema#"


@pytest.mark.parametrize(
    ("term", "node"),
    [
        ("<urn:a>", URIRef("urn:a")),
        ("_:b1", BNode("b1")),
        ('"text"', Literal("text", datatype=URIRef(f"{XSD}string"))),
        ('"Text"@de', Literal("Text", lang="de")),
        (
            v.literal("1.00", f"<{XSD}decimal>"),
            Literal("1.00", datatype=URIRef(f"{XSD}decimal"), normalize=False),
        ),
    ],
)
def test_a_term_has_a_node_with_its_spelling(term, node):
    assert to_node(term) == node
    assert str(to_node(term)) == str(node)
    assert to_term(node) == term


def test_equal_individuals_are_one_node():
    reasoner = Reasoner(
        triples(":A rdfs:subClassOf :B . :y a :A ; owl:sameAs :x ; :p :z ; :d 1 . _:n owl:sameAs :z .")
    )
    x, y, z = (triple(f":{name} a :A")[0] for name in "xyz")
    find = representative(reasoner)
    assert [find(term) for term in (x, y, z, '"1"', "<urn:other>")] == [x, x, z, '"1"', "<urn:other>"]
    graph = fact_graph(reasoner)
    found = {(to_term(s), to_term(p), to_term(o)) for s, p, o in graph.triples((to_node(y), None, None))}
    assert found >= {(x, *one[1:]) for one in triples(":x a :A , :B ; :p :z ; :d 1 .")}
    assert {s for s, _, _ in found} == {x}
    assert len(list(graph.triples((None, to_node(triple(":x :p :z")[1]), None)))) == 1
    assert len(graph) == 1
