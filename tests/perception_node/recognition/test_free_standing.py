from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.free_standing import are_free_standing
from semmap.nodes.perception_node.recognition.recognise import Clutter, recognise
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, shipped
from tests.perception_node.recognition.test_features import block

THING = block(((0.0, 0.0, 0.0), (0.2, 0.1, 0.1)))
FAR = block(((0.5, 0.0, 0.0), (0.6, 0.1, 0.1)))
BESIDE = block(((0.202, 0.0, 0.0), (0.302, 0.1, 0.1)))
WITH_ROOM = block(((0.23, 0.0, 0.0), (0.33, 0.1, 0.1)))
TORCH = block(((0.5, 0.0, 0.0), (0.527, 0.026, 0.15)))
SHELF = block(((0.202, 0.0, 0.0), (0.802, 0.1, 0.1)))
SCRAP = block(((0.202, 0.0, 0.0), (0.222, 0.02, 0.05)))


def standing(*things, fragments=()):
    return are_free_standing(
        things, np.array([all(thing is not f for f in fragments) for thing in things])
    ).tolist()


def with_points(thing, count):
    return replace(thing, segments=(replace(thing.segments[0], count=count),))


def test_things_apart_stand_alone_and_fragments_side_by_side_do_not():
    assert standing(THING, FAR, fragments=[THING, FAR]) == [True, True]
    assert standing(THING, BESIDE, FAR, fragments=[THING, BESIDE, FAR]) == [False, False, True]


def test_a_thing_beside_a_recognised_one_of_its_size_stands_alone():
    thing, beside = with_points(THING, 1000), with_points(BESIDE, 3000)
    assert standing(thing, beside, fragments=[thing])[0]
    assert not standing(thing, beside, fragments=[thing, beside])[0]
    assert not standing(thing, with_points(BESIDE, 5000), fragments=[thing])[0]
    assert not standing(thing, with_points(SHELF, 3000), fragments=[thing])[0]
    few = with_points(THING, 400)
    assert not standing(few, with_points(BESIDE, 400), fragments=[few])[0]


def test_things_with_some_room_between_them_stand_alone():
    assert standing(THING, WITH_ROOM, fragments=[THING, WITH_ROOM]) == [True, True]


def test_the_foot_of_a_thing_may_be_hidden():
    assert standing(replace(THING, lifted_m=0.05)) == [True]


def test_a_slender_thing_that_is_low_is_no_leg():
    assert standing(TORCH) == [True]


def test_a_scrap_beside_a_thing_does_not_count():
    assert standing(THING, SCRAP, fragments=[THING, SCRAP])[0]


@pytest.mark.parametrize(
    "thing",
    [
        replace(THING, lifted_m=0.1),
        replace(THING, segments=(replace(THING.segments[0], cut=True),)),
        replace(THING, segments=(replace(THING.segments[0], count=20),)),
        replace(THING, segments=(replace(THING.segments[0], carrier=True),)),
        block(((0.0, 0.0, 0.0), (0.9, 0.02, 0.2))),
        block(((0.0, 0.0, 0.0), (0.06, 0.08, 0.46))),
        replace(THING, box=replace(THING.box, high=THING.box.high - [0.0, 0.0, 0.098])),
    ],
    ids=["in mid-air", "cut by the picture's edge", "of few points", "a table top", "large", "a leg", "flat"],
)
def test_what_may_be_a_piece_does_not_stand_alone(thing):
    assert standing(thing) == [False]


def test_what_is_below_a_tables_edge_may_be_its_leg():
    top = block(((0.0, 0.0, 0.0), (1.0, 1.6, 0.75)))
    table = replace(top, segments=(replace(top.segments[0], carrier=True),))
    edges = ((0.02, 0.8), (0.9, 0.8), (0.5, 0.02), (0.5, 1.5))
    legs = [block(((x, y, 0.0), (x + 0.08, y + 0.08, 0.3))) for x, y in edges]
    bin_ = block(((0.3, 0.3, 0.0), (0.5, 0.5, 0.3)))
    assert standing(*legs, bin_) == [True] * 5
    assert standing(table, *legs, bin_) == [False] * 5 + [True]


def test_what_stands_alone_is_an_object_however_much_it_looks_like_clutter():
    learnt = shipped()
    chances = np.zeros((2, len(learnt.classes)))
    chances[:, learnt.classes.index(CLUTTER)] = 0.95
    chances[:, learnt.classes.index("Book")] = 0.05
    kept, dropped = recognise([THING, replace(FAR, lifted_m=0.2)], chances, learnt)
    assert kept is not None
    assert kept.class_ == UNKNOWN
    assert kept.probability >= 0.95
    assert dropped == Clutter(pytest.approx(0.95))


def test_a_piece_at_the_image_edge_above_its_support_is_not_an_object():
    learnt = shipped()
    cut = replace(THING, segments=(replace(THING.segments[0], cut=True),))
    chances = np.zeros((3, len(learnt.classes)))
    chances[:, learnt.classes.index(CLUTTER)] = 0.5
    chances[:, learnt.classes.index("Book")] = 0.5
    found = recognise([replace(cut, lifted_m=0.1), cut, replace(THING, lifted_m=0.1)], chances, learnt)
    assert [isinstance(one, Clutter) for one in found] == [True, False, False]
