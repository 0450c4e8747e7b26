"""The layouts of outputs that are known, and which of them a model has. Pure."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.detection import decoding, model_input
from semmap.nodes.perception_node.detection.decoding import STRIDES, Candidates, Size, anchors, sigmoid
from semmap.nodes.perception_node.detection.model_input import InputFormat
from semmap.schemas.perception import DETECTOR_LAYOUTS
from semmap.schemas.wording import few

Outputs = Mapping[str, NDArray[Any]]
"""The outputs of a model by name, in its order."""
Decode = Callable[[], Candidates]


@dataclass(frozen=True)
class Layout:
    """A layout: the input that such models take, and how their outputs are read.

    `arrange` returns the function that decodes these outputs, or None if they have other shapes.
    `own_names`: names of outputs that tell it from another layout of the same shapes. `yields_to`: the layout
    that is meant if both fit and none is named.
    """

    name: str
    input: InputFormat
    arrange: Callable[[Outputs, Size], Decode | None]
    own_names: frozenset[str] = frozenset()
    yields_to: str = ""


def layout_of(outputs: Outputs, size: Size, named: str = "") -> Layout:
    """Return the layout of a model's outputs, or the one that is named.

    Raises ValueError with the outputs and their shapes if none fits, or several.
    """
    shapes = few([f"{name} {' x '.join(map(str, values.shape))}" for name, values in outputs.items()])
    if named:
        found = next((layout for layout in LAYOUTS if layout.name == named), None)
        if found is None:
            raise ValueError(f"unknown layout '{named}'; {_known()}")
        if found.arrange(outputs, size) is None:
            raise ValueError(f"its outputs are not of the layout {named}: {shapes}; {_known()}")
        return found
    fitting = [layout for layout in LAYOUTS if layout.arrange(outputs, size) is not None]
    fitting = [one for one in fitting if one.yields_to not in {other.name for other in fitting}]
    by_name = [layout for layout in fitting if layout.own_names & outputs.keys()]
    if len(by_name or fitting) != 1:
        several = few([layout.name for layout in by_name or fitting])
        fault = f"may be {several}" if fitting else "are of no known layout"
        raise ValueError(f"its outputs {fault}: {shapes}; {_known()} (--detector-layout)")
    return (by_name or fitting)[0]


def _known() -> str:
    return f"known layouts: {', '.join(DETECTOR_LAYOUTS)}"


def _split(outputs: Outputs) -> tuple[list[NDArray[Any]], NDArray[Any] | None]:
    """Return the outputs of up to three dimensions, and the one of four: masks or their prototypes."""
    flat = [values for values in outputs.values() if values.ndim < 4]
    deep = [values for values in outputs.values() if values.ndim == 4]
    if len(deep) > 1 or any(values.shape[:1] != (1,) for values in outputs.values()):
        return [], None
    return flat, deep[0] if deep else None


def _yolov8(outputs: Outputs, size: Size) -> Decode | None:
    flat, protos = _split(outputs)
    match [values.shape for values in flat]:
        case [(1, rows, cells)]:
            weights = 0 if protos is None else protos.shape[1]
            if rows > 4 + weights and _grid(cells, size):
                return lambda: decoding.decode_yolov8(flat[0], protos)
    return None


def _yolo_nms(outputs: Outputs, size: Size) -> Decode | None:
    flat, protos = _split(outputs)
    match [values.shape for values in flat]:
        case [(1, rows, columns)] if columns == 6 + (0 if protos is None else protos.shape[1]):
            if _grid(rows, size) or _grid(rows // 3, size):
                return None
            return lambda: decoding.decode_yolo_nms(flat[0], protos)
    return None


def _yolov5(outputs: Outputs, size: Size) -> Decode | None:
    flat, protos = _split(outputs)
    match [values.shape for values in flat]:
        case [(1, cells, columns)] if protos is None and columns > 5:
            if cells % 3 == 0 and _grid(cells // 3, size):
                return lambda: decoding.decode_yolov5(flat[0])
    return None


def _yolox(outputs: Outputs, size: Size) -> Decode | None:
    flat, protos = _split(outputs)
    match [values.shape for values in flat]:
        case [(1, cells, columns)] if protos is None and columns > 5 and _grid(cells, size):
            return lambda: decoding.decode_yolox(flat[0], size)
    return None


def _rtdetr(outputs: Outputs, size: Size) -> Decode | None:
    flat, masks = _split(outputs)
    boxes = [values for values in flat if values.ndim == 3 and values.shape[2] == 4]
    rows = {name: values for name, values in outputs.items() if values.ndim == 2}
    if masks is not None or len(flat) != 3 or len(boxes) != 1 or len(rows) != 2:
        return None
    whole = [name for name, values in rows.items() if values.dtype.kind in "iu"]
    label = whole[0] if len(whole) == 1 else "labels"
    if label not in rows or any(values.shape != boxes[0].shape[:2] for values in rows.values()):
        return None
    score = next(name for name in rows if name != label)
    return lambda: decoding.decode_selected(rows[label], boxes[0], rows[score])


def _boxes_and_logits(outputs: Outputs, size: Size) -> Decode | None:
    flat, masks = _split(outputs)
    if len(flat) != 2 or any(values.ndim != 3 for values in flat):
        return None
    boxes, logits = flat if flat[0].shape[2] == 4 else flat[::-1]
    if "pred_boxes" in outputs and "logits" in outputs:
        boxes, logits = outputs["pred_boxes"], outputs["logits"]
    queries = boxes.shape[1]
    if boxes.shape[2] != 4 or logits.shape[1] != queries:
        return None
    if masks is not None and masks.shape[1] != queries:
        return None
    return lambda: decoding.decode_shares(boxes, sigmoid(logits), size, masks)


def _ultralytics_rtdetr(outputs: Outputs, size: Size) -> Decode | None:
    flat, masks = _split(outputs)
    match [values.shape for values in flat]:
        case [(1, queries, columns)] if masks is None and columns > 4:
            if any(_grid(count, size) for count in (queries, queries // 3, columns)):
                return None
            values = flat[0]
            return lambda: decoding.decode_shares(values[..., :4], values[..., 4:], size)
    return None


def _grid(cells: int, size: Size) -> bool:
    return any(anchors(size, strides) == cells for strides in STRIDES)


LAYOUTS = (
    Layout("yolov8", model_input.YOLO, _yolov8),
    Layout("yolo-nms", model_input.YOLO, _yolo_nms),
    Layout("yolov5", model_input.YOLO, _yolov5),
    Layout("yolox", model_input.YOLOX, _yolox),
    Layout("rtdetr", model_input.STRETCHED, _rtdetr),
    Layout("rtdetr-logits", model_input.STRETCHED, _boxes_and_logits, frozenset({"logits", "pred_boxes"})),
    Layout("rtdetr-ultralytics", model_input.STRETCHED, _ultralytics_rtdetr, yields_to="yolo-nms"),
    Layout("rfdetr", model_input.IMAGENET, _boxes_and_logits, frozenset({"dets"})),
)


def as_floats(values: NDArray[Any]) -> NDArray[Any]:
    """Return half-precision values as floats, and all others as they are."""
    return values.astype(np.float32) if values.dtype == np.float16 else values
