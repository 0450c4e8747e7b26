from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.image_features import image_evidence
from semmap.nodes.perception_node.image_features.efficientnet import CLASSES, FEATURES
from semmap.nodes.perception_node.image_features.image_classifier import shipped
from semmap.nodes.perception_node.image_features.image_evidence import (
    ImageEvidence,
    ImageMemory,
    ThingImages,
    with_images,
)
from semmap.nodes.perception_node.image_features.network import Outputs
from semmap.nodes.perception_node.pipeline import observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import shipped as shipped_model
from tests.perception_node.scenes import shot

RNG = np.random.default_rng(0)
SCENE = RNG.integers(0, 255, (60, 80, 3), np.uint8)
LABELS = np.zeros((60, 80), np.int32)
LABELS[5:25, 5:25] = 1
LABELS[30:50, 40:75] = 2


class Banana:
    """A network that takes every image for a banana, and counts them."""

    def __init__(self):
        self.images = 0

    def __call__(self, images):
        self.images += len(images)
        scores = np.zeros((len(images), CLASSES), np.float32)
        scores[:, 954] = 30.0
        return Outputs(np.ones((len(images), FEATURES), np.float32), scores)


def fits(evidence, colours=SCENE, things=(0, 1)):
    return ThingImages(evidence, [(colours, LABELS)], (1, 2, 3)).fits(things, shipped_model())


def test_what_images_say_is_told_by_leaf():
    found = fits(ImageEvidence(Banana(), shipped()))
    assert [shipped_model().classes[leaf] for leaf in found.argmax(axis=1)] == ["Banana", "Banana"]
    bed = shipped_model().classes.index("Bedstand")  # an image knows nothing of it
    assert (found[:, bed] == shipped().least).all()


def test_a_thing_without_an_image_has_no_evidence():
    network = Banana()
    assert np.isnan(fits(ImageEvidence(network, shipped()), things=(2,))).all()
    assert network.images == 0


def test_a_thing_that_rests_is_looked_up_and_one_that_changes_is_not():
    network = Banana()
    evidence = ImageEvidence(network, shipped(), ImageMemory())
    first = fits(evidence)
    assert network.images == 4
    noisy = np.clip(SCENE + RNG.normal(0, 5, SCENE.shape), 0, 255).astype(np.uint8)
    np.testing.assert_array_equal(fits(evidence, noisy), first)
    assert network.images == 4
    changed = SCENE.copy()
    changed[5:25, 5:25] = 255 - changed[5:25, 5:25] // 4
    fits(evidence, changed)
    assert network.images == 6


def test_features_come_from_the_same_run_as_the_classes_and_are_compared():
    network = Banana()
    images = ThingImages(ImageEvidence(network, shipped()), [(SCENE, LABELS)], (1, 2, 3)).select((2, 0))
    images.fits((0, 1), shipped_model())
    features = images.features((0, 1))
    assert network.images == 2
    assert (features.any(axis=1) == [False, True]).all()
    (nothing, same), (none, other) = images.similarities(np.stack([features[1], -features[1]]), (0, 1))
    assert np.isnan([nothing, none]).all()
    assert (same, other < 0.0) == (pytest.approx(1.0), True)


def test_photographs_are_named_with_images_and_renderings_without():
    learnt = shipped_model()
    unsure = replace(learnt, weights=0.02 * learnt.weights, familiar=_never(learnt.familiar))
    seen = replace(unsure, images=ImageEvidence(Banana(), shipped()))
    rendered = shot().clouds
    photographed = [replace(cloud, colors=_with_noise(cloud.colors)) for cloud in rendered]
    plain, named = (
        observe_clouds(clouds, seen).observations.observations for clouds in (rendered, photographed)
    )
    assert not any("Banana" in o.candidates for o in plain)
    assert any(max(o.candidates, key=o.candidates.get) == "Banana" for o in named)


def _with_noise(colours):
    return np.clip(colours + RNG.normal(0, 2, colours.shape), 0, 255).astype(np.uint8)


def _never(familiar):
    """Return a recogniser that takes nothing for one of our models."""
    biases = familiar.biases[-1].copy()
    biases[-1] += 1000.0
    return replace(familiar, biases=(*familiar.biases[:-1], biases))


def test_without_its_packages_perception_works_as_it_is(monkeypatch):
    monkeypatch.setattr(image_evidence, "available", lambda: False)
    assert with_images(shipped_model()) is shipped_model()
