import numpy as np
import pytest

from semmap.nodes.perception_node.image_features.onnx_model import model, node


def test_an_operator_is_encoded_as_protocol_buffers():
    assert node("Add", ["a", "b"], "c") == b"\x0a\x01a\x0a\x01b\x12\x01c\x22\x03Add"
    flag = b"\x0a\x05group\x18\xac\x02\xa0\x01\x02"
    assert node("Conv", [], "c", group=300).endswith(b"\x2a" + bytes([len(flag)]) + flag)


def test_a_model_is_run_as_it_was_written():
    onnxruntime = pytest.importorskip("onnxruntime")
    nodes = [
        node("Conv", ["image", "w"], "sums", strides=(1, 2), group=2, auto_pad="SAME_UPPER"),
        node("Clip", ["sums", "low", "high"], "out"),
    ]
    constants = {
        "w": np.ones((2, 1, 3, 3), np.float32),
        "low": np.array(0.0, np.float32),
        "high": np.array(6.0, np.float32),
    }
    content = model(nodes, constants, {"image": ("n", 2, 4, 4)}, {"out": ("n", 2, 4, 2)})
    session = onnxruntime.InferenceSession(content, providers=["CPUExecutionProvider"])
    image = np.stack([np.ones((4, 4)), -np.ones((4, 4))])[None].astype(np.float32)
    (found,) = session.run(None, {"image": image})
    # the stride of 2 needs one column of padding, on the right
    np.testing.assert_array_equal(found, [[[[6, 4], [6, 6], [6, 6], [6, 4]], np.zeros((4, 2))]])
