"""Default thresholds of moved and stale, which docs and models rely on."""

import math

from semmap.nodes.coordinator.config import CoordinatorConfig


def test_a_body_has_moved_beyond_five_centimetres_five_degrees_or_a_fiftieth_of_its_way():
    moved = CoordinatorConfig().thresholds
    assert (moved.distance_m, math.degrees(moved.angle_rad), moved.share) == (0.05, 5.0, 0.02)


def test_a_live_pose_is_stale_after_two_seconds_and_is_committed_only_where_it_stops():
    live = CoordinatorConfig().live
    assert (live.stale_s, live.journal_every_s) == (2.0, 0.0)


def test_the_map_owns_what_exists_and_names_are_not_proved():
    config = CoordinatorConfig()
    assert (config.truth, config.keys) == ("map", None)
