"""Images without OpenGL."""

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.vision.raycast import raycast
from semmap.nodes.sim_node.vision.view import look_at

SCENE = """<mujoco>
  <asset>
    <texture name="half" type="2d" builtin="flat" rgb1="0.5 0.5 0.5" width="4" height="4"/>
    <material name="plain" rgba="0 0 1 1"/>
    <material name="tiled" texture="half" rgba="1 0.5 0 1"/>
  </asset>
  <worldbody>
    <geom name="floor" type="plane" size="9 9 1" rgba="0 1 0 1"/>
    <geom name="box" type="box" size="0.3 0.3 0.25" pos="0 0 0.25" rgba="1 0 0 1"/>
    <geom name="blue" type="box" size="0.1 0.1 0.1" pos="1 0 0.1" material="plain"/>
    <geom name="tiles" type="box" size="0.1 0.1 0.1" pos="-1 0 0.1" material="tiled"/>
    <geom name="hidden" type="box" size="0.3 0.3 0.3" pos="0 0 1.5" group="3"/>
    {more}
  </worldbody></mujoco>"""
VIEW = look_at(np.array([0.0, -1e-6, 3.0]), np.zeros(3), 80, 60, np.radians(60))


def seen(view=VIEW, more="", **how):
    model = mujoco.MjModel.from_xml_string(SCENE.format(more=more))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, *raycast(model, data, view, **how)


def at(x, y):
    """Return row and column of a point of the floor."""
    focal = VIEW.intrinsics[0, 0]
    return int(30 - focal * y / 3.0), int(40 + focal * x / 3.0)


def test_each_pixel_has_its_geom_its_depth_and_its_colour():
    model, rgb, depth, geom = seen()
    assert (rgb.shape, rgb.dtype) == ((60, 80, 3), np.uint8)
    assert (depth.shape, depth.dtype) == ((60, 80), np.float32)
    assert model.geom(int(geom[30, 40])).name == "box"
    assert depth[30, 40] == pytest.approx(2.5, abs=1e-3)
    assert model.geom(int(geom[at(0.6, 0.6)])).name == "floor"
    assert depth[at(0.6, 0.6)] == pytest.approx(3.0, abs=1e-3)  # along the axis, not along the ray
    assert depth[2, 2] == pytest.approx(3.0, abs=1e-3)
    red, green, blue = rgb[30, 40].tolist()
    assert red > 200
    assert green == blue == 0


def test_what_is_only_felt_is_not_seen():
    model, _, _, geom = seen()
    assert model.geom("hidden").id not in geom


def test_materials_give_their_colour_and_textures_their_mean():
    model, rgb, _, geom = seen()
    blue = rgb[geom == model.geom("blue").id].max(axis=0)
    assert blue[:2].tolist() == [0, 0]
    assert blue[2] > 200
    tiles = rgb[geom == model.geom("tiles").id].max(axis=0).astype(float)
    assert tiles[2] == 0
    assert tiles[1] / tiles[0] == pytest.approx(0.5, abs=0.02)
    assert tiles[0] / blue[2] == pytest.approx(0.5, abs=0.03)


def test_the_sky_has_no_depth_and_no_geom_and_is_darker_higher_up():
    level = look_at(np.array([0.0, 0.0, 5.0]), np.array([9.0, 0.0, 6.0]), 80, 60, np.radians(60))
    _, rgb, depth, geom = seen(level)
    assert (geom[:20] == -1).all()
    assert (depth[:20] == 0.0).all()
    low, high = rgb[:20].min(axis=(0, 1)).astype(int), rgb[:20].max(axis=(0, 1)).astype(int)
    assert (rgb[0, 40] == low).all()
    assert (high - low > 5).all()
    assert rgb[0, 40].tolist() == sorted(rgb[0, 40].tolist())  # it is blue
    up = look_at(np.array([0.0, 0.0, 5.0]), np.array([0.0, 0.0, 9.0]), 3, 3, 0.1)
    assert seen(up)[1][1, 1].tolist() == pytest.approx([153, 189, 224], abs=1)


def test_what_faces_the_lamp_is_brighter_than_what_does_not():
    front = look_at(np.array([0.0, -3.0, 0.25]), np.array([0.0, 0.0, 0.25]), 80, 60, np.radians(30))
    side = look_at(np.array([3.0, 0.0, 0.25]), np.array([0.0, 0.0, 0.25]), 80, 60, np.radians(30))
    model, *from_front = seen(front)
    _, *from_side = seen(side)
    box = model.geom("box").id
    lit = from_front[0][from_front[2] == box][:, 0].mean()
    unlit = from_side[0][from_side[2] == box][:, 0].mean()
    top = seen()[1][30, 40, 0]
    assert unlit < lit < top
    assert unlit == pytest.approx(255 * np.sqrt(0.3 + 0.18), abs=4)  # no lamp, only what is everywhere
    assert top == pytest.approx(255 * np.sqrt(0.3 + 0.18 + 0.48 * 0.9), abs=6)


def test_with_shadows_what_is_behind_something_seen_from_the_lamp_is_darker():
    tower = '<geom name="tower" type="box" size="0.05 0.05 0.4" pos="-0.4 0.8 0.4" rgba="1 1 1 1"/>'
    model, plain, _, geom = seen(more=tower)
    _, shaded, _, _ = seen(more=tower, shadows=True)
    floor = geom == model.geom("floor").id
    ratio = shaded[floor][:, 1] / plain[floor][:, 1].astype(float)
    assert (ratio > 0.99).mean() > 0.7
    dark = ratio < 0.9
    assert dark.any()
    assert ratio[dark] == pytest.approx(np.sqrt(0.55), abs=0.01)
    rows, columns = np.nonzero(floor)
    towards = np.array([rows[dark].mean(), columns[dark].mean()])
    assert towards[0] < rows.mean()  # the lamp is in front, to the left
    assert shaded[30, 40].tolist() == plain[30, 40].tolist()
