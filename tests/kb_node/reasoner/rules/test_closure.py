"""The closure by the rule table, compared with owlrl, and its invariants."""

from __future__ import annotations

import random

import pytest

from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.rules.general import GeneralEngine
from semmap.nodes.kb_node.reasoner.terms import SAME_AS
from tests.kb_node.reasoner.graphs import EVERYTHING, triple, triples
from tests.kb_node.reasoner.test_owlrl import WRONG, _about_individuals, _expanded
from tests.kb_node.reasoner.test_worlds import THEMES
from tests.kb_node.reasoner.worlds import World

INTEGER = "<http://www.w3.org/2001/XMLSchema#integer>"


@pytest.mark.parametrize("seed", range(4))
def test_the_same_follows_as_with_owlrl(seed):
    world = World(seed, without=WRONG)
    closure = Closure(world.asserted)
    theirs, is_contradictory = _expanded(world.asserted)
    assert (closure.clash is not None) == is_contradictory
    if not is_contradictory:
        assert _about_individuals(closure.facts) == _about_individuals(theirs)


def grown(seed, theme):
    """Return a random world after some consistent changes. It starts with few facts."""
    world = World(seed, theme)
    for _ in range(15):
        change = world.change()
        if Closure(world.after(change)).clash is None:
            world.accept(change)
    return world


def consistent(theme):
    found = [grown(seed, theme) for seed in range(5)]
    return [world for world in found if Closure(world.asserted).clash is None][:3]


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_the_order_of_facts_does_not_matter(theme):
    for seed, world in enumerate(consistent(theme)):
        facts = list(world.asserted)
        whole = set(Closure(facts).facts)
        random.Random(seed).shuffle(facts)
        assert set(Closure(facts).facts) == whole


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_a_closure_from_a_base_equals_a_fresh_closure(theme):
    for world in consistent(theme):
        everything = list(world.asserted)
        schema, facts = everything[::2], everything[1::2]
        owned = [
            fact for fact in world.asserted if "22-rdf-syntax-ns#" in fact[1] or fact[0].startswith("_:")
        ]
        base = Closure(dict.fromkeys([*owned, *schema]))
        before = dict(base.facts)
        both = Closure(facts, base=base)
        assert set(both.facts) == set(Closure(world.asserted).facts)
        assert base.facts == before


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_premises_precede_their_conclusions(theme):
    for world in consistent(theme):
        closure = Closure(world.asserted)
        known = set()
        for fact, reason in closure.facts.items():
            assert reason is None or set(reason.premises) <= known | set(closure.facts)
            assert (reason is None) or set(closure.leaves(fact)) <= set(world.asserted)
            known.add(fact)


CASES = {
    "subclass": (":A rdfs:subClassOf :B . :x a :A .", ":x a :B", ":x a :C"),
    "domain": (":p rdfs:domain :A . :x :p :y .", ":x a :A", ":y a :A"),
    "range": (":p rdfs:range :A . :x :p :y .", ":y a :A", ":x a :A"),
    "inverse": (":p owl:inverseOf :q . :x :p :y .", ":y :q :x", ":x :q :y"),
    "symmetric": (":p a owl:SymmetricProperty . :x :p :y .", ":y :p :x", ":x :p :x"),
    "transitive": (":p a owl:TransitiveProperty . :x :p :y . :y :p :z .", ":x :p :z", ":z :p :x"),
    "functional": (":p a owl:FunctionalProperty . :x :p :y , :z .", ":y owl:sameAs :z", ":x owl:sameAs :y"),
    "chain": (":r owl:propertyChainAxiom ( :p :q ) . :x :p :y . :y :q :z .", ":x :r :z", ":x :r :y"),
    "all of": (":I owl:intersectionOf ( :A :B ) . :x a :A , :B . :y a :A .", ":x a :I", ":y a :I"),
    "one of": (":U owl:unionOf ( :A :B ) . :x a :B .", ":x a :U", ":x a :A"),
    "some": (":S owl:onProperty :p ; owl:someValuesFrom :A . :x :p :y . :y a :A .", ":x a :S", ":y a :S"),
    "only": (":S owl:onProperty :p ; owl:allValuesFrom :A . :x a :S ; :p :y .", ":y a :A", ":x a :A"),
    "has": (":S owl:onProperty :p ; owl:hasValue :y . :x a :S .", ":x :p :y", ":x :p :x"),
    "key": (
        ":A owl:hasKey ( :p ) . :x a :A ; :p 1 . :y a :A ; :p 1.0 . :z :p 1 .",
        ":x owl:sameAs :y",
        ":x owl:sameAs :z",
    ),
    "spelling": (
        ":p a owl:InverseFunctionalProperty . :x :p 1 . :y :p 01 .",
        ":x owl:sameAs :y",
        ":x owl:sameAs :z",
    ),
}


