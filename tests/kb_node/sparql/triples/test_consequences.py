"""What follows, kept beside what is said: always all that a reasoner says."""

from functools import cache

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from nodes.kb_node.reasoner import Inconsistent, Reasoner, compiled
from nodes.kb_node.reasoner.rules.closure import Closure
from nodes.kb_node.relations.placed import Placed
from nodes.kb_node.sparql.triples.consequences import Consequences, inferred
from nodes.kb_node.sparql.triples.dataset import ASSERTED, DENIED, INFERRED, Dataset, Delta
from schemas.entities import Pose
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
    """The schema is the same in all examples: close it once."""
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
    """Every consistent one of the commits, each compared with all that a reasoner says."""
    dataset = Dataset(0, tbox)
    consequences = Consequences(tbox, dataset)
    truth = Reasoner(tbox)
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


@settings(SETTINGS, max_examples=12)
@given(_commits(_at_home()))
def test_at_home(commits):
    _follow(HOUSEHOLD, commits)


def test_a_class_that_limits_values_makes_them_one():
    before = graphs.triples(":a :m1 :x , :y . :z :free :x .")
    dataset = _follow(TBOX, [((), before), ((), graphs.triples(":a a :Max1 ."))])
    assert graphs.triple(":z :free :y") in _as_triples(dataset, INFERRED)


SMALL = graphs.triples("""
dm:Cup a owl:Class ; owl:disjointWith dm:Kitchen . dm:Kitchen a owl:Class . dm:Shelf a owl:Class .
dm:Laden a owl:Class ; owl:onProperty dm:supports ; owl:someValuesFrom dm:Cup .
dm:isOn a owl:ObjectProperty , owl:AsymmetricProperty ; owl:inverseOf dm:supports ;
    owl:propertyDisjointWith dm:isInside .
dm:supports a owl:ObjectProperty . dm:isInside a owl:ObjectProperty ; owl:inverseOf dm:holds .
dm:holds a owl:ObjectProperty . dm:contains a owl:ObjectProperty .
dm:isLocatedIn a owl:ObjectProperty ; owl:inverseOf dm:contains ; rdfs:range dm:Kitchen ;
    owl:propertyChainAxiom ( dm:isOn dm:isLocatedIn ) .
""")
SIZES = {"room": (5.0, 5.0, 2.5), "flat": (9.0, 9.0, 2.5), "shelf": (1.0, 1.0, 0.75)}
SAID = st.one_of(
    st.builds(
        lambda s, c: f":{s} a dm:{c}",
        st.sampled_from(NAMES[:6]),
        st.sampled_from(["Cup", "Kitchen", "Shelf"]),
    ),
    st.builds(
        lambda s, p, o: f":{s} dm:{p} :{o}",
        st.sampled_from(NAMES[:6]),
        st.sampled_from(["isOn", "supports", "isInside", "isLocatedIn", "contains"]),
        st.sampled_from(NAMES[:6]),
    ),
).map(graphs.triple)
HEIGHTS = [0.0, 0.75, 0.77, 0.9]
PLACED = st.builds(
    lambda name, x, z: Placed(
        name=name,
        iri=f"http://example.org/{name}",
        pose=None if x is None else Pose(position_m=(x, 0.0, z)),
        size_m=SIZES.get(name[:-1], (0.1, 0.1, 0.1)),
        place=name.startswith(("room", "flat")),
        model="",
    ),
    st.sampled_from(NAMES[:6]),
    st.sampled_from([None, 0.0, 0.0, 0.3, 4.0]),
    st.sampled_from(HEIGHTS),
)  # fmt: skip
MOVES = st.tuples(st.lists(PLACED, max_size=4), st.lists(st.sampled_from(NAMES), max_size=1))


