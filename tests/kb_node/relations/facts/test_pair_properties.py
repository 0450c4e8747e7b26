"""The properties of a TBox that follow from measured relations."""

import pytest

from semmap.nodes.kb_node.relations.facts.pair_properties import PairProperties
from semmap.ontology import vocabulary as v
from tests.kb_node.home import turtle

TBOX = turtle("""
dm:isUnder a owl:ObjectProperty ; rdfs:subPropertyOf dm:isLower . dm:isAbove a owl:ObjectProperty .
dm:isLower a owl:ObjectProperty ; owl:inverseOf dm:isHigher . dm:isHigher rdfs:subPropertyOf dm:related .
dm:isNear a owl:ObjectProperty ; owl:equivalentProperty dm:closeTo . dm:closeTo a owl:SymmetricProperty .
dm:near rdfs:subPropertyOf dm:isNear . dm:isBeside owl:inverseOf dm:isBeside .
dm:touches a owl:ObjectProperty ; rdfs:subPropertyOf [ owl:inverseOf dm:touchedBy ] .
""")
IRIS = {name: v.entity_iri(name) for name in ("cup1", "table1")}
NAMES = {iri: name for name, iri in IRIS.items()}


class Measured:
    """The facts of pairs, as a set."""

    def __init__(self, *facts):
        self.facts = facts

    def holds(self, *fact):
        return fact in self.facts


def said(properties, *fact):
    return {(NAMES[s], v.local_name(p), NAMES[o]) for s, p, o in properties.triples(fact, IRIS)}


@pytest.fixture(scope="module")
def properties():
    return PairProperties(TBOX)


def test_a_relation_implies_its_superproperties_and_their_inverses(properties):
    assert said(properties, "cup1", "isUnder", "table1") == {
        ("cup1", "isUnder", "table1"),
        ("table1", "isAbove", "cup1"),
        ("cup1", "isLower", "table1"),
        ("table1", "isHigher", "cup1"),
        ("table1", "related", "cup1"),
    }


def test_a_symmetric_relation_holds_in_both_directions(properties):
    both = {("cup1", "table1"), ("table1", "cup1")}
    found = said(properties, "cup1", "isNear", "table1")
    assert found == {(s, p, o) for s, o in both for p in ("isNear", "closeTo")}


@pytest.mark.parametrize(
    ("text", "implied"),
    [
        ("dm:isUnder owl:equivalentProperty dm:below .", ("cup1", "below", "table1")),
        ("dm:below owl:equivalentProperty dm:isUnder .", ("cup1", "below", "table1")),
        ("dm:isUnder owl:inverseOf dm:over .", ("table1", "over", "cup1")),
        ("dm:over owl:inverseOf dm:isUnder .", ("table1", "over", "cup1")),
    ],
)
def test_equivalent_and_inverse_properties_may_be_named_in_either_order(text, implied):
    properties = PairProperties(turtle(f"dm:isUnder a owl:ObjectProperty . {text}"))
    assert said(properties, "cup1", "isUnder", "table1") == {("cup1", "isUnder", "table1"), implied}


def test_only_declared_relations_and_named_properties_are_stated(properties):
    assert said(properties, "cup1", "isNextTo", "table1") == set()
    assert {p for _, p, _ in said(properties, "cup1", "touches", "table1")} == {"touches"}
    assert said(PairProperties(), "cup1", "isNear", "table1") == set()


def test_the_relations_from_which_a_property_may_follow(properties):
    assert properties.sources[v.dm("related")] == {"isUnder", "isAbove"}
    assert properties.sources[v.dm("closeTo")] == {"isNear"}
    assert v.dm("near") not in properties.sources
    assert v.dm("isBeside") not in properties.sources


@pytest.mark.parametrize(
    ("triple", "fact"),
    [
        (("cup1", "isLower", "table1"), ("cup1", "isUnder", "table1")),
        (("table1", "related", "cup1"), ("cup1", "isUnder", "table1")),
        (("table1", "closeTo", "cup1"), ("cup1", "isNear", "table1")),
    ],
)
def test_a_triple_holds_if_a_relation_that_implies_it_does(properties, triple, fact):
    s, p, o = triple
    term = (IRIS[s], v.dm(p), IRIS[o])
    assert properties.holds(term, Measured(fact), NAMES)
    assert not properties.holds(term, Measured(), NAMES)
    assert not properties.holds(term, Measured((fact[0], "touches", fact[2])), NAMES)


@pytest.mark.parametrize(
    ("property_", "forwards", "backwards"),
    [
        ("isUnder", True, False),
        ("isAbove", False, True),
        ("isLower", True, False),
        ("isHigher", False, True),
        ("related", False, True),
    ],
)
def test_a_triple_holds_in_the_direction_of_its_property(properties, property_, forwards, backwards):
    under = Measured(("cup1", "isUnder", "table1"))
    cup, p, table = IRIS["cup1"], v.dm(property_), IRIS["table1"]
    assert properties.holds((cup, p, table), under, NAMES) == forwards
    assert properties.holds((table, p, cup), under, NAMES) == backwards


def test_a_triple_about_another_individual_or_property_does_not_hold(properties):
    every = Measured(("cup1", "isUnder", "table1"))
    assert not properties.holds((IRIS["cup1"], v.dm("isLower"), v.entity_iri("x")), every, NAMES)
    assert not properties.holds((v.entity_iri("x"), v.dm("isLower"), IRIS["table1"]), every, NAMES)
    assert not properties.holds((IRIS["cup1"], v.dm("color"), IRIS["table1"]), every, NAMES)
