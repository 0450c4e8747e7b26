import random
from array import array

import pytest

from nodes.kb_node.reasoner.abox.adjacency import NONE, Adjacency

NODES, EDGES = 6, 120


def empty():
    made = Adjacency([NONE] * EDGES)
    made.heads = array("i", [NONE]) * NODES
    made.after, made.before, made.group = (array("i", [NONE]) * EDGES for _ in range(3))
    return made


def columns(adjacency):
    return [list(c) for c in (adjacency.heads, adjacency.after, adjacency.before, adjacency.group)]


@pytest.mark.parametrize("seed", range(100))
def test_linking_many_edges_leaves_what_linking_one_by_one_does(seed):
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
