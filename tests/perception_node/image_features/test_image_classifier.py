from dataclasses import fields, replace

import numpy as np
import pytest

from semmap.nodes.perception_node.image_features.efficientnet import CLASSES, FEATURES
from semmap.nodes.perception_node.image_features.image_classifier import load, save, shipped
from semmap.nodes.perception_node.image_features.network import Outputs
from semmap.nodes.perception_node.recognition.recognition_model import UNKNOWN
from semmap.nodes.perception_node.recognition.recognition_model import shipped as shipped_model
from semmap.schemas.errors import BadFile


def outputs(look, of_imagenet=None):
    """The outputs of the network for an image that has exactly one look of the shipped classifier."""
    column = shipped().weights[:, look]
    scores = np.zeros((1, CLASSES), np.float32)
    if of_imagenet is not None:
        scores[0, of_imagenet] = 20.0
    halves = column[:FEATURES], column[FEATURES:]
    return [Outputs(np.asarray(half, np.float32)[None], scores) for half in halves]


def test_each_look_fits_its_own_classes_best():
    found = shipped()
    for look in range(len(found.biases)):
        (fits,) = found(*outputs(look))
        assert found.looks[look, fits.argmax()] == found.looks[look].max()


def test_a_look_that_is_more_frequent_fits_better():
    looks = np.eye(len(shipped().biases))
    (apart,) = replace(shipped(), biases=1e4 * looks[0])(*outputs(1))
    assert apart == pytest.approx(shipped()(*outputs(0))[0], abs=1e-3)


def test_classes_of_imagenet_count():
    banana, shark = 954, 2
    apart, told, outdoors = (shipped()(*outputs(0, number))[0] for number in (None, banana, shark))
    assert np.argmax(told - apart) == shipped().leaves.index("Banana")
    np.testing.assert_allclose(outdoors, apart)  # only things of a household are asked for


def test_its_classes_are_leaves_of_recognition():
    assert set(shipped().leaves) <= set(shipped_model().classes)
    assert UNKNOWN in shipped().leaves


def test_a_saved_classifier_is_read_as_it_was(tmp_path):
    save(shipped(), tmp_path / "images.npz")
    again = load(tmp_path / "images.npz")
    for field in fields(again):
        np.testing.assert_array_equal(getattr(again, field.name), getattr(shipped(), field.name))


def test_an_invalid_file_is_rejected(tmp_path):
    (tmp_path / "images.npz").write_bytes(b"nothing")
    with pytest.raises(BadFile, match="not a valid image classifier"):
        load(tmp_path / "images.npz")
