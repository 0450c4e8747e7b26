"""Masks: COCO's format, and label images."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.perception_node.input.masks import (
    DetectorLabel,
    masks_from_image,
    masks_from_numbers,
    masks_from_runs,
    masks_from_stack,
)
from semmap.schemas.perception import MaskImage, MaskRun


def runs(mask):
    """Return column-wise run lengths, starting with background."""
    flat = mask.T.ravel()
    edges = np.flatnonzero(np.diff(flat.astype(int))) + 1
    counts = np.diff([0, *edges, flat.size]).tolist()
    return [0, *counts] if flat[0] else counts


def compressed(counts):
    """Encode as COCO's text: differences to the run before the last, five bits per character."""
    text = ""
    for n, count in enumerate(counts):
        value = count - counts[n - 2] if n > 2 else count
        more = True
        while more:
            bits = value & 0x1F
            value >>= 5
            more = value != (-1 if bits & 0x10 else 0)
            text += chr((bits | 0x20 if more else bits) + 48)
    return text


@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 2**32 - 1), st.floats(0.0, 1.0))
def test_runs_and_their_text_give_the_mask_back(height, width, seed, share):
    mask = np.random.default_rng(seed).random((height, width)) < share
    counts = runs(mask)
    for code in (tuple(counts), compressed(counts)):
        found = masks_from_runs([MaskRun(size=(height, width), counts=code, label="cup")], height, width)
        assert (found.labels == mask).all()


def test_text_worked_out_by_hand():
    # runs 5, 2, 3, 4, 86: the first three as they are, then 4 - 2 and 86 - 3, which takes two letters
    found = masks_from_runs([MaskRun(size=(10, 10), counts="5232c2", label="cup", score=0.9)], 10, 10)
    assert np.flatnonzero(found.labels.T.ravel()).tolist() == [5, 6, 10, 11, 12, 13]
    assert found.detector_labels == (DetectorLabel("cup", 0.9),)


def test_where_masks_overlap_the_surer_one_is_in_front():
    left, right = np.zeros((2, 4, 6), bool)
    left[:, :4], right[:, 2:] = True, True
    masks = [MaskRun(size=(4, 6), counts=tuple(runs(m)), score=s) for m, s in ((left, 0.9), (right, 0.5))]
    assert masks_from_runs(masks, 4, 6).labels[0].tolist() == [1, 1, 1, 1, 2, 2]


def test_a_label_image_has_names_or_none():
    labels = np.array([[0, 1], [2, 2]], "<u2")
    named = masks_from_image(MaskImage(labels=labels.tobytes(), names=("cup", ""), scores=(0.8, 1.0)), 2, 2)
    assert named.labels.tolist() == labels.tolist()
    assert named.detector_labels == (DetectorLabel("cup", 0.8), None)
    assert masks_from_numbers(labels).detector_labels == (None, None)


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (
            lambda: masks_from_runs([MaskRun(size=(3, 3), counts=(9,))], 4, 4),
            "a mask has 3 x 3 pixels, the image 4 x 4",
        ),
        (
            lambda: masks_from_runs([MaskRun(size=(4, 4), counts=(3, 4))], 4, 4),
            "add up to 7 pixels, not to 16",
        ),
        (lambda: masks_from_runs([MaskRun(size=(4, 4), counts="~")], 4, 4), "invalid character"),
        (lambda: masks_from_runs([MaskRun(size=(4, 4), counts="P")], 4, 4), "truncated"),
        (lambda: masks_from_image(MaskImage(labels=b"abc"), 2, 2), "not a label image of 2 x 2 pixels"),
        (lambda: masks_from_numbers(np.array([[3]]), ["cup"]), "but 1 names"),
        (lambda: masks_from_numbers(np.array([[-1]])), "0 for none"),
        (lambda: masks_from_numbers(np.array([[1]]), ["cup"], [0.5, 0.5]), "each name needs one"),
    ],
)
def test_what_is_wrong_with_masks_is_said(made, said):
    with pytest.raises(ValueError, match=said):
        made()


@pytest.mark.parametrize(
    ("scores", "both"),
    [((), 2), ((0.9, 0.5), 1), ((0.5, 0.9), 2)],
    ids=["the last", "the first", "the second"],
)
def test_masks_of_a_stack_are_numbered_in_order_and_the_better_one_covers_the_other(scores, both):
    stack = np.array([[[1, 1, 0]], [[0, 1, 1]]], bool)
    assert masks_from_stack(stack, scores=scores).labels.tolist() == [[1, both, 2]]
