"""Inferred triples that are maintained commit by commit always equal those of a new reasoner."""

from functools import cache

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner, compiled
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.rules.facts import pack, unpack
from semmap.nodes.kb_node.sparql.triples.consequences import Consequences, inferred
from semmap.nodes.kb_node.sparql.triples.dataset import INFERRED, Dataset, Delta
from tests.depth import tries
from tests.kb_node.reasoner import graphs
from tests.kb_node.reasoner.facts import ANY_FACT

HOUSEHOLD = graphs.household()
TBOX = graphs.triples(graphs.EVERYTHING)
NAMES = ["room1", "room2", "flat1", "shelf1", "cup1", "cup2", "door1", "person1"]
CLASSES = ["Kitchen", "Apartment", "Shelf", "Cup", "Door", "Person", "Physical_Thing", "Location"]
PROPERTIES = [
    "isLocatedIn", "contains", "isSubLocationOf", "isOn", "isInside", "isPartOf", "hasDirectPart", "connects",
    "isAdjacentTo", "isConnectedTo", "touches", "holds", "isOwnedBy",
]  # fmt: skip


@pytest.fixture(autouse=True)
def _closed_once(monkeypatch):
    """Close the schema once, as it is the same in all examples."""
    close = cache(lambda facts: Closure(facts))
    monkeypatch.setattr(compiled, "Closure", lambda facts: close(tuple(facts)))


def _at_home():
    name = st.sampled_from(NAMES)
    typed = st.builds(lambda s, c: f":{s} a dm:{c}", name, st.sampled_from(CLASSES))
    linked = st.builds(lambda s, p, o: f":{s} dm:{p} :{o}", name, st.sampled_from(PROPERTIES), name)
    return st.one_of(typed, linked, linked).map(graphs.triple)


def _as_triples(dataset, graph):
    found = dataset.store.quads_for_pattern(None, None, None, graph)
    return {(str(q.subject), str(q.predicate), str(q.object)) for q in found}


def _follow(tbox, commits):
    """Apply each consistent commit and compare with a new reasoner."""
    dataset = Dataset(0, tbox)
    truth = Reasoner(tbox)
    closed = truth.closed and unpack(pack(truth.closed))  # from the node; the process computes it otherwise
    consequences = Consequences(tbox, dataset, closed=closed)
    said = dict.fromkeys(tbox)
    for seq, (delete, insert) in enumerate(commits, start=1):
        insert = tuple(t for t in dict.fromkeys(insert) if t not in said)
        delete = tuple(t for t in dict.fromkeys(delete) if t in said and t not in insert)
        try:
            truth.apply(delete=delete, insert=insert)
        except Inconsistent:
            continue
        said = {t: None for t in said if t not in delete} | dict.fromkeys(insert)
        delta = consequences.after(Delta(seq=seq, retracted=delete, inserted=insert))
        assert not set(delta.newly_inferred) & set(delta.no_longer_inferred)
        dataset.apply(delta)
        assert _as_triples(dataset, INFERRED) == set(inferred(truth))
    return dataset


def _commits(facts):
    return st.lists(st.tuples(st.lists(facts, max_size=3), st.lists(facts, max_size=3)), max_size=12)


SETTINGS = settings(deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


@settings(SETTINGS, max_examples=60)
@given(_commits(ANY_FACT))
def test_with_every_construct_of_the_language(commits):
    _follow(TBOX, commits)


@settings(SETTINGS, max_examples=tries(12))
@given(_commits(_at_home()))
def test_in_the_household(commits):
    _follow(HOUSEHOLD, commits)


def test_a_class_that_limits_values_makes_them_equal():
    before = graphs.triples(":a :m1 :x , :y . :z :free :x .")
    dataset = _follow(TBOX, [((), before), ((), graphs.triples(":a a :Max1 ."))])
    assert graphs.triple(":z :free :y") in _as_triples(dataset, INFERRED)
