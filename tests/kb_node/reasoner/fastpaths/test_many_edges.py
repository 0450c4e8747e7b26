"""Bulk insertion of computed facts gives the same result as single insertion."""

import random
from functools import partial

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.abox.saturation import Saturation
from semmap.nodes.kb_node.reasoner.fastpaths import paths
from semmap.nodes.kb_node.reasoner.fastpaths.many_edges import ManyEdges
from semmap.nodes.kb_node.reasoner.terms import TYPE
from tests.depth import tries
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.graphs import triple, triples
from tests.kb_node.reasoner.worlds import AXIOMS, KEYS, NOMINALS, TRANSITIVE, World

STEPS = 12
CHAINS = [text for text in AXIOMS if "Chain" in text] * 5 + [
    text for text in AXIOMS if text.startswith("{p}")
]
VALUES = [
    "{e} owl:equivalentClass {e}",
    "{e} rdfs:subClassOf {e}",
    "{p} rdfs:domain {c}",
    "{p} rdfs:range {c}",
]
THEMES = {
    "everything": AXIOMS,
    "keys": KEYS,
    "nominals": NOMINALS,
    "transitive": TRANSITIVE,
    "chains": CHAINS,
    "values": [*AXIOMS, *VALUES * 10],
    "restrictions": VALUES,
}
HOME = triples("""
:isOn a owl:ObjectProperty , owl:AsymmetricProperty ; owl:inverseOf :bears ;
    owl:propertyDisjointWith :isInside .
:bears a owl:ObjectProperty . :isInside a owl:ObjectProperty , owl:IrreflexiveProperty .
:isIn a owl:ObjectProperty ; rdfs:range :Place ;
    owl:propertyChainAxiom ( :isOn :isIn ) , ( :isIn :isPartOf ) .
:isPartOf a owl:ObjectProperty , owl:TransitiveProperty ; rdfs:subPropertyOf :isIn .
:Place owl:disjointWith :Thing . :Laden a owl:Class ; owl:onProperty :bears ; owl:someValuesFrom :Thing .
:Laden rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :affords ; owl:hasValue :putting ] .
:kitchen :isPartOf :flat . :table a :Thing .
""")


@pytest.fixture(autouse=True)
def comparable(monkeypatch):
    """Restore `MANY`, and disable fast removal, which may also remove computed facts."""
    monkeypatch.setattr(paths, "MANY", paths.MANY)
    monkeypatch.setattr(paths, "remove_individuals", lambda *_: None)


def together(reasoner, **change):
    """Apply a change by columns, even if it is small."""
    paths.MANY = 1
    reasoner.update_computed(**change)


def singly(reasoner, **change):
    """Apply a change edge by edge, even if it is large."""
    paths.MANY = 10**9
    reasoner.update_computed(**change)


def state(reasoner):
    individuals = {term for s, p, o in reasoner.given() for term in (s, o) if p != TYPE and term[0] == "<"}
    return (
        set(reasoner.asserted()),
        set(reasoner.computed()),
        set(reasoner.inferred()),
        {individual: reasoner.types(individual) for individual in individuals},
    )


def is_done(change):
    """Apply a change and return whether it was accepted."""
    try:
        change()
    except Inconsistent:
        return False
    return True


def follow(seed, theme):
    """Apply the same changes to two reasoners, in bulk and singly; return the number of facts."""
    world, random_ = World(seed, theme), random.Random(seed)
    try:
        pair = [Reasoner(world.asserted), Reasoner(world.asserted)]
    except Inconsistent:
        return 0
    taken = 0
    for _ in range(STEPS):
        some = None
        if random_.random() < 0.6:
            facts = [
                fact for fact in (world._fact() for _ in range(random_.randint(1, 12))) if fact[1] != TYPE
            ]
            there = sorted(pair[0].computed())
            gone = random_.sample(there, min(len(there), random_.choice((0, 0, 1, 3))))
            change = {"add": facts, "remove": gone}
            calls = [partial(call, one, **change) for call, one in zip((together, singly), pair, strict=True)]
        else:
            facts, some = [], world.change()
            change = some._asdict()
            calls = [partial(one.apply, **change) for one in pair]
        before = [state(one) for one in pair]
        done = [is_done(call) for call in calls]
        assert done[0] == done[1], change
        if not done[0]:
            assert [state(one) for one in pair] == before, change
        elif some:
            world.accept(some)
        else:
            taken += len(facts)
        assert state(pair[0]) == state(pair[1]), change
    found = sorted(pair[0].inferred())
    for fact in random_.sample(found, min(3, len(found))):
        proofs.check(pair[0].explain(fact), list(pair[0].given()))
    return taken


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_bulk_insertion_equals_single_insertion(theme):
    assert sum(follow(seed, theme) for seed in range(tries(12))) > tries(100)


@pytest.mark.long
@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_many_times(theme):
    for _ in range(100):
        seed = random.randrange(10**9)
        print(seed)  # shown if it fails
        follow(seed, theme)


def at_home(tables, per_table):
    """Return a kitchen with tables and cups on them, and a chair on a table without a location."""
    said, seen = list(HOME), []
    for n in range(tables):
        said += triples(f":t{n} a :Thing .")
        seen.append(f":t{n} :isIn :kitchen")
        for k in range(per_table):
            said += triples(f":c{n}_{k} a :Thing .")
            seen += [f":c{n}_{k} :isOn :t{n}", f":c{n}_{k} :isIn :kitchen"]
    return said, [triple(text) for text in (*seen, ":chair :isOn :t0")]


