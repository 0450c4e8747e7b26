"""Outputs of detectors as boxes, scores, classes and masks in pixels of the input."""

import numpy as np
import pytest

from semmap.nodes.perception_node.detection import decoding

SIZE = 64, 96
"""Height and width of the input."""
CELLS = decoding.anchors(SIZE, (8, 16, 32))
BOX = (48.0, 40.0, 24.0, 16.0)
"""Middle and size of a box in it."""
CORNERS = (36.0, 32.0, 60.0, 48.0)


def test_cells_of_all_grids_are_counted_also_where_the_last_is_cut():
    assert CELLS == 8 * 12 + 4 * 6 + 2 * 3
    assert decoding.anchors((33, 16), (8, 32)) == 5 * 2 + 2 * 1


def test_a_row_is_of_its_best_class():
    found = decoding.of_rows(np.zeros((2, 4)), np.array([[0.1, 0.7, 0.2], [0.5, 0.1, 0.1]]))
    assert (found.scores.tolist(), found.kinds.tolist(), found.classes) == ([0.7, 0.5], [1, 0], 3)
    assert found.masks is None


def test_probabilities_of_any_logits_are_from_0_to_1():
    found = decoding.sigmoid(np.array([-1e4, -np.log(3), 0.0, np.log(3), 1e4], np.float32))
    assert found == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])


@pytest.mark.parametrize("wide", [24.0, 1e30], ids=["of a usual size", "far too wide"])
@pytest.mark.parametrize("raw", [True, False])
def test_boxes_of_yolox_are_relative_to_their_cells_unless_they_were_decoded(raw, wide):
    rows = np.zeros((1, CELLS, 5 + 2), np.float32)
    x, y, _, high = BOX
    if raw:
        rows[0, 8 * 12 + 2 * 6 + 3, :4] = x / 16 - 3, y / 16 - 2, np.log(wide / 16), np.log(high / 16)
        rows[0, 0, 2] = -60.0  # sizes are logarithms, which differ by more than the middles
        row = 8 * 12 + 2 * 6 + 3
    else:
        rows[0, :, 0] = np.linspace(0.0, 95.0, CELLS)
        row = 7
        rows[0, row, :4] = x, y, wide, high
    rows[0, row, 4:] = 0.5, 0.2, 0.8
    found = decoding.decode_yolox(rows, SIZE)
    if wide < 1e3:
        assert found.corners[row] == pytest.approx(CORNERS, abs=1e-4)
    assert np.isfinite(found.corners).all()
    assert found.corners[row, [1, 3]] == pytest.approx((32.0, 48.0), abs=1e-4)
    assert (found.scores[row], found.kinds[row], found.classes) == (pytest.approx(0.4), 1, 2)


def test_scores_of_yolov5_are_those_of_a_thing_times_those_of_its_classes():
    rows = np.array([[[*BOX, 0.5, 0.6, 0.2]]], np.float32)
    found = decoding.decode_yolov5(rows)
    assert found.corners == pytest.approx(np.array([CORNERS]))
    assert (found.scores[0], found.kinds[0], found.classes) == (pytest.approx(0.3), 0, 2)


@pytest.mark.parametrize("masked", [True, False])
def test_masks_of_yolo_are_sums_of_prototypes(masked):
    protos = np.arange(2 * 2 * 3, dtype=np.float32).reshape(1, 2, 2, 3) if masked else None
    weights = [2.0, -1.0] if masked else []
    scores = decoding.decode_yolov8(np.array([[*BOX, 0.1, 0.9, 0.3, *weights]]).transpose()[None], protos)
    chosen = decoding.decode_yolo_nms(np.array([[[*CORNERS, 0.9, 1.0, *weights]]]), protos)
    for found, classes in ((scores, 3), (chosen, 0)):
        assert found.corners == pytest.approx(np.array([CORNERS]))
        assert (found.scores.tolist(), found.kinds.tolist(), found.classes) == ([0.9], [1], classes)
        if protos is None:
            assert found.masks is None
        else:
            assert found.masks([0]).tolist() == [(2 * protos[0, 0] - protos[0, 1]).tolist()]


def test_shares_are_of_the_width_and_height_of_the_input():
    boxes = np.array([[[0.5, 0.625, 0.25, 0.25]]], np.float32)
    masks = np.ones((1, 1, 2, 2), np.float32)
    found = decoding.decode_shares(boxes, np.array([[[0.2, 0.7]]]), SIZE, masks)
    assert found.corners == pytest.approx(np.array([CORNERS]))
    assert (found.kinds.tolist(), found.masks([0]).shape) == ([1], (1, 2, 2))
    assert decoding.decode_shares(boxes, np.array([[[0.2, 0.7]]]), SIZE).masks is None


def test_things_that_were_selected_are_as_they_are():
    corners, labels, scores = np.array([[CORNERS]]), np.array([[5.0]]), np.array([[0.9]])
    found = decoding.decode_selected(labels, corners, scores)
    assert (found.corners.tolist(), found.kinds.tolist(), found.scores.tolist()) == ([[*CORNERS]], [5], [0.9])
    assert (found.classes, found.masks) == (0, None)
