"""What one more look makes of a track."""

from __future__ import annotations

import pytest
from msgspec import structs

from nodes.perception_node.tracking.class_hierarchy import ANYTHING
from nodes.perception_node.tracking.tracks import Track
from schemas.entities import Size
from tests.perception_node.things import CLASSES, CONFIG, at, seen

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
    assert (track.looks, track.borne_out) == (5, 5)
    track = track.see(seen("Object", at(1.7, 1, 0.0), (0.6, 0.9, 0.85), whole=False), CONFIG)
    assert (track.looks, track.borne_out) == (6, 5)
