from semmap.nodes.extern.web.views.entities.locations import Locations
from semmap.nodes.extern.web.views.trees import class_tree, place_tree
from tests.extern.web.views.sample_maps import by_name, class_, fact, place, thing

CLASSES = (
    class_("Thing"),
    class_("Dishware", "Thing"),
    class_("Graspable", "Thing"),
    class_("Cup", "Dishware", "Graspable", labels={"en": "cup"}),
    class_("Mug", "Cup", labels={"en": "large cup"}),
    class_("Chair", "Thing"),
)


def labels(nodes):
    return {node["label"]: labels(node["children"]) for node in nodes}


def known(*facts):
    locations = Locations()
    locations.reset(facts)
    return locations


def test_counts_include_inferred_instances_and_show_asserted_ones():
    tree = class_tree(
        CLASSES,
        [
            thing("cup1", types=("Dishware", "Thing")),
            thing("mug1", "Mug", types=("Cup", "Dishware", "Thing")),
        ],
    )
    assert labels(tree) == {
        "Thing · 2": {"Dishware · 2": {"Cup · 2 (1 asserted)": {"Mug (large cup) · 1": {}}}}
    }


def test_a_class_with_two_parents_is_below_both_with_different_ids():
    tree = class_tree(CLASSES, [], with_empty=True)
    (root,) = tree
    ids = [grandchild["id"] for child in root["children"] for grandchild in child["children"]]
    assert ids == ["Thing/Dishware/Cup", "Thing/Graspable/Cup"]
    assert len(labels(tree)["Thing"]) == 3


def test_cycles_of_classes_end():
    circle = (class_("Root"), class_("A", "B", "Root"), class_("B", "A"))
    assert labels(class_tree(circle, [], with_empty=True)) == {"Root": {"A": {"B": {}}}}


def test_classes_with_unknown_parents_are_roots():
    assert labels(class_tree([class_("A", "Nowhere")], [], with_empty=True)) == {"A": {}}


def test_places_are_below_their_parent_places():
    entities = by_name(
        place("flat1", (10.0, 8.0, 2.5), properties={"hasSubLocation": ("kitchen1",)}),
        place("kitchen1", preferred_reference="the kitchen"),
        place("corner1", (1.0, 1.0, 2.0)),
        thing("cup1"),
    )
    facts = (
        fact("cup1", "isLocatedIn", "kitchen1"),
        fact("cup1", "isLocatedIn", "flat1"),
        fact("corner1", "isLocatedIn", "kitchen1"),
        fact("corner1", "isLocatedIn", "flat1"),
    )
    assert labels(place_tree(entities, known(*facts))) == {
        "flat1 · 1": {"kitchen1 (the kitchen) · 1": {"corner1": {}}}
    }


def test_cycles_of_places_are_shown():
    entities = by_name(
        place("a", properties={"hasSubLocation": ("b",)}), place("b", properties={"hasSubLocation": ("a",)})
    )
    assert set(labels(place_tree(entities, known()))) == {"a", "b"}
