"""The cost of an observation for a thing: by place, size and class."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING
from semmap.nodes.perception_node.tracking.costs import (
    FORBIDDEN,
    Target,
    class_difference,
    cost_anywhere,
    cost_in_place,
    cost_nearby,
    cost_of_height,
    is_complete_despite_cut,
    size_difference,
)
from tests.perception_node.things import CLASSES, SIZES, at, seen

CUP = Target(at(1, 1), SIZES["Cup"], "Cup")
BOX = (0.4, 0.4, 0.4)
EXTENT = st.floats(0.05, 2.0)
SIZE = st.tuples(EXTENT, EXTENT, EXTENT)


def box(size_m=BOX, where=None, class_="Object", **how):
    return seen(class_, where or at(1, 1), size_m, **how)


def target(size_m=BOX, class_="Object", **how):
    return Target(at(1, 1), size_m, class_, **how)


def test_what_is_seen_as_it_was_costs_nothing():
    assert cost_in_place(CUP, seen("Cup", at(1, 1)), CLASSES) == 0.0
    assert cost_anywhere(CUP, seen("Cup", at(1, 1)), CLASSES) == pytest.approx(0.0)
    assert size_difference(CUP, seen("Cup", at(1, 1))) == 0.0


@given(SIZE)
def test_a_quarter_turn_is_no_difference_in_size(size_m):
    x, y, z = size_m
    assert size_difference(target(size_m), box((y, x, z))) == pytest.approx(0.0)


@given(SIZE, SIZE)
def test_size_differs_as_much_one_way_as_the_other(one, other):
    assert size_difference(target(one), box(other)) == pytest.approx(size_difference(target(other), box(one)))


def test_size_differs_by_the_mean_logarithm_or_half_of_the_worst():
    def log(now, before):
        return math.log((now + 0.01) / (before + 0.01))

    all_larger = box((0.6, 0.6, 0.6))
    assert size_difference(target(), all_larger) == pytest.approx(log(0.6, 0.4))
    one_larger = box((0.4, 0.4, 0.9))
    assert size_difference(target(), one_larger) == pytest.approx(log(0.9, 0.4) / 2.0)
    assert size_difference(target(), box((0.4, 0.4, 0.2))) == pytest.approx(log(0.4, 0.2) / 2.0)
    assert size_difference(target(None), all_larger) == 0.0


def test_what_is_seen_in_part_may_be_smaller_and_what_was_may_turn_out_larger():
    small, large = (0.2, 0.2, 0.2), (0.6, 0.6, 0.6)
    whole = size_difference(target(), box(small))
    assert size_difference(target(), box(small, whole=False)) == pytest.approx(0.3 * whole)
    assert size_difference(target(), box(large, whole=False)) == size_difference(target(), box(large))
    assert size_difference(target(whole=False), box(large)) == pytest.approx(
        0.3 * size_difference(target(), box(large))
    )
    assert size_difference(target(whole=False), box(small)) == whole


@pytest.mark.parametrize(
    ("class_", "of", "difference"),
    [
        ("Cup", "Cup", 0.0),
        ("Tableware", "Cup", 0.0),
        ("Cup", "Object", 0.0),
        ("Book", "Cup", 1.0),
    ],
)
def test_classes_differ_unless_one_is_above_the_other(class_, of, difference):
    assert class_difference(class_, seen(of, at(1, 1)), CLASSES) == difference


def test_what_else_it_may_be_makes_it_less_alien():
    maybe = structs.replace(seen("Bottle", at(1, 1)), candidates={"Bottle": 0.6, "Cup": 0.3})
    assert class_difference("Cup", maybe, CLASSES) == pytest.approx(0.7)
    assert class_difference("Tableware", maybe, CLASSES) == pytest.approx(0.7)
    sure = structs.replace(maybe, candidates={"Cup": 0.7, "Book": 0.5})
    assert class_difference("Object", sure, CLASSES) == 0.0


@pytest.mark.parametrize(("aside_m", "stays"), [(0.0, True), (0.24, True), (0.26, False)])
def test_in_its_place_is_what_hardly_stands_aside(aside_m, stays):
    """A thing is in its place within a quarter of both widths, and five centimetres."""
    cost = cost_in_place(target(), box(where=at(1 + aside_m, 1)), CLASSES)
    assert cost == (pytest.approx(aside_m / 0.25) if stays else FORBIDDEN)
    assert cost_in_place(target(), box(where=at(1, 1 - aside_m)), CLASSES) == cost


@pytest.mark.parametrize(("above_m", "stays"), [(0.24, True), (-0.24, True), (0.26, False), (-0.26, False)])
def test_in_its_place_is_what_hardly_stands_higher_or_lower(above_m, stays):
    cost = cost_in_place(target(), box(where=at(1, 1, 0.7 + above_m)), CLASSES)
    assert cost == (0.0 if stays else FORBIDDEN)


def test_middles_are_compared_not_bottoms():
    tall = box((0.4, 0.4, 0.5), where=at(1, 1, 0.7 - 0.05))
    assert cost_in_place(target(), tall, CLASSES) < 0.2


def test_in_its_place_a_thing_of_another_class_must_be_more_like_it():
    wider = box((0.5, 0.5, 0.5), class_="Book")
    assert 0.15 < size_difference(target(), wider) < 0.3
    assert cost_in_place(target(class_="Book"), wider, CLASSES) == pytest.approx(
        size_difference(target(), wider)
    )
    assert cost_in_place(target(class_="Cup"), wider, CLASSES) == FORBIDDEN
    assert cost_in_place(target(class_="Cup"), box(class_="Book"), CLASSES) == pytest.approx(1.0)
    assert cost_in_place(target(), box((0.6, 0.6, 0.6)), CLASSES) == FORBIDDEN


def test_the_front_of_a_thing_is_the_thing_in_its_place():
    shelf = Target(at(1, 1, 0.0), (0.4, 1.0, 1.8), "Object")
    front = seen("Object", at(1.19, 1, 0.0), (0.02, 1.0, 1.8))
    assert size_difference(shelf, front) > 0.3
    assert cost_in_place(shelf, front, CLASSES) < 1.0
    narrow = seen("Object", at(1.19, 1, 0.0), (0.02, 0.4, 1.8))
    assert cost_in_place(shelf, narrow, CLASSES) == FORBIDDEN


def test_anywhere_costs_a_tenth_of_the_way_and_how_unlike_it_is():
    assert cost_anywhere(target(), box(where=at(4, 5)), CLASSES) == pytest.approx(0.5)
    assert cost_anywhere(target(), box(where=at(1, 1, 1.7)), CLASSES) == pytest.approx(0.1)
    larger = box((0.5, 0.5, 0.5), where=at(4, 5, 0.65))
    assert cost_anywhere(target(class_="Cup"), structs.replace(larger, class_="Cup"), CLASSES) == (
        pytest.approx(0.5 + size_difference(target(), larger))
    )


def test_anywhere_else_only_its_own_kind_counts():
    assert cost_anywhere(target(class_="Cup"), box(class_="Book", where=at(4, 5)), CLASSES) == FORBIDDEN
    assert cost_anywhere(target(class_="Cup"), box(class_="Book"), CLASSES) == pytest.approx(1.0)
    larger = box((0.6, 0.6, 0.6), class_="Cup", where=at(4, 5))
    assert size_difference(target(), larger) > 0.35
    assert cost_anywhere(target(class_="Cup"), larger, CLASSES) == FORBIDDEN


def test_what_is_like_nothing_known_is_recognised_by_its_size_alone():
    same = box(class_=ANYTHING, where=at(4, 5))
    assert cost_anywhere(target(class_="Cup"), same, CLASSES) == pytest.approx(0.5 + 0.1)
    assert cost_anywhere(target(class_=ANYTHING), same, CLASSES) == pytest.approx(0.5)
    larger = box((0.5, 0.5, 0.5), class_=ANYTHING, where=at(4, 5))
    assert cost_anywhere(target(class_="Cup"), larger, CLASSES) == FORBIDDEN


def test_what_has_no_size_is_found_nowhere_unless_its_class_has_one():
    unknown = Target(at(1, 1), None, "Cup")
    assert cost_anywhere(unknown, seen("Cup", at(1, 1)), CLASSES) == FORBIDDEN
    assert unknown.box is None
    usual = unknown._replace(usual_m=SIZES["Cup"])
    assert usual.box.size_m == SIZES["Cup"]
    assert cost_anywhere(usual, seen("Cup", at(1, 1)), CLASSES) == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (box((0.4, 0.4, 0.1)), 0.0),
        (box((0.4, 0.4, 0.1), where=at(1.08, 1)), 0.2),
        (box((0.4, 0.4, 0.1), where=at(1, 0.92)), 0.2),
        (box((0.4, 0.4, 0.1), where=at(1.11, 1)), FORBIDDEN),
        (box((0.4, 0.5, 0.1)), FORBIDDEN),
        (box((0.45, 0.45, 0.1)), 0.0),
        (box((0.4, 0.4, 0.1), where=at(1, 1, 0.72)), FORBIDDEN),
    ],
)
def test_only_the_height_is_another_of_what_stands_on_the_same_spot_and_is_as_wide(found, expected):
    cost = cost_of_height(target(), found, CLASSES)
    assert cost == (expected if expected == FORBIDDEN else pytest.approx(expected))


def test_another_kind_and_what_has_no_size_are_not_compared_by_height():
    assert cost_of_height(target(class_="Book"), box(class_="Cup"), CLASSES) == FORBIDDEN
    assert cost_of_height(target(None), box(), CLASSES) == FORBIDDEN


USUAL = (0.4, 0.6, 0.8)


@pytest.mark.parametrize(
    ("before", "now", "whole", "was_whole", "expected"),
    [
        ((0.4, 1.2, 0.8), USUAL, False, True, True),
        ((0.6, 0.4, 1.6), (0.6, 0.4, 0.8), False, True, True),
        ((0.4, 1.2, 0.8), USUAL, True, True, False),
        ((0.4, 1.2, 0.8), USUAL, False, False, False),
        ((0.4, 0.9, 0.8), USUAL, False, True, False),
        ((0.4, 1.2, 0.8), (0.4, 0.6, 0.55), False, True, False),
        ((0.4, 1.2, 0.8), (0.4, 0.6, 1.15), False, True, False),
        ((0.4, 1.2, 0.8), (0.4, 0.75, 0.8), False, True, True),
    ],
)
def test_what_was_too_large_is_rather_what_measures_as_usual(before, now, whole, was_whole, expected):
    known = target(before, whole=was_whole, usual_m=USUAL)
    assert is_complete_despite_cut(box(now, whole=whole), known) is expected
    assert not is_complete_despite_cut(box(now, whole=whole), known._replace(usual_m=None))
    assert not is_complete_despite_cut(box(now, whole=whole), known._replace(size_m=None))


@pytest.mark.parametrize(("aside_m", "way"), [(0.19, 0.19 / 0.5), (0.39, 1.0 / 1.5)])
def test_a_front_costs_at_most_two_thirds_for_its_distance(aside_m, way):
    oven = Target(at(1, 1, 0.0), (0.8, 0.9, 1.8), "Object")
    front = seen("Object", at(1 + aside_m, 1, 0.0), (0.02, 0.9, 1.8))
    assert cost_in_place(oven, front, CLASSES) == pytest.approx(way + 0.15)


RED, BLUE = (0.8, 0.1, 0.1), (0.1, 0.1, 0.8)


@pytest.mark.parametrize(
    ("other", "color", "is_like"),
    [
        (seen("Cup", at(1.1, 1)), RED, True),
        (seen("Cup", at(1.1, 1)), None, True),
        (seen("Cup", at(1.1, 1)), BLUE, False),
        (seen("Cup", at(1.5, 1)), RED, False),
        (seen("Book", at(1.1, 1), SIZES["Cup"]), RED, False),
        (seen("Cup", at(1.1, 1), (0.3, 0.3, 0.3)), RED, False),
    ],
)
def test_a_new_thing_near_a_hidden_one_is_it_if_kind_size_and_colour_agree(other, color, is_like):
    hidden, other = CUP._replace(color_rgb=RED), structs.replace(other, color_rgb=color)
    assert cost_nearby(hidden, other, CLASSES, 0.3) == (pytest.approx(0.1) if is_like else FORBIDDEN)


@pytest.mark.parametrize(
    ("now", "alike", "matches"),
    [
        (seen("Cup", at(4, 4)), math.nan, True),
        (seen("Cup", at(4, 4)), 0.3, True),
        (seen("Cup", at(4, 4)), 0.2, False),
        (seen("Cup", at(1, 1)), 0.2, True),
        (seen("Bottle", at(4, 4), SIZES["Cup"]), 0.4, False),
        (seen("Bottle", at(4, 4), SIZES["Cup"]), 0.6, True),
        (seen(ANYTHING, at(4, 4), SIZES["Cup"], whole=False), 0.6, True),
        (seen("Cup", at(4, 4), BOX), 0.9, False),
    ],
)
def test_images_tell_things_apart_and_replace_class_and_colour_elsewhere(now, alike, matches):
    assert (cost_anywhere(CUP, now, CLASSES, alike) < FORBIDDEN) == matches


def test_the_more_alike_image_costs_less():
    now = seen("Cup", at(4, 4))
    assert cost_anywhere(CUP, now, CLASSES, 0.9) < cost_anywhere(CUP, now, CLASSES, 0.4)
