import contextlib
import os
import sys
from types import SimpleNamespace

import mujoco
import pytest

from semmap.nodes.sim_node.window import Window
from semmap.nodes.sim_node.world import World
from semmap.schemas.entities import distance_m
from semmap.schemas.errors import BadRequest
from tests.sim_node.orders import order, pose

DISPLAY = bool(os.environ.get("DISPLAY"))


@pytest.mark.skipif(DISPLAY, reason="there is a display")
def test_without_a_display_it_is_said_at_once():
    with pytest.raises(BadRequest, match="no display"):
        Window(World())


@pytest.mark.skipif(not DISPLAY, reason="needs a display")
def test_the_mouse_pulls_a_body_and_lets_it_go():
    world = World()
    window = Window(world)
    try:
        window.refresh()
        world.spawn([order("chair1", "chair", pose(0, 0))])  # a new model while the window is open
        world.step(0.5)
        window.refresh()
        mouse = window._viewer.perturb
        mouse.select, mouse.active = world.model.geom_bodyid[world.body_names().index("chair1")], 1
        mouse.refpos = mouse.refselpos = [0.5, 0.5, 1.0]
        mouse.localmass, mouse.scale = 5.0, 1.0
        for _ in range(40):
            window.refresh()
            world.step(0.05)
        mouse.active = 0
        for _ in range(40):
            window.refresh()
            world.step(0.05)
        assert window._viewer.user_scn.geoms[0].label == "chair1"
    finally:
        window.close()
    chair = world.scene().bodies[0]
    assert distance_m(chair.pose, pose(0, 0)) > 0.1
    assert chair.resting


class Viewer:
    """MuJoCo's viewer without a display, which records its calls."""

    def __init__(self, world):
        self.cam, self.perturb = mujoco.MjvCamera(), mujoco.MjvPerturb()
        self.user_scn = mujoco.MjvScene(world.model, maxgeom=10)
        self.loaded, self.synced, self.running, self.closed = [], 0, True, False

    def is_running(self):
        return self.running

    def lock(self):
        return contextlib.nullcontext()

    def sync(self):
        self.synced += 1

    def close(self):
        self.closed = True

    def _get_sim(self):
        return SimpleNamespace(load=lambda model, data, name: self.loaded.append(model))


@pytest.fixture
def opened(monkeypatch):
    world = World()
    viewer = Viewer(world)
    monkeypatch.setattr("semmap.nodes.sim_node.window._require_display", lambda: None)
    shown = SimpleNamespace(launch_passive=lambda model, data, **how: viewer)
    monkeypatch.setattr(mujoco, "viewer", shown, raising=False)
    monkeypatch.setitem(sys.modules, "mujoco.viewer", shown)
    return world, viewer, Window(world)


def test_another_model_is_loaded_once_and_each_refresh_shows_the_world(opened):
    world, viewer, window = opened
    window.refresh()
    assert (viewer.loaded, viewer.synced) == ([], 1)
    world.spawn([order("fridge1", "fridge", pose(0, 0))])
    window.refresh()
    window.refresh()
    assert (viewer.loaded, viewer.synced) == ([world.model], 3)


def test_a_window_that_was_closed_shows_nothing(opened):
    world, viewer, window = opened
    viewer.running = False
    world.spawn([order("fridge1", "fridge", pose(0, 0))])
    window.refresh()
    assert (viewer.loaded, viewer.synced) == ([], 0)
    window.close()
    assert viewer.closed


def test_the_selected_body_has_its_name_above_it(opened):
    world, viewer, window = opened
    world.spawn([order("can1", "can", pose(1, 2))])
    window.refresh()
    assert viewer.user_scn.ngeom == 0
    viewer.perturb.select = world.model.geom_bodyid[world.body_names().index("can1")]
    window.refresh()
    assert viewer.user_scn.ngeom == 1
    label = viewer.user_scn.geoms[0]
    assert label.label == "can1"
    assert label.type == mujoco.mjtGeom.mjGEOM_LABEL
    assert label.pos == pytest.approx((1.0, 2.0, world.data.xpos[viewer.perturb.select][2] + 0.3))
    viewer.perturb.select = world.model.nbody
    window.refresh()
    assert viewer.user_scn.ngeom == 0
