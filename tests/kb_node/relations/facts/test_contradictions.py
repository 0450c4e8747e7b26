"""Asserted locations that contradict the geometry."""

import math

import pytest
from msgspec import structs

from benchmarks.relations.accuracy import FLAT_BY_HAND
from semmap.nodes.kb_node.answers import answers
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.relations.facts.contradictions import (
    fact_of,
    find_contradiction,
    find_contradictions,
)
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Pose
from semmap.schemas.relations import Relation
from tests.kb_node import home
from tests.kb_node.relations.entities import CORNER, ROOM, TABLE, TOP, thing

CHAIR = thing("chair1", (2.0, 0.0, 0.0))
BOOK = thing("book1", (0.0, 0.0, TOP))
BOWL = thing("bowl1", (0.2, 0.2, TOP))
WALL = thing("wall1", (0.0, -3.0, 0.0), "wall", size=(6.0, 0.1, 2.5))
FLAT_BED = thing("bed1", (1.0, 1.0, 0.0), "nothing known")


def against(relation, entity, other, *others):
    space = Space(
        {e.name: e for e in (ROOM, CORNER, TABLE, CHAIR, BOOK, BOWL, WALL, entity, other, *others)}.values()
    )
    found = find_contradiction(space, (entity.name, relation, other.name))
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
            "cup1 was asserted to be on table1; it stands 1.45 m from it",
        ),
        ("isOn", thing("cup1", (0.0, 0.0, 0.0)), TABLE, "below a surface of table1"),
        ("isOn", thing("cup1", (2.0, 0.0, CHAIR.size_m[2] / 2)), TABLE, "it stands 1.56"),
        ("isInside", thing("apple1", (0.8, 0.3, TOP)), BOWL, "was asserted to be inside bowl1; it stands"),
        ("isInside", thing("apple1", (0.34, 0.2, TOP)), BOWL, "% of its volume is within it"),
        ("isLocatedIn", thing("cup1", (5.0, 0.0, 0.0)), ROOM, "asserted to be in kitchen1; it stands 1.9"),
        ("isLocatedIn", thing("x1", (5.0, 0.0, 0.0), "unheard of"), ROOM, "it stands 1.99"),
        ("isLocatedIn", thing("cup1", (1.0, 1.0, 0.0)), CORNER, "it stands"),
        ("isNear", thing("cup1", (0.3, 0.0, TOP)), TABLE, None),
        ("isNear", thing("cup1", (1.0, 0.0, 0.0)), TABLE, None),
        ("isNear", thing("cup1", (1.0, 0.0, 0.0)), ROOM, None),
        ("isNear", thing("cup1", None), TABLE, None),
        ("isNear", thing("cup1", (2.0, 4.0, 0.0)), TABLE, "asserted to be near table1; they are 3."),
        ("isNear", thing("cup1", (2.0, 4.0, 0.0)), FLAT_BED, None),
        ("isUnder", thing("cup1", (0.0, 0.0, 0.0)), TABLE, None),
        ("isUnder", thing("cup1", (0.0, 0.0, TOP + 1.0)), TABLE, "to be under table1; table1 is below cup1"),
        ("isUnder", thing("cup1", (4.0, 0.0, 0.0)), TABLE, "under table1; seen from above they are 3."),
        ("isUnder", thing("cup1", (4.0, 0.0, 0.0)), ROOM, None),
        ("isAbove", thing("cup1", (0.0, 0.0, TOP + 1.0)), TABLE, None),
        ("isAbove", thing("cup1", (0.0, 0.0, TOP)), TABLE, None),
        ("isAbove", thing("cup1", (4.0, 0.0, TOP)), TABLE, "above table1; seen from above they are 3."),
        ("isAbove", thing("cup1", (0.0, 0.0, -2.0)), TABLE, "to be above table1; cup1 is below table1"),
    ],
)  # fmt: skip
def test_geometry_denies_a_stated_location(relation, entity, other, text):
    found = against(relation, entity, other)
    assert found is None if text is None else text in found


@pytest.mark.parametrize("said", [("cup1", "isOn", "gone"), ("gone", "isOn", "table1")])
def test_unknown_entities_are_not_denied(said):
    assert find_contradiction(Space([TABLE]), said) is None


def test_no_object_is_on_itself():
    found = find_contradiction(Space([TABLE]), ("table1", "isOn", "table1"))
    assert found is not None
    assert found.text == "table1 was asserted to be on table1; an object cannot be on, in or inside itself"
    assert found.gap_m == 0.0


def test_a_contradiction_has_the_distance():
    cup = thing("cup1", (1.0, 2.0, 0.0))
    assert find_contradiction(Space([TABLE, cup]), ("cup1", "isOn", "table1")) == Relation(
        relation="isOn",
        subject="cup1",
        object="table1",
        holds=False,
        gap_m=1.4499,
        share=0.0,
        text="cup1 was asserted to be on table1; it stands 1.45 m from it",
    )


def test_inverse_properties_give_the_same_fact():
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
    assert len(list(find_contradictions(Space([TABLE, cup]), twice))) == 1


def test_the_asserted_locations_of_the_flat_hold(tmp_path):
    triples = rdf.parse(HOUSEHOLD_TTL.read_bytes(), "household.ttl", label_prefix="h")
    flat = home.new_map(tmp_path, triples)
    flat.commit(home.transaction(1, rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f")))
    by_hand = rdf.parse(FLAT_BY_HAND.read_bytes(), "by_hand.ttl", label_prefix="h")
    assert len(by_hand) == 58
    assert not flat.commit(home.transaction(2, by_hand)).notes
    said = list(answers.asserted_locations(flat))
    assert len(said) == 58
    assert not [relation.text for relation in find_contradictions(Space(flat.entities()), said)]
    home.close(flat)


def test_a_flat_map_denies_no_support():
    """A plan has all objects at height 0 and no sizes. A place may have an extent."""

    table, cup, book = (
        structs.replace(thing(name, at), size_m=None)
        for name, at in (
            ("table1", (0.0, 0.0, 0.0)),
            ("cup1", (0.1, 0.0, 0.0)),
            ("book1", (2.0, 2.0, 0.3)),
        )
    )
    said = ("cup1", "isOn", "table1")
    assert find_contradiction(Space([ROOM, table, cup]), said) is None
    assert find_contradiction(Space([ROOM, table, cup]), ("cup1", "isLocatedIn", "kitchen1")) is None
    assert find_contradiction(Space([ROOM, table, cup, book]), said) is not None
    assert (
        find_contradiction(Space([ROOM, table, structs.replace(cup, size_m=(0.1, 0.1, 0.1))]), said)
        is not None
    )


def test_is_flat_follows_changes():
    space = Space([thing("table1", (0.0, 0.0, 0.0), size=None)])
    flat = structs.replace(thing("cup1", (0.0, 0.0, 0.0)), size_m=None)
    space.remove("table1")
    space.put(flat)
    assert space.is_flat
    with space.with_changes([structs.replace(flat, pose=Pose(position_m=(0.0, 0.0, 0.1)))]):
        assert not space.is_flat
    assert space.is_flat
    space.put(structs.replace(flat, size_m=(0.1, 0.1, 0.1)))
    assert not space.is_flat
    with space.with_changes((), ["cup1"]):
        assert space.is_flat
    assert not space.is_flat
    space.remove("cup1")
    assert space.is_flat