def test_a_home_is_the_same_as_with_single_insertion():
    said, seen = at_home(6, 7)
    pair = Reasoner(said), Reasoner(said)
    together(pair[0], add=seen)
    for fact in seen:
        singly(pair[1], add=[fact])
    assert state(pair[0]) == state(pair[1])
    for text in (
        ":c5_6 :isIn :flat",
        ":chair :isIn :flat",
        ":t5 a :Laden",
        ":t5 :affords :putting",
        ":t5 :bears :c5_6",
    ):
        assert pair[0].follows(triple(text)), text
    assert not pair[0].holds(triple(":c5_6 a :Laden"))
    for one in pair:
        one.update_computed(remove=seen)
    assert state(pair[0]) == state(pair[1]) == state(Reasoner(said))


FAULTS = [
    ":t3 :isOn :c3_0",  # what is asymmetric
    ":c2_1 :isInside :t2",  # what excludes another
    ":c1_1 :isIn :t1",  # the wrong class
    ":c0_0 :isInside :c0_0",  # what is irreflexive
]


@pytest.mark.parametrize(
    ("fault", "is_there"), [*((fault, False) for fault in FAULTS), *((fault, True) for fault in FAULTS[:2])]
)
def test_contradictory_facts_in_bulk_are_rejected_with_an_explanation(fault, is_there):
    said, seen = at_home(4, 3)
    fault = triple(fault)
    reasoner = Reasoner([*said, fault] if is_there else said)
    before = state(reasoner)
    with pytest.raises(Inconsistent) as refusal:
        together(reasoner, add=seen if is_there else [*seen, fault])
    support = refusal.value.explanation.support
    assert fault in support
    assert state(reasoner) == before
    together(reasoner, add=[fact for fact in seen if fact not in support])


def test_existing_facts_are_not_duplicated():
    said, seen = at_home(2, 2)
    reasoner = Reasoner([*said, seen[0]])
    together(reasoner, add=[*seen, *seen])
    together(reasoner, add=seen)
    assert sorted(reasoner.computed()) == sorted(set(seen) - {seen[0]})


def test_an_inferred_fact_that_is_now_computed_outlives_its_reason():
    said, seen = at_home(1, 1)
    cup_in_flat, cup_in_kitchen = triple(":c0_0 :isIn :flat"), triple(":c0_0 :isIn :kitchen")
    reasoner = Reasoner(said)
    together(reasoner, add=seen)
    assert not reasoner.is_computed(cup_in_flat)
    together(reasoner, add=[cup_in_flat])
    reasoner.update_computed(remove=[cup_in_kitchen, triple(":t0 :isIn :kitchen")])
    assert reasoner.holds(cup_in_flat)
    assert not reasoner.holds(cup_in_kitchen)


def test_no_edge_of_a_consistent_home_is_processed_singly(monkeypatch):
    said, seen = at_home(6, 7)
    reasoner = Reasoner(said)
    asked = []
    monkeypatch.setattr(Saturation, "_process_edge", lambda _, edge: asked.append(edge))
    together(reasoner, add=seen)
    assert not asked
    assert reasoner.holds(triple(":c5_6 :isIn :flat"))


def test_conclusions_of_chains_in_bulk_are_explained_and_removed_with_their_reasons():
    said, seen = at_home(2, 2)
    reasoner = Reasoner([*said, *triples(":flat :isPartOf :house .")])
    together(reasoner, add=seen)
    in_house = triple(":c1_1 :isIn :house")
    proofs.check(reasoner.explain(in_house), list(reasoner.given()))
    reasoner.update_computed(remove=[triple(":c1_1 :isIn :kitchen")])
    assert reasoner.holds(in_house)  # as what it is on is there
    reasoner.update_computed(remove=[triple(":t1 :isIn :kitchen")])
    assert not reasoner.holds(in_house)


@pytest.mark.parametrize(
    ("first", "then"),
    [
        ([":cup :isOn :tray", ":tray :isIn :kitchen"], []),
        ([":cup :isOn :tray"], [":tray :isIn :kitchen"]),
        ([":tray :isIn :kitchen"], [":cup :isOn :tray"]),
        ([":tray :bears :cup"], [":kitchen :has :tray"]),  # seen from the other end
        ([":kitchen :has :tray"], [":tray :bears :cup"]),
    ],
)
def test_a_chain_is_derived_in_any_order_of_insertion(first, then):
    reasoner = Reasoner([*HOME, *triples(":has owl:inverseOf :isIn .")])
    for come in (first, then):
        together(reasoner, add=[triple(text) for text in come])
    explanation = reasoner.explain(triple(":cup :isIn :flat"))
    proofs.check(explanation, list(reasoner.given()))
    assert {triple(text) for text in (*first, *then)} < set(explanation.support)
    assert not any(reasoner.inferred(triple(":flat :isIn :cup")[0], triple(":flat :isIn :cup")[1]))


@pytest.mark.parametrize("more", [":a :isOn :k", ":a :isIn :k", ":k :bears :a", ":a :isPartOf :k"])
def test_a_chain_is_derived_beside_other_edges_of_its_ends(more):
    one, other = Reasoner(HOME), Reasoner(HOME)
    facts = triples(f":a :isOn :b . :b :isIn :k . {more} .")
    together(one, add=facts)
    singly(other, add=facts)
    assert state(one) == state(other)
    assert one.holds(triple(":a :isIn :k"))


def test_free_rows_are_used_before_new_edges_are_allocated():
    said, seen = at_home(6, 7)
    reasoner = Reasoner(said)
    store = reasoner._engine._abox.store
    together(reasoner, add=seen)
    length = len(store.subject)
    for _ in range(3):
        reasoner.update_computed(remove=seen)
        together(reasoner, add=seen)
    assert len(store.subject) <= length + 256


def test_few_facts_are_inserted_singly(monkeypatch):
    monkeypatch.setattr(ManyEdges, "insert", None)
    said, seen = at_home(1, 2)
    Reasoner(said).update_computed(add=seen)
