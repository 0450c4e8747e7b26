"""Where an entity is, as a change of triples."""

import pytest

from ontology import stars
from ontology import vocabulary as v
from schemas import errors
from schemas.commits import Placed, Transaction
from schemas.entities import Pose, orientation_from_yaw
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle

TURNED = orientation_from_yaw(1.0)


def placed(semantic_map, **fields):
    """The commit that puts `chair1` somewhere."""
    where = (Placed(**{"name": "chair1", **fields}),)
    return semantic_map.commit(Transaction(id=f"placed{fields}", source="operator", placed=where))


def coordinates_of(semantic_map, name):
    edges = semantic_map.reasoner.asserted(v.entity_iri(name), v.HAS_POSITION)
    return [node for _, _, node in edges]


def test_what_is_not_given_stays(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    placed(semantic_map, at=(1.0, 2.0, 3.0), yaw=1.0)
    assert semantic_map.entity("chair1").pose == Pose(position_m=(1.0, 2.0, 3.0), orientation_wxyz=TURNED)
    placed(semantic_map, at=(4.0, 5.0, 6.0))
    assert semantic_map.entity("chair1").pose == Pose(position_m=(4.0, 5.0, 6.0), orientation_wxyz=TURNED)
    placed(semantic_map, orientation=(1.0, 0.0, 0.0, 0.0))
    assert semantic_map.entity("chair1").pose == Pose(position_m=(4.0, 5.0, 6.0))


def test_the_coordinates_change_where_they_are(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    before = len(semantic_map.abox())
    nodes = coordinates_of(semantic_map, "chair1")
    placed(semantic_map, at=(7.0, 8.0, 9.0))
    assert (coordinates_of(semantic_map, "chair1"), len(semantic_map.abox())) == (nodes, before)


def test_coordinates_of_two_are_left_to_the_other(semantic_map):
    shared = v.entity_iri("chair1_coordinates")
    other = [t for t in chair("chair2") if t[1] != v.HAS_POSITION and "coordinates" not in t[0]]
    both = [*chair(), *other, (v.entity_iri("chair2"), v.HAS_POSITION, shared)]
    semantic_map.commit(transaction(1, both))
    before = semantic_map.entity("chair2").pose
    placed(semantic_map, at=(7.0, 8.0, 9.0))
    assert semantic_map.entity("chair1").pose == Pose(position_m=(7.0, 8.0, 9.0))
    assert semantic_map.entity("chair2").pose == before
    assert coordinates_of(semantic_map, "chair1") == [v.entity_iri("chair1_coordinates_2")]


def test_a_first_position(semantic_map):
    semantic_map.commit(transaction(1, turtle(":chair1 a dm:Chair .")))
    with pytest.raises(errors.BadRequest, match="no position yet"):
        placed(semantic_map, yaw=1.0)
    placed(semantic_map, at=(1.0, 2.0, 3.0))
    assert semantic_map.entity("chair1").pose == Pose(position_m=(1.0, 2.0, 3.0))


def test_where_it_is_already_is_no_commit(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    assert placed(semantic_map, at=semantic_map.entity("chair1").pose.position_m) is None


@pytest.mark.parametrize(
    ("fields", "error"),
    [
        ({"name": "chair9", "at": (0.0, 0.0, 0.0)}, errors.UnknownName),
        ({"orientation": (1.0, 1.0, 0.0, 0.0)}, errors.BadRequest),
        ({"yaw": 1.0, "orientation": (1.0, 0.0, 0.0, 0.0)}, errors.BadRequest),
    ],
)
def test_a_refusal_changes_nothing(semantic_map, fields, error):
    semantic_map.commit(transaction(1, chair()))
    before = home.state(semantic_map)
    with pytest.raises(error):
        placed(semantic_map, **fields)
    assert home.state(semantic_map) == before


def test_what_the_tbox_has_is_not_placed(tmp_path):
    throne = [(v.entity_iri("chair1"), v.RDF_TYPE, v.dm("Chair"))]
    throne += stars.position(*map(v.entity_iri, ("chair1", "spot")), Pose(position_m=(0.0, 0.0, 0.0)))
    semantic_map = home.new_map(tmp_path, [*home.TBOX, *throne])
    with pytest.raises(errors.Refused, match="TBox"):
        placed(semantic_map, at=(1.0, 0.0, 0.0))
    home.close(semantic_map)
