"""Tiny ONNX models with the inputs and outputs of real detectors; their outputs are constant."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from semmap.nodes.perception_node.image_features.onnx_model import _field, _tensor, _value, model, node

_INT64 = 7


def write_model(
    path: Path,
    outputs: Mapping[str, np.ndarray],
    *,
    images: tuple[str, Sequence[int | str]] = ("images", (1, 3, 640, 640)),
    sizes: str = "",
    metadata: Mapping[str, str] = {},
) -> Path:
    """Write a model that returns these outputs for each image; `sizes`: a second input, of integers."""
    nodes, values = [], []
    for name, found in outputs.items():
        whole = found.dtype.kind in "iu"
        nodes.append(
            node("Cast", [f"{name}.value"], name, to=_INT64)
            if whole
            else node("Identity", [f"{name}.value"], name)
        )
        values.append(_field(12, _value(name, found.shape) if not whole else _integers(name, found.shape)))
    graph = b"".join(
        [
            *(_field(1, one) for one in nodes),
            _field(2, "detector"),
            *(
                _field(5, _tensor(f"{name}.value", found.astype(np.float32)))
                for name, found in outputs.items()
            ),
            _field(11, _value(*images)),
            *([_field(11, _integers(sizes, ("n", 2)))] if sizes else []),
            *values,
        ]
    )
    whole_model = model([], {}, {}, {})
    head, tail = _field(1, 8), _field(8, _field(2, 13))
    assert whole_model == head + _field(7, _field(2, "semmap")) + tail
    notes = (_field(14, _field(1, key) + _field(2, text)) for key, text in metadata.items())
    path.write_bytes(head + _field(7, graph) + tail + b"".join(notes))
    return path


def _integers(name: str, shape: Sequence[int | str]) -> bytes:
    return _value(name, shape).replace(b"\x08\x01\x12", b"\x08\x07\x12", 1)


def yolov8(boxes: Sequence[tuple[float, ...]], classes: int = 80, cells: int = 8400) -> np.ndarray:
    """Return predictions (1, 4 + C, A): each box is (x, y, w, h, class, score)."""
    rows = np.zeros((1, 4 + classes, cells), np.float32)
    for n, (x, y, w, h, kind, score) in enumerate(boxes):
        rows[0, :4, n] = x, y, w, h
        rows[0, 4 + int(kind), n] = score
    return rows
