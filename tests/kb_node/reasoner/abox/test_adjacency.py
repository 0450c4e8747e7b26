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
