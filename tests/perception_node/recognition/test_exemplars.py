"""Exemplars combined with the votes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.image_features.efficientnet import FEATURES
from semmap.nodes.perception_node.pipeline import parts_in, shipped
from semmap.nodes.perception_node.recognition.exemplars import Exemplar, with_exemplars
from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.recognise import recognise
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN
from semmap.nodes.perception_node.recognition.similarity import WIDTH
from semmap.nodes.perception_node.recognition.vote import leaf_probabilities
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from tests.perception_node.scenes import shot

MUG = Exemplar(3, "Mug_of_mine", ("Tableware", "Object"), np.zeros((2, WIDTH)), (0.1, 0.08, 0.09), "", 0)


def likely(*chances):
    """A similarity that says this of each thing, by the last of the kept views."""

    def like(kept, seen):
        return np.concatenate([np.zeros((len(kept) - 1, len(seen))), [chances]])

    return like


@pytest.fixture(scope="module")
def things():
    found = parts_in([segment_cloud(shot().clouds[0])]).things
    return [thing for thing in found if not thing.carrier][:3]


def test_without_lessons_nothing_is_otherwise():
    assert with_exemplars(shipped(), [], likely()) is shipped()


def test_what_is_alike_is_called_so_and_the_others_are_as_before(things):
    features = features_of(things)
    before = leaf_probabilities(shipped(), features)
    knowing = with_exemplars(shipped(), [MUG], likely(0.0, 0.9, 0.0))
    chances = leaf_probabilities(knowing, features)
    assert chances.sum(axis=1) == pytest.approx(1.0)
    assert (chances[[0, 2], :-1] == before[[0, 2]]).all()
    assert chances[:, -1].tolist() == pytest.approx([0.0, 0.9, 0.0])
    assert chances[1, :-1] == pytest.approx(0.1 * before[1])
    said = recognise(things, chances, knowing)[1]
    assert (said.class_, said.probability) == (MUG.class_, pytest.approx(0.9, abs=0.01))
    assert said.candidates[MUG.class_] == pytest.approx(said.probability)
    assert [o.shown for o in recognise(things, chances, knowing)] == [False, True, False]
    assert [o.class_ for o in recognise(things, chances, knowing)][::2] == [
        o.class_ for o in recognise(things, before, shipped())
    ][::2]


@pytest.mark.parametrize("leaf", [UNKNOWN, CLUTTER])
def test_what_would_be_nothing_known_or_no_thing_is_called_as_it_was_shown(things, leaf):
    knowing = with_exemplars(shipped(), [MUG], likely(0.9))
    votes = np.zeros((1, len(shipped().classes)))
    votes[0, shipped().classes.index(leaf)] = 1.0
    chances = knowing.exemplars.add_probabilities(features_of(things[:1]), votes)
    assert recognise(things[:1], chances, knowing)[0].class_ == MUG.class_


@pytest.mark.parametrize(
    ("shape", "image", "shown"),
    [
        (0.0, 0.8, True),
        (0.1, 0.5, True),
        (0.6, 0.0, False),
        (0.9, 0.0, False),
        (0.9, np.nan, True),
        (0.0, np.nan, False),
    ],
)
def test_images_decide_whether_it_is_an_exemplar_where_both_have_one(things, shape, image, shown):
    seen = replace(MUG, images=np.ones((2, FEATURES)))
    knowing = with_exemplars(shipped(), [seen], likely(shape)).exemplars
    votes = np.full((1, len(shipped().classes)), 1.0 / len(shipped().classes))
    before = knowing.add_probabilities(features_of(things[:1]), votes)
    after = knowing.with_images(before, lambda kept: np.array([[np.nan], [image]]))
    assert after.sum() == pytest.approx(1.0)
    assert (after[0, -1] > 0.4) == shown
    if np.isnan(image):
        assert after == pytest.approx(before)


def test_exemplars_without_images_are_compared_as_before(things):
    knowing = with_exemplars(shipped(), [MUG], likely(0.9)).exemplars
    before = knowing.add_probabilities(features_of(things[:1]), np.ones((1, 1)))
    assert knowing.with_images(before, lambda kept: pytest.fail("an image was asked for")) is before


def test_lessons_of_a_class_that_is_known_count_for_it(things):
    exemplars = [replace(MUG, number=n, class_="Cup", ancestors=shipped().ancestors["Cup"]) for n in (1, 2)]
    knowing = with_exemplars(shipped(), exemplars, likely(0.6))
    chances = leaf_probabilities(knowing, features_of(things[:1]))
    (said,) = recognise(things[:1], chances, knowing)
    assert said.class_ == "Cup"
    assert said.probability == pytest.approx(0.75, abs=0.05)
    assert said.candidates["Cup"] == pytest.approx(said.probability)
    assert said.shown


def test_what_the_votes_say_louder_than_a_lesson_is_not_known_as_shown(things):
    exemplar = replace(MUG, class_="Cup", ancestors=shipped().ancestors["Cup"])
    knowing = with_exemplars(shipped(), [exemplar], likely(0.3))
    votes = np.zeros((1, len(shipped().classes)))
    votes[0, shipped().classes.index("Cup")] = 1.0
    (said,) = recognise(
        things[:1], knowing.exemplars.add_probabilities(features_of(things[:1]), votes), knowing
    )
    assert (said.class_, said.shown) == ("Cup", False)


def test_the_size_of_what_was_shown_is_known():
    knowing = with_exemplars(shipped(), [MUG, replace(MUG, number=4, class_="Cup")], likely())
    assert knowing.usual_m[MUG.class_] == MUG.size_m
    assert knowing.usual_m["Cup"] == shipped().usual_m["Cup"]
    assert not any("#" in name for name in knowing.usual_m)


@pytest.mark.parametrize(
    ("alike", "chance"), [(1.0, 0.999), (0.9995, 0.999), (0.99, 0.99), (0.001, 0.001), (0.0009, 0.0)]
)
def test_nothing_is_certainly_an_exemplar_and_what_is_hardly_like_it_is_none(things, alike, chance):
    knowing = with_exemplars(shipped(), [MUG], likely(alike))
    votes = np.full((1, len(shipped().classes)), 1.0 / len(shipped().classes))
    chances = knowing.exemplars.add_probabilities(features_of(things[:1]), votes)
    assert chances[0, -1] == pytest.approx(chance)
    assert chances.sum() == pytest.approx(1.0)
