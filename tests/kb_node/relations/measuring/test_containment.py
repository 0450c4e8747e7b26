"""What a hollow contains: what fits in it, and in a sealed hollow only what lies wholly within."""

import math

import pytest

from semmap.nodes.kb_node.relations.geometry.fitting import model_shape
from semmap.ontology.model_shapes import shapes
from tests.kb_node.relations.entities import TABLE, TOP, thing
from tests.kb_node.relations.facts.test_many_at_once import require_alike

SEALED = sorted(name for name, shape in shapes().items() if any(room.is_sealed for room in shape.interiors))
OPEN = sorted(
    name
    for name, shape in shapes().items()
    if any(room.open and not room.shallow for room in shape.interiors)
)
ROUND = sorted(name for name in OPEN if any(room.round for room in shapes()[name].interiors))
LYING = (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)


def is_inside(outer, inner):
    facts = require_alike([TABLE, outer, inner])
    return (inner.name, "isInside", outer.name) in facts


def around(model, share, at):
    """Return a box, `share` of the size of the hollow of a model, at a height of the model."""
    (room,) = model_shape(model).interiors
    (x0, y0, z0), (x1, y1, z1) = room.low, room.high
    size = (share * (x1 - x0), share * (y1 - y0), share * (z1 - z0))
    return thing("thing1", ((x0 + x1) / 2, (y0 + y1) / 2, TOP + at(z0, z1)), "", size=size)


@pytest.mark.parametrize("model", SEALED)
@pytest.mark.parametrize("share", [0.1, 0.4, 0.65])
def test_a_sealed_hollow_contains_what_is_wholly_within(model, share):
    outer = thing("outer1", (0.0, 0.0, TOP), model)
    assert is_inside(outer, around(model, share, lambda low, high: low + 0.2 * (high - low)))
    assert is_inside(outer, around(model, share, lambda low, high: low))


@pytest.mark.parametrize("model", SEALED)
@pytest.mark.parametrize("share", [0.1, 0.4, 0.65, 0.95])
def test_a_sealed_hollow_does_not_contain_what_overlaps_it(model, share):
    outer = thing("outer1", (0.0, 0.0, TOP), model)
    (room,) = model_shape(model).interiors
    for at in (
        lambda low, high: low - 0.002,
        lambda low, high: high - 0.5 * share * (high - low),
        lambda low, high: low + 1.02 * (1.0 - share) * (high - low) + 1e-3,
    ):
        assert not is_inside(outer, around(model, share, at))
    long = thing("thing1", (0.0, 0.0, TOP + (room.low[2] + room.high[2]) / 2), "", size=(1.0, 0.01, 0.01))
    assert not is_inside(outer, long)


def test_an_object_at_the_place_of_a_carton_is_on_the_table():
    for model in ("glass", "egg", "cup", "can", "fork"):
        facts = require_alike([TABLE, thing("carton1", (0.0, 0.0, TOP)), thing(f"{model}1", (0.0, 0.0, TOP))])
        assert (f"{model}1", "isOn", "table1") in facts, model


def test_the_corner_beside_a_round_can_is_outside():
    can = thing("can1", (0.0, 0.0, TOP))
    bead = (0.006, 0.006, 0.006)
    assert is_inside(can, thing("bead1", (0.015, 0.015, TOP + 0.02), "", size=bead))
    assert not is_inside(can, thing("bead1", (0.026, 0.026, TOP + 0.02), "", size=bead))


def test_a_sealed_hollow_lies_and_turns_with_its_object():
    bottle = thing("bottle1", (-0.14, 0.0, TOP + 0.04), turn=LYING)
    assert is_inside(bottle, thing("bead1", (-0.07, 0.0, TOP + 0.03), "", size=(0.02, 0.02, 0.02)))
    assert not is_inside(bottle, thing("bead1", (-0.07, 0.03, TOP + 0.03), "", size=(0.02, 0.02, 0.02)))


@pytest.mark.parametrize("model", OPEN)
def test_an_open_hollow_contains_what_fits_in_it(model):
    shape = model_shape(model)
    (room,) = (room for room in shape.interiors if room.open)
    (x0, y0, z0), (x1, y1, z1) = room.low, room.high
    outer = thing("outer1", (0.0, 0.0, TOP), model)
    middle = ((x0 + x1) / 2, (y0 + y1) / 2, TOP + z0)
    small = tuple(0.3 * (high - low) for low, high in zip(room.low, room.high, strict=True))
    assert is_inside(outer, thing("thing1", middle, "", size=small))
    wide = (1.2 * (x1 - x0), 1.2 * (y1 - y0), 0.3 * (z1 - z0))
    assert not is_inside(outer, thing("thing1", middle, "", size=wide))


def test_vessels_and_tableware_are_round():
    assert {"bowl", "pan", "bucket", "pot", "glass", "cup", "vase", "jar", "flower_pot"} <= set(ROUND)
    assert {"sink", "box", "basket"}.isdisjoint(ROUND)


@pytest.mark.parametrize("model", ROUND)
def test_an_object_beside_a_round_hollow_is_not_in_it(model):
    """It stands in a corner of the box around the hollow, low or on its floor, short or tall."""
    (room,) = (room for room in model_shape(model).interiors if room.round)
    (x0, y0, z0), (x1, y1, z1) = room.low, room.high
    yaw = 0.6
    turn = (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
    wide = 0.07 * (x1 - x0)

    def at(share, bottom, height, way=(1, 1)):
        x, y = (
            (low + high + sign * share * (high - low)) / 2
            for low, high, sign in zip((x0, y0), (x1, y1), way, strict=True)
        )
        x, y = x * math.cos(yaw) - y * math.sin(yaw), x * math.sin(yaw) + y * math.cos(yaw)
        return thing("thing1", (x, y, TOP + bottom), "", size=(wide, wide, height), turn=turn)

    outer = thing("outer1", (0.0, 0.0, TOP), model, turn=turn)
    for way in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        assert not is_inside(outer, at(0.85, 0.0, z1, way))
        for height in (0.5 * (z1 - z0), 1.5 * z1):
            assert not is_inside(outer, at(0.85, z0, height, way))
            assert is_inside(outer, at(0.5, z0, 0.5 * (z1 - z0), way))
    assert is_inside(outer, at(0.0, z0, 0.5 * (z1 - z0)))


def test_a_tilted_bowl_does_not_contain_what_is_in_a_corner_of_its_box():
    bowl = thing("bowl1", (0.0, 0.0, TOP), turn=(math.cos(0.1), math.sin(0.1), 0.0, 0.0))
    size = (0.01, 0.01, 0.03)
    assert is_inside(bowl, thing("thing1", (0.02, 0.02, TOP + 0.03), "", size=size))
    assert not is_inside(bowl, thing("thing1", (0.064, 0.058, TOP + 0.03), "", size=size))
