"""Updates for commits take effect exactly once, even if they are sent twice, late or in part."""

from __future__ import annotations

from functools import partial

import pyoxigraph
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from semmap.nodes.extern.fleet import facts as f
from semmap.nodes.extern.fleet import updates
from semmap.nodes.extern.fleet.facts import Facts
from semmap.nodes.extern.fleet.frames import Frame
from semmap.nodes.extern.fleet.updates import Change
from semmap.schemas.bridge import MapCopy
from semmap.schemas.commits import Commit, Departed
from semmap.schemas.entities import Pose
from tests.recorder.messages import entity as made

FRAME = Frame(10.0, 0.0, 0.0, 0.0)


def triple(number):
    """One of few triples, some about blank nodes."""
    s = f"_:b{number}" if number % 3 == 0 else f"<urn:s{number}>"
    return (s, "<urn:p>", f'"{number}"')


numbers = st.sets(st.integers(0, 8), max_size=5)


@st.composite
def histories(draw):
    """Commits 2, 3, ... of a map, each with what was asserted after it; the first is commit 1, the copy."""
    there = frozenset(draw(numbers))
    history = [(None, there)]
    for seq in range(2, 2 + draw(st.integers(1, 6))):
        gone, come = draw(numbers) & there, draw(numbers) - there
        there = (there - gone) | come
        commit = Commit(
            seq=seq,
            stamp_ns=seq * 10**9,
            id=str(seq),
            source="operator",
            digest=f"d{seq}",
            retracted=tuple(map(triple, sorted(gone))),
            inserted=tuple(map(triple, sorted(come))),
        )
        history.append((commit, there))
    return history


def facts(seq, **more):
    return Facts(
        robot="r",
        map_id="m",
        begun=f.iso(0),
        epoch=1,
        commit=seq,
        digest=f"d{seq}",
        stamp=f.iso(seq * 10**9),
        **more,
    )


def whole(there, seq=1, entities=()):
    return MapCopy(
        map_id="m",
        begun_ns=0,
        seq=seq,
        digest=f"d{seq}",
        stamp_ns=seq * 10**9,
        triples=tuple(map(triple, sorted(there))),
        entities=entities,
    )


def graph(store, name="<urn:semmap:robot:r>"):
    node = pyoxigraph.NamedNode(name[1:-1])
    return {
        (str(q.subject), str(q.predicate), str(q.object))
        for q in store.quads_for_pattern(None, None, None, node)
    }


def expected(there):
    return set(updates.skolemize("r", map(triple, there)))


def said(store):
    """The facts as the server tells them."""
    return f.read([[str(t) for t in row] for row in store.query(f.QUERY)]).get("r")


def copied(there, **more):
    store = pyoxigraph.Store()
    wanted = facts(1, copying="me", **more)
    for operation in updates.copy_operations(None, wanted, whole(there)):
        store.update(operation)
    return store


@given(histories(), st.data())
def test_the_graph_is_the_map_as_of_the_commit_that_it_says(history, data):
    store = copied(history[0][1])
    assert graph(store) == expected(history[0][1])
    at = 0
    sent = []
    while at < len(history) - 1:
        until = data.draw(st.integers(at + 1, len(history) - 1))
        change = Change("r", None)
        for commit, _ in history[at + 1 : until + 1]:
            change.take(commit)
        before = said(store)
        after = structs.replace(
            before, commit=until + 1, digest=f"d{until + 1}", stamp=f.iso((until + 1) * 10**9)
        )
        operations = list(change.operations(before, after))
        sent += operations
        for operation in operations:
            store.update(operation)
        at = until
        assert graph(store) == expected(history[at][1])
        for late in data.draw(st.lists(st.sampled_from(sent), max_size=3)):
            store.update(late)  # sent twice, or carried out late
        assert graph(store) == expected(history[at][1])
        assert (said(store).commit, said(store).digest) == (at + 1, f"d{at + 1}")


