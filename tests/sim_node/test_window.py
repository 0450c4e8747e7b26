import os

import pytest

from nodes.sim_node.window import Window
from nodes.sim_node.world import World
from schemas.entities import distance_m
from schemas.errors import BadRequest
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
