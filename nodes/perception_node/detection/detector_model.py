"""Runs an ONNX model of a detector on colour images."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from semmap.nodes.perception_node.detection.class_names import (
    coco_names,
    names_of,
    read_names,
)
from semmap.nodes.perception_node.detection.decoding import Candidates, Size
from semmap.nodes.perception_node.detection.layouts import Outputs, as_floats, layout_of
from semmap.nodes.perception_node.detection.model_input import Bytes, Floats, Placement
from semmap.nodes.perception_node.detection.selection import select
from semmap.nodes.perception_node.input.masks import Box, DetectorLabel, Masks
from semmap.schemas.errors import BadFile
from semmap.schemas.perception import COCO, LEAST_SCORE

_USUAL_SIDE = 640
"""Width and height of an input that takes any size [pixel]."""
_LARGEST_SIDE = 4096
_TYPES = {
    "tensor(float)": np.float32,
    "tensor(float16)": np.float16,
    "tensor(double)": np.float64,
    "tensor(int64)": np.int64,
    "tensor(int32)": np.int32,
}


class DetectorModel:
    """A detector or instance segmenter. Thread-safe: several images may be in work at once."""

    def __init__(
        self,
        path: Path,
        names: Path | None = None,
        layout: str = "",
        least_score: float = LEAST_SCORE,
        threads: int = 0,
    ) -> None:
        """Load a model and run it once on a black image, whose outputs show its layout.

        `names`: a file with the names of the classes, or the word `coco`. `threads`: the number of cores that
        it uses, half of them by default. Raises BadFile if it cannot be used, with the reason.
        """
        self.file = path.name
        self._least = least_score
        self._session = _session(path, threads or max(1, (os.cpu_count() or 1) // 2))
        metadata = self._session.get_modelmeta().custom_metadata_map
        try:
            _require_task(metadata.get("task", ""))
            self._image, self._type, self._size = _image_input(self._session.get_inputs())
            outputs = self._run(np.zeros((1, 3, *self._size), np.float32))
            self._layout = layout_of(outputs, self._size, layout)
            classes = self._decode(outputs).classes
        except ValueError as error:
            raise BadFile(f"{path}: {error}") from None
        self.layout = self._layout.name
        given = None
        if names is not None:
            given = coco_names(classes) if str(names) == COCO else read_names(names)
        self.names = names_of(given, metadata, classes, self.file)

    def __call__(self, colours: Bytes) -> Masks:
        """Return the detections in an rgb image (H, W, 3); those without masks are boxes.

        Raises BadFile if the model fails.
        """
        values, placement = self._layout.input.prepare(colours, *self._size)
        try:
            found = self._decode(self._run(values))
        except ValueError as error:
            raise BadFile(f"{self.file}: {error}") from None
        rows = select(found, self._least)
        labels = tuple(
            DetectorLabel(self._name(int(found.kinds[row])), min(1.0, float(found.scores[row])))
            for row in rows
        )
        height, width = colours.shape[:2]
        boxes = _pixel_boxes(placement.to_image(found.corners[rows]), height, width)
        numbers = np.zeros((height, width), np.int32)
        if found.masks is None:
            return Masks(numbers, labels, boxes=boxes)
        for number, mask in reversed(list(enumerate(found.masks(rows), 1))):  # the best score is last
            left, top, right, bottom = boxes[number - 1]
            if left < right and top < bottom:
                inside = _resized(mask, placement, self._size, boxes[number - 1]) > 0.0
                numbers[top:bottom, left:right][inside] = number
        return Masks(numbers, labels)

    def _name(self, kind: int) -> str:
        name = self.names[kind] if 0 <= kind < len(self.names) else ""
        return name or str(kind)

    def _run(self, values: Floats) -> Outputs:
        """Return the outputs by name. Raises ValueError with the runtime's reason."""
        feeds: dict[str, NDArray[Any]] = {self._image: values.astype(self._type)}
        for other in self._session.get_inputs():
            if other.name != self._image:  # the size in pixels to which boxes refer
                feeds[other.name] = np.array([self._size[::-1]], _TYPES.get(other.type, np.int64))
        names = [output.name for output in self._session.get_outputs()]
        try:
            found = self._session.run(names, feeds)
        except Exception as error:  # its classes are not public
            raise ValueError(f"it failed in onnxruntime: {_one_line(error)}") from None
        return {name: as_floats(np.asarray(one)) for name, one in zip(names, found, strict=True)}

    def _decode(self, outputs: Outputs) -> Candidates:
        decode = self._layout.arrange(outputs, self._size)
        if decode is None:
            raise ValueError(f"its outputs are no longer of the layout {self._layout.name}")
        return decode()


