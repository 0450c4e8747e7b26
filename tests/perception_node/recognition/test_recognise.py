from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.exemplars import Exemplar, with_exemplars
from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.recognise import reclassify_trimmed, recognise, trim
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, shipped
from semmap.nodes.perception_node.recognition.similarity import WIDTH
from semmap.nodes.perception_node.recognition.similarity import shipped as similarity
from semmap.nodes.perception_node.recognition.vote import leaf_probabilities
from semmap.nodes.perception_node.views.boxes import in_frame
from semmap.nodes.perception_node.views.merged_thing import thing_of
from semmap.nodes.perception_node.views.supports import Support
from tests.perception_node.recognition.test_features import ALONE, WITH_A_SCRAP


def test_trimming_takes_a_scrap_away():
    whole, bare = WITH_A_SCRAP.box.size_m, ALONE.box.size_m
    assert whole.prod() > 1.4 * bare.prod()
    trimmed = trim(WITH_A_SCRAP).box.size_m
    assert trimmed.prod() < 0.75 * whole.prod()
    assert np.abs(np.log(trimmed / bare)).max() < 0.2


def test_what_is_recognised_is_not_looked_at_again():
    learnt = shipped()
    chances = np.full((1, len(learnt.classes)), 0.0)
    chances[0, learnt.classes.index("Book")] = 1.0
    assert reclassify_trimmed([WITH_A_SCRAP], chances, learnt) is chances


def test_a_thing_without_scraps_stays_what_it_was():
    learnt = shipped()
    chances = leaf_probabilities(learnt, features_of([ALONE]))
    assert (reclassify_trimmed([ALONE], chances, learnt) == chances).all()


def test_nothing_is_nothing():
    assert reclassify_trimmed([], np.empty((0, len(shipped().classes))), shipped()).shape[0] == 0


class NoImages:
    """The images of things that no view shows."""

    def fits(self, things, learnt):
        return np.full((len(things), len(learnt.classes)), np.nan)

    def similarities(self, kept, things):
        return np.full((len(kept), len(things)), np.nan)


def test_images_change_nothing_where_nothing_is_shown_whether_or_not_there_are_exemplars():
    shown = Exemplar(1, "Vase", ("Object",), np.zeros((1, WIDTH)), (0.1, 0.1, 0.2), "shown", 0)
    for learnt in (shipped(), with_exemplars(shipped(), [shown], similarity())):
        chances = leaf_probabilities(learnt, features_of([ALONE]))
        without = recognise([ALONE], chances, learnt)
        assert recognise([ALONE], chances, learnt, images=NoImages()) == without


def test_what_is_reported_is_as_likely_as_among_things_that_are_no_clutter():
    learnt = shipped()
    chances = np.zeros((1, len(learnt.classes)))
    for leaf, chance in {"Book": 0.4, UNKNOWN: 0.1, CLUTTER: 0.5}.items():
        chances[0, learnt.classes.index(leaf)] = chance
    (book,) = recognise([ALONE], chances, learnt)
    assert (book.class_, book.probability) == ("Book", pytest.approx(0.8))
    assert book.candidates == pytest.approx({"Book": 0.8, UNKNOWN: 0.2})
    assert (book.points, book.whole, book.shown) == (ALONE.count, True, False)


@pytest.mark.parametrize(
    ("cut", "lifted_m", "clutter", "class_"),
    [
        (True, 0.0, 0.69, "Book"),
        (True, 0.0, 0.71, None),
        (True, 0.1, 0.34, "Book"),
        (True, 0.1, 0.36, None),
        (False, 0.1, 0.69, "Book"),
        (False, 0.1, 0.71, None),
        (False, 0.0, 0.71, UNKNOWN),
    ],
)
def test_clutter_is_not_reported_unless_it_stands_free(cut, lifted_m, clutter, class_):
    learnt = shipped()
    segments = tuple(replace(segment, cut=cut) for segment in ALONE.segments)
    chances = np.zeros((1, len(learnt.classes)))
    chances[0, [learnt.classes.index("Book"), learnt.classes.index(CLUTTER)]] = 1.0 - clutter, clutter
    (found,) = recognise([replace(ALONE, segments=segments, lifted_m=lifted_m)], chances, learnt)
    if class_ is None:
        assert found.reason.startswith(f"classified as clutter ({clutter:.2f})")
    else:
        assert found.class_ == class_


@pytest.mark.parametrize("yaw_deg", [-80.0, -20.0, 10.0, 40.0, 70.0])
def test_the_long_side_is_along_x_and_the_yaw_within_a_quarter_turn(yaw_deg):
    learnt, yaw = shipped(), np.radians(yaw_deg)
    segment = ALONE.segments[0]
    turned = replace(segment, points=in_frame(segment.points, -yaw).astype(np.float32))
    chances = np.zeros((1, len(learnt.classes)))
    chances[0, learnt.classes.index("Book")] = 1.0
    (found,) = recognise([thing_of([turned], [Support(0.0)])], chances, learnt)
    assert found.pose.yaw_rad == pytest.approx(yaw, abs=0.03)
    assert found.size_m[0] > found.size_m[1]
    assert found.pose.position_m[:2] == pytest.approx(
        (0.1 * np.cos(yaw) - 0.05 * np.sin(yaw), 0.1 * np.sin(yaw) + 0.05 * np.cos(yaw)), abs=0.03
    )
