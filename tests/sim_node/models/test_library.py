import re
from pathlib import Path

import numpy as np
import pytest

from semmap.nodes.sim_node.models.library import ModelError, assemble, build, check_size
from semmap.nodes.sim_node.models.parts import Joint, Role, bounds, box, moving, visual
from semmap.nodes.sim_node.models.variety_table import KINDS

HOUSEHOLD = Path(__file__).parents[3] / "ontology" / "household.ttl"


def test_every_model_that_the_tbox_names_is_there():
    named = set(re.findall(r'dm:model "([^"]+)"', HOUSEHOLD.read_text()))
    assert named - KINDS.keys() == set()


def test_there_are_sixty_models_and_no_two_are_built_alike():
    shapes = {name: tuple((p.shape, p.role) for p in build(name, None).parts) for name in KINDS}
    assert len(set(shapes.values())) >= 60


@pytest.mark.parametrize("name", KINDS)
def test_a_model_fills_its_size_from_the_bottom_centre_up(name):
    wanted = KINDS[name].size_m
    model = build(name, None)
    low, high = bounds(model.parts)
    assert low[2] == pytest.approx(0.0, abs=1e-9)
    assert low[:2] == pytest.approx(-high[:2])
    for have, want in zip(model.size_m, wanted, strict=True):
        assert abs(have - want) <= max(0.15 * want, 0.012)
    assert model.mass_kg == pytest.approx(KINDS[name].mass_kg, rel=0.5)
    a, b, c = sorted(model.inertial.moments)
    assert a > 0.0
    assert c <= a + b + 1e-6


@pytest.mark.parametrize("name", KINDS)
def test_what_is_felt_is_no_bigger_than_what_is_seen(name):
    parts = build(name, None).parts
    colliding = [part for part in parts if part.role is not Role.VISUAL]
    low, high = bounds([part for part in parts if part.role is not Role.COLLISION])
    colliding_low, colliding_high = bounds(colliding)
    assert (colliding_low >= low - 0.006).all()
    assert (colliding_high <= high + 0.006).all()
    assert colliding_low[2] == pytest.approx(0.0, abs=0.004)
    assert len(colliding) <= 40


@pytest.mark.parametrize(
    ("name", "size"), [("table", (1.0, 2.0, 0.5)), ("cup", (0.2, 0.25, 0.3)), ("wall", (0.2, 6, 3))]
)
def test_models_take_the_size_of_their_entity(name, size):
    model = build(name, size)
    assert model.size_m == pytest.approx(size, rel=0.15)
    assert model.mass_kg > build(name, None).inertial.mass_kg


def test_a_size_that_is_long_the_other_way_turns_the_model():
    assert build("couch", (2.0, 0.9, 0.85)).size_m == pytest.approx((2.0, 0.9, 0.85), rel=0.05)
    along, across = build("couch", (2.0, 0.9, 0.85)), build("couch", (0.9, 2.0, 0.85))
    assert along.inertial.moments[:2] == pytest.approx(across.inertial.moments[1::-1])


def test_without_a_model_there_is_a_box():
    assert build("", (0.2, 0.3, 0.4)).size_m == pytest.approx((0.2, 0.3, 0.4))
    assert build("no_such_thing", None).size_m == pytest.approx((0.3, 0.3, 0.3))
    assert build("no_such_thing", None).name == "box"


@pytest.mark.parametrize(
    "size", [(1000.0, 1.0, 1.0), (1.0, 1e-6, 1.0), (1.0, 1.0, float("nan")), (1.0, 1.0, -1.0)]
)
def test_absurd_sizes_are_refused(size):
    with pytest.raises(ModelError, match="a size must be from"):
        build("chair", size)


def test_inertia_of_a_box_is_that_of_the_textbook():
    model = build("", (0.6, 0.6, 1.8))
    mass = model.mass_kg
    expected = mass / 12 * np.array([0.36 + 3.24, 0.36 + 3.24, 0.72])
    assert model.inertial.moments == pytest.approx(expected)
    assert model.inertial.centre_m == pytest.approx((0, 0, 0.9))


