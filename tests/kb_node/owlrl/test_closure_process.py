"""The graph for owlrl behaves like an rdflib graph."""

import rdflib
from rdflib import RDF, Literal, URIRef
from rdflib.paths import OneOrMore

from semmap.nodes.kb_node.owlrl.closure_process import QuickGraph

A, B, C, P = (URIRef(f"urn:{name}") for name in "abcp")


def test_it_contains_the_same_triples_as_an_rdflib_graph():
    quick, plain = QuickGraph(), rdflib.Graph()
    for graph in (quick, plain):
        graph.add((A, P, B))
        graph.addN([(B, P, C, graph), (C, P, Literal(1), graph)])
        graph.parse(data="<urn:a> a <urn:C> . <urn:b> a <urn:C> .", format="turtle")
        graph.remove((B, None, None))
        graph.add((B, P, A))
    assert set(quick) == set(plain)
    asked = [(s, p, o) for s in (A, B, C, None) for p in (P, RDF.type, None) for o in (A, B, C, None)]
    asked += [(A, P * OneOrMore, A), (C, P, Literal(1)), (C, P, Literal("1"))]
    assert [triple in quick for triple in asked] == [triple in plain for triple in asked]
