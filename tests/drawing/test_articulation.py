"""Surfaces are drawn with their joints at their current positions."""

import numpy as np
import pytest

from semmap.nodes.drawing.articulation import articulated, joint_positions_of
from semmap.nodes.sim_node.models.facets import surface_of
from semmap.nodes.sim_node.models.library import build
from semmap.schemas.joints import Joint


def points(surface):
    return np.frombuffer(surface.points, "<f4").reshape(-1, 3)


def test_a_surface_tells_what_each_joint_moves():
    surface = surface_of(build("fridge", None))
    assert {leaf.joint for leaf in surface.leaves} == {"door", "freezer"}
    assert all(0 < leaf.count < len(points(surface)) for leaf in surface.leaves)


def test_an_open_door_reaches_out_and_the_rest_stays():
    surface = surface_of(build("fridge", None))
    door = next(leaf for leaf in surface.leaves if leaf.joint == "door")
    moved = points(articulated(surface, (("door", 1.5),))) - points(surface)
    rows = np.arange(len(moved))
    own = (rows >= door.first) & (rows < door.first + door.count)
    assert np.abs(moved[own]).max() > 0.3
    assert not moved[~own].any()


def test_a_hinge_keeps_distances_from_its_axis_and_a_slide_shifts():
    for name in ("door", "cabinet", "chest_of_drawers"):
        for leaf in surface_of(build(name, None)).leaves:
            surface = surface_of(build(name, None))
            rows = slice(leaf.first, leaf.first + leaf.count)
            before, after = points(surface)[rows], points(articulated(surface, ((leaf.joint, 0.3),)))[rows]
            if leaf.kind == "slide":
                assert np.linalg.norm(after - before, axis=1) == pytest.approx(0.3, abs=1e-5)
            else:
                far = [np.linalg.norm(each - leaf.anchor, axis=1) for each in (before, after)]
                assert far[1] == pytest.approx(far[0], abs=1e-5)


def test_what_is_shut_is_the_surface_itself_and_an_unknown_joint_is_passed_over():
    surface = surface_of(build("fridge", None))
    assert articulated(surface, ()) is surface
    assert articulated(surface, (("lid", 1.0),)) is surface


def test_bends_come_in_steps_that_can_be_seen():
    joints = (
        Joint(name="door", kind="hinge", position=0.512),
        Joint(name="drawer", kind="slide", position=0.004),
        Joint(name="ball", kind="ball", position=1.0),
    )
    assert joint_positions_of(joints) == (("door", 0.5),)