RED = (1.0, 0.0, 0.0)


def hinged(axis=(0.0, 1.0, 0.0), *, kind="hinge", friction=0.0, anchor=(0.0, 0.0, 1.0), seen_only=False):
    """Return a box of one metre with a lid of one metre beside it, moved by a joint."""
    joint = Joint("lid", kind, anchor, axis, (0.0, 1.0), friction=friction)
    lid = moving(joint, box((1.0, 1.0, 0.1), (0.5, 0.0, 1.05), RED))
    return assemble(
        "box", [box((1.0, 1.0, 1.0), (0.0, 0.0, 0.5), RED), *(visual(lid) if seen_only else lid)], 11.0
    )


def test_a_model_is_put_on_its_bottom_centre_with_its_joints():
    model = hinged()
    assert model.size_m == pytest.approx((1.5, 1.0, 1.1))
    low, _ = bounds(model.parts)
    assert low == pytest.approx((-0.75, -0.5, 0.0))
    assert model.leaves[0].joint.anchor == pytest.approx((-0.25, 0.0, 1.0))
    assert [part.joint for part in model.parts] == [None, model.leaves[0].joint]
    assert len(model.frame) == 1
    assert model.frame[0].joint is None
    plain = build("cup", None)
    assert plain.frame is plain.parts


def test_mass_is_shared_out_by_the_volume_of_what_collides():
    model = hinged()
    assert model.inertial.mass_kg == pytest.approx(10.0)
    assert model.leaves[0].inertial.mass_kg == pytest.approx(1.0)
    assert model.mass_kg == pytest.approx(11.0)
    decoration = hinged(seen_only=True)
    assert decoration.leaves[0].inertial.mass_kg == pytest.approx(0.001)
    assert decoration.inertial.mass_kg == pytest.approx(11.0)


@pytest.mark.parametrize(
    ("how", "friction"),
    [
        ({}, 1.3 * 9.81 * 0.5),  # the arm to the middle of the lid, at its height
        ({"axis": (0.0, 0.0, 1.0)}, 0.0),
        ({"friction": 50.0}, 50.0),
        ({"kind": "slide", "axis": (0.0, 0.0, 1.0)}, 1.3 * 9.81),
        ({"kind": "slide", "axis": (1.0, 0.0, 0.0)}, 0.0),
    ],
    ids=str,
)
def test_what_hangs_on_a_joint_is_held_where_it_is_left(how, friction):
    (leaf,) = hinged(**how).leaves
    assert leaf.joint.friction == pytest.approx(friction, rel=0.02)


def test_nothing_is_lighter_than_two_grams_or_heavier_than_five_tonnes():
    mote = [box((0.01, 0.01, 0.01), (0, 0, 0), RED)]
    assert assemble("mote", mote, 1e-6).mass_kg == 0.002
    assert assemble("star", mote, 1e9).mass_kg == 5000.0


@pytest.mark.parametrize(
    ("extent", "is_possible"), [(0.001, True), (0.0009, False), (100.0, True), (101.0, False)]
)
def test_a_body_measures_from_a_millimetre_to_a_hundred_metres(extent, is_possible):
    for axis in range(3):
        size_m = [1.0, 1.0, 1.0]
        size_m[axis] = extent
        if is_possible:
            check_size(size_m)
        else:
            with pytest.raises(ModelError, match=r"0\.001 to 100 m along each axis, not .*; look here"):
                check_size(size_m, "; look here")
    check_size(None)


def test_mass_grows_with_volume():
    assert build("table", (1.6, 2.4, 1.5)).mass_kg == pytest.approx(8 * 22.0)
    assert build("", (0.2, 0.3, 0.4)).mass_kg == pytest.approx(150.0 * 0.024)
