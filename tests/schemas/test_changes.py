"""Changes of entities as text."""

import pytest

from semmap.schemas import codec
from semmap.schemas.changes import Change, between, in_words, of_properties, removed
from semmap.schemas.entities import Entity, Pose, Provenance, orientation_from_yaw

BY = Provenance(commit=1, stamp_ns=1, source="operator")


def entity(**fields):
    made = {
        "name": "cup1",
        "class_": "Cup",
        "iri": "urn:cup1",
        "types": ("Cup",),
        **dict.fromkeys(("provenance", "pose_provenance", "shape_provenance", "reference_provenance"), BY),
    }
    return Entity(**{**made, **fields})


HERE, THERE = Pose(position_m=(8.0, 2.3, 0.76)), Pose(position_m=(9.0, 2.3, 0.76))
TURNED = Pose(position_m=(8.0, 2.3, 0.76), orientation_wxyz=orientation_from_yaw(1.5708))
SLIGHTLY_TURNED = Pose(position_m=HERE.position_m, orientation_wxyz=orientation_from_yaw(0.005))
LEANING = Pose(position_m=HERE.position_m, orientation_wxyz=(0.98, 0.199, 0.0, 0.0))


@pytest.mark.parametrize(
    ("was", "now", "said"),
    [
        ({"pose": HERE}, {"pose": THERE}, "moved from (8, 2.3, 0.76) to (9, 2.3, 0.76)"),
        ({"pose": HERE}, {"pose": TURNED}, "turned from 0° to 90°"),
        ({"pose": HERE}, {"pose": SLIGHTLY_TURNED}, "turned by less than a degree"),
        ({"pose": HERE}, {"pose": LEANING}, "tilted"),
        (
            {"pose": TURNED},
            {"pose": THERE},
            "moved from (8, 2.3, 0.76) to (9, 2.3, 0.76) and turned from 90° to 0°",
        ),
        (
            {"pose": HERE},
            {"pose": Pose(position_m=(8.0001, 2.3, 0.76))},
            "moved by less than a millimetre, at (8, 2.3, 0.76)",
        ),
        ({}, {"pose": HERE}, "placed at (8, 2.3, 0.76)"),
        ({"pose": HERE}, {}, "no longer has a position"),
        ({}, {"size_m": (0.1, 0.1, 0.12)}, "size: unknown → 0.1 x 0.1 x 0.12"),
        ({}, {"class_": "Mug"}, "class Cup → Mug"),
        ({}, {"preferred_reference": "cup"}, "label added: 'cup'"),
        ({"preferred_reference": "cup"}, {"preferred_reference": "mug"}, "label: 'cup' → 'mug'"),
        ({"preferred_reference": "cup"}, {}, "label removed: 'cup'"),
        (
            {"alternative_references": ("a", "b")},
            {"alternative_references": ("b", "c")},
            "alias added: 'c'; alias removed: 'a'",
        ),
        (
            {"alternative_references": ("a", "b")},
            {"alternative_references": ("b", "a")},
            "aliases in another order",
        ),
        ({}, {"conflict": "a bowl"}, "conflict: a bowl"),
        ({"conflict": "a bowl"}, {}, "conflict resolved"),
        ({"properties": {"isOpen": False}}, {"properties": {"isOpen": True}}, "isOpen: false → true"),
        ({}, {"properties": {"mass": 0.5}}, "mass: not set → 0.5"),
        (
            {"properties": {"hasColor": ("color_red", "color_blue")}},
            {"properties": {"hasColor": ("color_blue", "color_green")}},
            "hasColor: + color_green, - color_red",
        ),
        ({"properties": {"hasColor": ("color_red",)}}, {}, "hasColor: - color_red"),
        ({"pose": HERE}, {"pose": HERE}, ""),
        ({}, {"name": "mug1"}, "renamed from cup1"),
    ],
)
def test_what_is_otherwise_is_said(was, now, said):
    assert in_words(between(entity(**was), entity(**now))) == said


def test_what_comes_and_goes_is_said():
    (added,) = between(None, entity())
    assert (added.kind, added.text) == ("added", "added as Cup")
    assert removed("cup1", "Cup").text == "removed"


def test_changes_are_the_same_after_the_wire():
    was = entity(pose=HERE, size_m=(1.0, 1.0, 1.0), properties={"isOpen": True, "hasColor": ("a", "b")})
    changes = tuple(between(was, entity(class_="Mug", pose=THERE, properties={"isOpen": False})))
    assert codec.decode(codec.encode(changes), tuple[Change, ...]) == changes
    assert len(changes) == 5


def test_an_empty_text_is_a_value():
    (said,) = of_properties("cup1", [("serial", "a", "")])
    assert said.text == "serial: a → ''"
    (said,) = of_properties("cup1", [("serial", "", None)])
    assert said.text == "serial: '' → not set"


def test_labels_of_blank_nodes_are_not_shown():
    texts = [
        said.text
        for was, now in (("_:a", "_:b"), (None, "_:b"), (("_:a",), ("_:a", "_:b")))
        for said in of_properties("cup1", [("hasShape", was, now)])
    ]
    assert texts == [
        "hasShape: other content",
        "hasShape: not set → a nameless value",
        "hasShape: + a nameless value",
    ]
