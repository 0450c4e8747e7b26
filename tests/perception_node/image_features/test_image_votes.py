from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.image_features.image_votes import with_image_votes
from semmap.nodes.perception_node.recognition.exemplars import Exemplar, with_exemplars
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, shipped
from semmap.nodes.perception_node.recognition.similarity import WIDTH
from semmap.nodes.perception_node.recognition.similarity import shipped as similarity

MODEL = shipped()


def chances(of, model=MODEL):
    row = np.zeros((1, len(model.classes)))
    for leaf, probability in of.items():
        row[0, model.classes.index(leaf)] = probability
    return row


def fits(of, model=MODEL):
    """What an image says: these fits, and 0.01 for all else."""
    return lambda things: np.repeat(np.maximum(chances(of, model), 0.01), len(things), axis=0)


def share(found, leaf, model=MODEL):
    return found[0, model.classes.index(leaf)]


def test_images_decide_between_likely_classes():
    found = with_image_votes(chances({"Radio": 0.5, "Box": 0.4, CLUTTER: 0.1}), MODEL, fits({"Box": 0.9}))
    assert share(found, "Box") > 0.7
    assert found.sum() == pytest.approx(1.0)
    assert share(found, CLUTTER) == pytest.approx(0.1)


def test_images_name_what_shape_does_not_know():
    found = with_image_votes(chances({UNKNOWN: 0.95, "Box": 0.05}), MODEL, fits({"Box": 1.0}))
    assert share(found, "Box") > 0.5


def test_images_that_know_the_thing_as_of_no_class_leave_it_so():
    found = with_image_votes(chances({UNKNOWN: 0.6, "Pan": 0.4}), MODEL, fits({UNKNOWN: 1.0}))
    assert share(found, UNKNOWN) > 0.5


def test_a_thing_without_an_image_keeps_its_probabilities():
    before = np.repeat(chances({"Cup": 0.6, UNKNOWN: 0.4}), 2, axis=0)
    seen = np.concatenate([fits({"Bottle": 1.0})([0]), np.full((1, len(MODEL.classes)), np.nan)])
    first, second = with_image_votes(before, MODEL, lambda n: seen)
    assert first[MODEL.classes.index("Bottle")] > 0.5
    np.testing.assert_array_equal(second, before[1])


def test_images_of_clutter_are_not_processed():
    asked = []

    def see(things):
        asked.extend(things)
        return np.full((len(things), len(MODEL.classes)), np.nan)

    rows = [{CLUTTER: 0.9, "Cup": 0.1}, {"Cup": 0.5, UNKNOWN: 0.5}]
    with_image_votes(np.concatenate([chances(row) for row in rows]), MODEL, see)
    assert asked == [1]


def test_exemplars_keep_their_probability():
    shown = Exemplar(1, "Vase", ("Object",), np.zeros((1, WIDTH)), (0.1, 0.1, 0.2), "shown", 0)
    model = with_exemplars(MODEL, [shown], similarity())
    before = chances({shown.leaf: 0.7, "Cup": 0.2, UNKNOWN: 0.1}, model)
    found = with_image_votes(before, model, fits({"Bottle": 1.0}, model))
    assert share(found, shown.leaf, model) == pytest.approx(0.7)
    assert found.sum() == pytest.approx(1.0)


def test_a_model_without_things_is_no_error():
    assert with_image_votes(np.zeros((0, len(MODEL.classes))), replace(MODEL), fits({})).shape[0] == 0
