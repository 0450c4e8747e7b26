from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.kinds import Kinds
from semmap.nodes.kb_node.reasoner.abox.store import ASSERTED, BLOCK, COMPUTED, DERIVED, VALUE, Store
from semmap.nodes.kb_node.reasoner.fastpaths.layout import Layout
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.tbox.schema import Schema
from tests.kb_node.reasoner.graphs import triples

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


A, B, C, X, Y = ("<urn:a>", "<urn:b>", "<urn:c>", '"x"', '"y"')


def new_store():
    return Store(Kinds(SCHEMA))


def contents(store):
    """Return the edges with their sources, after a check that all ways of finding them agree."""
    found = {}
    for node, term in enumerate(store.terms):
        if not term:
            assert store.is_bare(node)
            assert node not in store.numbers.values()
            continue
        assert store.numbers[term] == node
        leaving, entering = list(store.out.all(node)), list(store.into.all(node))
        assert len(set(leaving)) == len(leaving)
        assert all(store.subject[edge] == node for edge in leaving)
        assert all(store.object[edge] == node for edge in entering)
        for edge in leaving:
            assert edge in store.into.all(store.object[edge])
            assert edge in store.out.of(node, store.predicate[edge])
            triple = (term, store.predicate[edge], store.terms[store.object[edge]])
            assert store.edge(*(store.numbers[term], triple[1], store.object[edge])) == edge
            found[triple] = store.source[edge]
        for edge in entering:
            assert edge in store.out.all(store.subject[edge])
    return found


def two_related(store):
    """Return the layout of two individuals: the first has two kinds of edges, the second one value."""
    kind, text = store._kinds.individual(A), store._kinds.literal(X)
    return Layout(
        kinds=(kind, kind),
        others=(text, text),
        edges=((0, 2, 1), (0, 3, 2), (0, 2, 3), (1, 2, 2)),
        values=(3,),
        heads=((0, 0), (1, 3)),
        groups=((0, 1),),
        pairs=((0, 2),),
    )


def as_two_related(one, other, *texts):
    first, second = texts
    return {
        (one, 2, other): ASSERTED,
        (one, 3, first): ASSERTED,
        (one, 2, second): ASSERTED,
        (other, 2, first): VALUE,
    }


def test_a_written_run_has_the_edges_of_its_layout():
    store = new_store()
    layout = two_related(store)
    store.write(layout, (A, B), (X, Y))
    store.write(layout, (C, "<urn:d>"), ('"z"', X))
    assert contents(store) == as_two_related(A, B, X, Y) | as_two_related(C, "<urn:d>", '"z"', X)


def test_many_runs_in_new_rows_have_the_edges_of_their_layout():
    store = new_store()
    x, y = store.node(X), store.node(Y)
    before = store.add(store.node(C), 2, x, ASSERTED)
    firsts, seconds = ("<urn:a1>", "<urn:a2>"), ("<urn:b1>", "<urn:b2>")
    store.append(two_related(store), [firsts, seconds], [[x, y], [y, y]])
    expected = as_two_related(firsts[0], seconds[0], X, Y) | as_two_related(firsts[1], seconds[1], Y, Y)
    assert contents(store) == {(C, 2, X): ASSERTED} | expected
    assert store.edge(store.node(C), 2, x) == before


def test_many_edges_are_added_as_single_ones():
    count = 3 * BLOCK
    for is_first in (False, True):
        store = new_store()
        things = [store.node(f"<urn:t{n}>") for n in range(count)]
        here = store.node(A)
        store.add(things[0], 3, here, ASSERTED)
        store.log = []
        assert list(store.add_each(2, [], [], DERIVED)) == []
        edges = store.add_each(2, things, [here] * count, DERIVED, is_first=is_first)
        assert len(edges) == count
        assert store.log == [(thing, 2, here) for thing in things]
        expected = {(f"<urn:t{n}>", 2, A): DERIVED for n in range(count)}
        assert contents(store) == expected | {("<urn:t0>", 3, A): ASSERTED}


def test_several_edges_of_one_subject_are_added_together():
    store = new_store()
    here, things = store.node(A), [store.node(f"<urn:t{n}>") for n in range(2 * BLOCK)]
    store.add_each(2, [here] * len(things), things, ASSERTED)
    assert contents(store) == {(A, 2, f"<urn:t{n}>"): ASSERTED for n in range(len(things))}