@given(histories(), st.data())
def test_a_copy_that_was_cut_short_is_made_again(history, data):
    store = copied(history[0][1])
    (_, there) = history[-1]
    seq = len(history)
    first = list(updates.copy_operations(said(store), facts(seq, copying="one"), whole(there, seq)))
    cut = data.draw(st.integers(0, len(first)))
    for operation in first[:cut]:
        store.update(operation)
    state = said(store)
    assert (state.commit is None) == (0 < cut < len(first))
    for operation in updates.copy_operations(state, facts(seq, copying="two"), whole(there, seq)):
        store.update(operation)
    for late in first:
        store.update(late)
    assert graph(store) == expected(there)
    assert (said(store).commit, said(store).copying) == (seq, "")


def test_a_copy_says_that_it_is_one_until_it_is_whole():
    store = pyoxigraph.Store()
    *most, last = updates.copy_operations(None, facts(7, copying="me"), whole({1, 2}, 7))
    for operation in most:
        store.update(operation)
    assert (said(store).commit, said(store).copying) == (None, "me")
    store.update(last)
    assert said(store) == facts(7)


def test_of_two_who_begin_a_graph_one_does():
    store = pyoxigraph.Store()
    mine = list(updates.copy_operations(None, facts(1, copying="me"), whole({1})))
    theirs = list(updates.copy_operations(None, facts(1, copying="you"), whole({2})))
    for pair in zip(mine, theirs, strict=True):
        for operation in pair:
            store.update(operation)
    assert graph(store) == expected({1})


def test_an_epoch_that_ended_is_remembered():
    store = copied({1, 2})
    wanted = structs.replace(facts(1, copying="me"), map_id="other", digest="x1", epoch=2)
    for operation in updates.copy_operations(said(store), wanted, whole({3})):
        store.update(operation)
    assert graph(store) == expected({3})
    assert said(store) == structs.replace(wanted, copying="")
    ended = f"?e a {f.term('Epoch')} ; {f.term('number')} 1 ; {f.term('digest')} 'd1'"
    assert store.query(f"ASK {{ GRAPH {f.FACTS} {{ {ended} }} }}")


def entity(name, at):
    there = made(name, "Cup", at=Pose(position_m=at or (0.0, 0.0, 0.0)))
    return structs.replace(there, pose=there.pose if at else None)


def xs(store):
    rows = store.query(
        f"SELECT ?n ?x {{ GRAPH {f.poses_graph('r')} {{ ?s {f.term('entity')} ?n ; {f.term('x')} ?x }} }}"
    )
    return {row[0].value: float(row[1].value) for row in rows}


def test_poses_are_in_the_fleets_frame_and_go_with_their_entities():
    store = pyoxigraph.Store()
    there = (entity("cup1", (1.0, 0.0, 0.0)), entity("cup2", (2.0, 0.0, 0.0)), entity("kitchen1", None))
    for operation in updates.copy_operations(
        None, facts(1, copying="me", frame=FRAME), whole({1}, entities=there)
    ):
        store.update(operation)
    assert xs(store) == {"cup1": 11.0, "cup2": 12.0}
    make = partial(Commit, stamp_ns=0, id="2", source="operator")
    change = Change("r", FRAME)
    change.take(make(seq=2, changed=(entity("cup1", (5.0, 0.0, 0.0)),)))
    change.take(
        make(seq=3, changed=(entity("cup3", (3.0, 0.0, 0.0)),), removed=(Departed(name="cup2", types=()),))
    )
    for operation in change.operations(said(store), facts(3, frame=FRAME)):
        store.update(operation)
    assert xs(store) == {"cup1": 15.0, "cup3": 13.0}


@pytest.mark.parametrize("text", ['a "quoted" word', "back\\slash", "two\nlines", "ünïcode"])
def test_texts_survive(text):
    store = pyoxigraph.Store()
    store.update(f"INSERT DATA {{ <urn:s> <urn:p> {f.text(text)} }}")
    assert next(iter(store)).object.value == text
