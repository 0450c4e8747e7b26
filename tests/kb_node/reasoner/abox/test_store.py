from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.kinds import Kinds
from semmap.nodes.kb_node.reasoner.abox.store import ASSERTED, Store
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.tbox.schema import Schema

SCHEMA = Schema(Closure())
EDGES = st.tuples(st.integers(0, 3), st.integers(2, 4), st.integers(0, 3))


@given(st.lists(st.tuples(st.booleans(), EDGES), max_size=40))
def test_edges_are_found_from_both_ends_and_in_groups(changes):
    store = Store(Kinds(SCHEMA))
    nodes = [store.node(f"<http://example.org/{i}>") for i in range(4)]
    there = {}
    for adds, triple in changes:
        if adds and triple not in there:
            there[triple] = store.add(*triple, ASSERTED)
        elif not adds and triple in there:
            store.remove(there.pop(triple))
    for s in nodes:
        assert {store.object[e] for p in (2, 3, 4) for e in store.out.of(s, p)} == {
            o for a, _, o in there if a == s
        }
        assert sorted(store.out.all(s)) == sorted(e for (a, _, _), e in there.items() if a == s)
        assert sorted(store.into.all(s)) == sorted(e for (_, _, b), e in there.items() if b == s)
        assert store.is_bare(s) == all(s not in (a, b) for a, _, b in there)
        for p in (2, 3, 4):
            for o in nodes:
                assert store.edge(s, p, o) == there.get((s, p, o), NONE)


def test_a_released_number_is_reused():
    store = Store(Kinds(SCHEMA))
    first = store.node("<http://example.org/a>")
    assert store.release(first)
    assert store.find("<http://example.org/a>") is None
    assert store.node("<http://example.org/b>") == first


def test_a_node_with_an_edge_is_not_released():
    store = Store(Kinds(SCHEMA))
    a, b = store.node("<http://example.org/a>"), store.node('"b"')
    edge = store.add(a, 2, b, ASSERTED)
    assert not store.release(b)
    store.remove(edge)
    assert store.release(b)
