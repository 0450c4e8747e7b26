"""Datasets: what each of many frames shows, one after another."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.detector import Detector
from semmap.nodes.perception_node.fitting.model_surfaces import ClassSurfaces
from semmap.nodes.perception_node.fitting.things import all_fitted
from semmap.nodes.perception_node.input.files.frame_folders import FileFrame, read_frame
from semmap.nodes.perception_node.pipeline import Learnt, look
from semmap.schemas.errors import SemmapError
from semmap.schemas.perception import FrameRow, Observation, SeenInFrame

_AHEAD = 2
"""So many frames a core are under way at once."""


class Told(NamedTuple):
    """A frame's row, and (H, W) n where `row.objects[n - 1]` is seen, 0 for none; None on an error.

    `unknown_labels`: what a detector said that is no class here.
    """

    row: FrameRow
    labels: NDArray[np.int32] | None
    unknown_labels: tuple[str, ...] = ()


def perceived(
    folders: Sequence[Path],
    learnt: Learnt,
    detector: Detector | None = None,
    surfaces: ClassSurfaces | None = None,
) -> Iterator[Told]:
    """What the frames in these folders show, in their order; what is wrong with one is told in its row.

    With `surfaces` the models of classes are fitted to the things of each.
    """
    cores = os.cpu_count() or 1
    under_way: deque[Future[Told]] = deque()
    with ThreadPoolExecutor(cores) as threads:
        for folder in folders:
            under_way.append(threads.submit(_told, folder, learnt, detector, surfaces))
            if len(under_way) >= _AHEAD * cores:
                yield under_way.popleft().result()
        while under_way:
            yield under_way.popleft().result()


def _told(folder: Path, learnt: Learnt, detector: Detector | None, surfaces: ClassSurfaces | None) -> Told:
    try:
        frame = read_frame(folder)
        masks = None
        if detector is not None:
            masks = detector.masks_of(folder / detector.file, frame.shape).thinned(frame.step)
    except SemmapError as error:
        return Told(FrameRow(frame=folder.name, error=error.text), None)
    seen = look([frame.cloud], learnt, [masks], None if detector is None else detector.labels)
    labels = _whole(seen.labels[0], frame)
    boxes = _boxes(labels, len(seen.observations.observations))
    told = seen.observations.observations
    if surfaces is not None:
        told = all_fitted([frame.cloud], seen, surfaces)
    rows = zip(told, boxes, strict=True)
    return Told(
        FrameRow(frame=folder.name, objects=tuple(_object(*row) for row in rows)), labels, seen.unknown_labels
    )


def _whole(labels: NDArray[np.int32], frame: FileFrame) -> NDArray[np.int32]:
    """Labels of every `step`-th pixel as labels of all."""
    height, width = frame.shape
    return labels.repeat(frame.step, axis=0).repeat(frame.step, axis=1)[:height, :width]


def _boxes(labels: NDArray[np.int32], count: int) -> list[tuple[int, int, int, int]]:
    """First column and row of each label, and those after the last; four zeros for one that is nowhere."""
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
    )
