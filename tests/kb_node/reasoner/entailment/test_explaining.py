"""Proofs of statements that no rule derives, with their support."""

import time

import pytest

from semmap.nodes.kb_node.reasoner import Reasoner, entails
from semmap.nodes.kb_node.reasoner.entailment import explaining
from semmap.nodes.kb_node.reasoner.entailment.explaining import (
    _negation,
    _shrunk,
    nearby,
    why_entailed,
    why_excluded,
)
from semmap.nodes.kb_node.reasoner.refutation import refute
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, SAME_AS
from tests.kb_node.reasoner.graphs import household, triple, triples

TBOX = """
:Mug rdfs:subClassOf :Cup . :Cup rdfs:subClassOf :Thing ,
 [ owl:onProperty :part ; owl:someValuesFrom :Handle ] .
:Wall rdfs:subClassOf :Part . :Thing owl:disjointWith :Part .
:Grippable owl:onProperty :part ; owl:someValuesFrom :Handle . :Other rdfs:subClassOf :Cup .
:on a owl:ObjectProperty , owl:AsymmetricProperty . :under owl:inverseOf :on .
:knows a owl:ReflexiveProperty . :knows rdfs:subPropertyOf :meets .
:mug1 a :Mug . :mug2 a :Mug ; :on :mug1 . :wall1 a :Wall .
"""


@pytest.mark.parametrize(
    ("goal", "text"),
    [
        (":Mug owl:disjointWith :Wall", "nothing is both a Mug and a Wall, because every "),
        (
            ":on a owl:IrreflexiveProperty",
            "nothing is on itself, because if one thing is on another, ",
        ),
        (
            ":under a owl:AsymmetricProperty",
            "if one thing is under another, the other is not under it",
        ),
        (":mug1 a :Grippable", "mug1 is a Grippable, because"),
        (":Mug rdfs:subClassOf :Grippable", "every Mug is a Grippable, because"),
        (":mug1 :meets :mug1", "mug1 meets itself, because "),
        (":mug1 owl:topObjectProperty :wall1", "mug1 has top object property wall1 (axiomatic)."),
    ],
)
def test_the_support_is_sufficient_and_minimal(goal, text):
    reasoner = Reasoner(triples(TBOX))
    goal = triple(goal)
    assert not reasoner.holds(goal)
    found = why_entailed(Reasoner(nearby(reasoner, goal[::2])), goal)
    assert found.conclusion == goal
    assert found.text.startswith(text), found.text
    assert set(found.support) <= set(reasoner.asserted())
    assert entails(Reasoner(found.support), [goal])
    for left_out in found.support:
        assert not entails(Reasoner([one for one in found.support if one != left_out]), [goal])


DENYING = """
:Mug rdfs:subClassOf [ owl:onProperty :part ; owl:someValuesFrom :Handle ] . :Handle owl:disjointWith :Soft .
:Plush rdfs:subClassOf [ owl:onProperty :part ; owl:allValuesFrom :Soft ] .
:Person owl:equivalentClass [ owl:unionOf ( :Adult :Child ) ] .
:Robot owl:disjointWith :Adult , :Child .
:knows a owl:ReflexiveProperty . :avoids owl:propertyDisjointWith :knows .
:mug1 a :Mug . :ann a :Person . :bob a :Adult ; :avoids :ann .
"""


@pytest.mark.parametrize(
    ("supposed", "text"),
    [
        (
            ":mug1 a :Plush",
            "mug1 is not a Plush, because it is a Mug (asserted), every Mug has a part that is a",
        ),
        (
            ":ann a :Robot",
            "ann is not a Robot, because it is a Person (asserted), a Person is by definition something that",
        ),
        (
            ":ann :avoids :ann",
            "ann does not avoid itself, because everything knows itself, and nothing that avoids something",
        ),
        (
            ":bob owl:sameAs :ann",
            "bob is different from ann, because bob avoids ann (asserted), everything knows",
        ),
    ],
)
def test_statements_that_are_excluded_although_no_rule_contradicts_them(supposed, text):
    reasoner, supposed = Reasoner(triples(DENYING)), triple(supposed)
    assert refute(reasoner, supposed) is None
    found = why_excluded(Reasoner(nearby(reasoner, supposed[::2]), closed=reasoner.closed), supposed)
    assert found.text.startswith(text), found.text
    s, p, o = supposed
    assert found.conclusion == ((s, DIFFERENT_FROM, o) if p == SAME_AS else None)
    assert (found.supposed, found.steps) == (supposed, ())
    assert set(found.support) <= set(reasoner.asserted())
    contrary = _negation(supposed)
    assert entails(Reasoner(found.support), contrary)
    for left_out in found.support:
        assert not entails(Reasoner([one for one in found.support if one != left_out]), contrary)


