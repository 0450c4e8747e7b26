"""The scenes of a video."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from semmap.nodes.extern.movie import storyboard
from semmap.nodes.extern.movie.storyboard import GLIDE_S, LEAST_S, Scene, interpolate, scenes, steps, total_s
from semmap.schemas.entities import Pose, angle_rad, orientation_from_yaw
from tests.recorder.messages import START_NS, commit, entity, pose

CUP, TABLE = entity("cup1", "Cup", pose(1.0)), entity("table1", "Table")
KITCHEN = entity("kitchen1", "Kitchen", place=True)
START = {e.name: e for e in (CUP, TABLE, KITCHEN)}


def board(*commits, **rhythm):
    return list(scenes(START, commits, since=1, start_ns=START_NS + 1_000_000_000, **rhythm))


def test_it_begins_with_what_is_there_and_has_a_body():
    (first,) = board()
    assert first.add == (CUP, TABLE)
    assert first.caption.startswith("commit 1 · 20")
    assert first.seconds == storyboard.FIRST_S


def test_each_commit_is_a_scene_that_says_what_it_changes():
    moved = structs.replace(CUP, pose=pose(1.5))
    larger = structs.replace(TABLE, size_m=(1.0, 1.0, 1.0))
    box = entity("box1", "Box")
    _, one, two, three = board(
        commit(2, moved, box, reason="tidy"), commit(3, larger), commit(4, removed=("cup1", "kitchen1"))
    )
    assert (one.glide, one.add, one.remove) == ((("cup1", CUP.pose, moved.pose),), (box,), ())
    assert one.labels == {"cup1": "cup1 moved 50 cm", "box1": "box1 is added"}
    assert one.caption.startswith("commit 2 · ")
    assert one.caption.endswith(" · operator: tidy")
    assert (two.add, two.glide) == ((larger,), ())
    assert two.labels == {"table1": "table1 size: unknown -> 1 x 1 x 1"}
    assert (three.remove, three.labels) == (("cup1",), {"cup1": "cup1 is removed"})


def test_a_scene_is_as_long_as_it_was_and_long_enough_to_be_read():
    commits = [structs.replace(commit(seq), stamp_ns=START_NS + s * 10**9) for seq, s in ((2, 3), (3, 103))]
    assert [scene.seconds for scene in board(*commits, longest_s=5.0)] == [2.0, 5.0, LEAST_S]
    assert total_s(board(*commits, speed=1e6)) == pytest.approx(storyboard.FIRST_S + 2 * LEAST_S)


def test_things_glide_from_where_they_were_to_where_they_are():
    scene = Scene(seconds=2.0, caption="", glide=(("cup1", pose(), pose(1.0)),))
    shares = [*steps(scene, 20)]
    assert sum(frames for _, frames in shares) == 40
    assert len(shares) == GLIDE_S * 20 + 1
    assert [share for share, _ in shares] == sorted(share for share, _ in shares)
    assert (shares[0][0], shares[-1]) == (0.0, (1.0, 28))


def test_what_goes_is_seen_for_a_while_and_a_still_scene_is_one_picture():
    assert [*steps(Scene(seconds=2.0, caption="", remove=("cup1",)), 10)] == [(0.0, 6), (1.0, 14)]
    assert [*steps(Scene(seconds=2.0, caption=""), 10)] == [(1.0, 20)]
    assert [*steps(Scene(seconds=0.01, caption="", remove=("cup1",)), 10)] == [(1.0, 1)]


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi), st.floats(0.0, 1.0))
def test_on_the_way_a_thing_turns_the_shorter_way_round(first, second, share):
    was, now = (
        Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=orientation_from_yaw(a)) for a in (first, second)
    )
    there = interpolate(was, now, share)
    whole = angle_rad(was, now)
    if whole < 3.0:  # opposite ways are equally short
        assert angle_rad(was, there) + angle_rad(there, now) == pytest.approx(whole, abs=1e-4)
    assert interpolate(was, now, 0.0) == was or angle_rad(interpolate(was, now, 0.0), was) < 1e-6
    assert angle_rad(interpolate(was, now, 1.0), now) < 1e-6
