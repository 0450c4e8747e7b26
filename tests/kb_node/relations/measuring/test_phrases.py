"""Wording of relations and lengths, and of the measurement behind a relation."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.relations.measuring.phrases import (
    describe_support,
    explain_location,
    format_height,
    format_length,
    phrase_relation,
)
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.schemas.relations import PHRASES
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing


@pytest.mark.parametrize("relation", PHRASES)
def test_every_relation_can_be_denied(relation):
    denied = phrase_relation(relation, holds=False)
    assert "not" in denied.split()
    assert phrase_relation(relation) == PHRASES[relation] != denied


@pytest.mark.parametrize(
    ("length_m", "text"),
    [
        (0.0099, "9.9 mm"),
        (-0.002, "-2.0 mm"),
        (0.01, "1.0 cm"),
        (-0.5, "-50.0 cm"),
        (0.999, "99.9 cm"),
        (1.0, "1.00 m"),
        (-2.5, "-2.50 m"),
    ],
)
def test_a_length_has_the_unit_of_its_magnitude(length_m, text):
    assert format_length(length_m) == text


@pytest.mark.parametrize(
    ("gap_m", "text"),
    [(0.03, "3.0 cm above"), (-0.03, "3.0 cm below"), (0.00004, "level with"), (0.0001, "0.1 mm above")],
)
def test_a_height_is_above_or_below_or_level(gap_m, text):
    assert format_height(gap_m) == text


def describe(*entities):
    space = Space(entities)
    return describe_support(space, space.solids["cup1"])


def test_a_support_is_named_before_the_place():
    assert describe(ROOM, TABLE, thing("cup1", (0.2, 0.1, TOP))) == "is on table1"


def test_an_object_on_the_floor_names_the_place():
    assert describe(ROOM, thing("cup1", (2.0, 1.0, 0.0))) == "is on the floor of kitchen1"


def test_an_object_in_the_air_has_no_known_support():
    assert describe(ROOM, thing("cup1", (2.0, 1.0, 1.5))) == "has no known support"


def explain(of, at):
    space = Space((ROOM, TABLE, thing("cup1", at)))
    cup = space.solids["cup1"]
    _, supports, place = space.spatial_relations(cup)
    other, made = supports[0] if of == "isOn" else place
    return explain_location(of, cup, other, made)


def test_the_reason_for_on_is_the_height_and_the_share_of_the_base():
    reason = explain("isOn", (0.0, 0.0, TOP + 0.004))
    assert reason.startswith("its bottom is 4.0 mm above a surface of table1, at ")
    assert reason.endswith("and 100% of its base is over it")


def test_the_reason_for_a_place_is_the_share_of_the_footprint():
    assert explain("isLocatedIn", (2.0, 1.0, 0.0)) == "100% of its footprint is within kitchen1"
