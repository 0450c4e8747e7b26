from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy, hierarchy_of
from semmap.schemas.entities import ClassInfo


def test_the_class_table_tells_the_hierarchy_and_the_labels():
    row = ClassInfo(
        name="Coffee_Cup",
        iri="http://example.org/Coffee_Cup",
        parents=("Cup",),
        ancestors=("Cup", "Object"),
        labels={"it": "tazzina", "en": "coffee cup"},
        spatial=True,
        place=False,
        fixed=False,
        model="",
    )
    classes = hierarchy_of([row], {})
    assert classes.is_a("Coffee_Cup", "Cup")
    assert not classes.is_a("Cup", "Coffee_Cup")
    assert classes.related("Coffee_Cup", "Cup")
    assert classes.related("Cup", "Coffee_Cup")
    assert not classes.related("Cup", "Bottle")
    assert classes.label("Coffee_Cup") == "coffee cup"
    assert ClassHierarchy().label("Coffee_Cup") == "coffee cup"
    assert ClassHierarchy().is_a("Coffee_Cup", "Object")
