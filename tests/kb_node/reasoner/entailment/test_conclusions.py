"""Graphs to prove that have blank nodes, lists and declarations."""

import pytest

from semmap.nodes.kb_node.reasoner import Reasoner, entails
from semmap.nodes.kb_node.reasoner.entailment.effort import Effort
from tests.kb_node.reasoner.entailment import test_axiom_tests, test_entails, test_prover
from tests.kb_node.reasoner.entailment.cases import cases, follows
from tests.kb_node.reasoner.graphs import triples

FOLLOWS = """
there is one that is not in a class
    :Boy owl:disjointWith :Girl . :stewie a :Boy
    _:x a [ owl:complementOf :Girl ]
there is one that differs, and is in a class
    :Cup owl:disjointWith :Room . :c a :Cup . :r a :Room
    :c owl:differentFrom _:x . _:x a :Room
there is one that another differs from
    :Cup owl:disjointWith :Room . :c a :Cup . :r a :Room
    _:x owl:differentFrom :c
two blank nodes may be one individual
    :a :p :b
    :a :p _:x , _:y
a blank node is found by a second triple
    :a :p :b , :c . :c :q :d
    :a :p _:x . _:x :q _:y
imports are not part of the conclusions
    :a a :A
    <http://example.org/o> a owl:Ontology ; owl:imports <http://example.org/other> . :a a :A
"""

DOES_NOT = """
none is known to differ
    :c a :Cup . :r a :Room
    :c owl:differentFrom _:x
one differs, but is not in the class
    :Cup owl:disjointWith :Room . :c a :Cup . :r a :Room
    :c owl:differentFrom _:x . _:x a :Cup
one blank node cannot be two individuals
    :a :p :b . :c :q :d
    :a :p _:x . _:x :q _:y
imports without an ontology
    :a a :A
    :a a :A ; owl:imports <http://example.org/other>
one of two axioms
    :A rdfs:subClassOf :B
    :A rdfs:subClassOf :B , :C
one of two facts
    :a :p :b
    :a :p :b ; :q :b
a list of one's own
    :A rdfs:subClassOf :B
    :A rdfs:subClassOf :B . :a rdf:first :b
a negative assertion with two targets
    [] NEVER(:a :p :x)
    [] a owl:NegativePropertyAssertion ; owl:sourceIndividual :a ; owl:assertionProperty :p ;
      owl:targetIndividual :x , :y
"""


@pytest.mark.parametrize(("premise", "conclusion"), cases(FOLLOWS))
def test_a_graph_follows(premise, conclusion):
    assert follows(premise, conclusion)


@pytest.mark.parametrize(("premise", "conclusion"), cases(DOES_NOT))
def test_a_graph_does_not_follow(premise, conclusion):
    assert not follows(premise, conclusion)


@pytest.mark.parametrize("module", [test_entails, test_axiom_tests, test_prover], ids=lambda m: m.__name__)
def test_the_facts_that_a_search_has_used_are_sufficient(module):
    for case in cases(module.FOLLOWS)[::2]:
        premise, conclusion = case.values
        if "_:" in conclusion:  # these are matched only, and not explained
            continue
        reasoner, goal, effort = Reasoner(triples(premise + " .")), triples(conclusion), Effort(traced=True)
        assert entails(reasoner, goal, effort), case.id
        known = set(reasoner.asserted())
        assert entails(Reasoner([fact for fact in effort.seen if fact in known]), goal), case.id
