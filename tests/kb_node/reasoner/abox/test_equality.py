"""Which individuals and values are the same, and what follows."""

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.terms import SAME_AS
from tests.kb_node.reasoner.graphs import triple, triples

TBOX = """
:owner a owl:ObjectProperty , owl:FunctionalProperty . :owns owl:inverseOf :owner .
:badge a owl:ObjectProperty , owl:InverseFunctionalProperty . :near a owl:ObjectProperty .
:mass a owl:DatatypeProperty , owl:FunctionalProperty . :note a owl:DatatypeProperty .
:number a owl:DatatypeProperty . :street a owl:ObjectProperty .
:House a owl:Class ; owl:hasKey ( :street :number ) .
:Cup a owl:Class . :Lid a owl:Class .
:Jar a owl:Class ; rdfs:subClassOf
    [ owl:onProperty :has ; owl:maxQualifiedCardinality "1"^^xsd:nonNegativeInteger ; owl:onClass :Lid ] .
:One a owl:Class ; rdfs:subClassOf
    [ owl:onProperty :near ; owl:maxCardinality "1"^^xsd:nonNegativeInteger ] .
"""


@pytest.fixture
def reasoner():
    return Reasoner(triples(TBOX))


def are_same(reasoner, one, other):
    holds = [reasoner.holds(triple(f":{a} owl:sameAs :{b}")) for a, b in ((one, other), (other, one))]
    assert len(set(holds)) == 1
    return holds[0]


def test_two_values_of_a_functional_property_are_the_same(reasoner):
    reasoner.apply(insert=triples(":cup1 :owner :ann . :cup1 :owner :anna . :cup2 :owner :bob ."))
    assert are_same(reasoner, "ann", "anna")
    assert not are_same(reasoner, "ann", "bob")


def test_two_owners_by_the_inverse_property_are_the_same(reasoner):
    reasoner.apply(insert=triples(":ann :owns :cup1 . :cup1 :owner :anna ."))
    assert are_same(reasoner, "ann", "anna")


def test_two_that_share_a_value_of_an_inverse_functional_property_are_the_same(reasoner):
    reasoner.apply(insert=triples(":ann :badge :b1 . :anna :badge :b1 . :bob :badge :b2 ."))
    assert are_same(reasoner, "ann", "anna")
    assert not are_same(reasoner, "ann", "bob")


def test_the_same_individuals_have_the_facts_of_each_other(reasoner):
    reasoner.apply(insert=triples(":ann owl:sameAs :anna . :anna owl:sameAs :an . :an a :Cup ; :near :bob ."))
    assert are_same(reasoner, "ann", "an")
    assert reasoner.holds(triple(":ann a :Cup"))
    assert reasoner.holds(triple(":ann :near :bob"))
    assert not reasoner.holds(triple(":bob a :Cup"))


def test_an_equality_leads_to_another_one(reasoner):
    reasoner.apply(insert=triples(":cup1 :owner :ann . :mug1 :owner :anna . :cup1 owl:sameAs :mug1 ."))
    assert are_same(reasoner, "ann", "anna")
    reasoner.apply(delete=triples(":cup1 owl:sameAs :mug1 ."))
    assert not are_same(reasoner, "ann", "anna")


def test_only_members_of_the_limited_class_are_the_same(reasoner):
    reasoner.apply(insert=triples(":jar1 a :Jar ; :has :a , :b , :c . :a a :Lid . :b a :Lid . :c a :Cup ."))
    assert are_same(reasoner, "a", "b")
    assert not are_same(reasoner, "a", "c")
    reasoner.apply(insert=triples(":cup1 :has :d , :e . :d a :Lid . :e a :Lid ."))
    assert not are_same(reasoner, "d", "e")


def test_a_limit_applies_when_its_owner_or_a_value_joins_the_class_later(reasoner):
    reasoner.apply(insert=triples(":jar1 :has :a , :b . :a a :Lid . :b a :Lid . :x :near :y , :z ."))
    assert not are_same(reasoner, "a", "b")
    reasoner.apply(insert=triples(":jar1 a :Jar . :x a :One ."))
    assert are_same(reasoner, "a", "b")
    assert are_same(reasoner, "y", "z")


ADDRESS = ":h1 a :House ; :street :elm ; :number 7 . "


@pytest.mark.parametrize(
    ("other", "same"),
    [
        (":h2 a :House ; :street :elm ; :number 7 .", True),
        (':h2 a :House ; :street :elm ; :number "7.0"^^xsd:decimal .', True),
        (":h2 a :House ; :street :elm , :oak ; :number 8 , 7 .", True),
        (":h2 a :House ; :street :ulme ; :number 7 . :ulme owl:sameAs :elm .", True),
        (":h2 a :House ; :street :elm ; :number 8 .", False),
        (":h2 a :House ; :street :oak ; :number 7 .", False),
        (":h2 a :House ; :street :elm .", False),
        (":h2 a :Cup ; :street :elm ; :number 7 .", False),
    ],
)
def test_members_that_share_a_value_of_every_key_property_are_the_same(reasoner, other, same):
    reasoner.apply(insert=triples(ADDRESS + other))
    assert are_same(reasoner, "h1", "h2") == same


def test_different_individuals_that_must_be_the_same_contradict(reasoner):
    reasoner.apply(insert=triples(":ann owl:differentFrom :bob . :cup1 :owner :ann ."))
    with pytest.raises(Inconsistent):
        reasoner.apply(insert=triples(":cup1 :owner :bob ."))
    assert not are_same(reasoner, "ann", "bob")


@pytest.mark.parametrize(
    ("one", "other", "consistent"),
    [
        ("1", '"1.0"^^xsd:decimal', True),
        ("1", "2", False),
        ('"a"', '"a"@en', False),
        ('"a"', '"b"', False),
    ],
)
def test_values_are_the_same_if_they_are_equal(reasoner, one, other, consistent):
    facts = triples(f":cup1 :mass {one} , {other} .")
    if consistent:
        reasoner.apply(insert=facts)
        assert reasoner.is_compiled
    else:
        with pytest.raises(Inconsistent):
            reasoner.apply(insert=facts)


def test_a_value_of_an_unknown_datatype_takes_the_value_that_it_must_equal(reasoner):
    reasoner.apply(insert=triples(':cup1 :mass "one"^^:count , 1 . :cup2 :note "1.0"^^xsd:decimal .'))
    assert reasoner.holds(triple(':cup2 :note "one"^^:count'))
    with pytest.raises(Inconsistent):
        reasoner.apply(insert=triples(':cup3 :mass "one"^^:count , 2 .'))


@pytest.mark.parametrize(
    ("facts", "reason"),
    [
        (":cup1 :owner :ann , 1 .", "an individual is the same as a value"),
        (":x :near :Cup . :x a :One . :x :near :ann .", "a class or property is the same as another"),
    ],
)
def test_what_the_compiled_rules_do_not_cover_is_left_to_the_general_ones(reasoner, facts, reason):
    reasoner.apply(insert=triples(facts))
    assert reason in reasoner.not_incremental


def test_a_removed_reason_separates_individuals_unless_there_is_another(reasoner):
    first, second = triples(":cup1 :owner :ann , :anna ."), triples(":ann :badge :b1 . :anna :badge :b1 .")
    reasoner.apply(insert=[*first, *second])
    reasoner.apply(delete=first[:1])
    assert are_same(reasoner, "ann", "anna")
    reasoner.apply(delete=second[:1])
    assert not are_same(reasoner, "ann", "anna")
    assert not list(reasoner.inferred(None, SAME_AS, None))
