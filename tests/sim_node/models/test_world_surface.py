"""The walls of a world and the bodies of its file, as triangles."""

import mujoco
import numpy as np
import pytest

from semmap.nodes.drawing.articulation import articulated
from semmap.nodes.sim_node.models.world_surface import (
    body_surface,
    close_joints,
    digest_of,
    world_surface,
)

ROOM = """<mujoco>
  <asset>
    <material name="brick" rgba="1 0 0 1"/>
    <mesh name="wedge" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>
  </asset>
  <worldbody>
    <geom type="plane" size="5 5 0.1"/>
    <geom type="box" size="0.5 0.1 1" pos="2 3 1" euler="0 0 90" material="brick"/>
    <geom type="sphere" size="0.25" pos="0 0 4" rgba="0 1 0 1"/>
    <geom type="cylinder" size="0.1 0.5" pos="0 0 8" rgba="0 0 1 1"/>
    <geom type="mesh" mesh="wedge" pos="20 0 0" rgba="1 1 1 1"/>
    <geom type="box" size="9 9 9" rgba="0 0 0 0"/>
    <geom type="box" size="9 9 9" group="3"/>
    <body name="cup" pos="30 0 0"><freejoint/><geom type="box" size="1 1 1"/></body>
  </worldbody>
</mujoco>"""


@pytest.fixture(scope="module")
def told():
    model = mujoco.MjModel.from_xml_string(ROOM)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    names = ["cup" if body else "" for body in model.geom_bodyid]
    surface = world_surface(model, data, names)
    rows = (np.frombuffer(surface.points, "<f4"), np.frombuffer(surface.normals, "<f4"))
    points, normals = (row.reshape(-1, 3) for row in rows)
    colours = np.frombuffer(surface.colours, "u1").reshape(-1, 3)
    return points, normals, colours, np.frombuffer(surface.triangles, "<u4").reshape(-1, 3)


def spans(points):
    return np.stack([points.min(axis=0), points.max(axis=0)])


def test_a_wall_is_where_it_stands_and_as_it_is_turned(told):
    points, _, colours, _ = told
    wall = points[(colours == (255, 0, 0)).all(axis=1)]
    assert spans(wall) == pytest.approx(np.array([(1.9, 2.5, 0), (2.1, 3.5, 2)]), abs=1e-6)


def test_round_things_have_their_size(told):
    points, _, colours, _ = told
    ball = points[(colours == (0, 255, 0)).all(axis=1)]
    can = points[(colours == (0, 0, 255)).all(axis=1)]
    assert spans(ball) == pytest.approx(np.array([(-0.25, -0.25, 3.75), (0.25, 0.25, 4.25)]), abs=0.01)
    assert spans(can) == pytest.approx(np.array([(-0.1, -0.1, 7.5), (0.1, 0.1, 8.5)]), abs=0.01)


def test_a_mesh_is_among_it_and_what_is_a_body_unseen_or_endless_is_not(told):
    points, _, _, _ = told
    assert 20.5 < points[:, 0].max() < 21.5
    assert points[:, 0].min() > -1.0


def test_triangles_turn_their_faces_outwards(told):
    points, normals, _, triangles = told
    a, b, c = (points[triangles[:, i]] for i in range(3))
    faces = np.cross(b - a, c - a)
    large = np.linalg.norm(faces, axis=1) > 1e-9
    assert (np.einsum("ij,ij->i", faces, normals[triangles[:, 0]])[large] > 0.0).all()


ROBOT = mujoco.MjModel.from_xml_string("""<mujoco><worldbody>
    <body name="robot" pos="5 6 0" euler="0 0 90">
      <joint name="base" type="slide" axis="1 0 0"/>
      <geom type="box" size="0.5 0.1 0.2" pos="0 0 0.2" rgba="1 0 0 1"/>
      <body name="arm" pos="0.4 0 0.4">
        <joint name="shoulder" axis="0 1 0"/><joint name="pan" axis="0 0 1" pos="0.1 0 0"/>
        <geom type="box" size="0.1 0.1 0.3" pos="0 0 0.3"/>
        <body name="plate" pos="0 0 0.6" euler="0 30 0"><geom type="sphere" size="0.1"/>
          <body name="hand"><joint name="wrist" axis="1 1 0"/><joint name="reach" type="slide" axis="0 0 1"/>
            <geom type="box" size="0.1 0.02 0.02"/></body></body>
      </body>
      <body name="antenna" pos="-0.4 0 0.4"><geom type="box" size="0.02 0.02 0.1" pos="0 0 0.1"/></body>
    </body>
    <geom type="box" size="1 1 1"/>
  </worldbody></mujoco>""")
ROBOT_GEOMS = np.flatnonzero(ROBOT.geom_bodyid).tolist()


def at(**positions):
    """Return the state with joints at these positions."""
    data = mujoco.MjData(ROBOT)
    for name, position in positions.items():
        data.joint(name).qpos[:] = position
    mujoco.mj_forward(ROBOT, data)
    return data


def robot_surface(data, geoms=ROBOT_GEOMS):
    body = data.body("robot")
    return body_surface(ROBOT, data, geoms, body.id, np.concatenate([body.xpos, body.xquat]))


def points_of(surface):
    return np.frombuffer(surface.points, "<f4").reshape(-1, 3)


def test_the_surface_of_a_body_is_in_its_own_frame_and_has_its_parts():
    points = points_of(robot_surface(at()))
    assert points[:, :2].min(axis=0) == pytest.approx((-0.5, -0.1), abs=0.002)
    assert points[:, 2].min() == pytest.approx(0.0, abs=1e-6)
    assert robot_surface(at(), geoms=[]) is None


def test_joints_move_the_surface_of_a_body_as_they_move_its_parts():
    closed, random = robot_surface(at()), np.random.default_rng(1)
    assert [leaf.joint for leaf in closed.leaves] == ["shoulder", "pan", "wrist", "reach"]
    for _ in range(20):
        names = ("base", *(leaf.joint for leaf in closed.leaves))
        positions = dict(zip(names, random.uniform(-1.0, 1.0, 5).tolist(), strict=True))
        moved, truth = articulated(closed, tuple(positions.items())), robot_surface(at(**positions))
        assert points_of(moved) == pytest.approx(points_of(truth), abs=1e-4)
        assert np.frombuffer(moved.normals, "<f4") == pytest.approx(
            np.frombuffer(truth.normals, "<f4"), abs=1e-3
        )


def test_the_surface_does_not_depend_on_the_position_of_joints_when_it_is_requested():
    bent = close_joints(ROBOT, at(base=1.0, shoulder=0.7, reach=0.2))
    assert digest_of(robot_surface(bent)) == digest_of(robot_surface(at()))
