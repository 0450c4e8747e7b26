from pathlib import Path

import numpy as np

from semmap.nodes.perception_node.image_features.efficientnet import CLASSES
from semmap.nodes.perception_node.recognition.recognition_model import UNKNOWN, shipped
from semmap.nodes.training.recognition.imagenet_classes import classes_by_number
from semmap.nodes.training.recognition.learn_images import Picture, learn, varied
from semmap.nodes.training.scenes.foreign_things import ForeignThing


def thing(name, class_, *, new=False):
    return ForeignThing(name, Path("none.obj"), (class_,), new, (0.1, 0.1, 0.1), "", learnable=True)


def test_looks_are_learnt_with_the_classes_that_have_them():
    rng = np.random.default_rng(0)
    things = [thing("cereals", "Box"), thing("drill", "Object", new=True), thing("unseen", "Cup")]
    looks = [look for look in ("cereals", "drill") for _ in range(12)]
    centres = {"cereals": [1.0, 0], "drill": [0, 1.0]}
    inputs = np.array([centres[look] for look in looks]) + rng.normal(0, 0.05, (len(looks), 2))
    found = learn(inputs, looks, things)
    scores = inputs @ found.weights + found.biases
    np.testing.assert_array_equal(scores.argmax(axis=1), np.repeat([0, 1], 12))
    shares = dict(zip(found.leaves, found.looks[0], strict=True))
    assert (shares["Box"], shares["Book"], shares["Cup"]) == (1.0, 0.3, 0.0)
    assert found.looks[1, found.leaves.index(UNKNOWN)] == 1.0


def test_a_varied_picture_still_shows_its_thing():
    rng = np.random.default_rng(0)
    own = np.zeros((200, 120), bool)
    own[30:170, 30:90] = True
    colours = rng.integers(0, 255, (*own.shape, 3), np.uint8)
    for _ in range(10):
        found = varied(Picture("cup", colours, own), rng)
        assert found.own.shape == found.colours.shape[:2]
        assert found.colours.dtype == np.uint8
        assert 30 <= np.ptp(np.flatnonzero(found.own.any(axis=1))) + 1 <= 160


def test_classes_of_imagenet_are_ours():
    found = classes_by_number()
    assert found[954] == ("Banana",)
    assert set(found) <= set(range(CLASSES))
    assert {class_ for classes in found.values() for class_ in classes} <= set(shipped().classes)
