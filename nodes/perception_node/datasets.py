"""Datasets: observations of each of many frames."""

from __future__ import annotations

import logging
import os
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.detector import Detector
from semmap.nodes.perception_node.fitting.fit_observations import fit_all
from semmap.nodes.perception_node.fitting.model_surfaces import ClassSurfaces
from semmap.nodes.perception_node.input.files.frame_folders import FileFrame, read_frame
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.input.robot_mask import read_robot
from semmap.nodes.perception_node.pipeline import FrameResult, RecognitionModel, observe_clouds
from semmap.nodes.perception_node.views.boxed import FEWEST_POINTS
from semmap.schemas.errors import SemmapError
from semmap.schemas.perception import DroppedInFrame, FrameRow, Observation, SeenInFrame

log = logging.getLogger(__name__)

_AHEAD = 2
"""Number of frames in progress per core."""


class DatasetFrame(NamedTuple):
    """The row of one frame and its label image; the labels are None on an error.

    In `labels` (H, W), n is a pixel of `row.objects[n - 1]`, and 0 is background. `unknown_labels` are labels
    of a detector that match no class.
    """

    row: FrameRow
    labels: NDArray[np.int32] | None
    unknown_labels: tuple[str, ...] = ()


def perceive_folders(
    folders: Sequence[Path],
    learnt: RecognitionModel,
    detector: Detector | None = None,
    surfaces: ClassSurfaces | None = None,
    robot: Path | None = None,
) -> Iterator[DatasetFrame]:
    """Yield the observations of the frames in these folders, in order.

    An error of a frame is in its row, even an unexpected one, so that no frame ends the run.

    With `surfaces`, the models of classes are fitted to the things of each frame. `robot` names the file in
    each folder with the state of the robot, which is left out.
    """
    cores = os.cpu_count() or 1
    under_way: deque[Future[DatasetFrame]] = deque()
    with ThreadPoolExecutor(cores) as threads:
        for folder in folders:
            under_way.append(threads.submit(_perceive, folder, learnt, detector, surfaces, robot))
            if len(under_way) >= _AHEAD * cores:
                yield under_way.popleft().result()
        while under_way:
            yield under_way.popleft().result()


def _perceive(
    folder: Path,
    learnt: RecognitionModel,
    detector: Detector | None,
    surfaces: ClassSurfaces | None,
    robot: Path | None,
) -> DatasetFrame:
    try:
        return _perceive_folder(folder, learnt, detector, surfaces, robot)
    except SemmapError as error:
        text = error.text
    except Exception as error:
        log.debug("processing of %s failed", folder, exc_info=True)
        text = f"{folder.name}: processing failed: {type(error).__name__}: {error}; report it with this frame"
    return DatasetFrame(FrameRow(frame=folder.name, error=text), None)


def _perceive_folder(
    folder: Path,
    learnt: RecognitionModel,
    detector: Detector | None,
    surfaces: ClassSurfaces | None,
    robot: Path | None,
) -> DatasetFrame:
    frame = read_frame(folder)
    if robot is not None:
        frame = replace(frame, cloud=read_robot(folder / robot).remove_from(frame.cloud))
    masks = None
    if detector is not None:
        masks = detector.masks_of(frame.cloud, frame.shape, frame.step, folder)
    seen = observe_clouds([frame.cloud], learnt, [masks], None if detector is None else detector.labels)
    labels = _whole(seen.labels[0], frame)
    boxes = _boxes(labels, len(seen.observations.observations))
    observations = seen.observations.observations
    if surfaces is not None:
        observations = fit_all([frame.cloud], seen, surfaces)
    objects = tuple(_object(*row) for row in zip(observations, boxes, strict=True))
    dropped = *_dropped_things(seen, frame), *_unused_masks(seen, masks, frame)
    return DatasetFrame(
        FrameRow(frame=folder.name, objects=objects, dropped=dropped, notes=seen.notes),
        labels,
        seen.unknown_labels,
    )


def _dropped_things(seen: FrameResult, frame: FileFrame) -> Iterator[DroppedInFrame]:
    """Yield the things that are not reported: fragments, and noise."""
    if frame.cloud.intrinsics is None:
        return
    height, width = frame.shape
    pose = np.array(seen.observations.views[0].map_from_camera).reshape(4, 4)
    for thing, reason in seen.dropped:
        points = np.concatenate([segment.points for segment in thing.segments])
        pixels = ((points - pose[:3, 3]) @ pose[:3, :3]) @ frame.cloud.intrinsics.T
        places = np.floor(pixels[:, :2] / pixels[:, 2:]).astype(int)
        column, row = (places.min(axis=0) * frame.step).tolist()
        end_column, end_row = ((places.max(axis=0) + 1) * frame.step).tolist()
        yield DroppedInFrame(
            reason=reason,
            box_px=(max(0, column), max(0, row), min(width, end_column), min(height, end_row)),
            points=thing.count,
        )


def _unused_masks(seen: FrameResult, masks: Masks | None, frame: FileFrame) -> Iterator[DroppedInFrame]:
    """Yield the masks of a detector that cover no surface."""
    if masks is None:
        return
    boxes = _boxes(_whole(masks.labels, frame), len(masks.detector_labels))
    for number in seen.unused_masks[0]:
        label = masks.detector_labels[number - 1]
        kind = "box" if masks.boxes else "mask"
        name = f"{kind} {number}" if label is None else f"{kind} {number} ('{label.label}')"
        fault = f"covers fewer than {FEWEST_POINTS} points of one surface"
        if masks.boxes:
            left, top, right, bottom = (frame.step * side for side in masks.boxes[number - 1])
            boxes[number - 1] = left, top, min(right, frame.shape[1]), min(bottom, frame.shape[0])
            fault = "has no segment that fits it: the thing is flat, hidden, or without depth"
        yield DroppedInFrame(
            reason=f"{name} {fault}",
            box_px=boxes[number - 1],
            points=int(np.count_nonzero((masks.labels == number) & (frame.cloud.points_camera[..., 2] > 0))),
        )


def _whole(labels: NDArray[np.int32], frame: FileFrame) -> NDArray[np.int32]:
    """Expand labels of every `step`-th pixel to all pixels."""
    height, width = frame.shape
    return labels.repeat(frame.step, axis=0).repeat(frame.step, axis=1)[:height, :width]


def _boxes(labels: NDArray[np.int32], count: int) -> list[tuple[int, int, int, int]]:
    """Return first column and row of each label, and those after the last; four zeros for an absent label."""
    found: list[tuple[int, int, int, int]] = []
    for n in range(1, count + 1):
        rows, columns = (np.flatnonzero((labels == n).any(axis=axis)) for axis in (1, 0))
        if not rows.size:
            found.append((0, 0, 0, 0))
            continue
        found.append((int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1))
    return found


def _object(seen: Observation, box_px: tuple[int, int, int, int]) -> SeenInFrame:
    return SeenInFrame(
        class_=seen.class_,
        probability=seen.probability,
        candidates=seen.candidates,
        pose=seen.pose,
        size_m=seen.size_m,
        box_px=box_px,
        points=seen.points,
        fit=seen.fit,
        label=seen.label,
    )