@pytest.mark.parametrize(
    "supposed",
    [
        ":mug1 a :Robot",
        ":ann :knows :bob",
        ":bob owl:sameAs :mug1",
        ":bob owl:differentFrom :ann",
        ":ann :said 1",
        ":Mug rdfs:subClassOf :Plush",
    ],
)
def test_a_possible_statement_is_not_excluded(supposed):
    assert why_excluded(Reasoner(triples(DENYING)), triple(supposed)) is None


@pytest.mark.parametrize("goal", [":mug1 :on :mug2", ":mug1 a :Other", ":Cup rdfs:subClassOf :Mug"])
def test_a_statement_that_does_not_follow_has_no_proof(goal):
    reasoner = Reasoner(triples(TBOX))
    before = set(reasoner.asserted())
    assert why_entailed(reasoner, triple(goal)) is None
    assert set(reasoner.asserted()) == before


def test_only_nearby_facts_are_used():
    told = triples(TBOX + "".join(f":mug{i} a :Mug ; :on :table{i} . " for i in range(3, 300)))
    reasoner = Reasoner(told)
    near = nearby(reasoner, triple(":mug3 :on :table3")[::2])
    assert set(triples(":mug3 a :Mug ; :on :table3 .")) <= set(near)
    assert not {t for t in near if "mug4>" in t[0]}


@pytest.mark.parametrize(
    ("terms", "found"),
    [
        ((":a",), ":a :p :b . :b :p :c . :a a :A . :b a :B . :x :q :b ."),
        ((":d",), ":c :p :d . :b :p :c . :d :n 1 . :c a :C . :d a :D ."),
        ((":x",), ":x :q :b . :a :p :b . :b :p :c . :b a :B ."),
        (
            (":a", ":d"),
            ":a :p :b . :b :p :c . :c :p :d . :d :n 1 . :a a :A . :b a :B . :c a :C . :d a :D . :x :q :b .",
        ),
        (("1",), ""),
        ((":A",), ""),
    ],
)
def test_the_facts_within_two_steps_are_nearby(terms, found):
    tbox = triples(":A rdfs:subClassOf :B . :A rdfs:label 'a' . :p a owl:ObjectProperty .")
    facts = triples(
        ":a :p :b . :b :p :c . :c :p :d . :d :n 1 . :e :n 1 . :x :q :b . "
        ":a a :A . :b a :B . :c a :C . :d a :D ."
    )
    near = nearby(Reasoner([*tbox, *facts]), [triple(f":x :p {term}")[2] for term in terms])
    assert set(near) - set(tbox) == set(triples(found))
    assert set(tbox) <= set(near)


@pytest.mark.parametrize("is_small", [True, False])
def test_classes_are_assumed_in_a_small_graph_only(monkeypatch, is_small):
    """Such an assumption is an axiom, with which everything is recomputed."""
    facts = triples(":All owl:unionOf ( :A [ owl:complementOf :A ] ) . :x a :Thing .")
    monkeypatch.setattr(explaining, "_SMALL", len(facts) - (not is_small))
    goal = triple(":x a :All")
    found = why_entailed(Reasoner(facts), goal)
    assert (found is not None) is is_small


@pytest.mark.parametrize("needed", [(), (0,), (7,), (0, 7), (3, 4), (1, 5, 9), (0, 1, 2, 11, 12), range(13)])
def test_what_is_not_needed_is_left_out(needed):
    many = [(f"<s{i}>", "<p>", "<o>") for i in range(13)]
    wanted = [many[i] for i in needed]
    found = _shrunk(many, lambda some: set(wanted) <= set(some), time.thread_time() + 60.0)
    assert found == wanted


def test_an_existing_value_is_not_named_again():
    """Otherwise an individual would equal a value, and everything would be recomputed, in seconds."""
    reasoner = Reasoner(
        [
            *household(),
            *triples(""":Full rdfs:subClassOf [ owl:onProperty :mass ;
        owl:someValuesFrom xsd:float ] . :mass a owl:DatatypeProperty , owl:FunctionalProperty .
        :thing1 a :Full ; :mass "1.5"^^xsd:float ."""),
        ]
    )
    engine = reasoner._engine
    seen = []
    assuming = reasoner.assuming
    reasoner.assuming = lambda *given, **how: seen.append(reasoner._engine) or assuming(*given, **how)
    assert not entails(reasoner, [triple(":thing1 a :Elsewhere")])
    assert seen
    assert all(one is engine for one in seen)


def test_proofs_do_not_depend_on_the_load_of_the_machine():
    many = [(f"<s{i}>", "<p>", "<o>") for i in range(16)]

    def suffice(some):
        time.sleep(0.01)  # others have the core
        return many[7] in some

    assert _shrunk(many, suffice, time.thread_time() + 0.03) == [many[7]]
