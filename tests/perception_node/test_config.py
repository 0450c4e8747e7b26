"""Settings of perception."""

import math
from dataclasses import FrozenInstanceError, replace

import pytest

from semmap.nodes.perception_node.config import PerceptionConfig, TrackingConfig


def test_a_thing_needs_fewer_looks_the_clearer_it_is_and_more_to_go_than_to_come():
    config = TrackingConfig()
    assert (config.clear_frames, config.confirm_frames, config.part_frames) == (2, 3, 3)
    assert (config.rest_frames, config.nudge_frames, config.kept_frames) == (2, 8, 40)
    assert (config.gone_frames, config.odd_frames, config.vanished_frames) == (10, 15, 1)
    assert (config.still_m, config.moved_m, config.resized, config.clear) == (0.02, 0.03, 0.25, 0.8)
    assert config.turned_rad == pytest.approx(math.radians(20.0))
    assert config.when_gone == "remove"


def test_while_a_camera_moves_parts_and_empty_places_need_more_looks():
    config = replace(TrackingConfig(), part_frames=5, vanished_frames=1)
    moving = config.for_moving_camera
    assert (moving.part_frames, moving.vanished_frames, moving.pushed_m) == (10, 3, 0.6)
    assert replace(config, pushed_m=0.2).for_moving_camera.pushed_m == 0.2
    assert moving.confirm_frames == config.confirm_frames


def test_without_settings_nothing_is_kept_and_no_label_is_known():
    config = PerceptionConfig()
    assert (config.tracking, dict(config.labels), config.lessons) == (TrackingConfig(), {}, None)
    for frozen in (config, config.tracking):
        with pytest.raises(FrozenInstanceError):
            frozen.lessons = 1
