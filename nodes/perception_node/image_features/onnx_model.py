"""Writes ONNX models: the few messages and fields that a network of convolutions takes.

The format is protocol buffers; the numbers of the fields are those of onnx.proto.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

_IR_VERSION, _OPSET = 8, 13
_FLOAT = 1
_ATTRIBUTE_INT, _ATTRIBUTE_STRING, _ATTRIBUTE_INTS = 2, 3, 7

Attribute = int | str | Sequence[int]


def node(kind: str, inputs: Sequence[str], output: str, **attributes: Attribute) -> bytes:
    """Return a NodeProto: an operator of this kind with named inputs and one output."""
    return b"".join(
        [
            *(_field(1, name) for name in inputs),
            _field(2, output),
            _field(4, kind),
            *(_field(5, _attribute(name, value)) for name, value in attributes.items()),
        ]
    )


def model(
    nodes: Sequence[bytes],
    constants: Mapping[str, NDArray[np.float32]],
    inputs: Mapping[str, Sequence[int | str]],
    outputs: Mapping[str, Sequence[int | str]],
) -> bytes:
    """Return a ModelProto of nodes in order of execution. A dimension is a number, or a name if it varies."""
    graph = b"".join(
        [
            *(_field(1, one) for one in nodes),
            _field(2, "semmap"),
            *(_field(5, _tensor(name, values)) for name, values in constants.items()),
            *(_field(11, _value(name, shape)) for name, shape in inputs.items()),
            *(_field(12, _value(name, shape)) for name, shape in outputs.items()),
        ]
    )
    return _field(1, _IR_VERSION) + _field(7, graph) + _field(8, _field(2, _OPSET))


def _attribute(name: str, value: Attribute) -> bytes:
    if isinstance(value, int):
        return _field(1, name) + _field(3, value) + _field(20, _ATTRIBUTE_INT)
    if isinstance(value, str):
        return _field(1, name) + _field(4, value) + _field(20, _ATTRIBUTE_STRING)
    return _field(1, name) + b"".join(_field(8, one) for one in value) + _field(20, _ATTRIBUTE_INTS)


def _tensor(name: str, values: NDArray[np.float32]) -> bytes:
    data = np.ascontiguousarray(values, "<f4").tobytes()
    shape = b"".join(_field(1, size) for size in values.shape)
    return shape + _field(2, _FLOAT) + _field(8, name) + _field(9, data)


def _value(name: str, shape: Sequence[int | str]) -> bytes:
    """Return a ValueInfoProto of a tensor of floats."""
    sizes = (_field(1, _field(1 if isinstance(size, int) else 2, size)) for size in shape)
    return _field(1, name) + _field(2, _field(1, _field(1, _FLOAT) + _field(2, b"".join(sizes))))


def _field(number: int, value: int | str | bytes) -> bytes:
    if isinstance(value, int):
        return _varint(number << 3) + _varint(value)
    content = value.encode() if isinstance(value, str) else value
    return _varint(number << 3 | 2) + _varint(len(content)) + content


def _varint(value: int) -> bytes:
    found = bytearray()
    while value > 0x7F:
        found.append(value & 0x7F | 0x80)
        value >>= 7
    found.append(value)
    return bytes(found)
