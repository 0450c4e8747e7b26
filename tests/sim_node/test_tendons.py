"""Worlds with tendons and equality constraints."""

import mujoco
import pytest

from semmap.nodes.sim_node.world import World

FINGERS = """<mujoco><worldbody><geom type="plane" size="0 0 .1"/>
<body name="left" pos="0 0 1"><joint name="l" axis="0 1 0" damping="1"/><geom size=".1" pos=".2 0 0"/></body>
<body name="right" pos="0 1 1"><joint name="r" axis="0 1 0" damping="1"/><geom size=".1" pos=".2 0 0"/></body>
</worldbody><tendon><fixed name="both"><joint joint="l" coef="1"/><joint joint="r" coef="-1"/></fixed>
</tendon>
<equality>{}</equality></mujoco>"""


@pytest.mark.parametrize(
    ("equality", "sleeps"), [('<tendon tendon1="both"/>', False), ('<joint joint1="l" joint2="r"/>', True)]
)
def test_bodies_rest_whatever_they_are_tied_with(equality, sleeps):
    world = World(mujoco.MjSpec.from_string(FINGERS.format(equality)))
    world.step(10.0)
    assert all(world.poses().resting)
    assert world.asleep is sleeps