def _session(path: Path, threads: int) -> Any:
    """Return the loaded model, on a GPU if the installed runtime has one. Raises BadFile."""
    try:
        import onnxruntime
    except ImportError:
        raise BadFile(f"{path} needs onnxruntime; install semmap[perception]") from None
    if not path.is_file():
        raise BadFile(f"there is no file {path}")
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads, options.inter_op_num_threads = threads, 1
    options.log_severity_level = 3  # errors; it warns of parts of models that are unusual
    wanted = ("CUDAExecutionProvider", "CPUExecutionProvider")
    there = [one for one in wanted if one in onnxruntime.get_available_providers()]
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=there)
    except Exception as error:  # its classes are not public
        raise BadFile(f"{path} is not a valid ONNX model: {_one_line(error)}") from None


def _require_task(task: str) -> None:
    """Raise ValueError for a model that Ultralytics trained for another task, in the same layout."""
    if task and task not in ("detect", "segment"):
        raise ValueError(f"it was trained for the task '{task}'; use a model for detection or segmentation")


def _image_input(inputs: list[Any]) -> tuple[str, Any, Size]:
    """Return the name, the type and the size of the input for images. Raises ValueError for other inputs."""
    images = [one for one in inputs if len(one.shape) == 4]
    described = ", ".join(f"{one.name} {' x '.join(map(str, one.shape))} of {one.type}" for one in inputs)
    fault = ValueError(
        f"its inputs are {described}; a detector takes an image, 1 x 3 x height x width floats"
    )
    if len(images) != 1 or images[0].type not in ("tensor(float)", "tensor(float16)"):
        raise fault
    if any(tuple(other.shape[1:]) != (2,) for other in inputs if other is not images[0]):
        raise fault
    batch, channels, *sides = images[0].shape
    height, width = (side if isinstance(side, int) else _USUAL_SIDE for side in sides)
    fixed = [size for size in (batch, channels) if isinstance(size, int)]
    if fixed not in ([1, 3], [3], [1], []) or not all(0 < side <= _LARGEST_SIDE for side in (height, width)):
        raise fault
    return images[0].name, _TYPES[images[0].type], (height, width)


def _pixel_boxes(corners: Floats, height: int, width: int) -> tuple[Box, ...]:
    """Return first column and row of each box, and those after the last, inside the image."""
    low = np.floor(np.clip(corners[:, :2], 0, (width, height))).astype(int)
    high = np.ceil(np.clip(corners[:, 2:], 0, (width, height))).astype(int)
    return tuple(
        (x, y, right, bottom) for (x, y), (right, bottom) in zip(low.tolist(), high.tolist(), strict=True)
    )


def _resized(mask: Floats, placement: Placement, size: Size, box: Box) -> Floats:
    """Return the part of a mask of the whole input that is in a box of the image, in the image's pixels."""
    (across, down), (first, upper) = placement.scale, placement.offset
    width, height = mask.shape[1] / size[1], mask.shape[0] / size[0]
    left, right = ((side * across + first) * width for side in box[::2])
    top, bottom = ((side * down + upper) * height for side in box[1::2])
    part = left, top, min(right, mask.shape[1]), min(bottom, mask.shape[0])
    whole = Image.fromarray(np.ascontiguousarray(mask, np.float32))
    pixels = box[2] - box[0], box[3] - box[1]
    return np.asarray(whole.resize(pixels, Image.Resampling.BILINEAR, box=part))


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())[:300]