@pytest.mark.parametrize(("turtle", "follows", "does_not"), CASES.values(), ids=CASES)
def test_conclusions_of_a_rule(turtle, follows, does_not):
    closure = Closure(triples(turtle))
    assert closure.clash is None
    assert closure.holds(triple(follows))
    assert not closure.holds(triple(does_not))
    engine = GeneralEngine(triples(turtle))
    assert engine.holds(triple(follows))
    assert not engine.holds(triple(does_not))
    found = list(engine.inferred(None, None, None))
    assert len(found) == len(set(found))
    assert triple(follows) in found
    explanation = engine.explain(triple(follows))
    assert explanation.conclusion == triple(follows)
    assert set(explanation.support) <= set(triples(turtle)) or "_:" in str(explanation.support)


CLASHES = {
    "disjoint": ":A owl:disjointWith :B . :x a :A , :B .",
    "different": ":x owl:sameAs :y ; owl:differentFrom :y .",
    "irreflexive": ":p a owl:IrreflexiveProperty . :x :p :x .",
    "asymmetric": ":p a owl:AsymmetricProperty . :x :p :y . :y :p :x .",
    "nothing": ":x a owl:Nothing .",
    "complement": ":A owl:complementOf :B . :x a :A , :B .",
    "two values": ":p a owl:FunctionalProperty . :x :p 1 , 2 .",
    "range": ":p rdfs:range xsd:byte . :x :p 300 .",
    "ill-typed": ':x :p "a"^^xsd:integer .',
}


@pytest.mark.parametrize("turtle", CLASHES.values(), ids=CLASHES)
def test_a_contradiction_is_found_and_minimal(turtle):
    facts = triples(turtle)
    assert Closure(facts).clash is not None
    assert GeneralEngine(facts).contradiction() is not None
    for left_out in facts:
        rest = [fact for fact in facts if fact != left_out]
        assert Closure(rest).clash is None
        assert GeneralEngine(rest).contradiction() is None


def test_the_general_engine_answers_patterns():
    engine = GeneralEngine(triples(EVERYTHING + ":i2 a :A ; :q :i4 ; :int 1 . :i4 owl:sameAs :i6 ."))
    assert engine.contradiction() is None
    for ask in (engine.asserted, engine.inferred):
        everything = set(ask(None, None, None))
        for s, p, o in sorted(everything, key=str)[::7]:
            for pattern in (
                (s, None, None),
                (None, p, None),
                (None, None, o),
                (s, p, None),
                (None, p, o),
                (s, p, o),
            ):
                if ask == engine.inferred and p == SAME_AS:
                    continue
                wanted = {
                    f for f in everything if all(a in (None, b) for a, b in zip(pattern, f, strict=True))
                }
                assert set(ask(*pattern)) == wanted, pattern


def test_a_spelling_of_a_later_query_counts_without_being_in_the_graph():
    facts = triples(":x :mass 1 .")
    (x, mass, _), spelled = facts[0], '"1.0"^^<http://www.w3.org/2001/XMLSchema#decimal>'
    assert Closure(facts, mentions=[spelled]).holds((x, mass, spelled))
    assert not Closure(facts, mentions=['"2"']).holds((x, mass, '"2"'))
    assert not Closure(facts).holds((x, mass, spelled))
