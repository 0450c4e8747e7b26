"""What a large transaction adds is predicted, or nothing is if it is not regular."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.kb_node.entities import new_entities
from semmap.nodes.kb_node.entities.new_entities import predict_new_entities
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Edit, NewEntity, Statement, Transaction
from semmap.schemas.entities import Pose, orientation_from_yaw
from tests.kb_node import home

POSE = Pose(position_m=(1.0, 2.0, 0.5), orientation_wxyz=orientation_from_yaw(1.0))
CHAIR, DOOR, KITCHEN, PROPERTY = (v.bare(v.dm(name)) for name in ("Chair", "Door", "Kitchen", "Property"))


@pytest.fixture(scope="module")
def classes(tmp_path_factory):
    made = home.new_map(tmp_path_factory.mktemp("map"))
    yield made.classes
    home.close(made)


@pytest.fixture(autouse=True)
def few(monkeypatch):
    """Two are many, and four the most."""
    monkeypatch.setattr(new_entities, "MANY", 2)
    monkeypatch.setattr(new_entities, "MOST", 4)


def new(name, class_iri=CHAIR, **fields):
    return NewEntity(name=name, class_iri=class_iri, **{"pose": POSE, **fields})


def adding(*entities, **fields):
    return Transaction(id="1", source="file", add=entities, **fields)


def stating(count=2, extra=(), class_=CHAIR, **described):
    triples = [
        triple
        for n in range(count)
        for triple in entity_triples.describe(
            f"chair{n}", v.iri(class_), **{"pose": POSE, "size_m": (1.0, 1.0, 2.0), **described}
        )
    ]
    return Transaction(id="1", source="file", insert=(*triples, *extra))


def test_entities_to_add_are_predicted_by_class(classes):
    expected = predict_new_entities(
        adding(new("chair1"), new("door1", DOOR), new("kitchen1", KITCHEN, size=(3.0, 3.0, 2.0))), classes
    )
    chair, door, kitchen = expected.placed()
    assert (chair.name, chair.pose, chair.model, chair.place, chair.fixed) == (
        "chair1",
        POSE,
        "chair",
        False,
        False,
    )
    assert (door.fixed, door.place) == (True, False)
    assert (kitchen.place, kitchen.size_m) == (True, (3.0, 3.0, 2.0))


def test_entities_without_a_pose_are_not_expected(classes):
    expected = predict_new_entities(adding(new("chair1"), new("chair2", pose=None)), classes)
    assert [one.name for one in expected.placed()] == ["chair1"]


@pytest.mark.parametrize(("count", "is_predicted"), [(1, False), (2, True), (4, True), (5, False)])
def test_too_few_and_too_many_are_not_predicted(classes, count, is_predicted):
    chairs = [new(f"chair{n}") for n in range(count)]
    assert (predict_new_entities(adding(*chairs), classes) is not None) == is_predicted
    assert (predict_new_entities(stating(count), classes) is not None) == is_predicted


TWO = (new("chair1"), new("chair2"))


@pytest.mark.parametrize(
    "transaction",
    [
        adding(*TWO, remove=("old1",)),
        adding(*TWO, edit=(Edit(name="old1"),)),
        adding(*TWO, retract=stating().insert[:1]),
        adding(*TWO, insert=stating().insert[:1]),
        adding(new("chair1"), new("thing1", PROPERTY)),
        adding(new("chair1"), new("chair2", set=(Statement(property="note", values=("a",)),))),
        stating(extra=[(v.entity_iri("chair0"), v.MODEL, '"chair"')]),
        stating(extra=[(v.entity_iri("chair0"), v.IS_OPEN, '"true"')]),
        stating(class_=PROPERTY),
        structs.replace(stating(), add=TWO),
    ],
)
def test_an_irregular_transaction_is_not_predicted(classes, transaction):
    assert predict_new_entities(transaction, classes) is None


@pytest.mark.parametrize("sized", [{}, {"size_m": None}])
def test_stated_entities_are_read_from_their_triples_in_any_order(classes, sized):
    transaction = stating(**sized)
    for insert in (transaction.insert, transaction.insert[::-1]):
        expected = predict_new_entities(structs.replace(transaction, insert=insert), classes)
        first, second = sorted(expected.placed(), key=lambda one: one.name)
        assert (first.name, second.name) == ("chair0", "chair1")
        assert first.pose.position_m == POSE.position_m
        assert first.pose.orientation_wxyz == pytest.approx(POSE.orientation_wxyz, abs=1e-6)
        assert first.size_m == (None if sized else (1.0, 1.0, 2.0))
        assert first.model == "chair"


def test_an_entity_without_a_whole_position_is_not_predicted(classes):
    transaction = stating()
    kept = [t for t in transaction.insert if t[1] != v.COORDINATE_XYZ[1] or "chair1" in t[0]]
    assert predict_new_entities(structs.replace(transaction, insert=tuple(kept)), classes) is None


def test_the_digest_of_expected_entities_does_not_depend_on_their_order(classes):
    from semmap.nodes.kb_node.relations.facts.precompute_messages import PrecomputeResult, compute_digest

    expected = list(predict_new_entities(adding(*TWO), classes).placed())
    result = PrecomputeResult(mark=compute_digest(expected), facts=({},))
    assert result.match(expected[::-1]) == ({},)
    assert result.match(expected[:1]) is None
    moved = structs.replace(expected[0], pose=Pose(position_m=(9.0, 2.0, 0.5)))
    assert result.match([moved, expected[1]]) is None
