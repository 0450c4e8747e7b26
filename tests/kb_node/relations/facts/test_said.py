"""Said against seen."""

import math

import pytest
from msgspec import structs

from benchmarks.relations.accuracy import FLAT_BY_HAND
from semmap.nodes.kb_node.answers import answers
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.relations.facts.said import denial, denied, fact_of
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Pose
from tests.kb_node import home
from tests.kb_node.relations.made import CORNER, ROOM, TABLE, TOP, thing

CHAIR = thing("chair1", (2.0, 0.0, 0.0))
BOOK = thing("book1", (0.0, 0.0, TOP))
BOWL = thing("bowl1", (0.2, 0.2, TOP))
WALL = thing("wall1", (0.0, -3.0, 0.0), "wall", size=(6.0, 0.1, 2.5))
FLAT_BED = thing("bed1", (1.0, 1.0, 0.0), "nothing known")


def against(relation, entity, other, *others):
    space = Space(
        {e.name: e for e in (ROOM, CORNER, TABLE, CHAIR, BOOK, BOWL, WALL, entity, other, *others)}.values()
    )
    found = denial(space, (entity.name, relation, other.name))
    return found and found.text


@pytest.mark.parametrize(
    ("relation", "entity", "other", "text"),
    [
        ("isOn", thing("cup1", (0.3, 0.0, TOP)), TABLE, None),
        ("isOn", thing("cup1", (0.3, 0.0, TOP + 0.04)), TABLE, None),
        ("isOn", thing("cup1", (0.0, 0.0, TOP + BOOK.size_m[2])), TABLE, None),
        ("isOn", thing("apple1", (0.2, 0.2, TOP + 0.02)), TABLE, None),
        ("isOn", thing("cup1", None), TABLE, None),
        ("isOn", thing("thing1", (5.0, 5.0, 0.0), "unheard of"), TABLE, None),
        ("isOn", thing("cup1", (0.0, 0.0, 0.0)), FLAT_BED, None),
        ("isOn", thing("clock1", (0.0, -2.92, 1.5), yaw=math.pi / 2), WALL, None),
        ("isInside", thing("apple1", (0.2, 0.2, TOP + 0.02)), BOWL, None),
        ("isInside", thing("apple1", (0.2, 0.2, TOP + 0.05)), BOWL, None),
        ("isLocatedIn", thing("cup1", (1.0, 1.0, 0.0)), ROOM, None),
        ("isLocatedIn", thing("x1", (1.0, 1.0, 0.0), "unheard of"), ROOM, None),
        (
            "isOn",
            thing("cup1", (1.0, 2.0, 0.0)),
            TABLE,
            "cup1 was said to be on table1; it stands 1.45 m from it",
        ),
        ("isOn", thing("cup1", (0.0, 0.0, 0.0)), TABLE, "below a surface of table1"),
        ("isOn", thing("cup1", (2.0, 0.0, CHAIR.size_m[2] / 2)), TABLE, "it stands 1.56"),
        ("isInside", thing("apple1", (0.8, 0.3, TOP)), BOWL, "apple1 was said to be inside bowl1; it stands"),
        ("isInside", thing("apple1", (0.34, 0.2, TOP)), BOWL, "% of its volume is within it"),
        ("isLocatedIn", thing("cup1", (5.0, 0.0, 0.0)), ROOM, "was said to be in kitchen1; it stands 1.9"),
        ("isLocatedIn", thing("x1", (5.0, 0.0, 0.0), "unheard of"), ROOM, "it stands 1.99"),
        ("isLocatedIn", thing("cup1", (1.0, 1.0, 0.0)), CORNER, "it stands"),
    ],
)  # fmt: skip
def test_what_geometry_says_against_it(relation, entity, other, text):
    found = against(relation, entity, other)
    assert found is None if text is None else text in found


@pytest.mark.parametrize("said", [("cup1", "isOn", "gone"), ("gone", "isOn", "table1")])
def test_nothing_is_said_of_what_is_not_there(said):
    assert denial(Space([TABLE]), said) is None


def test_nothing_is_on_itself():
    found = denial(Space([TABLE]), ("table1", "isOn", "table1"))
    assert found is not None
    assert found.text == "table1 was said to be on table1; nothing is on, in or inside itself"


def test_a_fact_is_read_off_either_of_two_inverse_properties():
    cup, table = v.entity_iri("cup1"), v.entity_iri("table1")
    assert (
        fact_of((cup, v.dm("isOn"), table))
        == fact_of((table, v.dm("supports"), cup))
        == ("cup1", "isOn", "table1")
    )
    assert fact_of((cup, v.dm("touches"), table)) is None
    on_top = "<http://www.ease-crc.org/ont/SOMA.owl#isOntopOf>"
    assert fact_of((cup, on_top, table)) == fact_of((cup, v.dm("isOn"), table))
    cup = thing("cup1", (3.0, 0.0, 0.0))
    twice = [("cup1", "isOn", "table1")] * 2
    assert len(list(denied(Space([TABLE, cup]), twice))) == 1


def test_what_was_said_of_the_flat_by_hand_holds(tmp_path):
    triples = rdf.parse(HOUSEHOLD_TTL.read_bytes(), "household.ttl", label_prefix="h")
    flat = home.new_map(tmp_path, triples)
    flat.commit(home.transaction(1, rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f")))
    by_hand = rdf.parse(FLAT_BY_HAND.read_bytes(), "by_hand.ttl", label_prefix="h")
    assert len(by_hand) == 58
    assert not flat.commit(home.transaction(2, by_hand)).notes
    said = list(answers.said_of_place(flat))
    assert len(said) == 58
    assert not [relation.text for relation in denied(Space(flat.entities()), said)]
    home.close(flat)


def test_a_flat_map_denies_nothing_of_what_is_on_what():
    """A plan has all things at height 0 and knows no sizes; a place may have an extent."""

    table, cup, book = (
        structs.replace(thing(name, at), size_m=None)
        for name, at in (
            ("table1", (0.0, 0.0, 0.0)),
            ("cup1", (0.1, 0.0, 0.0)),
            ("book1", (2.0, 2.0, 0.3)),
        )
    )
    said = ("cup1", "isOn", "table1")
    assert denial(Space([ROOM, table, cup]), said) is None
    assert denial(Space([ROOM, table, cup]), ("cup1", "isLocatedIn", "kitchen1")) is None
    assert denial(Space([ROOM, table, cup, book]), said) is not None
    assert denial(Space([ROOM, table, structs.replace(cup, size_m=(0.1, 0.1, 0.1))]), said) is not None


def test_whether_a_map_is_flat_is_kept_in_step():
    space = Space([thing("table1", (0.0, 0.0, 0.0), size=None)])
    flat = structs.replace(thing("cup1", (0.0, 0.0, 0.0)), size_m=None)
    space.take("table1")
    space.put(flat)
    assert space.is_flat
    with space.supposing([structs.replace(flat, pose=Pose(position_m=(0.0, 0.0, 0.1)))]):
        assert not space.is_flat
    assert space.is_flat
    space.put(structs.replace(flat, size_m=(0.1, 0.1, 0.1)))
    assert not space.is_flat
    with space.supposing((), ["cup1"]):
        assert space.is_flat
    assert not space.is_flat
    space.take("cup1")
    assert space.is_flat
