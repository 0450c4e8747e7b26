"""Settings of the simulator."""

from dataclasses import FrozenInstanceError
from pathlib import Path

import pytest

from semmap.nodes.bus import RESTART_S
from semmap.nodes.sim_node.config import CameraConfig, RobotConfig, SimConfig


def test_without_settings_there_is_a_bare_floor_that_no_camera_films():
    plain = SimConfig()
    assert (plain.world, plain.models, plain.data, plain.robot) == (None, None, None, None)
    assert (plain.window, plain.still) == (False, False)
    assert plain.patience_s == RESTART_S
    assert plain.cameras == CameraConfig(0.0, 640, 480, noise=False, segments=False, graphics=True)


def test_a_robot_begins_at_the_origin():
    robot = RobotConfig(Path("rover.xml"))
    assert (robot.name, robot.at_m, robot.yaw_rad) == ("robot1", (0.0, 0.0, 0.0), 0.0)


@pytest.mark.parametrize("config", [SimConfig(), CameraConfig(), RobotConfig(Path("rover.xml"))])
def test_settings_do_not_change(config):
    with pytest.raises(FrozenInstanceError):
        config.name = "other"
    assert config == type(config)(**vars(config))
