import random
from array import array

import pytest

from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE, Adjacency

NODES, EDGES = 6, 120


def empty():
    made = Adjacency([NONE] * EDGES)
    made.heads = array("i", [NONE]) * NODES
    made.after, made.before, made.group = (array("i", [NONE]) * EDGES for _ in range(3))
    return made


def columns(adjacency):
    return [list(c) for c in (adjacency.heads, adjacency.after, adjacency.before, adjacency.group)]


@pytest.mark.parametrize("seed", range(100))
def test_linking_many_edges_equals_linking_one_by_one(seed):
    rng = random.Random(seed)
    together, singly = empty(), empty()
    begin = 0
    while begin < EDGES:
        step, count = rng.randint(1, 3), rng.randint(1, 8)
        edges = range(begin, min(begin + step * count, EDGES), step)
        begin += step * count
        predicate = rng.randrange(3)
        alike = rng.random() < 0.5
        nodes = [rng.randrange(NODES)] * len(edges) if alike else rng.choices(range(NODES), k=len(edges))
        for adjacency in (together, singly):
            for edge in edges:
                adjacency.predicate[edge] = predicate
        together.link_each(nodes, edges, predicate)
        for node, edge in zip(nodes, edges, strict=True):
            singly.link(node, edge, predicate)
    assert columns(together) == columns(singly)


@pytest.mark.parametrize("seed", range(20))
def test_edges_are_found_by_several_predicates(seed):
    rng = random.Random(seed)
    adjacency = empty()
    of: dict[int, dict[int, set[int]]] = {node: {} for node in range(NODES)}
    for edge in range(EDGES // 6):
        node, predicate = rng.randrange(NODES), rng.randrange(5)
        adjacency.predicate[edge] = predicate
        adjacency.link(node, edge, predicate)
        of[node].setdefault(predicate, set()).add(edge)
    for node, edges in of.items():
        assert sorted(adjacency.predicates(node)) == sorted(edges)
        wanted = tuple(rng.sample(range(5), rng.randint(0, 5)))
        there = [predicate for predicate in wanted if predicate in edges]
        assert [adjacency.predicate[first] for first in adjacency.firsts(node, wanted)] == there
        assert adjacency.has_any(node, wanted) == bool(there)
        assert set(adjacency.among(node, wanted)) == {edge for p in there for edge in edges[p]}


@pytest.mark.parametrize("seed", range(20))
def test_linked_and_unlinked_edges_are_those_of_each_node(seed):
    rng = random.Random(seed)
    adjacency = empty()
    there: dict[int, tuple[int, int]] = {}
    for _ in range(3 * EDGES):
        edge = rng.randrange(EDGES // 4)
        if edge in there:
            adjacency.unlink(there.pop(edge)[0], edge)
        else:
            there[edge] = node, predicate = rng.randrange(NODES), rng.randrange(3)
            adjacency.predicate[edge] = predicate
            adjacency.link(node, edge, predicate)
    for node in range(NODES):
        own = {edge: predicate for edge, (at, predicate) in there.items() if at == node}
        assert sorted(adjacency.all(node)) == sorted(own)
        assert sorted(adjacency.predicates(node)) == sorted(set(own.values()))
        for predicate in range(4):
            alike = sorted(edge for edge, its in own.items() if its == predicate)
            assert sorted(adjacency.of(node, predicate)) == alike
            assert adjacency.first(node, predicate) in (alike or [NONE])
            assert all(adjacency.is_alone(edge) == (len(alike) == 1) for edge in alike)
    nodes = rng.sample(range(NODES), 3)
    own = [edge for edge, (at, _) in there.items() if at in nodes]
    assert sorted(adjacency.gather(nodes, EDGES)) == sorted(own)
    some = adjacency.gather(nodes, 2)
    assert set(some) <= set(own)
    assert len(some) == min(len(own), 3)
    unlinked = set(range(EDGES)) - there.keys()
    assert all(column[edge] == NONE for column in columns(adjacency)[1:] for edge in unlinked)


def test_a_cleared_edge_has_no_links():
    adjacency = empty()
    for edge, predicate in enumerate((0, 0, 0, 1)):
        adjacency.predicate[edge] = predicate
        adjacency.link(0, edge, predicate)
    for edge in range(4):
        adjacency.clear(edge)
    assert all(set(column) == {NONE} for column in columns(adjacency)[1:])


def test_first_edges_of_a_predicate_are_linked_before_the_others():
    adjacency = empty()
    adjacency.predicate[:6] = [0, 0, 1, 1, 1, 1]
    adjacency.link(0, 0, 0)
    adjacency.link(1, 1, 0)
    adjacency.link_firsts([0, 1, 2], range(2, 5))
    assert [list(adjacency.all(node)) for node in range(4)] == [[2, 0], [3, 1], [4], []]
    assert [list(adjacency.predicates(node)) for node in range(3)] == [[1, 0], [1, 0], [1]]
