from semmap.nodes.drawing.neighbourhood import GraphEdge, around, by_class, by_place
from tests.recorder.messages import entity

ENTITIES = {
    "cup1": entity("cup1", "Cup"),
    "cup2": entity("cup2", "Cup"),
    "table1": entity("table1", "Table"),
    "kitchen1": entity(
        "kitchen1", "Kitchen", place=True, size_m=(4.0, 3.0, 2.5), preferred_reference="kitchen"
    ),
    "corner1": entity("corner1", "Corner", place=True, size_m=(1.0, 1.0, 2.5)),
}
RELATIONS = {
    "cup1": (
        ("isOn", "table1"),
        ("isAbove", "table1"),
        ("isLocatedIn", "kitchen1"),
        ("isLocatedIn", "corner1"),
    ),
    "table1": (("isLocatedIn", "kitchen1"), ("isOn", "table1")),
    "kitchen1": (("hasSubLocation", "corner1"), ("isLit", "nowhere")),
}


def names(graph):
    return [knot.id for knot in graph.knots]


def test_around_a_thing_are_its_class_and_what_is_next_to_it_only():
    graph = around(["cup1"], ENTITIES, RELATIONS)
    assert set(names(graph)) == {"cup1", "class:Cup", "table1", "kitchen1", "corner1"}
    assert GraphEdge("cup1", "table1", "isAbove, isOn") in graph.links
    assert not [link for link in graph.links if "cup1" not in (link.source, link.target)]


def test_what_leads_to_a_thing_is_next_to_it():
    assert GraphEdge("cup1", "table1", "isAbove, isOn") in around(["table1"], ENTITIES, RELATIONS).links


def test_unfolded_things_are_shown_with_their_own_neighbours():
    graph = around(["cup1"], ENTITIES, RELATIONS, unfolded=["kitchen1", "not_shown"])
    assert GraphEdge("table1", "kitchen1", "isLocatedIn") in graph.links
    assert GraphEdge("kitchen1", "corner1", "hasSubLocation") in graph.links


def test_of_many_neighbours_the_rest_is_counted_and_unfolds():
    many = {f"book{i:02}": entity(f"book{i:02}", "Book") for i in range(40)}
    entities = {**ENTITIES, **many}
    relations = dict.fromkeys(many, (("isOn", "table1"),))
    graph = around(["table1"], entities, relations)
    more = next(knot for knot in graph.knots if knot.kind == "more")
    shown = sum(name in many for name in names(graph))
    assert shown + more.hidden == 40
    assert shown < 20
    unfolded = around(["table1"], entities, relations, unfolded=["table1"])
    assert sum(name in many for name in names(unfolded)) == 40


def test_a_thousand_things_stay_readable():
    entities = {f"cup{i}": entity(f"cup{i}", "Cup") for i in range(1000)} | ENTITIES
    relations = {name: (("isLocatedIn", "kitchen1"),) for name in entities if name != "kitchen1"}
    assert len(around(["kitchen1"], entities, relations).knots) < 40
    assert len(around(list(entities), entities, relations).knots) < 80
    assert len(by_place(entities, relations).knots) == 2
    assert len(by_class(entities, ["Cup"]).knots) < 80


def test_by_place_each_thing_counts_in_its_smallest_place():
    graph = by_place(ENTITIES, RELATIONS)
    assert {knot.id: knot.hidden for knot in graph.knots} == {
        "kitchen1": 1,
        "corner1": 1,
        "more:elsewhere": 1,
    }
    assert graph.knots[1].label == "kitchen (1)"
    assert graph.links == (GraphEdge("kitchen1", "corner1", "hasSubLocation"),)


def test_by_place_each_place_is_in_the_smallest_around_it_and_nothing_is_said_twice():
    places = ENTITIES | {
        "flat1": entity("flat1", "Location", place=True, size_m=(9.0, 9.0, 2.5)),
        "hall1": entity("hall1", "Corridor", place=True, size_m=(1.0, 9.0, 2.5)),
    }
    relations = {
        "corner1": (("isLocatedIn", "kitchen1"), ("isLocatedIn", "flat1")),
        "kitchen1": (("hasSubLocation", "corner1"), ("isAdjacentTo", "hall1"), ("isLocatedIn", "flat1")),
        "hall1": (("isAdjacentTo", "kitchen1"), ("isLocatedIn", "flat1")),
        "flat1": (("hasSubLocation", "kitchen1"), ("hasSubLocation", "hall1")),
    }
    assert {(a, said, b) for a, b, said in by_place(places, relations).links} == {
        ("corner1", "isLocatedIn", "kitchen1"),
        ("kitchen1", "isLocatedIn", "flat1"),
        ("hall1", "isLocatedIn", "flat1"),
        ("hall1", "isAdjacentTo", "kitchen1"),
    }


def test_without_places_it_is_by_class():
    cups = {name: ENTITIES[name] for name in ("cup1", "cup2", "table1")}
    assert by_place(cups, {}) == by_class(cups)


def test_a_class_unfolds_into_its_entities():
    graph = by_class(ENTITIES, ["Cup", "Unheard_Of"])
    assert graph.knots[0].label == "Cup (2)"
    assert graph.links == (GraphEdge("cup1", "class:Cup", "is a"), GraphEdge("cup2", "class:Cup", "is a"))


def test_of_an_empty_map_there_is_nothing():
    assert around(["cup1"], {}, {}).knots == by_place({}, {}).knots == ()
