"""Updates of a track by one more observation."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from msgspec import structs

from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING
from semmap.nodes.perception_node.tracking.fits import KnownFit
from semmap.nodes.perception_node.tracking.tracks import Track, slack_m, turn_between, turned_like
from semmap.schemas.entities import Size
from tests.perception_node.things import CLASSES, CONFIG, SIZES, at, seen

COUCH: Size = (2.0, 0.9, 0.85)


def couch() -> Track:
    track = Track(at(1, 1, 0.0), COUCH)
    for _ in range(5):
        track = track.see(seen("Object", at(1, 1, 0.0), COUCH), CONFIG)
    return track


@pytest.mark.parametrize(
    ("pose", "size_m"),
    [
        pytest.param(at(1.7, 1, 0.0), (0.6, 0.9, 0.85), id="one end of it"),
        pytest.param(at(0.5, 1, 0.0), (3.2, 1.0, 0.8), id="with what stands beside it"),
        pytest.param(at(1.6, 1.2, 0.0), (1.4, 1.1, 0.8), id="a part of it, with something else"),
    ],
)
def test_what_a_pictures_edge_cuts_does_not_move_what_was_seen_whole(pose, size_m):
    track = couch()
    for _ in range(20):
        track = track.see(seen("Object", pose, size_m, whole=False), CONFIG)
    assert track.pose == at(1, 1, 0.0)
    assert track.size_m == pytest.approx(COUCH)


def test_what_a_pictures_edge_cuts_elsewhere_has_moved():
    track = couch().see(seen("Object", at(4, 1, 0.0), (0.6, 0.9, 0.85), whole=False), CONFIG)
    assert track.pose == at(4, 1, 0.0)


def test_a_look_from_near_counts_more_for_the_class_than_one_from_afar_or_in_part():
    def after(points: int, *, whole: bool) -> str:
        track = Track(at(1, 1), (0.08, 0.08, 0.1))
        for _ in range(4):
            track = track.see(structs.replace(seen("Bottle", at(1, 1), COUCH), points=300), CONFIG)
        near = structs.replace(seen("Cup", at(1, 1), COUCH, whole=whole), points=points)
        return track.see(near, CONFIG).votes.belief(CLASSES)

    assert after(10_000, whole=True) == "Cup"
    assert after(300, whole=True) == "Bottle"
    assert after(1000, whole=False) in ("Bottle", ANYTHING)


def test_a_look_from_near_counts_more_for_place_and_size_than_one_from_afar():
    def after(points: int) -> Track:
        track = Track(at(1, 1), (0.26, 0.26, 0.07))
        for height, of in ((0.07, 100), (0.03, points)):
            plate = seen("Object", at(1, 1 + height / 10), (0.26, 0.26, height))
            track = track.see(structs.replace(plate, points=of), CONFIG)
        return track

    assert after(100).size_m[2] == pytest.approx(0.05)
    assert after(100).pose.position_m[1] == pytest.approx(1.005)
    assert after(16_000).size_m[2] < 0.035
    assert after(16_000).pose.position_m[1] < 1.0035


def test_looks_at_a_part_do_not_bear_out_where_a_thing_is():
    track = couch()
    assert (track.frames, track.whole_frames) == (5, 5)
    track = track.see(seen("Object", at(1.7, 1, 0.0), (0.6, 0.9, 0.85), whole=False), CONFIG)
    assert (track.frames, track.whole_frames) == (6, 5)


BOX: Size = (0.4, 0.2, 0.3)


def box_seen(pose=None, size_m=BOX, *, points=1000, whole=True, class_="Object"):
    return structs.replace(seen(class_, pose or at(1, 1), size_m, whole=whole), points=points)


def box(**more) -> Track:
    track = Track(at(1, 1), BOX).see(box_seen(), CONFIG)
    return replace(track, **more)


def test_the_first_look_is_what_is_known():
    track = box()
    assert (track.pose, track.size_m) == (at(1, 1), BOX)
    assert (track.frames, track.whole_frames, track.whole, track.sized, track.placed) == (
        1,
        1,
        True,
        1.0,
        1.0,
    )
    assert track.sized_as == "Object"


def test_where_it_is_is_the_mean_of_looks_by_what_they_are_worth():
    track = box().see(box_seen(at(1.018, 1)), CONFIG)
    assert track.pose.position_m == pytest.approx((1.009, 1.0, 0.7))
    assert (track.placed, track.frames, track.whole_frames) == (2.0, 2, 2)
    track = box().see(box_seen(at(1.018, 1), points=4000), CONFIG)  # worth two
    assert track.pose.position_m == pytest.approx((1.012, 1.0, 0.7))
    track = box().see(box_seen(at(1, 1, yaw=0.1)), CONFIG)
    assert track.pose.yaw_rad == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("points", "whole", "worth"),
    [(1000, True, 1.0), (4000, True, 2.0), (10, True, 0.25), (10**9, True, 4.0), (1000, False, 0.5)],
)
def test_a_look_is_worth_the_root_of_its_points_and_half_in_part(points, whole, worth):
    assert Track(at(1, 1), BOX).see(box_seen(points=points, whole=whole), CONFIG).placed == worth


def test_a_mean_goes_back_only_so_many_looks():
    track = box(placed=1000.0, sized=1000.0).see(box_seen(at(1.0189, 1), (0.421, 0.2, 0.3)), CONFIG)
    assert track.placed == track.sized == 21.0
    assert track.pose.position_m[0] == pytest.approx(1.0009)
    assert track.size_m[0] == pytest.approx(0.401)


def test_what_moves_begins_anew_and_what_is_turned_does_too():
    away = box(occupied=3, fit=FIT).see(box_seen(at(2, 1)), CONFIG)
    assert away.pose == at(2, 1)
    assert (away.frames, away.whole_frames, away.occupied, away.placed, away.fit) == (1, 1, 0, 1.0, None)
    turned = box(occupied=3).see(box_seen(at(1, 1, yaw=0.5)), CONFIG)
    assert (turned.frames, turned.occupied) == (1, 4)
    stays = box(occupied=3, fit=FIT).see(box_seen(), CONFIG)
    assert (stays.frames, stays.occupied, stays.fit) == (2, 3, FIT)


FIT = KnownFit("Object", 0.9, at(0, 0, yaw=1.0).orientation_wxyz, 1)


def test_a_look_at_it_forgets_that_it_was_missed():
    track = box(unseen=2, odd=3, absent=4).see(box_seen(), CONFIG)
    assert (track.unseen, track.odd, track.absent) == (0, 0, 0)
    part = replace(track, unseen=2, odd=3, absent=4).see(box_seen(whole=False), CONFIG)
    assert (part.unseen, part.odd, part.absent, part.frames) == (0, 0, 0, 3)
    assert part.placed == track.placed


@pytest.mark.parametrize(
    ("occupancy", "odd", "expected"),
    [
        ("unknown", False, {"absent": 5}),
        ("unknown", True, {"absent": 5}),
        ("free", False, {"unseen": 3, "odd": 0, "absent": 5}),
        ("occupied", False, {"occupied": 2, "unseen": 0, "odd": 0, "absent": 0}),
        ("occupied", True, {"occupied": 2, "unseen": 0, "odd": 4, "absent": 0}),
    ],
)
def test_what_is_seen_in_its_place_tells_what_it_means_that_it_is_not_seen(occupancy, odd, expected):
    track = box(unseen=2, odd=3, absent=4, occupied=1)
    assert track.miss(occupancy, odd=odd) == replace(track, **expected)


def test_it_is_gone_after_enough_looks_and_nearly_odd_one_before():
    assert not box(unseen=3, odd=5).is_gone(CONFIG)
    assert box(unseen=4).is_gone(CONFIG)
    assert box(odd=6).is_gone(CONFIG)
    assert box(odd=5).is_nearly_odd(CONFIG)
    assert not box(odd=4).is_nearly_odd(CONFIG)
    assert not box(odd=5, sized=0.0).is_nearly_odd(CONFIG)


@pytest.mark.parametrize(
    ("changes", "rests"),
    [
        ({"frames": 3}, True),
        ({"frames": 2}, False),
        ({"frames": 1, "occupied": 2}, True),
        ({"frames": 0, "occupied": 9}, False),
        ({"frames": 9, "unseen": 1}, False),
        ({"frames": 9, "odd": 1}, False),
    ],
    ids=str,
)
def test_it_rests_when_it_was_seen_there_often_enough(changes, rests):
    assert box(**changes).rests(3) is rests


def test_sizes_are_means_and_a_look_at_the_whole_is_worth_more_than_any_at_a_part():
    track = box().see(box_seen(size_m=(0.42, 0.2, 0.3), class_="Book"), CONFIG)
    assert track.size_m == pytest.approx((0.41, 0.2, 0.3))
    assert (track.sized, track.sized_as) == (2.0, "Book")
    part = Track(at(1, 1), BOX).see(box_seen(whole=False), CONFIG)
    whole = part.see(box_seen(size_m=(0.42, 0.2, 0.3)), CONFIG)
    assert whole.size_m == (0.42, 0.2, 0.3)
    assert (whole.sized, whole.whole) == (1.0, True)
    parts = part.see(box_seen(size_m=(0.42, 0.2, 0.3), whole=False), CONFIG)
    assert parts.size_m == pytest.approx((0.41, 0.2, 0.3))
    elsewhere = box().see(box_seen(at(5, 5), (0.3, 0.2, 0.3), whole=False), CONFIG)
    assert (elsewhere.size_m, elsewhere.whole) == (BOX, True)


@pytest.mark.parametrize(
    ("x", "size_m", "is_part"),
    [
        (1.0, (0.2, 0.1, 0.2), True),
        (1.11, (0.2, 0.1, 0.3), True),
        (1.3, (0.4, 0.2, 0.3), False),
        (1.25, (0.4, 0.2, 0.3), True),
    ],
)
def test_what_is_cut_is_a_part_of_what_was_seen_whole_where_much_of_either_is_in_both(x, size_m, is_part):
    track = box().see(box_seen(at(x, 1), size_m, whole=False), CONFIG)
    assert (track.pose == at(1, 1)) is is_part


def test_when_all_of_a_front_is_seen_the_track_is_of_that():
    front = Track(at(1.19, 1, 0.0), (0.02, 1.0, 1.8), map_pose=at(9, 9), part=True, rejected_class="Cup")
    front = front.see(seen("Object", at(1.19, 1, 0.0), (0.02, 1.0, 1.8)), CONFIG)
    shelf = seen("Object", at(1, 1, 0.0), (0.4, 1.0, 1.8))
    track = front.see(shelf, CONFIG)
    assert (track.pose, track.size_m, track.frames, track.whole_frames) == (shelf.pose, shelf.size_m, 1, 1)
    assert (track.map_pose, track.part, track.rejected_class, track.whole) == (at(9, 9), True, "Cup", True)
    back = track.see(seen("Object", at(1.19, 1, 0.0), (0.02, 1.0, 1.8)), CONFIG)
    assert (back.pose, back.size_m, back.frames) == (shelf.pose, shelf.size_m, 2)


def test_all_of_it_that_a_picture_s_edge_cuts_is_taken_for_the_whole():
    track = box(frames=9, sized=5.0).see_all(box_seen(size_m=(0.2, 0.2, 0.3), whole=False), CONFIG)
    assert track.size_m == (0.2, 0.2, 0.3)
    assert (track.frames, track.whole, track.outsized, track.sized) == (1, True, True, 1.0)


def test_the_map_is_told_the_yaw_of_the_model_if_there_is_one():
    assert box().reported_pose == at(1, 1)
    assert box(fit=FIT).reported_pose == at(1, 1, yaw=1.0)
    assert box(fit=replace(FIT, orientation_wxyz=None)).reported_pose == at(1, 1)


def test_a_model_that_does_not_fit_at_all_takes_its_class_away():
    cup = Track(at(1, 1), SIZES["Cup"])
    for _ in range(4):
        cup = cup.see(seen("Cup", at(1, 1)), CONFIG)
    kept, doubted = cup.fitted(FIT_OF_CUP, rejected=False), cup.fitted(FIT_OF_CUP, rejected=True)
    assert (kept.fit, kept.rejected_class, kept.votes) == (FIT_OF_CUP, "", cup.votes)
    assert (doubted.fit, doubted.rejected_class) == (FIT_OF_CUP, "Cup")
    assert doubted.votes.belief(CLASSES) == ANYTHING
    again = doubted.see(seen("Cup", at(1, 1)), CONFIG)
    assert again.votes.belief(CLASSES) == ANYTHING


FIT_OF_CUP = KnownFit("Cup", 0.1, None, 0)


@pytest.mark.parametrize(
    ("yaw", "size_m", "expected_yaw", "expected_m"),
    [
        (0.1, (0.4, 0.2, 0.3), 0.1, (0.4, 0.2, 0.3)),
        (0.1 + math.pi / 2, (0.2, 0.4, 0.3), 0.1, (0.4, 0.2, 0.3)),
        (0.1 - math.pi / 2, (0.2, 0.4, 0.3), 0.1, (0.4, 0.2, 0.3)),
        (0.1 + math.pi, (0.4, 0.2, 0.3), 0.1, (0.4, 0.2, 0.3)),
    ],
)
def test_a_box_is_described_by_the_quarter_turn_that_is_most_like_the_track_s(
    yaw, size_m, expected_yaw, expected_m
):
    pose, turned = turned_like(at(1, 1, yaw=yaw), size_m, box())
    assert turned == expected_m
    assert pose.yaw_rad == pytest.approx(expected_yaw)
    assert pose.position_m == (1.0, 1.0, 0.7)


@pytest.mark.parametrize(
    ("yaw", "turn"), [(0.3, 0.3), (-0.3, 0.3), (math.pi - 0.3, 0.3), (3.5 - 2 * math.pi, 3.5 - math.pi)]
)
def test_a_box_is_turned_at_most_by_a_quarter_either_way(yaw, turn):
    assert turn_between(box(), at(1, 1, yaw=yaw)) == pytest.approx(turn)


def test_what_is_about_as_wide_as_long_is_never_turned():
    assert turn_between(box(size_m=(0.25, 0.2, 0.3)), at(1, 1, yaw=0.7)) == 0.0
    assert turn_between(box(size_m=(0.27, 0.2, 0.3)), at(1, 1, yaw=0.7)) == pytest.approx(0.7)


@pytest.mark.parametrize(("size_m", "expected"), [((0.1, 0.1, 0.3), 0.02), ((2.0, 0.1, 0.3), 0.1)])
def test_a_big_box_may_seem_to_move_by_a_twentieth_of_its_size(size_m, expected):
    assert slack_m(size_m, 0.02) == expected
