import io
import os
import pickle
import sys
from collections import OrderedDict
from types import ModuleType

import numpy as np
import pytest

from semmap.nodes.perception_node.image_features.torch_weights import read_weights
from semmap.schemas.errors import BadFile

MAGIC = 0x1950A86A20F9469CFC6C


class Tensor:
    """A tensor as PyTorch writes it: a part of a storage."""

    def __init__(self, key, first, shape, strides, kind="FloatStorage"):
        self.kind, self.args = kind, (key, first, shape, strides, False, OrderedDict())

    def __reduce__(self):
        key, *rest = self.args
        return sys.modules["torch._utils"]._rebuild_tensor_v2, (Storage(self.kind, key), *rest)


class Storage:
    def __init__(self, kind, key):
        self.kind, self.key = kind, key


class Pickler(pickle.Pickler):
    def persistent_id(self, obj):
        if isinstance(obj, Storage):
            return ("storage", getattr(sys.modules["torch"], obj.kind), obj.key, "cpu", 6, None)
        return None


@pytest.fixture
def write(monkeypatch):
    """A function that writes tensors and storages as PyTorch did before version 1.6."""
    torch, utils = ModuleType("torch"), ModuleType("torch._utils")
    for kind in ("FloatStorage", "LongStorage"):
        setattr(torch, kind, type(kind, (), {"__module__": "torch", "__qualname__": kind}))

    def rebuild(*_):
        raise AssertionError

    rebuild.__module__, rebuild.__qualname__ = "torch._utils", "_rebuild_tensor_v2"
    utils._rebuild_tensor_v2 = rebuild
    monkeypatch.setitem(sys.modules, "torch", torch)
    monkeypatch.setitem(sys.modules, "torch._utils", utils)

    def written(tensors, storages, magic=MAGIC):
        file = io.BytesIO()
        for header in (magic, 1001, {"little_endian": True}):
            pickle.dump(header, file, 2)
        Pickler(file, 2).dump(OrderedDict(tensors))
        pickle.dump(list(storages), file, 2)
        for values in storages.values():
            file.write(len(values).to_bytes(8, "little") + values.tobytes())
        return file.getvalue()

    return written


def test_tensors_are_read_with_their_strides_and_integers_are_left_out(write):
    values = np.arange(6, dtype=np.float32)
    tensors = {
        "turned": Tensor("1", 0, (3, 2), (1, 3)),
        "count": Tensor("0", 0, (), (), "LongStorage"),
        "part": Tensor("1", 4, (2,), (1,)),
    }
    found = read_weights(write(tensors, {"0": np.array([7], np.int64), "1": values}))
    assert set(found) == {"turned", "part"}
    np.testing.assert_array_equal(found["turned"], [[0, 3], [1, 4], [2, 5]])
    np.testing.assert_array_equal(found["part"], [4, 5])


def test_a_tensor_beyond_its_storage_is_rejected(write):
    with pytest.raises(BadFile, match="larger than its storage"):
        read_weights(write({"w": Tensor("1", 4, (3,), (1,))}, {"1": np.zeros(6, np.float32)}))


class Harmful:
    def __reduce__(self):
        return os.getcwd, ()


@pytest.mark.parametrize("content", [b"", b"no weights", pickle.dumps(3), pickle.dumps([1, 2])])
def test_other_files_are_rejected(content):
    with pytest.raises(BadFile, match="invalid file of weights"):
        read_weights(content)


def test_code_in_a_file_is_not_run():
    with pytest.raises(BadFile, match=r"getcwd is not permitted"):
        read_weights(pickle.dumps(Harmful()))


def test_a_file_of_another_format_is_rejected(write):
    with pytest.raises(BadFile, match="unknown format"):
        read_weights(write({}, {}, magic=1))
