from nodes.recorder.drawing import graph
from nodes.recorder.drawing.graph import Graph, graph_of, nodes_and_edges
from tests.recorder.messages import entity

ENTITIES = {"cup1": entity("cup1", "Cup"), "table1": entity("table1", "Table")}


def test_relations_become_edges_once():
    found = graph_of(ENTITIES, {"cup1": (("isAbove", "table1"), ("isOn", "table1")), "table1": ()})
    assert found == Graph({"cup1": "Cup", "table1": "Table"}, (("cup1", "table1"),))


def test_a_large_map_is_drawn_in_part(monkeypatch):
    monkeypatch.setattr(graph, "LIMIT", 1)
    found = graph_of(ENTITIES, {"cup1": (("isOn", "table1"),)})
    assert found == Graph({"cup1": "Cup"}, ())


def test_every_entity_has_an_edge_to_its_class():
    nodes, edges = nodes_and_edges(Graph({"cup1": "Cup", "cup2": "Cup"}, (("cup1", "cup2"),)))
    assert nodes.node_ids is not None
    assert edges.edges is not None
    assert nodes.node_ids.as_arrow_array().to_pylist() == ["cup1", "cup2", "class:Cup"]
    pairs = [(edge["first"], edge["second"]) for edge in edges.edges.as_arrow_array().to_pylist()]
    assert pairs == [("cup1", "class:Cup"), ("cup2", "class:Cup"), ("cup1", "cup2")]
