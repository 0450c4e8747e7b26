"""What is expected of a commit, and whether it came."""

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.facts.precompute_messages import (
    ClassModel,
    ExpectedEntities,
    ExpectedEntity,
    PrecomputeResult,
    compute_digest,
)
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.schemas.entities import IDENTITY, Pose
from tests.kb_node.relations.entities import TABLE, TOP, thing

CUP = PlacedEntity.of(thing("cup1", (0.0, 0.0, TOP)))
OTHER = PlacedEntity.of(TABLE)


def expected(number, orientation=None, size=None):
    classes = [
        ClassModel("cup", place=False),
        ClassModel("", place=True),
        ClassModel("door", False, fixed=True),
    ]
    iri = "<http://example.org/map#cup1>"
    arrivals = [ExpectedEntity(iri, number, ('"1.5"^^<urn:float>', 2, 3.0), orientation, size)]
    made = ExpectedEntities(classes, arrivals)
    assert len(made) == 1
    (found,) = made.placed()
    return found


@pytest.mark.parametrize(
    ("orientation", "turn"),
    [
        (None, IDENTITY),
        ((None, 0.0, 0.0, 1.0), IDENTITY),
        ((0.0, 0.0, '"0.6"^^<urn:float>', 0.8), (0.0, 0.0, 0.6, 0.8)),
    ],
)
@pytest.mark.parametrize(
    ("size", "size_m"), [(None, None), ((1.0, None, 1.0), None), (('"0.5"', 1, 2.0), (0.5, 1.0, 2.0))]
)
def test_an_expected_entity_has_the_pose_and_size_that_are_complete(orientation, turn, size, size_m):
    found = expected(0, orientation, size)
    assert (found.name, found.iri) == ("cup1", "http://example.org/map#cup1")
    assert found.pose == Pose(position_m=(1.5, 2, 3.0), orientation_wxyz=turn)
    assert found.size_m == size_m


def test_an_expected_entity_is_like_its_class():
    cup, room, door = map(expected, range(3))
    assert [one.place for one in (cup, room, door)] == [False, True, False]
    assert [one.fixed for one in (cup, room, door)] == [False, False, True]
    assert (cup.model, room.model) == ("cup", "")
    with pytest.raises(IndexError):
        expected(3)


def test_facts_are_those_of_exactly_the_expected_entities_in_any_order():
    facts = ({"cup1": (("isOn", "table1"),)},)
    found = PrecomputeResult(compute_digest([CUP, OTHER]), facts)
    unplaced = thing("cup9", None)
    for came in ([CUP, OTHER], [OTHER, CUP], [thing("cup1", (0.0, 0.0, TOP)), TABLE], [CUP, unplaced, OTHER]):
        assert found.match(came) == facts
    for came in ([], [CUP], [CUP, OTHER, OTHER], [structs.replace(CUP, fixed=True), OTHER]):
        assert found.match(came) is None