def test_literals_are_added_once():
    store = new_store()
    known = store.node(X)
    nodes = store.add_literals(dict.fromkeys((X, Y), store._kinds.literal(X)))
    assert nodes == {X: known, Y: store.find(Y)}
    assert store.terms[nodes[Y]] == Y
    assert store.kind[nodes[Y]] is store._kinds.literal(Y)


def test_a_replaced_literal_is_removed_unless_it_is_used():
    store = new_store()
    a, b, x = store.node(A), store.node(B), store.node(X)
    edge, other = store.add(a, 2, x, ASSERTED), store.add(b, 2, x, ASSERTED)
    store.replace_literal(edge, Y)
    assert contents(store) == {(A, 2, Y): ASSERTED, (B, 2, X): ASSERTED}
    store.replace_literal(other, Y)
    assert contents(store) == {(A, 2, Y): ASSERTED, (B, 2, Y): ASSERTED}
    assert store.find(X) is None


def test_erased_individuals_take_their_edges_with_them():
    store = new_store()
    a, b, c, x, y = map(store.node, (A, B, C, X, Y))
    gone = [store.add(*edge) for edge in ((a, 2, x, VALUE), (a, 2, y, ASSERTED), (a, 3, c, ASSERTED))]
    gone += [store.add(*edge) for edge in ((a, 2, b, ASSERTED), (b, 2, a, ASSERTED), (b, 3, c, ASSERTED))]
    store.add(c, 2, y, COMPUTED)
    free = len(store._free_edges)
    store.erase({a, b}, gone)
    assert contents(store) == {(C, 2, Y): COMPUTED}
    assert [store.find(term) for term in (A, B, X)] == [None] * 3
    assert len(store._free_edges) == free + len(gone)
    again = store.add(store.node(A), 2, store.node(X), ASSERTED)
    assert contents(store) == {(C, 2, Y): COMPUTED, (A, 2, X): ASSERTED}
    assert store.source[again] == ASSERTED


def test_an_edge_is_found_by_one_of_several_predicates():
    store = new_store()
    a, b, c = map(store.node, (A, B, C))
    second = store.add(a, 3, b, ASSERTED)
    first = store.add(a, 2, b, ASSERTED)
    store.add(a, 2, c, ASSERTED)
    assert store.edge_of(a, (2, 3), b) == first
    assert store.edge_of(a, (3, 2), b) == second
    assert store.edge_of(a, (3,), c) == NONE
    assert store.edge_of(a, (), b) == NONE
    assert store.edge_of(b, (2, 3), a) == NONE


def test_a_removed_edge_is_recorded_and_its_row_reused():
    store = new_store()
    a, b = store.node(A), store.node(B)
    store.log = []
    edge = store.add(a, 2, b, DERIVED)
    store.remove(edge)
    assert store.log == [(a, 2, b)] * 2
    assert contents(store) == {}
    assert store.add(b, 2, a, ASSERTED) == edge
    assert contents(store) == {(B, 2, A): ASSERTED}


def test_free_rows_are_counted_for_compaction():
    store = new_store()
    assert store.free_rows == 0
    store.add(store.node(A), 2, store.node(B), ASSERTED)
    assert store.free_rows == BLOCK - 1


def test_individuals_are_listed_under_their_kind():
    ((cls, *_),) = tbox = triples(":Cup a owl:Class .")
    schema = Schema(Closure(tbox))
    store = Store(Kinds(schema))
    cup = store._kinds.of(frozenset({schema.cls(cls)}))
    nodes = [store.node(term) for term in (A, B, C)]
    for node in nodes:
        store.list_under_kind(node, store.kind[node], cup)
        store.kind[node] = cup
    assert list(cup.nodes) == nodes
    store.list_under_kind(nodes[0], cup, None)
    assert sorted(cup.nodes) == nodes[1:]
    for node in nodes[1:]:
        assert cup.nodes[store.places[node]] == node
    store.list_under_kind(nodes[1], cup, None)
    assert list(cup.nodes) == nodes[2:]
