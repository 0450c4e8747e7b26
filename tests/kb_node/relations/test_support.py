"""What an object rests on through others, and why an object is on nothing."""

import pytest

from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.support import describe_unsupported, find_contents, find_supporters
from tests.kb_node.relations.entities import ROOM, thing

TABLE = thing("table1", (0.0, 0.0, 0.0), "", size=(1.0, 1.0, 0.7))
BOOK = thing("book1", (0.0, 0.0, 0.7), "", size=(0.3, 0.3, 0.05))
STONE = thing("stone1", (0.0, 0.0, 0.75), "", size=(0.1, 0.1, 0.1))


def at(x, z, **options):
    return thing("a1", (x, 0.0, z), "", size=(0.2, 0.2, 0.2), **options)


def test_supporters_are_found_through_others():
    space = Space([ROOM, STONE, TABLE, BOOK])
    found = {name: {s.name for s in find_supporters(space, solid)} for name, solid in space.solids.items()}
    assert found == {
        "kitchen1": set(),
        "table1": set(),
        "book1": {"table1"},
        "stone1": {"table1", "book1"},
    }
    listed = {
        name: [(how, upper.name) for how, upper, _ in find_contents(space, solid)]
        for name, solid in space.solids.items()
    }
    assert listed == {
        "kitchen1": [],
        "table1": [("isOn", "book1")],
        "book1": [("isOn", "stone1")],
        "stone1": [],
    }


@pytest.mark.parametrize(
    ("entity", "gap_m", "share", "reason"),
    [
        (at(0.0, 1.0), 0.3, 1.0, "its bottom is 30.0 cm above a surface of table1"),
        (at(0.5, 1.0), 0.3, 0.5, "its bottom is 30.0 cm above a surface of table1"),
        (at(2.0, 0.5), 0.5, 0.0, "its bottom is 50.0 cm above the floor of kitchen1"),
        (
            at(9.0, 0.5), 0.5, 0.0,
            "its bottom is at a height of 50.0 cm, and it is not in a place with a floor",
        ),
        (
            at(0.58, 0.72), 0.02, 0.1,
            "its bottom is 2.0 cm above a surface of table1, but 10% of its base is over it",
        ),
    ],
)  # fmt: skip
def test_an_object_without_support(entity, gap_m, share, reason):
    found = describe_unsupported(space := Space([ROOM, TABLE, entity]), space.solids["a1"])
    assert (found.relation, found.subject, found.object, found.holds) == ("isOn", "a1", "", False)
    assert (found.gap_m, found.share) == pytest.approx((gap_m, share))
    assert found.text == f"a1 is on nothing: {reason}"


@pytest.mark.parametrize("entity", [at(0.0, 0.7), at(2.0, 0.0), at(9.0, 0.04), at(2.0, 1.0, place=True)])
def test_an_object_on_something_or_on_the_ground_lacks_no_support(entity):
    space = Space([ROOM, TABLE, entity])
    assert describe_unsupported(space, space.solids["a1"]) is None


def test_an_object_of_unknown_size_has_no_known_support():
    space = Space([ROOM, TABLE, thing("a1", (0.0, 0.0, 1.0), "unheard of")])
    found = describe_unsupported(space, space.solids["a1"])
    assert found.text == (
        "a1 has no known support: its size is unknown, so only its place can be computed;"
        " set a size: semmap update a1 --size X Y Z"
    )
