"""Deletion of facts whose conclusions depend on each other in cycles."""

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
"""Every A has p to a, which is therefore an A itself and has p to itself."""


@pytest.mark.parametrize("classes", [[A], [B], [A, B]])
def test_a_cycle_of_conclusions_is_removed_with_its_origin(classes):
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
"""A table with a cup is laden, and an object on a laden table is a cup: a cycle."""


def test_a_conclusion_may_have_another_reason_but_not_in_a_cycle():
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