@settings(SETTINGS, max_examples=150)
@given(st.lists(st.tuples(st.lists(SAID, max_size=2), st.lists(SAID, max_size=3), MOVES), max_size=10))
def test_what_poses_tell_is_as_from_nothing_after_every_commit(commits):
    dataset = Dataset(0, SMALL)
    consequences = Consequences(SMALL, dataset)
    truth = Reasoner(SMALL)
    said, there = dict.fromkeys(SMALL), {}
    for seq, (delete, insert, (moved, removed)) in enumerate(commits, start=1):
        insert = tuple(t for t in dict.fromkeys(insert) if t not in said)
        delete = tuple(t for t in dict.fromkeys(delete) if t in said and t not in insert)
        try:
            truth.apply(delete=delete, insert=insert)
        except Inconsistent:
            continue
        said = {t: None for t in said if t not in delete} | dict.fromkeys(insert)
        moved = {placed.name: placed for placed in moved}
        removed = [name for name in removed if name not in moved]
        there = {name: p for name, p in (there | moved).items() if name not in removed}
        before = _seen(dataset)
        delta = consequences.after(Delta(seq=seq, retracted=delete, inserted=insert), moved.values(), removed)
        dataset.apply(delta)
        assert before ^ _seen(dataset) <= set(delta.everything)
        anew = Dataset(0, said)
        Consequences(said, anew, there.values())
        for graph in (ASSERTED, INFERRED, DENIED):
            assert _as_triples(dataset, graph) == _as_triples(anew, graph)
        assert dataset.denials == anew.denials == len(_as_triples(dataset, DENIED))
        assert _as_triples(dataset, ASSERTED) | _as_triples(dataset, DENIED) == set(said)


def _seen(dataset):
    return _as_triples(dataset, ASSERTED) | _as_triples(dataset, INFERRED)


def _placed(name, x, z, size=(0.1, 0.1, 0.1), place=False):
    pose = Pose(position_m=(x, 0.0, z))
    return Placed(name=name, iri=f"http://example.org/{name}", pose=pose, size_m=size, place=place, model="")


ROOM = _placed("room1", 0.0, 0.0, (5.0, 5.0, 2.5), place=True)
SHELF = _placed("shelf1", 0.0, 0.0, (1.0, 1.0, 0.75))


def _at(*placed, said=""):
    said = [*HOUSEHOLD, *graphs.triples(said)]
    dataset = Dataset(0, said)
    return Consequences(said, dataset, placed), dataset


def test_what_is_computed_has_consequences():
    consequences, dataset = _at(ROOM, SHELF, _placed("cup1", 0.0, 0.75), said=":shelf1 a dm:Shelf .")
    for follows in (":cup1 dm:isOn :shelf1", ":shelf1 dm:supports :cup1", ":cup1 dm:isLocatedIn :room1"):
        assert graphs.triple(follows) in _as_triples(dataset, INFERRED)
    delta = consequences.after(Delta(seq=1), [_placed("cup1", 20.0, 0.75)])
    dataset.apply(delta)
    assert graphs.triple(":cup1 dm:isOn :shelf1") in delta.no_longer_inferred
    assert not [t for t in _seen(dataset) if ":cup1" in t[0] and "isLocatedIn" in t[1]]


def test_what_geometry_denies_has_no_consequences():
    said = ":cup1 dm:isOn :shelf1 . :shelf1 dm:isLocatedIn :room1 ."
    far, near = _placed("cup1", 20.0, 0.75), _placed("cup1", 0.0, 0.75)
    consequences, dataset = _at(SHELF, far, said=said)
    on, in_ = graphs.triple(":cup1 dm:isOn :shelf1"), graphs.triple(":cup1 dm:isLocatedIn :room1")
    assert _as_triples(dataset, DENIED) == {on}
    assert not {on, in_} & _seen(dataset)
    dataset.apply(consequences.after(Delta(seq=1), [near]))
    assert {on, in_} <= _seen(dataset)
    assert not _as_triples(dataset, DENIED)
    dataset.apply(consequences.after(Delta(seq=2), [far]))
    dataset.apply(consequences.after(Delta(seq=3, retracted=(on,))))
    assert dataset.denials == 0
    assert on not in _as_triples(dataset, ASSERTED)


def test_a_computed_fact_that_contradicts_is_withheld_until_it_does_not():
    cup = _placed("cup1", 0.0, 0.75)
    consequences, dataset = _at(ROOM, SHELF, cup, said=":room1 a dm:Cup .")
    in_, on = graphs.triple(":cup1 dm:isLocatedIn :room1"), graphs.triple(":cup1 dm:isOn :shelf1")
    assert in_ not in _seen(dataset)
    assert on in _seen(dataset)
    dataset.apply(consequences.after(Delta(seq=1, retracted=tuple(graphs.triples(":room1 a dm:Cup .")))))
    assert in_ in _seen(dataset)
    dataset.apply(consequences.after(Delta(seq=2, inserted=tuple(graphs.triples(":room1 a dm:Cup .")))))
    assert in_ not in _seen(dataset)


def test_a_tbox_without_these_properties_has_nothing_computed():
    dataset = Dataset(0, TBOX)
    Consequences(TBOX, dataset, [ROOM, SHELF])
    assert not [t for t in _seen(dataset) if "room1" in t[2]]
