"""Selection of the thing to be learned in an image."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.exemplar_views import (
    exemplar_view_of,
    find_shown_thing,
    view_of_shown,
)
from semmap.nodes.perception_node.image_features.efficientnet import CLASSES, FEATURES
from semmap.nodes.perception_node.image_features.image_classifier import shipped as shipped_classifier
from semmap.nodes.perception_node.image_features.image_evidence import ImageEvidence
from semmap.nodes.perception_node.image_features.network import Outputs
from semmap.nodes.perception_node.pipeline import shipped
from tests.perception_node.scenes import KINDS, shot


def around(kind):
    """Return the box around a thing in the first camera's image, and its pixels."""
    number = [body.name for body in shot().bodies].index(kind) + 1
    rows, columns = np.nonzero(shot().owners[0] == number)
    return (int(columns.min()), int(rows.min()), int(columns.max()) + 1, int(rows.max()) + 1), len(rows)


@pytest.fixture(scope="module")
def shown():
    return find_shown_thing(shot().clouds[0], shipped())


def test_the_largest_compact_thing_is_shown(shown):
    largest = max(KINDS, key=lambda kind: around(kind)[1])
    thing, own = shown
    assert np.count_nonzero(own) == pytest.approx(thing.count, rel=0.02)
    assert thing.count == pytest.approx(around(largest)[1], rel=0.2)


@pytest.mark.parametrize("kind", ["apple", "bottle"])
def test_what_is_in_a_box_is_shown(kind):
    box, pixels = around(kind)
    thing, own = find_shown_thing(shot().clouds[0], shipped(), box)
    assert np.count_nonzero(own) == pytest.approx(thing.count, rel=0.02)
    assert thing.count == pytest.approx(pixels, rel=0.2)
    (body,) = [body for body in shot().bodies if body.name == kind]
    assert exemplar_view_of(thing, shipped()).size_m[2] == pytest.approx(body.size_m[2], abs=0.02)


def test_where_there_is_nothing_nothing_is_shown():
    assert find_shown_thing(shot().clouds[0], shipped(), (0, 0, 8, 8)) is None


def test_only_photographs_are_stored_with_their_images(shown):
    def network(images):
        return Outputs(np.ones((len(images), FEATURES)), np.ones((len(images), CLASSES)))

    learnt = replace(shipped(), images=ImageEvidence(network, shipped_classifier()))
    rendering = shot().clouds[0]
    noise = np.random.default_rng(0).integers(0, 4, rendering.colors.shape, np.uint8)
    photograph = replace(rendering, colors=rendering.colors // 2 + noise)
    images = [view_of_shown(shown, cloud, learnt).image for cloud in (rendering, photograph)]
    assert [image.any() for image in images] == [False, True]
