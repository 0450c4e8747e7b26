"""What goes when something is deleted, where conclusions rest on one another in circles."""

import pytest

from nodes.kb_node.reasoner import Reasoner
from nodes.kb_node.reasoner.terms import TYPE
from tests.kb_node.reasoner.graphs import triples

X, A, B = (f"<http://example.org/{name}>" for name in "xAB")
CIRCLE = """
    :A rdfs:subClassOf :B ,
        [ a owl:Restriction ; owl:onProperty :p ; owl:allValuesFrom :B ] ,
        [ a owl:Restriction ; owl:onProperty :p ; owl:hasValue :a ] .
    :B rdfs:subClassOf :A .
"""
"""Whoever is an A has p to a, which thereby is one itself, and so has p to itself."""


@pytest.mark.parametrize("classes", [[A], [B], [A, B]])
def test_a_circle_of_conclusions_goes_with_what_began_it(classes):
    reasoner = Reasoner(triples(CIRCLE))
    added = [(X, TYPE, cls) for cls in classes]
    with reasoner.supposing(added):
        assert len(set(reasoner.inferred())) > len(classes)
    assert set(reasoner.inferred()) == set()
    reasoner.apply(insert=added)
    reasoner.apply(delete=added)
    assert set(reasoner.inferred()) == set()
