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


CHAINS = """
    :in a owl:ObjectProperty , owl:TransitiveProperty . :contains owl:inverseOf :in .
    :at a owl:ObjectProperty ; owl:propertyChainAxiom ( :on :in ) . :near a owl:ObjectProperty .
    :near owl:propertyChainAxiom ( :beside :on ) .
"""


def names(*parts):
    return tuple(f"<http://example.org/{part}>" for part in parts)


@pytest.mark.parametrize(
    ("facts", "lost", "conclusion"),
    [
        (":c :on :t , :s . :t :in :r . :s :in :r .", ("c", "on", "t"), ("c", "at", "r")),
        (":c :on :t , :s . :t :in :r . :s :in :r .", ("s", "in", "r"), ("c", "at", "r")),
        (":c :on :t , :s . :t :in :r . :r :contains :s .", ("t", "in", "r"), ("c", "at", "r")),
        (":a :in :b , :c . :b :in :d . :c :in :d .", ("b", "in", "d"), ("a", "in", "d")),
        (":a :in :b , :c . :b :in :d . :d :contains :c .", ("a", "in", "b"), ("d", "contains", "a")),
        (":a :beside :b , :c . :b :on :d . :c :on :d .", ("a", "beside", "c"), ("a", "near", "d")),
    ],
)
def test_the_conclusion_of_a_chain_stays_while_other_facts_entail_it(facts, lost, conclusion):
    reasoner = Reasoner(triples(CHAINS))
    facts = triples(facts)
    reasoner.apply(insert=facts)
    reasoner.apply(delete=[names(*lost)])
    assert reasoner.holds(names(*conclusion))
    left = [fact for fact in facts if fact != names(*lost)]
    assert set(reasoner.inferred()) == set(Reasoner([*triples(CHAINS), *left]).inferred())
    for fact in left:
        reasoner.apply(delete=[fact])
    assert not reasoner.holds(names(*conclusion))
    assert set(reasoner.inferred()) == set()


def test_an_asserted_edge_that_a_chain_entails_stays_as_a_conclusion():
    reasoner = Reasoner(triples(CHAINS))
    reasoner.apply(insert=triples(":c :on :t ; :at :r . :t :in :r ."))
    reasoner.apply(delete=[names("c", "at", "r")])
    assert names("c", "at", "r") in set(reasoner.inferred())


def test_an_asserted_value_that_a_class_entails_stays_as_a_conclusion():
    reasoner = Reasoner(triples(":Fridge rdfs:subClassOf [ owl:onProperty :does ; owl:hasValue :cooling ] ."))
    reasoner.apply(insert=triples(":f a :Fridge ; :does :cooling , :humming ."))
    reasoner.apply(delete=[names("f", "does", "cooling"), names("f", "does", "humming")])
    assert reasoner.holds(names("f", "does", "cooling"))
    assert not reasoner.holds(names("f", "does", "humming"))
