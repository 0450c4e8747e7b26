from semmap.nodes.drawing.neighbourhood import GraphEdge, GraphNode, Neighbourhood
from semmap.nodes.recorder.drawing.graph import MANY, graph_of, nodes_and_edges
from tests.recorder.messages import entity

ENTITIES = {
    "cup1": entity("cup1", "Cup"),
    "table1": entity("table1", "Table"),
    "room1": entity("room1", "Kitchen", place=True),
    **{f"book{i}": entity(f"book{i}", "Book") for i in range(MANY + 1)},
}
RELATIONS = {"cup1": (("isOn", "table1"), ("isLocatedIn", "room1"))}


def names(graph):
    return {knot.id for knot in graph.knots}


def test_what_a_commit_touched_is_shown_with_what_is_next_to_it():
    assert names(graph_of(ENTITIES, RELATIONS, ["cup1"])) == {"cup1", "class:Cup", "table1", "room1"}


def test_without_a_commit_and_for_a_large_one_the_whole_is_shown_by_places():
    for touched in ((), ["gone1"], [name for name in ENTITIES if name.startswith("book")]):
        graph = graph_of(ENTITIES, RELATIONS, touched)
        assert [knot.label for knot in graph.knots] == ["room1 (1)", f"{MANY + 2} elsewhere"]


def test_of_many_edges_it_is_not_written_what_they_say():
    knots = [
        GraphNode("cup1", "cup1", "centre", "Cup"),
        *(GraphNode(f"b{i}", f"b{i}", "entity", "B") for i in range(20)),
    ]
    nodes, edges = nodes_and_edges(
        Neighbourhood(tuple(knots), tuple(GraphEdge("cup1", f"b{i}", "isNear") for i in range(20)))
    )
    assert nodes.node_ids is not None
    assert edges.edges is not None
    assert len(nodes.node_ids.as_arrow_array()) == 21
    assert edges.edges.as_arrow_array().to_pylist()[3] == {"first": "cup1", "second": "b3"}


def test_what_an_edge_says_is_a_small_node_on_it():
    knots = (GraphNode("cup1", "cup1", "centre", "Cup"), GraphNode("table1", "table1", "entity", "Table"))
    more = GraphNode("more:cup1:in", "3 more", "more", "")
    graph = Neighbourhood(
        (*knots, more), (GraphEdge("cup1", "table1", "isOn"), GraphEdge("more:cup1:in", "cup1", ""))
    )
    nodes, edges = nodes_and_edges(graph)
    assert nodes.node_ids is not None
    assert nodes.labels is not None
    assert edges.edges is not None
    assert nodes.node_ids.as_arrow_array().to_pylist() == [
        "cup1", "table1", "more:cup1:in", "cup1 isOn table1"
    ]  # fmt: skip
    assert nodes.labels.as_arrow_array().to_pylist() == ["cup1", "table1", "3 more", "isOn"]
    pairs = [(edge["first"], edge["second"]) for edge in edges.edges.as_arrow_array().to_pylist()]
    assert pairs == [("cup1", "cup1 isOn table1"), ("cup1 isOn table1", "table1"), ("more:cup1:in", "cup1")]
