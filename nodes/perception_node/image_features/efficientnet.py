"""EfficientNet-Lite0 as an ONNX model, from the weights of its PyTorch version.

Tan and Le, 2019; the Lite versions have no squeeze-and-excitation, and ReLU6 as activation.
"""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.image_features.onnx_model import model, node
from semmap.nodes.perception_node.image_features.torch_weights import Arrays

SIDE = 224
"""Width and height of its input [pixel]."""

FEATURES, CLASSES = 1280, 1000

_STAGES = (
    (3, 1, 1, 1),
    (3, 2, 6, 2),
    (5, 2, 6, 2),
    (3, 2, 6, 3),
    (5, 1, 6, 3),
    (5, 2, 6, 4),
    (3, 1, 6, 1),
)
"""Of each stage: the size of its kernels, the stride of its first block, the expansion, and its blocks."""

_EPSILON = 1e-3


def onnx_of(weights: Arrays) -> bytes:
    """Return the model: `images` (N, 3, SIDE, SIDE) to `features` (N, FEATURES) and `scores` (N, CLASSES).

    The scores are of the classes of ImageNet. Raises KeyError for weights of another network.
    """
    graph = _Graph(weights)
    last = graph.convolve("images", "_conv_stem", "_bn0", stride=2)
    block = 0
    for kernel, stride, expansion, count in _STAGES:
        for n in range(count):
            last = graph.add_block(last, f"_blocks.{block}.", kernel, stride if n == 0 else 1, expansion)
            block += 1
    last = graph.convolve(last, "_conv_head", "_bn1")
    graph.nodes.append(node("GlobalAveragePool", [last], "pooled"))
    graph.nodes.append(node("Flatten", ["pooled"], "features"))
    graph.constants |= {"fc.weight": weights["_fc.weight"], "fc.bias": weights["_fc.bias"]}
    graph.nodes.append(node("Gemm", ["features", "fc.weight", "fc.bias"], "scores", transB=1))
    return model(
        graph.nodes,
        graph.constants,
        {"images": ("n", 3, SIDE, SIDE)},
        {"features": ("n", FEATURES), "scores": ("n", CLASSES)},
    )


class _Graph:
    """The nodes and constants so far."""

    def __init__(self, weights: Arrays) -> None:
        self._weights = weights
        self.nodes: list[bytes] = []
        self.constants: Arrays = {"0": np.array(0.0, np.float32), "6": np.array(6.0, np.float32)}

    def add_block(self, last: str, block: str, kernel: int, stride: int, expansion: int) -> str:
        """Add an inverted residual block and return its output."""
        first = last
        norms = iter(("_bn0", "_bn1", "_bn2") if expansion > 1 else ("_bn1", "_bn2"))
        if expansion > 1:
            last = self.convolve(last, f"{block}_expand_conv", block + next(norms))
        last = self.convolve(last, f"{block}_depthwise_conv", block + next(norms), stride=stride, each=True)
        project = f"{block}_project_conv"
        last = self.convolve(last, project, block + next(norms), active=False)
        out, wide = self._weights[f"{project}.weight"].shape[:2]
        if stride == 1 and wide == expansion * out:
            self.nodes.append(node("Add", [first, last], f"{block}sum"))
            last = f"{block}sum"
        return last

    def convolve(
        self, last: str, name: str, norm: str, *, stride: int = 1, each: bool = False, active: bool = True
    ) -> str:
        """Add a convolution of all channels, or of each by itself, with its normalisation and activation."""
        w = self._weights
        scale = w[f"{norm}.weight"] / np.sqrt(w[f"{norm}.running_var"] + _EPSILON)
        kernels = w[f"{name}.weight"]
        self.constants[f"{name}.weight"] = kernels * scale[:, None, None, None]
        self.constants[f"{name}.bias"] = w[f"{norm}.bias"] - w[f"{norm}.running_mean"] * scale
        self.nodes.append(
            node(
                "Conv",
                [last, f"{name}.weight", f"{name}.bias"],
                name,
                strides=(stride, stride),
                group=len(kernels) if each else 1,
                auto_pad="SAME_UPPER",
            )
        )
        if not active:
            return name
        self.nodes.append(node("Clip", [name, "0", "6"], f"{name}.active"))
        return f"{name}.active"
