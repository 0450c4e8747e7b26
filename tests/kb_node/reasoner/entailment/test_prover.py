"""Proofs by refutation, by cases, and with names for values that must exist."""

import pytest

from semmap.nodes.kb_node.reasoner import Reasoner, entails
from semmap.nodes.kb_node.reasoner.entailment import contradictory
from semmap.nodes.kb_node.reasoner.entailment.effort import Effort
from semmap.nodes.kb_node.reasoner.entailment.explaining import empty_classes
from tests.kb_node.reasoner.entailment.cases import cases, follows, spelled_out
from tests.kb_node.reasoner.graphs import triples

FOLLOWS = """
everything is in a class or not in it
    :x a :C
    :x a [ owl:unionOf (:A [ owl:complementOf :A ]) ]
a union by one of its parts
    :x :p :y . :A owl:equivalentClass LEAST(:q)
    :x a [ owl:unionOf (:A SOME(:p owl:Thing)) ]
each member of an enumeration
    :E owl:oneOf (:a :b) . :a a :D . :b a :D . :x a :E
    :x a :D
a value of the inverse
    :b :p :a
    :a a [ owl:onProperty [ owl:inverseOf :p ] ; owl:hasValue :b ]
all values, for there are none
    :p rdfs:domain :A . :A owl:disjointWith :B . :x a :B
    :x a ONLY(:p :Z)
related to oneself, and therefore to a member
    :N rdfs:subClassOf SELF(:likes)
    :N rdfs:subClassOf SOME(:likes :N)
two values in a class
    :a :p :b , :c . :b owl:differentFrom :c ; a :B . :c a :B
    :a a [ owl:onProperty :p ; owl:minQualifiedCardinality TWO ; owl:onClass :B ]
two of three values are different
    :a :p :b , :c , :d . :b owl:differentFrom :d
    :a a LEAST(:p)
at least no value
    :a a :A
    :a a [ owl:onProperty :p ; owl:minCardinality NONE ]
reflexive by a class and a property above
    :N rdfs:subClassOf SELF(:likes) . :likes rdfs:subPropertyOf :knows . :n a :N
    :n :knows :n
equal to the only member
    :C owl:oneOf (:a) . :x a :C
    :x owl:sameAs :a
every value is related to a topmost property
    :a :p 1
    :a owl:topDataProperty 2
a definition beside others that cannot be read
    :A owl:equivalentClass [ owl:onProperty :q ; owl:minCardinality :many ] , LEAST(:p) ,
      [ owl:onProperty :r ; owl:minCardinality :many ] . :a :p :b , :c . :b owl:differentFrom :c
    :a a :A
a value in a narrower datatype
    :a :d 5
    :a a SOME(:d xsd:byte)
"""

DOES_NOT = """
one member of an enumeration is in no other class
    :E owl:oneOf (:a :b) . :a a :D . :x a :E
    :x a :D
a value of the property is none of its inverse
    :b :p :a
    :b a [ owl:onProperty [ owl:inverseOf :p ] ; owl:hasValue :a ]
one of two values is in the class
    :a :p :b , :c . :b owl:differentFrom :c ; a :B
    :a a [ owl:onProperty :p ; owl:minQualifiedCardinality TWO ; owl:onClass :B ]
a value in a wider datatype
    :a :d 500
    :a a SOME(:d xsd:byte)
related to another, and not to itself
    :N rdfs:subClassOf SOME(:likes :N) . :n a :N
    :n :likes :n
"""


@pytest.mark.parametrize(("premise", "conclusion"), cases(FOLLOWS))
def test_a_fact_follows(premise, conclusion):
    assert follows(premise, conclusion)


@pytest.mark.parametrize(("premise", "conclusion"), cases(DOES_NOT))
def test_a_fact_does_not_follow(premise, conclusion):
    assert not follows(premise, conclusion)


CLASH = ":B owl:disjointWith :C . "
OF_MEMBERS = {
    ":A rdfs:subClassOf SOME(:p :B) , ONLY(:p :C)": "A",
    ":A rdfs:subClassOf SOME(:p :B) . :p rdfs:range :C": "A",
    ":A rdfs:subClassOf SOME([ owl:inverseOf :p ] :B) . :p rdfs:domain :C": "A",
    ":A rdfs:subClassOf SOME(:q :D) . :D rdfs:subClassOf SOME(:p :B) , ONLY(:p :C)": "AD",
    ":A rdfs:subClassOf SELF(:p) . :p a owl:IrreflexiveProperty": "A",
    ":A rdfs:subClassOf LEAST(:p) , MOST(:p)": "A",
    ":p a owl:ReflexiveProperty , owl:IrreflexiveProperty": "ABCD",
    ":A rdfs:subClassOf SOME(:p :B) , SOME(:p :C)": "",
    ":A rdfs:subClassOf ONLY(:p :B) , ONLY(:p :C)": "",
}
"""Axioms, and the classes that have no members because of the values that these must have."""


@pytest.mark.parametrize(("axioms", "empty"), OF_MEMBERS.items(), ids=OF_MEMBERS)
def test_a_value_that_must_exist_and_cannot_is_a_contradiction(axioms, empty):
    tbox = triples(CLASH + spelled_out(axioms + " ."))
    assert contradictory(Reasoner([*tbox, *triples(":a a :A .")])) is ("A" in empty)
    names = [f"<http://example.org/{name}>" for name in "ABCD"]
    found = list(empty_classes(Reasoner(tbox), names, 10.0))
    assert [one.conclusion[0] for one in found] == [f"<http://example.org/{name}>" for name in empty]
    for one in found:
        assert set(one.support) <= set(tbox)
        assert list(empty_classes(Reasoner(one.support), [one.conclusion[0]], 10.0))


def test_a_class_without_members_is_searched_until_the_time_limit():
    reasoner = Reasoner(triples(spelled_out(":A rdfs:subClassOf LEAST(:p) , MOST(:p) .")))
    assert not list(empty_classes(reasoner, ["<http://example.org/A>"], -1.0))


@pytest.mark.parametrize(("recompute", "is_proved"), [(True, True), (False, False)])
def test_values_are_named_only_if_everything_may_be_recomputed(recompute, is_proved):
    reasoner = Reasoner(triples(spelled_out(":A rdfs:subClassOf SOME(:p :B) . :a a :A .")))
    goal = triples(":a :p [ a :B ] .")
    assert entails(reasoner, goal, Effort(allow_recompute=recompute)) is is_proved


@pytest.mark.parametrize(
    ("facts", "is_named"),
    [
        (":fred a :Person", True),
        (":fred a :Person ; :parent :fred", False),
        (":fred a :Person ; :parent :bob", True),
        (":fred a :Person . :fred :child :fred", False),
        (':cup1 a :Full ; :mass "1.5"^^xsd:float', False),
        (":cup1 a :Full ; :mass 1", True),
    ],
)
def test_a_value_is_named_if_no_known_value_is_in_the_class(facts, is_named):
    tbox = ":Person rdfs:subClassOf SOME(:parent :Person) . :child owl:inverseOf :parent ."
    tbox += ":Full rdfs:subClassOf SOME(:mass xsd:float) ."
    reasoner, assumed = Reasoner(triples(spelled_out(f"{tbox} {facts} ."))), []
    assuming = reasoner.assuming
    reasoner.assuming = lambda new, **how: assumed.extend(new) or assuming(new, **how)
    assert not contradictory(reasoner)
    assert any(o.startswith("_:") for _, p, o in assumed if p.startswith("<http://example.org/")) is is_named
