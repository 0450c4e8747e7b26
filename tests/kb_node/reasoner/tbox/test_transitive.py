"""Transitive properties whose closure is computed by queries and not stored."""

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.graphs import triple, triples

TBOX = """
:with a owl:TransitiveProperty , owl:SymmetricProperty .
:in rdfs:subPropertyOf :with . :in owl:inverseOf :holds .
:part a owl:TransitiveProperty ; rdfs:domain :Thing ; rdfs:range :Thing . :has owl:inverseOf :part .
:Wet owl:onProperty :part ; owl:someValuesFrom :Water . :Kept owl:onProperty :part ; owl:allValuesFrom :Safe .
"""


def stored(reasoner):
    return len([p for p in reasoner._engine._abox.store.predicate if p >= 0])


@pytest.fixture
def reasoner():
    return Reasoner(triples(TBOX))


def test_only_asserted_edges_are_stored(reasoner):
    facts = triples("".join(f":cup{i} :in :room{i % 3} , :flat . " for i in range(300)))
    reasoner.apply(insert=facts)
    assert stored(reasoner) == len(facts) == 600
    assert len(list(reasoner.inferred(triple(":cup1 :with :x")[0], triple(":cup1 :with :x")[1]))) == 304
    assert reasoner.holds(triple(":cup1 :with :cup299"))
    assert not reasoner.holds(triple(":cup1 :with :elsewhere"))
    explanation = reasoner.explain(triple(":cup1 :with :cup299"))
    assert len(explanation.support) == 5
    proofs.check(explanation, [*triples(TBOX), *facts])


def test_a_class_whose_members_all_have_one_value_costs_each_member_one_edge():
    """Example: every arm of KnowRob's PR2 has one payload, below `associatedWith` of DUL."""
    arms = Reasoner(triples(TBOX + ":Arm rdfs:subClassOf [ owl:onProperty :in ; owl:hasValue :robot ] ."))
    empty = stored(arms)
    arms.apply(insert=triples("".join(f":arm{i} a :Arm . " for i in range(200))))
    assert stored(arms) - empty == 200
    assert arms.holds(triple(":arm0 :with :arm199"))
    arms.apply(delete=triples("".join(f":arm{i} a :Arm . " for i in range(199))))
    assert stored(arms) - empty == 1
    assert not arms.holds(triple(":arm0 :with :arm199"))


def test_a_restriction_is_passed_on_along_the_chain_and_back(reasoner):
    chain = triples(":a :part :b . :c :has :b . :c :part :d .".replace(":c :has :b", ":b :part :c"))
    wet = triple(":d a :Water")
    reasoner.apply(insert=chain)
    for change in ({"insert": [wet]}, {"delete": [chain[1]]}, {"insert": [chain[1]]}, {"delete": [wet]}):
        reasoner.apply(**change)
        told = set(reasoner.asserted())
        assert reasoner.holds(triple(":a a :Wet")) == ({wet, *chain} <= told)
        assert reasoner.holds(triple(":c a :Wet")) == (wet in told)
    reasoner.apply(insert=[wet, triple(":a a :Kept")])
    for fact in map(triple, (":a a :Wet", ":d a :Safe", ":a :part :d", ":d :has :a")):
        proofs.check(reasoner.explain(fact), list(reasoner.asserted()))


def test_a_member_of_a_restriction_need_not_have_its_value(reasoner):
    """No rule derives that a member of `:Wet` has a part."""
    reasoner.apply(insert=triples(":b a :Wet . :a :part :b ."))
    assert not reasoner.holds(triple(":a a :Wet"))


def test_the_ends_may_be_equal_to_other_individuals(reasoner):
    reasoner.apply(insert=triples(":a :part :b . :b owl:sameAs :c . :c :part :d . :d owl:sameAs :e ."))
    told = list(reasoner.asserted())
    for fact in map(triple, (":a :part :d", ":a :part :e", ":e :has :a")):
        assert fact in set(reasoner.inferred(fact[0]))
        assert fact in set(reasoner.inferred(None, None, fact[2]))
        proofs.check(reasoner.explain(fact), told)
    reasoner.apply(delete=triples(":b owl:sameAs :c ."))
    assert not reasoner.holds(triple(":a :part :d"))


@pytest.mark.parametrize(
    "axiom",
    [
        ":part a owl:IrreflexiveProperty .",
        ":part rdfs:subPropertyOf :near . :near a owl:AsymmetricProperty .",
        ":has owl:propertyDisjointWith :part .",
    ],
)
def test_a_cycle_is_found_if_a_rule_needs_pairs(axiom):
    reasoner = Reasoner(triples(TBOX + axiom))
    reasoner.apply(insert=triples(":a :part :b . :b :part :c ."))
    assert stored(reasoner) == 3
    with pytest.raises(Inconsistent):
        reasoner.apply(insert=triples(":c :part :a ."))


@pytest.mark.parametrize(
    "axiom",
    [":on a owl:TransitiveProperty .", ":on owl:propertyChainAxiom ( :on :on ) ."],
    ids=["declared", "as a chain"],
)
def test_every_form_of_the_transitivity_axiom_is_in_the_proof(axiom):
    told = triples(axiom + ":under owl:inverseOf :on . :a :on :b . :c :under :b . :c a :Floor .")
    told += triples(":Top owl:onProperty :on ; owl:someValuesFrom :Floor .")
    reasoner = Reasoner(told)
    for fact in map(triple, (":a :on :c", ":c :under :a", ":a a :Top")):
        proofs.check(reasoner.explain(fact), told)
