"""The outputs of a detector as boxes, scores, classes and masks, all in pixels of its input."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.detection.model_input import Floats

Indices = NDArray[np.int64]
Size = tuple[int, int]
"""Height and width of the input [pixel]."""

STRIDES = ((8, 16, 32), (8, 16, 32, 64), (4, 8, 16, 32))
"""The strides of the grids on which models of the YOLO family predict boxes."""


class Candidates(NamedTuple):
    """Everything that a model predicts for one image, before any threshold.

    `corners`: (N, 4) x, y of two corners [pixel of the input]. `scores` (N,) from 0 to 1 and `kinds` (N,),
    the number of the best class. `classes`: their number, 0 if unknown. `masks`: returns for rows n of these
    the masks (n, h, w), positive inside, of the whole input.
    """

    corners: Floats
    scores: Floats
    kinds: Indices
    classes: int
    masks: Callable[[Indices], Floats] | None = None


def anchors(size: Size, strides: tuple[int, ...]) -> int:
    """Return the number of cells of all grids."""
    return sum(-(-size[0] // stride) * -(-size[1] // stride) for stride in strides)


def of_rows(boxes: Floats, scores: Floats, masks: Callable[[Indices], Floats] | None = None) -> Candidates:
    """Return the best class of each row of scores (N, C), with boxes (N, 4) of corners."""
    kinds = scores.argmax(axis=1)
    best = np.take_along_axis(scores, kinds[:, None], axis=1)[:, 0]
    return Candidates(boxes, best, kinds, scores.shape[1], masks)


def decode_yolov8(predictions: Floats, protos: Floats | None) -> Candidates:
    """Return those of YOLOv8 and 11 (1, 4 + C, A); with `protos` (1, M, h, w), M weights follow."""
    rows = predictions[0].T
    weights = 0 if protos is None else protos.shape[1]
    end = rows.shape[1] - weights
    masks = None if protos is None else _of_protos(rows[:, end:], protos[0])
    return of_rows(corners_of(rows[:, :4]), rows[:, 4:end], masks)


def decode_yolo_nms(predictions: Floats, protos: Floats | None) -> Candidates:
    """Return those of a YOLO that selects boxes itself (1, N, 6): corners, score, class, and mask weights."""
    rows = predictions[0]
    masks = None if protos is None else _of_protos(rows[:, 6:], protos[0])
    return Candidates(rows[:, :4], rows[:, 4], rows[:, 5].astype(np.int64), 0, masks)


def decode_yolov5(predictions: Floats) -> Candidates:
    """Return those of YOLOv5 and 7 (1, 3 A, 5 + C): box, objectness, and scores of the classes."""
    rows = predictions[0]
    return of_rows(corners_of(rows[:, :4]), rows[:, 4:5] * rows[:, 5:])


def decode_yolox(predictions: Floats, size: Size) -> Candidates:
    """Return those of YOLOX (1, A, 5 + C), exported with or without decoding its boxes.

    Without, the middle is relative to a cell and the size is a logarithm; with, the middles fill the input.
    """
    rows = predictions[0]
    boxes = rows[:, :4]
    if np.ptp(boxes[:, :2], axis=0).max(initial=0.0) < max(size) / 2:
        strides = next(steps for steps in STRIDES if anchors(size, steps) == len(rows))
        cells = [np.indices((-(-size[0] // s), -(-size[1] // s)))[::-1].reshape(2, -1).T for s in strides]
        step = np.concatenate([np.full((len(c), 1), s) for c, s in zip(cells, strides, strict=True)])
        middles = (boxes[:, :2] + np.concatenate(cells)) * step
        sizes = np.exp(np.minimum(boxes[:, 2:], np.log(4.0 * max(size)))) * step
        boxes = np.concatenate([middles, sizes], axis=1).astype(np.float32)
    return of_rows(corners_of(boxes), rows[:, 4:5] * rows[:, 5:])


def decode_selected(labels: NDArray[Any], boxes: Floats, scores: Floats) -> Candidates:
    """Return those of RT-DETR with its post-processing: labels (1, N), corners (1, N, 4), scores (1, N)."""
    return Candidates(boxes[0], scores[0], labels[0].astype(np.int64), 0)


def decode_shares(boxes: Floats, scores: Floats, size: Size, masks: Floats | None = None) -> Candidates:
    """Return boxes (1, N, 4) of middle and size as shares of the input, with scores (1, N, C).

    `masks` are (1, N, h, w), positive inside.
    """
    scale = np.array([size[1], size[0]] * 2, np.float32)
    rows = None if masks is None else masks[0]
    return of_rows(
        corners_of(boxes[0]) * scale, scores[0], None if rows is None else lambda numbers: rows[numbers]
    )


def sigmoid(logits: Floats) -> Floats:
    """Return probabilities, without overflow."""
    return np.asarray(0.5 * (1.0 + np.tanh(0.5 * logits)), np.float32)


def corners_of(boxes: Floats) -> Floats:
    """Return boxes (N, 4) of middle and size as x, y of two corners."""
    half = boxes[:, 2:] / 2.0
    return np.concatenate([boxes[:, :2] - half, boxes[:, :2] + half], axis=1).astype(np.float32)


def _of_protos(weights: Floats, protos: Floats) -> Callable[[Indices], Floats]:
    return lambda rows: np.asarray(np.tensordot(weights[rows], protos, axes=1), np.float32)
