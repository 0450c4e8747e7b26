from semmap.nodes.drawing.neighbourhood import around, by_class
from semmap.nodes.extern.web.views.graph_chart import QUERY, chart_options, relations_of, rows_of
from semmap.ontology import vocabulary as v
from tests.recorder.messages import entity

ENTITIES = {
    "cup1": entity("cup1", "Cup", properties={"madeFor": ("table1", "unknown"), "isFull": True}),
    "table1": entity("table1", "Table", properties={"hasColor": "table1_of_old"}),
}
ON = (v.entity_iri("cup1"), v.dm("isOn"), v.entity_iri("table1"))


def test_relations_are_asserted_or_computed():
    rows = [ON, (v.entity_iri("cup1"), v.dm("isOn"), v.entity_iri("gone1")), (None, None, None)]
    assert relations_of(ENTITIES, rows) == {"cup1": (("isOn", "table1"), ("madeFor", "table1"))}


def test_the_query_has_the_relations_of_every_commit():
    assert v.dm("isOn") in QUERY
    assert v.dm("isLocatedIn") in QUERY


def test_names_are_never_templates_or_keys():
    evil = "<img src=x onerror=alert(1)>{b}"
    entities = {"cup1": entity("cup1", evil)}
    drawn = chart_options(by_class(entities), {}, ())
    (node,) = drawn["series"][0]["data"]
    assert node["name"].startswith("<img src=x")
    assert "formatter" not in node["label"]
    assert drawn["tooltip"] == {"show": False}
    assert not [key for key in node if key.startswith(":")]


def test_selected_nodes_are_highlighted_and_all_have_positions():
    graph = around(["cup1"], ENTITIES, relations_of(ENTITIES, [ON]))
    drawn = chart_options(graph, {"cup1": (3.0, 4.0)}, ["cup1"])["series"][0]
    by_id = {node["id"]: node for node in drawn["data"]}
    assert (by_id["cup1"]["x"], by_id["cup1"]["y"]) == (3.0, 4.0)
    assert by_id["cup1"]["itemStyle"]["borderWidth"] == 3
    assert "borderWidth" not in by_id["table1"]["itemStyle"]
    assert {(link["source"], link["target"]) for link in drawn["links"]} == {
        ("cup1", "class:Cup"), ("cup1", "table1")
    }  # fmt: skip


def test_the_table_has_the_links_of_the_graph():
    graph = around(["cup1"], ENTITIES, relations_of(ENTITIES, [ON]))
    rows = [(row["source"], row["label"], row["target"], row["names"]) for row in rows_of(graph, ENTITIES)]
    assert rows == [
        ("cup1", "is a", "Cup", ["cup1"]), ("cup1", "isOn, madeFor", "table1", ["cup1", "table1"])
    ]  # fmt: skip
