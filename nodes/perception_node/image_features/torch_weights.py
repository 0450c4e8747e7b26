"""Reads a file of PyTorch weights in the format before version 1.6, without PyTorch."""

from __future__ import annotations

import pickle
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import as_strided
from numpy.typing import NDArray

from semmap.schemas.errors import BadFile

Arrays = dict[str, NDArray[np.float32]]

_MAGIC = 0x1950A86A20F9469CFC6C
_HEADERS = 3
"""The pickles before the weights: a magic number, the version, and the sizes of integers."""


@dataclass(frozen=True)
class _Tensor:
    """A tensor without its values: its storage (None for integers), and where in it they are."""

    storage: str | None
    first: int
    shape: tuple[int, ...]
    strides: tuple[int, ...]


class _Unpickler(pickle.Unpickler):
    """Permits only dictionaries and tensors, since a pickle can otherwise run any code."""

    def find_class(self, module: str, name: str) -> Any:
        """Return the replacement of a permitted name. Raises UnpicklingError for all others."""
        found = _PERMITTED.get((module, name))
        if found is None:
            raise pickle.UnpicklingError(f"{module}.{name} is not permitted in a file of weights")
        return found

    def persistent_load(self, pid: Any) -> str | None:
        """Return the key of a storage of floats, None for other storages."""
        _, kind, key, *_ = pid
        return str(key) if kind == "FloatStorage" else None


def _rebuild_tensor(
    storage: str | None, first: int, shape: Sequence[int], strides: Sequence[int], *_: object
) -> _Tensor:
    return _Tensor(storage, first, tuple(shape), tuple(strides))


_PERMITTED: dict[tuple[str, str], Any] = {
    ("collections", "OrderedDict"): OrderedDict,
    ("torch._utils", "_rebuild_tensor_v2"): _rebuild_tensor,
    ("torch", "FloatStorage"): "FloatStorage",
    ("torch", "LongStorage"): "LongStorage",
}


def read_weights(content: bytes) -> Arrays:
    """Return the arrays of floats by name. Raises BadFile for content that is not such a file."""
    try:
        return _read(BytesIO(content))
    except (pickle.UnpicklingError, EOFError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise BadFile(f"invalid file of weights: {error}") from None


def _read(file: BytesIO) -> Arrays:
    headers = [_Unpickler(file).load() for _ in range(_HEADERS)]
    if headers[0] != _MAGIC:
        raise ValueError("unknown format")
    tensors = _Unpickler(file).load()
    storages: dict[str, NDArray[np.float32]] = {}
    floats = {tensor.storage for tensor in tensors.values()}
    for key in _Unpickler(file).load():
        count = int.from_bytes(file.read(8), "little")
        size = 4 if key in floats else 8
        data = file.read(size * count)
        if key in floats:
            storages[key] = np.frombuffer(data, "<f4", count)
    return {
        name: _values(tensor, storages[tensor.storage])
        for name, tensor in tensors.items()
        if tensor.storage is not None
    }


def _values(tensor: _Tensor, storage: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return a tensor's values. Raises ValueError if the storage is too small."""
    steps = (step * (size - 1) for step, size in zip(tensor.strides, tensor.shape, strict=True))
    if min(tensor.first, *tensor.strides, *tensor.shape, 0) < 0 or tensor.first + sum(steps) >= len(storage):
        raise ValueError("a tensor is larger than its storage")
    strides = [4 * step for step in tensor.strides]
    return np.ascontiguousarray(as_strided(storage[tensor.first :], tensor.shape, strides, writeable=False))
