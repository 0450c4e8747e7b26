"""An oven between others, whose depth is not visible from the front."""

from __future__ import annotations

import pytest

from semmap.nodes.perception_node.tracking.fronts import is_front
from semmap.nodes.perception_node.tracking.overlap import OrientedBox
from semmap.schemas.commands import Update
from tests.perception_node.things import CONFIG, Table, at, seen

OVEN = OrientedBox(at(1.0, 1.0, 0.0), (0.6, 0.6, 0.9))
FRONT = OrientedBox(at(1.0, 1.2, 0.0), (0.58, 0.2, 0.92))


def test_the_front_of_a_thing_is_as_wide_and_high_as_the_thing():
    assert is_front(FRONT, OVEN)
    assert not is_front(OVEN, FRONT)


def test_the_front_may_be_the_long_or_the_short_side():
    board = OrientedBox(at(1.0, 1.0, 0.0), (0.8, 0.5, 0.9))
    assert is_front(OrientedBox(at(1.0, 1.15, 0.0), (0.78, 0.2, 0.9)), board)
    deep = OrientedBox(at(1.0, 1.0, 0.0), (0.5, 0.6, 0.9))
    assert is_front(OrientedBox(at(1.0, 1.15, 0.0), (0.42, 0.2, 0.9)), deep)
    deeper = OrientedBox(at(1.0, 1.0, 0.0), (0.5, 0.7, 0.9))
    assert not is_front(OrientedBox(at(1.0, 1.15, 0.0), (0.48, 0.2, 0.9)), deeper)


@pytest.mark.parametrize(
    "piece",
    [
        pytest.param(OrientedBox(at(1.0, 1.2, 0.0), (0.3, 0.2, 0.9)), id="half as wide"),
        pytest.param(OrientedBox(at(1.0, 1.2, 0.0), (0.58, 0.2, 0.5)), id="half as high"),
        pytest.param(OrientedBox(at(1.0, 1.5, 0.0), (0.58, 0.2, 0.9)), id="before it"),
        pytest.param(OrientedBox(at(1.0, 1.0, 0.0), (0.58, 0.5, 0.9)), id="nearly as deep"),
    ],
)
def test_other_pieces_are_no_fronts(piece):
    assert not is_front(piece, OVEN)


def test_two_things_side_by_side_are_not_one_of_which_a_front_was_seen():
    chair = OrientedBox(at(1.0, 1.0, 0.0), (0.45, 0.45, 0.9))
    assert not is_front(chair, OrientedBox(at(1.22, 1.0, 0.0), (0.9, 0.45, 0.9)))
    table = OrientedBox(at(1.0, 1.0, 0.0), (1.15, 0.8, 0.8))
    assert not is_front(table, OrientedBox(at(1.0, 1.2, 0.0), (1.25, 1.2, 0.85)))
    book = OrientedBox(at(1.0, 1.2), (0.2, 0.03, 0.25))
    assert not is_front(book, OrientedBox(at(1.0, 1.15), (0.2, 0.14, 0.25)))


def test_when_all_of_it_is_seen_the_map_is_put_right_and_the_front_changes_nothing_any_more():
    table = Table([seen("Object", *FRONT)], config=CONFIG.for_moving_camera)
    table.observe(5)
    table.things = [seen("Object", *OVEN, whole=False)]
    (update,) = table.observe(3)
    assert isinstance(update, Update)
    assert update.at == pytest.approx((1.0, 1.0, 0.0), abs=0.01)
    assert update.size == pytest.approx(OVEN.size_m)
    table.things = [seen("Object", *FRONT)]
    assert table.observe(20) == []


def piece(width=0.6, depth=0.2, height=0.9, x=1.0, y=1.0):
    return OrientedBox(at(x, y, 0.0), (width, depth, height))


@pytest.mark.parametrize(
    ("front", "is_one"),
    [
        (piece(depth=0.4), True),
        (piece(depth=0.43), False),  # a little less than 1.4 times as deep
        (piece(width=0.47), True),
        (piece(width=0.46), False),  # more than a quarter narrower, as a logarithm
        (piece(width=0.77), True),
        (piece(width=0.78), False),
        (piece(height=0.71), True),
        (piece(height=0.70), False),
        (piece(height=1.15), True),
        (piece(height=1.16), False),
        (piece(y=1.2), True),
        (piece(y=1.28), True),
        (piece(y=1.29), False),  # less than two thirds of it in the thing
    ],
)
def test_the_limits_of_a_front(front, is_one):
    assert is_front(front, OVEN) == is_one


@pytest.mark.parametrize(
    ("front", "thing", "is_one"),
    [
        (piece(0.4, 0.29, 0.4), piece(0.51, 0.51, 0.4), True),
        (piece(0.4, 0.31, 0.4), piece(0.51, 0.51, 0.4), False),  # nearly as deep as wide
        (piece(0.31, 0.1, 0.4), piece(0.31, 0.3, 0.4), True),
        (piece(0.29, 0.1, 0.4), piece(0.29, 0.28, 0.4), False),  # its sides would have been seen
        (piece(0.6, 0.1, 0.61), piece(0.6, 0.5, 0.61), True),
        (piece(0.6, 0.1, 0.59), piece(0.6, 0.5, 0.59), False),  # its top would have been seen
        (piece(0.5, 0.2, 0.9), piece(0.6, 0.74, 0.9), True),
        (piece(0.5, 0.2, 0.9), piece(0.6, 0.76, 0.9), False),  # deeper than a thing with a front
    ],
)
def test_which_things_have_a_front(front, thing, is_one):
    assert is_front(front, thing) == is_one
