import numpy as np
import pytest

from semmap.nodes.perception_node.detection import model_input

RED = np.full((4, 8, 3), (200, 100, 50), np.uint8)


def test_yolo_pads_on_both_sides_with_grey_from_0_to_1():
    values, placement = model_input.YOLO.prepare(RED, 16, 16)
    assert values.shape == (1, 3, 16, 16)
    np.testing.assert_allclose(values[0, :, 8, 8], np.array([200, 100, 50]) / 255, atol=1e-6)
    np.testing.assert_allclose(values[0, :, [3, 12], 8], 114 / 255, atol=1e-6)
    assert placement == ((2.0, 2.0), (0, 4))
    values, placement = model_input.YOLO.prepare(RED.transpose(1, 0, 2), 16, 16)
    np.testing.assert_allclose(values[0, :, 8, [3, 12]], 114 / 255, atol=1e-6)
    np.testing.assert_allclose(values[0, 0, 8, 4:12], 200 / 255, atol=1e-6)
    assert placement == ((2.0, 2.0), (4, 0))


def test_yolox_pads_at_the_end_and_takes_bgr_from_0_to_255():
    values, placement = model_input.YOLOX.prepare(RED, 16, 16)
    assert values[0, :, 7, 8].tolist() == [50, 100, 200]
    assert values[0, :, 8, 8].tolist() == [114] * 3
    assert placement == ((2.0, 2.0), (0, 0))


def test_detr_stretches_and_rfdetr_also_normalises():
    values, placement = model_input.IMAGENET.prepare(RED, 16, 16)
    np.testing.assert_allclose(values[0, 0], (200 / 255 - 0.485) / 0.229, atol=1e-5)
    assert placement == ((2.0, 4.0), (0, 0))
    assert model_input.STRETCHED.prepare(RED, 16, 16)[0].max() == pytest.approx(200 / 255)


def test_boxes_in_the_input_are_converted_to_the_image():
    _, placement = model_input.YOLO.prepare(RED, 16, 16)
    np.testing.assert_allclose(placement.to_image(np.array([[2, 4, 16, 12]], np.float32)), [[1, 0, 8, 4]])
