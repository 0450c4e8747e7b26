import itertools
import math

from semmap.nodes.drawing.neighbourhood import around
from semmap.nodes.extern.web.views.graph_layout import arrange
from tests.recorder.messages import entity

ENTITIES = {f"book{i:02}": entity(f"book{i:02}", "Book") for i in range(40)} | {
    "shelf1": entity("shelf1", "Shelf")
}
RELATIONS = {name: (("isOn", "shelf1"),) for name in ENTITIES if name != "shelf1"}


def test_the_layout_is_deterministic():
    graph = around(["shelf1"], ENTITIES, RELATIONS)
    assert arrange(graph, {}) == arrange(graph, {})


def test_labels_do_not_overlap():
    for unfolded in ([], ["shelf1"]):
        graph = around(["shelf1"], ENTITIES, RELATIONS, unfolded=unfolded)
        at = arrange(graph, {})
        labels = {knot.id: knot.label for knot in graph.knots}
        for a, b in itertools.combinations(at, 2):
            (ax, ay), (bx, by) = at[a], at[b]
            wide = 7.0 * (len(labels[a]) + len(labels[b])) / 2.0
            assert abs(ax - bx) >= wide or abs(ay - by) >= 25.0, (a, b)


def test_earlier_nodes_stay_near_their_positions():
    few = around(["book01"], ENTITIES, RELATIONS)
    before = arrange(few, {})
    more = around(["book01"], ENTITIES, RELATIONS, unfolded=["shelf1"])
    after = arrange(more, before)
    assert len(after) > len(before)
    fresh = arrange(more, {})
    assert sum(math.dist(before[n], after[n]) for n in before) < sum(
        math.dist(before[n], fresh[n]) for n in before
    )


def test_empty_and_minimal_graphs_have_a_layout():
    assert arrange(around([], {}, {}), {}) == {}
    assert len(arrange(around(["shelf1"], ENTITIES, {}), {})) == 2
