"""A board 3 m long in front of a wall, and a camera that moves along it and sees only a part at a time."""

from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.views import segment_memory
from semmap.nodes.perception_node.views.segment_memory import SegmentMemory, completed, joined
from semmap.nodes.perception_node.views.segmented_view import SegmentedView
from semmap.nodes.perception_node.views.segments import cut_out

WIDTH, HEIGHT, FOCAL = 160, 120, 120.0
BOARD_M, WALL_M, SCREEN_M = 2.0, 3.0, 1.0
HALF_M = 1.5
K = np.array([[FOCAL, 0.0, WIDTH / 2], [0.0, FOCAL, HEIGHT / 2], [0.0, 0.0, 1.0]])


def seen_from(x, *, board=True, screen=False, label=1):
    """Return the view of a camera at (x, 0, 0) along the map's z axis, 1.33 m to either side."""
    aside = x + BOARD_M * (np.arange(WIDTH) + 0.5 - WIDTH / 2) / FOCAL
    above = BOARD_M * (np.arange(HEIGHT) + 0.5 - HEIGHT / 2) / FOCAL
    on = (np.abs(aside) < HALF_M)[None, :] & (np.abs(above) < 0.3)[:, None] & board & (not screen)
    depth = np.where(on, BOARD_M, SCREEN_M if screen else WALL_M).astype(np.float32)
    pose = np.eye(4)
    pose[0, 3] = x
    cloud = cloud_of(depth, np.full((HEIGHT, WIDTH, 3), 90, np.uint8), K, pose, camera="head", stamp_ns=1)
    labels = np.where(on, label, 0).astype(np.int32)
    nothing = np.zeros_like(labels)
    return SegmentedView(
        cloud, pose, labels, frozenset(), nothing, (), np.zeros((0, 0), np.float32),
        tuple(cut_out(cloud, pose, labels)),
    )  # fmt: skip


def looked(before, sight):
    """Return the memory after a frame, as in the pipeline, and the visible part of the board."""
    recalled = before.recalled([sight], [sight.labels])
    things = {segment.label: (segment,) for segment in sight.segments}
    for rest, thing in recalled:
        if thing:
            things[thing] = completed(things[thing], [rest])
    after = before.after([sight], things.values(), [rest for rest, thing in recalled if not thing])
    return after, next(iter(things.values()), ())


def drive(*places, **last):
    before, seen = SegmentMemory(), ()
    for n, x in enumerate(places):
        before, seen = looked(before, seen_from(x, **(last if n == len(places) - 1 else {})))
    return before, seen


def extent(segments):
    along = np.concatenate([segment.points for segment in segments])[:, 0]
    return along.min(), along.max()


def test_what_the_edge_cuts_is_completed_by_what_was_seen_before():
    _, alone = drive(0.7)
    assert extent(alone) == pytest.approx((-0.63, HALF_M), abs=0.03)
    assert all(segment.cut for segment in alone)
    _, seen = drive(-0.8, -0.7, -0.3, 0.2, 0.7)
    assert extent(seen) == pytest.approx((-HALF_M, HALF_M), abs=0.03)
    assert not any(segment.cut for segment in seen)


def test_it_stays_cut_where_nobody_has_seen_it_go_on():
    _, seen = drive(-0.1, 0.0, 0.1, 0.05)
    assert extent(seen) == pytest.approx((-1.33, 1.43), abs=0.05)
    assert all(segment.cut for segment in seen)


def test_a_camera_that_does_not_move_remembers_nothing():
    before, seen = drive(*[0.5] * 5)
    assert before.segments == ()
    assert len(seen) == 1


def test_what_is_looked_through_is_forgotten_and_what_is_hidden_is_not():
    before, _ = drive(-0.8, -0.7, -0.3)
    gone, _ = looked(before, seen_from(0.0, board=False))
    assert extent(gone.segments) == pytest.approx((-HALF_M, -1.33), abs=0.05)  # out of the picture
    gone, _ = looked(gone, seen_from(-0.5, board=False))
    assert gone.segments == ()
    hidden, _ = looked(before, seen_from(0.0, screen=True))
    assert len(hidden.segments[0].points) == len(before.segments[0].points)


def test_what_is_seen_as_two_things_is_no_longer_remembered_as_one():
    before, _ = drive(-0.8, -0.7)
    sight = seen_from(-0.6)
    left = np.arange(WIDTH) < WIDTH // 2
    labels = np.where(sight.labels & left, 2, sight.labels)
    recalled = before.recalled([sight], [labels])
    assert all(len(rest.points) < 0.1 * len(before.segments[0].points) for rest, _ in recalled)


def test_only_cameras_with_a_name_and_a_known_place_are_remembered():
    sight = seen_from(0.0)
    lacks = [
        replace(sight, cloud=replace(sight.cloud, **lack))
        for lack in ({"camera": ""}, {"intrinsics": None}, {"map_from_camera": None})
    ]
    assert SegmentMemory().after(lacks, [], []).first == {}
    assert [*SegmentMemory().after([*lacks, sight], [], []).first] == ["head"]


def test_memory_is_bounded(monkeypatch):
    monkeypatch.setattr(segment_memory, "MOST_SEGMENTS", 3)
    before, _ = drive(*np.linspace(-0.8, 0.8, 40))
    before = before.after([], [], [*before.segments, *[joined(before.segments)] * 5])
    assert len(before.segments) == 3
    assert all(len(segment.points) <= segment_memory.MOST_POINTS for segment in before.segments)
    assert all(len(segment.colors) == len(segment.points) for segment in before.segments)
    assert all(len(segment.ends) < 100 for segment in before.segments)
