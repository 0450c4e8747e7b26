"""What goes when something is deleted, where conclusions rest on one another in circles."""

import pytest

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.terms import TYPE
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
    with reasoner.assuming(added):
        assert len(set(reasoner.inferred())) > len(classes)
    assert set(reasoner.inferred()) == set()
    reasoner.apply(insert=added)
    reasoner.apply(delete=added)
    assert set(reasoner.inferred()) == set()


LADEN = """
    :Table a owl:Class . :Cup a owl:Class .
    :Laden owl:equivalentClass [ a owl:Class ; owl:intersectionOf ( :Table
        [ a owl:Restriction ; owl:onProperty :bears ; owl:someValuesFrom :Cup ] ) ] .
    :Made owl:equivalentClass [ a owl:Restriction ; owl:onProperty :isOn ; owl:someValuesFrom :Laden ] .
    :Made rdfs:subClassOf :Cup . :bears owl:inverseOf :isOn .
"""
"""A table is laden while a cup is on it, and what is on a laden table is a cup for that reason: a circle."""


def test_what_an_edge_said_may_be_said_by_another_one_but_not_in_a_circle():
    table, cup, other, made = (f"<http://example.org/{name}>" for name in ("t", "c", "d", "e"))
    bears, laden = "<http://example.org/bears>", "<http://example.org/Laden>"
    reasoner = Reasoner(triples(LADEN))
    types = [(table, TYPE, "<http://example.org/Table>")]
    types += [(one, TYPE, "<http://example.org/Cup>") for one in (cup, other)]
    reasoner.apply(insert=types)
    reasoner.update_computed(add=[(table, bears, one) for one in (cup, other, made)])
    reasoner.update_computed(remove=[(table, bears, cup)])
    assert laden in reasoner.types(table)
    reasoner.update_computed(remove=[(table, bears, other)])
    assert laden not in reasoner.types(table)
    assert "<http://example.org/Cup>" not in reasoner.types(made)
