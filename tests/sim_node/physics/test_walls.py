"""The outlines of static geometry."""

import math

import mujoco
import numpy as np
import pytest

from semmap.nodes.geometry import polygons
from semmap.nodes.sim_node.physics.walls import outer_points, walls

TETRAHEDRON = "0 0 0  1 0 0  0 1 0  0 0 2"


def outlines(*geoms, bodies=(), body_xml="", assets=""):
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><asset>{assets}</asset><worldbody>{''.join(geoms)}{body_xml}</worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return walls(model, data, bodies)


def box(outline):
    corners = np.array(outline.corners)
    return corners.min(axis=0).tolist(), corners.max(axis=0).tolist(), outline.low, outline.high


def test_a_box_is_its_rectangle_from_its_bottom_to_its_top():
    (wall,) = outlines('<geom type="box" size="1 0.1 1.2" pos="2 3 1.2"/>')
    assert len(wall.corners) == 4
    assert box(wall) == ([1.0, 2.9], [3.0, 3.1], 0.0, 2.4)


def test_a_turned_box_is_turned():
    (wall,) = outlines('<geom type="box" size="1 0.1 1" euler="0 0 90"/>')
    assert box(wall) == ([-0.1, -1.0], [0.1, 1.0], -1.0, 1.0)


def test_a_leaning_box_covers_more():
    (wall,) = outlines('<geom type="box" size="1 1 0.1" euler="0 90 0"/>')
    assert box(wall) == ([-0.1, -1.0], [0.1, 1.0], -1.0, 1.0)


@pytest.mark.parametrize("geom", ['type="cylinder" size="0.5 1"', 'type="sphere" size="0.5"'])
def test_what_is_round_has_sixteen_corners_around_it(geom):
    (pillar,) = outlines(f'<geom {geom} pos="1 2 1"/>')
    away = [math.hypot(x - 1.0, y - 2.0) for x, y in pillar.corners]
    assert len(away) == 16
    assert away == pytest.approx([0.5 / math.cos(math.pi / 16)] * 16, abs=1e-5)
    half = 1.0 if "cylinder" in geom else 0.5
    assert (pillar.low, pillar.high) == (1.0 - half, 1.0 + half)


def test_a_mesh_is_the_hull_of_its_corners():
    (wedge,) = outlines(
        '<geom type="mesh" mesh="t"/>', assets=f'<mesh name="t" vertex="{TETRAHEDRON}" scale="1 1 1"/>'
    )
    assert len(wedge.corners) == 3
    sides = sorted(
        math.dist(wedge.corners[k], wedge.corners[(k + 1) % 3]) for k in range(3)
    )  # MuJoCo moves a mesh to its middle and turns it
    assert wedge.high - wedge.low <= 2.0 + 1e-6
    assert sides[0] > 0.5


@pytest.mark.parametrize("form", ["cloud", "line", "circle", "grid", "point"])
def test_only_points_that_are_not_on_the_hull_are_dropped(form):
    points = np.random.default_rng(1).normal(size=(5000, 2))
    match form:
        case "line":
            points[:, 1] = 2.0 * points[:, 0]
        case "circle":
            points /= np.linalg.norm(points, axis=1)[:, None]
        case "grid":
            points = np.round(points)
        case "point":
            points[:] = 1.0
    outer = outer_points(points)
    assert polygons.hull(list(map(tuple, outer.tolist()))) == polygons.hull(list(map(tuple, points.tolist())))
    assert len(outer) < 100 or form in ("line", "circle", "point")


@pytest.mark.parametrize(
    "geom",
    [
        '<geom type="plane" size="1 1 1"/>',
        '<geom type="box" size="1 1 1" contype="0" conaffinity="0"/>',
    ],
    ids=["a floor", "what does not collide"],
)
def test_this_is_in_nobody_s_way(geom):
    assert outlines(geom) == ()


@pytest.mark.parametrize("masks", ['contype="1" conaffinity="0"', 'contype="0" conaffinity="1"'])
def test_what_collides_with_some_things_is_in_the_way(masks):
    assert len(outlines(f'<geom type="box" size="1 1 1" {masks}/>')) == 1


def test_bodies_and_what_moves_are_no_walls_but_what_follows_them_is():
    shelf = '<body name="shelf" pos="5 0 0"><geom type="box" size="1 1 1"/></body>'
    can = '<body name="can" pos="0 5 0"><freejoint/><geom type="box" size="1 1 1"/></body>'
    frame = '<body name="frame" pos="9 0 0"><geom type="box" size="1 1 1"/></body>'
    found = outlines(body_xml=shelf + can + frame, bodies={1})
    assert [box(wall)[0] for wall in found] == [[8.0, -1.0]]
    assert len(outlines(body_xml=shelf + can + frame)) == 2


@pytest.mark.parametrize("kind", ["capsule", "ellipsoid"])
def test_other_shapes_are_the_boxes_around_them(kind):
    (wall,) = outlines(f'<geom type="{kind}" size="0.2 0.3 0.4" pos="1 2 3"/>')
    across, up = (0.2, 0.5) if kind == "capsule" else (0.3, 0.4)
    low, high, bottom, top = box(wall)
    assert (low, high) == ([0.8, 2.0 - across], [1.2, 2.0 + across])
    assert (bottom, top) == (3.0 - up, 3.0 + up)
