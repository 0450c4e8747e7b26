"""Fits of tracked things, and the resulting updates of the map."""

from __future__ import annotations

import math

import pytest
from msgspec import structs

from semmap.nodes.perception_node.fitting.fit import Fit
from semmap.nodes.perception_node.fitting.fit_tracks import apply_fit, request_fit, with_known_fit
from semmap.nodes.perception_node.fitting.worker import Request
from semmap.nodes.perception_node.pipeline import FrameResult
from semmap.schemas.commands import Update
from semmap.schemas.entities import orientation_from_yaw
from semmap.schemas.perception import Observations
from tests.perception_node.things import CLASSES, CONFIG, Table, at, entity, seen

CUP = seen("Cup", at(0, 0, yaw=0.2))


def table(thing=CUP, **more):
    here = Table([thing], config=CONFIG).told(
        [entity("cup1", "Cup", at(0, 0, yaw=0.2), source="perception", **more)]
    )
    here.observe(2)
    return here


def observe_views(here):
    told = tuple(with_known_fit(o, e, here.tracks) for o, e in zip(here.things, here.taken_for, strict=True))
    return Observations(stamp_ns=0, views=(), observations=told)


def asked(here):
    told = observe_views(here)
    return request_fit(told, (), FrameResult(told, ()), here.tracks, CONFIG, CLASSES)


def fit(yaw, *, score=0.8, clear=True, fold=1):
    pose = at(0, 0, yaw=yaw)
    return Fit("Cup", pose, (0.08, 0.08, 0.1), score, clear, fold)


def answered(here, found):
    request = asked(here)
    assert request is not None
    here.tracks = apply_fit(here.tracks, request, found, CONFIG)


def told_of(here, frames=12):
    return [command for command in here.observe(frames) if isinstance(command, Update)]


def test_what_rests_is_fitted_once_and_again_when_it_has_moved():
    here = table()
    request = asked(here)
    assert (request.name, request.number) == ("cup1", 1)
    answered(here, fit(1.5))
    here.observe(3)
    assert asked(here) is None
    here.things = [seen("Cup", at(0.4, 0.1))]
    here.look()
    assert asked(here) is None  # it does not rest yet
    here.observe(2)
    assert asked(here) is not None


def test_what_could_not_be_fitted_is_not_tried_again_where_it_is():
    here = table()
    answered(here, None)
    here.look()
    assert asked(here) is None


@pytest.mark.parametrize("thing", [seen("Cup", at(0, 0), whole=False), seen("Object", at(0, 0))])
def test_what_is_seen_in_part_or_has_no_name_is_not_fitted(thing):
    assert asked(table(thing)) is None


def test_things_that_cannot_be_fitted_do_not_keep_the_next_one_from_it():
    things = [seen("Cup", at(0, 0), whole=False), seen("Object", at(1, 0)), seen("Cup", at(2, 0))]
    names = [("cup1", "Cup"), ("object1", "Object"), ("cup2", "Cup")]
    here = Table(things, config=CONFIG).told(
        [entity(name, kind, thing.pose) for (name, kind), thing in zip(names, things, strict=True)]
    )
    here.observe(2)
    request = asked(here)
    assert (request.name, request.number) == ("cup2", 3)
    assert request.seen.pose == things[2].pose


def test_a_frame_whose_clouds_are_not_its_views_is_not_fitted():
    here = table()
    told = observe_views(here)
    assert request_fit(told, (object(),), FrameResult(told, ()), here.tracks, CONFIG, CLASSES) is None


def test_a_model_across_a_long_box_gives_no_orientation():
    turned = at(0, 0, yaw=0.6)
    book = seen("Book", turned)
    here = Table([book], config=CONFIG).told([entity("book1", "Book", turned, source="perception")])
    here.observe(2)
    for yaw, kept in ((0.7, True), (0.6 + math.pi / 2, False), (0.6 + math.pi, True)):
        found = Fit("Book", at(0, 0, yaw=yaw), book.size_m, 0.8, True, 1)
        tracks = apply_fit(here.tracks, asked(here), found, CONFIG)
        assert (tracks.known["book1"].fit.orientation_wxyz is not None) == kept
        assert tracks.known["book1"].fit.score == 0.8


def test_the_size_follows_a_fitted_orientation_across_the_box():
    here = table(seen("Cup", at(0, 0), (0.1, 0.08, 0.1)))
    answered(here, fit(math.pi / 2))
    (told,) = observe_views(here).observations
    assert told.size_m == pytest.approx((0.08, 0.1, 0.1))


def test_an_observation_without_a_fit_gets_only_its_entity():
    told = with_known_fit(CUP, "cup1", table().tracks)
    assert told == structs.replace(CUP, entity="cup1")
    assert with_known_fit(CUP, "", table().tracks) == CUP


def test_the_map_and_all_others_are_told_the_orientation():
    here = table()
    answered(here, fit(1.5))
    (update,) = told_of(here)
    assert update.orientation == pytest.approx(orientation_from_yaw(1.5), abs=1e-5)
    assert here.entities["cup1"].pose.yaw_rad == pytest.approx(1.5, abs=1e-5)
    (told,) = observe_views(here).observations
    assert (told.entity, told.fit) == ("cup1", 0.8)
    assert told.pose.yaw_rad == pytest.approx(1.5)


@pytest.mark.parametrize(
    "found",
    [fit(0.2 + math.pi, fold=2), fit(1.5, fold=0), fit(1.5, clear=False), fit(0.25)],
    ids=["the same after half a turn", "round", "not clear", "as the box"],
)
def test_what_says_nothing_new_is_not_told(found):
    here = table()
    answered(here, found)
    assert told_of(here) == []


def test_what_somebody_else_said_of_the_yaw_stays():
    here = Table([CUP], config=CONFIG).told([entity("cup1", "Cup", at(0, 0, yaw=0.2))])
    here.observe(2)
    answered(here, fit(1.5))
    assert told_of(here) == []


def test_a_name_that_the_form_does_not_bear_out_is_taken_back_for_good():
    here = table()
    answered(here, fit(1.5, score=0.05))
    assert [update.class_ for update in told_of(here)] == ["Object"]
    here.observe(10)
    assert here.entities["cup1"].class_ == "Object"
    assert asked(here) is None


def test_a_name_that_was_shown_stays():
    here = table(structs.replace(CUP, shown=True))
    answered(here, fit(1.5, score=0.05))
    assert told_of(here) == []
    assert here.entities["cup1"].class_ == "Cup"


def test_the_answer_for_what_has_moved_meanwhile_is_not_taken():
    here = table()
    request = asked(here)
    late = Request(request.name, at(1, 1), request.seen, 1, (), request.found)
    assert apply_fit(here.tracks, late, fit(1.5), CONFIG) is here.tracks
    gone = Request("cup9", request.box, request.seen, 1, (), request.found)
    assert apply_fit(here.tracks, gone, fit(1.5), CONFIG) is here.tracks
