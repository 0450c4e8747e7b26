"""Similarity of two views."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.pipeline import parts_in
from semmap.nodes.perception_node.recognition import similarity
from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.similarity import COLOUR, GEOMETRY, SHAPE, WIDTH, views_of
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.nodes.training.recognition.samples import shared_pixels
from semmap.schemas.errors import BadFile
from tests.perception_node.scenes import KINDS, shot


@pytest.fixture(scope="module")
def seen():
    """Of each camera: the kind of each thing and its view; and all things."""
    found, things = [], []
    for camera, cloud in enumerate(shot().clouds):
        parts = parts_in([segment_cloud(cloud)])
        owner = shared_pixels(parts, shot(), [camera])[1:].argmax(axis=1)
        names = [shot().bodies[n - 1].name if n else "" for n in owner]
        views = views_of(features_of(parts.things))
        largest_last = sorted(range(len(names)), key=lambda n: parts.things[n].count)
        found.append({names[n]: views[n] for n in largest_last if names[n] in KINDS})
        things += parts.things
    return found, things


def test_the_columns_are_those_of_the_features(seen):
    things = seen[1]
    features = features_of(things)
    of_sorts = (GEOMETRY, SHAPE, COLOUR)
    assert [part.stop - part.start for part in of_sorts] == [f.shape[1] for f in features[: len(of_sorts)]]
    views = views_of(features)
    assert views.shape[1] == WIDTH
    assert views[:, similarity._HEIGHT] == pytest.approx([np.log(t.box.size_m[2]) for t in things])
    assert views[:, similarity._MEAN] == pytest.approx(np.array([t.colors.mean(axis=0) for t in things]))
    assert views[:, similarity._LEVELS].sum(axis=1) == pytest.approx(1.0)
    assert views[:, similarity._DISTANCES].sum(axis=1) == pytest.approx(1.0)
    grey = views[:, similarity._HUES].sum(axis=1) + views[:, similarity._GREYS].sum(axis=1)
    assert grey == pytest.approx(1.0)


def test_pairs_are_described_by_all_their_differences_and_by_sums_of_those_of_a_kind():
    kept, seen = np.zeros((1, WIDTH)), np.full((1, WIDTH), 2.0)
    (row,) = similarity.pair_features(kept, seen)
    each, signed, summed, rest = np.split(row, [WIDTH, WIDTH + 18, WIDTH + 23])
    assert (each == 2.0).all()
    assert (signed == 2.0).all()
    hues, greys, bands, levels, distances = summed / 2.0
    assert (hues, greys, bands, levels, distances) == (12, 4, 12, 8, 10)
    assert rest[:2] == pytest.approx(2.0 * np.sqrt(3.0))
    assert rest[2:6] == pytest.approx(0.0, abs=1e-6)  # of the mean colours without brightness
    assert rest[6:].tolist() == [0.0] * 5 + [2.0] * 5 + [2.0] * 3 + [0.0] * 2


def test_a_thing_is_like_itself_from_elsewhere_and_unlike_others(seen):
    (one, other), _ = seen
    kinds = sorted(one.keys() & other.keys())
    assert len(kinds) >= 3
    like = similarity.shipped()(np.array([one[k] for k in kinds]), np.array([other[k] for k in kinds]))
    assert (like.argmax(axis=1) == np.arange(len(kinds))).all()
    assert np.diag(like).min() > 0.5
    assert like[~np.eye(len(kinds), dtype=bool)].max() < 0.3


def test_it_is_read_as_it_was_written(tmp_path, seen):
    views = np.array(list(seen[0][0].values()))
    similarity.save(similarity.shipped(), tmp_path / "same.npz")
    again = similarity.load(tmp_path / "same.npz")
    assert (again(views, views) == similarity.shipped()(views, views)).all()


def test_a_file_of_something_else_is_told(tmp_path):
    (tmp_path / "none.npz").write_bytes(b"nothing")
    with pytest.raises(BadFile, match="is not a valid similarity model"):
        similarity.load(tmp_path / "none.npz")
