"""The score of segmentation."""

from __future__ import annotations

import importlib.util

import numpy as np
import pytest

from benchmarks.perception.recorded import Counts, group_of, score
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.training.segmentation.recorded_scenes import Scene, mirrored
from tests.data import data_folder

RNG = np.random.default_rng(0)


def scene(truth, valid=None):
    points = np.ones((*truth.shape, 3), np.float32)
    return Scene("learn0", Cloud(points), truth, np.ones_like(truth, bool) if valid is None else valid)


def stripes(*widths):
    return np.repeat(np.arange(len(widths), dtype=np.int32), widths)[None, :].repeat(50, axis=0)


def test_perfect_labels_in_another_order():
    truth = stripes(20, 10, 30)
    assert score(scene(truth), np.array([0, 2, 1], np.int32)[truth]) == Counts(2, 2, 2)


def test_an_object_cut_in_two_and_two_in_one():
    truth = stripes(20, 10, 30)
    halves = np.where(truth == 2, 2 + (np.arange(60) > 44)[None, :], truth).astype(np.int32)
    assert score(scene(truth), halves) == Counts(2, 3, 1)  # neither half has more than a half
    assert score(scene(truth), np.minimum(truth, 1)) == Counts(2, 1, 1)
    assert Counts(2, 3, 1).f1 == pytest.approx(0.4)


def test_what_is_small_or_invalid_does_not_count():
    truth = stripes(20, 7, 30)
    assert score(scene(truth), truth) == Counts(1, 1, 1)
    assert score(scene(truth, truth == 0), truth) == Counts(0, 0, 0)


def test_groups():
    assert [group_of(name) for name in ("learn0", "learn17", "learn44", "test65", "frame1")] == [
        "boxes",
        "stacked",
        "cylinders",
        "complex",
        "other",
    ]


def test_a_mirrored_scene():
    seen = scene(stripes(20, 10, 30))
    points = RNG.random((50, 60, 3)).astype(np.float32)
    twice = mirrored(mirrored(seen._replace(cloud=Cloud(points))))
    np.testing.assert_array_equal(twice.cloud.points_camera, points)
    np.testing.assert_array_equal(mirrored(seen).truth[:, 0], seen.truth[:, -1])


def test_it_says_what_the_data_sets_own_tool_says():
    tool = data_folder().parent / "tools" / "score_segmentation.py"
    if not tool.exists():
        pytest.skip(f"no {tool}")
    spec = importlib.util.spec_from_file_location("score_segmentation", tool)
    theirs = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(theirs)
    for _ in range(20):
        blocks = RNG.integers(0, 6, (2, 8, 8)).astype(np.int32)
        truth, labels = blocks.repeat(12, axis=1).repeat(12, axis=2)
        labels = np.where(RNG.random(labels.shape) < 0.4, truth, labels)
        valid = RNG.random(truth.shape) < 0.9
        field = np.where(valid, np.where(truth > 0, 10 * truth + 12, 3), 0)
        expected = theirs.score(field, labels, 0.5, 400)
        assert score(scene(truth, valid), labels) == tuple(expected)
