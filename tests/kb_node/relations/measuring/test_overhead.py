"""Which object is under which."""

import pytest

from semmap.nodes.kb_node.relations.measuring.overhead import beneath
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.ontology import model_shapes
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing


def space(*entities):
    return Space([ROOM, TABLE, *entities])


@pytest.mark.parametrize(
    ("lower", "share"),
    [
        pytest.param(thing("box1", (0.0, 0.0, 0.0), "box", size=(0.2, 0.2, 0.3)), 1.0, id="under it"),
        pytest.param(thing("box1", (0.0, 0.3, 0.0), "box", size=(0.2, 0.2, 0.9)), None, id="higher"),
        pytest.param(thing("cup1", (0.1, 0.1, TOP)), None, id="on it"),
        pytest.param(thing("box1", (3.0, 0.0, 0.0), "box", size=(0.2, 0.2, 0.3)), None, id="far away"),
    ],
)
def test_an_object_beneath_a_table(lower, share):
    there = space(lower)
    made = beneath(there.solids[lower.name], there.solids["table1"], there.limits)
    assert (None if made is None else made.share) == share
    assert made is None or (made.holds and made.gap_m > 0.3)


def test_a_chair_half_beneath_a_table_is_beneath_it_by_its_seat():
    there = space(thing("chair1", (0.0, -0.45, 0.0), yaw=1.57))
    made = beneath(there.solids["chair1"], there.solids["table1"], there.limits)
    assert 0.5 < made.share < 1.0
    assert 0.0 < made.gap_m < 0.4
    assert made.height_m < TOP


def test_only_parts_are_above_not_the_box_around_them():
    """A lamp on a bent arm is above what is under its shade, and not above the rest of its box."""

    def shape(*boxes):
        return model_shapes.ModelShape(
            size_m=(1.0, 1.0, 2.0),
            parts=tuple(
                model_shapes.ConvexPart(centre=at, straight=((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z)))
                for at, (x, y, z) in boxes
            ),
        )

    pole, arm = ((-0.45, -0.45, 0.9), (0.01, 0.01, 0.9)), ((0.0, -0.45, 1.8), (0.5, 0.01, 0.01))
    shade = ((0.4, -0.4, 1.7), (0.1, 0.1, 0.05))
    lamp = model_shapes.WorldShapes.of({"lamp1": shape(pole, arm, shade), "rail1": shape(arm)})
    model_shapes.exchange_world(lamp)
    try:
        for name, at, width, is_below in (
            ("lamp1", (0.4, -0.4), 0.2, True),
            ("lamp1", (0.3, 0.3), 0.2, False),
            ("lamp1", (-0.45, -0.45), 0.2, False),
            ("rail1", (0.0, 0.0), 1.1, True),
        ):
            whole = thing(name, (0.0, 0.0, 0.0), "", size=(1.0, 1.0, 2.0))
            there = Space([whole, thing("box1", (*at, 0.0), "", size=(width, width, 0.2))])
            made = beneath(there.solids["box1"], there.solids[name], there.limits)
            assert (made is not None and made.holds) == is_below, (name, at)
    finally:
        model_shapes.exchange_world(model_shapes.WorldShapes())


@pytest.mark.parametrize(
    ("x", "height", "is_below"),
    [(-0.6, 0.16, True), (-0.6, 0.05, False), (0.7, 0.5, True), (0.7, 0.2, False)],
    ids=["over the low end", "in the low end", "over the high end", "in the high end"],
)
@pytest.mark.parametrize("kind", ["board", "wedge"])
def test_a_ramp_is_under_an_object_where_its_slope_is_below_it(kind, x, height, is_below):
    """The ball over the low end is lower than the high end."""
    run, rise = 1.0, 0.5
    across = (0.0, 0.3, 0.0)
    if kind == "board":
        parts = [
            model_shapes.ConvexPart(
                centre=(0.0, 0.0, rise / 2), straight=((run, 0.0, rise / 2), across, (0.0, 0.0, 0.01))
            )
        ]
    else:
        corners = ((-run, 0.0), (run, 0.0), (run, rise))
        points = tuple((a, y, z) for y in (-0.3, 0.3) for a, z in corners)
        parts = [model_shapes.ConvexPart(centre=(0.0, 0.0, 0.0), points=points)]
    shape = model_shapes.ModelShape(size_m=(2 * run, 0.6, rise), parts=tuple(parts))
    model_shapes.exchange_world(model_shapes.WorldShapes.of({"ramp1": shape}))
    try:
        ramp = thing("ramp1", (0.0, 0.0, 0.0), "", size=shape.size_m)
        there = Space([ramp, thing("box1", (x, 0.0, height), "", size=(0.1, 0.1, 0.1))])
        made = beneath(there.solids["ramp1"], there.solids["box1"], there.limits)
        assert (made is not None and made.holds) == is_below
    finally:
        model_shapes.exchange_world(model_shapes.WorldShapes())
