"""Things that were moved are recognised by their images."""

import numpy as np
import pytest

from semmap.nodes.perception_node.tracking.observed_images import NO_IMAGES, ObservedImages
from tests.perception_node.things import Table, at, seen

RED, BLUE, UNKNOWN = np.array([1.0, 0.0]), np.array([0.0, 1.0]), np.zeros(2)


def images(*features):
    def similarities(kept, of):
        return np.where(kept.any(axis=1)[:, None] & of.any(axis=1), kept @ of.T, np.nan)

    return ObservedImages(np.array(features), similarities)


@pytest.mark.parametrize(
    ("then", "right"), [(images(BLUE, RED), True), (images(RED, BLUE), False), (NO_IMAGES, False)]
)
def test_two_of_a_kind_that_change_places_keep_their_names_by_their_images(then, right):
    table = Table([seen("Cup", at(1.0, 1.0)), seen("Cup", at(3.0, 1.0))], images=images(RED, BLUE))
    table.observe(10)
    first, second = table.taken_for
    table.things, table.images = [], NO_IMAGES
    table.observe(3)
    table.things, table.images = [seen("Cup", at(1.2, 1.5)), seen("Cup", at(2.8, 1.5))], then
    table.observe(3)
    assert table.taken_for == ((second, first) if right else (first, second))


def test_the_last_known_image_is_remembered():
    table = Table([seen("Cup", at(1.0, 1.0))], images=images(RED))
    table.observe(10)
    table.images = images(UNKNOWN)
    table.observe(3)
    (track,) = table.tracks.known.values()
    assert (track.image == RED).all()
