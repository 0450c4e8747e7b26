"""A detector's model: the layouts of the real exports, with constant outputs."""

import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from semmap.nodes.perception_node.detection.detector_model import DetectorModel
from semmap.nodes.perception_node.input.masks import Masks
from semmap.schemas.errors import BadFile
from tests.perception_node.detection.models import write_model, yolov8

pytest.importorskip("onnxruntime")

IMAGE = np.zeros((480, 640, 3), np.uint8)
CUP, BOOK = 41, 73
"""Numbers of classes among the 80 of COCO."""
BOX = (270, 210, 370, 270)
"""Where the cup is in the image."""
PADDED = (320.0, 320.0, 100.0, 60.0)
"""Its middle and size in an input of 640 x 640 that is padded on both sides; 80 pixels higher in a corner."""
STRETCHED = (320.0, 320.0, 100.0, 80.0)


def found_by(path, *args: Any) -> tuple[str, Masks]:
    model = DetectorModel(path, *args)
    return model.layout, model(IMAGE)


def yolox(*, raw: bool) -> np.ndarray:
    """Return predictions (1, 8400, 85) of the cup, in the coarsest grid if they are not decoded."""
    rows = np.zeros((1, 8400, 85), np.float32)
    sides = [80, 40, 20]
    cells = np.concatenate([np.indices((side, side))[::-1].reshape(2, -1).T for side in sides])
    strides = np.repeat([8, 16, 32], [side**2 for side in sides])
    x, y, w, h = PADDED[0], PADDED[1] - 80, *PADDED[2:]
    if raw:
        rows[0, -1, :4] = x / 32 - 19, y / 32 - 19, np.log(w / 32), np.log(h / 32)
    else:
        rows[0, :, :2] = cells * strides[:, None]
        rows[0, -1, :4] = x, y, w, h
    rows[0, -1, 4], rows[0, -1, 5 + CUP] = 0.9, 1.0
    return rows


def queries(columns: int, count: int = 300) -> np.ndarray:
    return np.zeros((1, count, columns), np.float32)


def shares(**more: Any) -> np.ndarray:
    boxes = queries(4)
    boxes[0, 7] = np.array(STRETCHED) / 640
    return boxes


def logits(columns: int, kind: int) -> np.ndarray:
    scores = np.full((1, 300, columns), -9.0, np.float32)
    scores[0, 7, kind] = np.log(0.9 / 0.1)
    return scores


def selected(*, whole: bool) -> dict[str, np.ndarray]:
    labels, boxes, scores = np.zeros((1, 300)), queries(4), np.zeros((1, 300), np.float32)
    labels[0, 3], scores[0, 3] = CUP, 0.9
    x, y, w, h = STRETCHED
    boxes[0, 3] = x - w / 2, y - h / 2, x + w / 2, y + h / 2
    return {"labels": labels.astype(np.int64 if whole else np.float32), "boxes": boxes, "scores": scores}


def yolo_nms() -> np.ndarray:
    rows = queries(6)
    x, y, w, h = PADDED
    rows[0, 0] = x - w / 2, y - h / 2, x + w / 2, y + h / 2, 0.9, CUP
    return rows


def yolov5() -> np.ndarray:
    rows = np.zeros((1, 25200, 85), np.float32)
    rows[0, 5, :5], rows[0, 5, 5 + CUP] = (*PADDED, 0.9), 1.0
    return rows


def ultralytics() -> np.ndarray:
    rows = queries(84)
    rows[0, 7, :4], rows[0, 7, 4 + CUP] = np.array(STRETCHED) / 640, 0.9
    return rows


PIXEL_VALUES = ("pixel_values", ("n", 3, 640, 640))
LAYOUTS = {
    "yolov8": ({"output0": yolov8([(*PADDED, CUP, 0.9)])}, {}),
    "yolo-nms": ({"output0": yolo_nms()}, {}),
    "yolov5": ({"output0": yolov5()}, {}),
    "yolox": ({"output": yolox(raw=True)}, {}),
    "rtdetr": (selected(whole=True), {"sizes": "orig_target_sizes"}),
    "rtdetr-logits": ({"logits": logits(80, CUP), "pred_boxes": shares()}, {"images": PIXEL_VALUES}),
    "rtdetr-ultralytics": ({"output0": ultralytics()}, {}),
    "rfdetr": ({"dets": shares(), "labels": logits(91, 47)}, {"images": ("input", (1, 3, 640, 640))}),
}
"""The outputs and inputs of a model for each layout; it sees a cup in `BOX`."""


def test_every_layout_has_a_test():
    from semmap.nodes.perception_node.detection import layouts
    from semmap.schemas.perception import DETECTOR_LAYOUTS

    assert list(LAYOUTS) == list(DETECTOR_LAYOUTS) == [layout.name for layout in layouts.LAYOUTS]


@pytest.mark.parametrize("name", LAYOUTS)
def test_a_layout_is_recognised_and_its_box_is_found(name, tmp_path):
    outputs, inputs = LAYOUTS[name]
    path = write_model(tmp_path / "model.onnx", outputs, **inputs)
    names = "coco" if name in ("yolo-nms", "rtdetr") else None  # the others have as many classes as COCO
    layout, masks = found_by(path, names)
    assert layout == name
    assert masks.boxes == (BOX,)
    (label,) = masks.detector_labels
    assert (label.label, round(label.score, 3)) == ("cup", 0.9)


def test_boxes_of_yolox_may_be_decoded_already(tmp_path):
    layout, masks = found_by(write_model(tmp_path / "model.onnx", {"output": yolox(raw=False)}))
    assert (layout, masks.boxes) == ("yolox", (BOX,))


def test_a_segmenter_gives_masks_inside_of_its_boxes(tmp_path):
    in_the_padding, beside = (320.0, 40.0, 100.0, 60.0), (-100.0, 320.0, 50.0, 60.0)
    found = [(*PADDED, CUP, 0.9), (*in_the_padding, CUP, 0.8), (*beside, CUP, 0.7)]
    boxes = yolov8(found, classes=80 + 32)
    boxes[0, 84, 0] = 1.0  # the weight of the first prototype
    protos = np.full((1, 32, 160, 160), -5.0, np.float32)
    protos[0, 0, 40:80, :] = 5.0  # rows 160 to 319 of the input, 80 to 239 of the image
    layout, masks = found_by(write_model(tmp_path / "seg.onnx", {"output0": boxes, "output1": protos}))
    rows, columns = np.nonzero(masks.labels == 1)
    assert (layout, masks.boxes) == ("yolov8", ())
    assert (columns.min(), rows.min(), columns.max() + 1) == BOX[:3]
    assert abs(rows.max() + 1 - 240) <= 2
    assert (len(masks.detector_labels), masks.labels.max()) == (3, 1)


def test_a_segmenter_may_select_its_things_itself(tmp_path):
    rows = np.concatenate([yolo_nms(), queries(32)], axis=2)
    rows[0, 0, 6] = 1.0
    protos = np.full((1, 32, 160, 160), 5.0, np.float32)
    layout, masks = found_by(write_model(tmp_path / "seg.onnx", {"output0": rows, "output1": protos}), "coco")
    assert layout == "yolo-nms"
    assert np.argwhere(masks.labels).min(axis=0).tolist() == [BOX[1], BOX[0]]
    assert np.count_nonzero(masks.labels) == 100 * 60


def test_a_model_for_another_task_is_rejected_though_its_shape_fits(tmp_path):
    rows = {"output0": yolov8([(*PADDED, 1, 0.9)], classes=3)}
    path = write_model(tmp_path / "m.onnx", rows, metadata={"names": "['a', 'b']", "task": "obb"})
    with pytest.raises(BadFile, match="it was trained for the task 'obb'; use a model for detection"):
        DetectorModel(path)


def test_masks_of_rfdetr_cover_the_whole_input(tmp_path):
    masks = np.full((1, 300, 40, 40), -5.0, np.float32)
    masks[0, 7, :, 20:] = 5.0
    outputs = {"dets": shares(), "labels": logits(91, 47), "masks": masks}
    _, found = found_by(write_model(tmp_path / "seg.onnx", outputs))
    rows, columns = np.nonzero(found.labels)
    assert (rows.min(), columns.max() + 1, rows.max() + 1) == BOX[1:]
    assert abs(columns.min() - 320) <= 2


def test_a_layout_may_be_named_and_must_fit(tmp_path):
    path = write_model(tmp_path / "m.onnx", {"boxes": shares(), "classes": logits(80, CUP)})
    shapes = "boxes 1 x 300 x 4 and classes 1 x 300 x 80"
    with pytest.raises(BadFile, match=f"its outputs may be rtdetr-logits and rfdetr: {shapes}"):
        DetectorModel(path)
    assert found_by(path, None, "rfdetr")[1].boxes == (BOX,)
    with pytest.raises(BadFile, match=f"its outputs are not of the layout yolox: {shapes}; known"):
        DetectorModel(path, None, "yolox")


def test_unknown_outputs_are_named_with_their_shapes_and_the_layouts(tmp_path):
    path = write_model(tmp_path / "m.onnx", {"a": np.zeros((1, 5, 7)), "b": np.zeros((1, 2))})
    with pytest.raises(BadFile) as error:
        DetectorModel(path)
    assert error.value.text == (
        f"{path}: its outputs are of no known layout: a 1 x 5 x 7 and b 1 x 2; known layouts: yolov8,"
        " yolo-nms, yolov5, yolox, rtdetr, rtdetr-logits, rtdetr-ultralytics, rfdetr (--detector-layout)"
    )


def test_an_input_of_any_size_is_640_pixels_wide(tmp_path):
    images = ("images", ("n", 3, "height", "width"))
    path = write_model(tmp_path / "m.onnx", LAYOUTS["yolov8"][0], images=images)
    assert found_by(path)[1].boxes == (BOX,)


def test_other_inputs_and_other_files_are_rejected(tmp_path):
    grey = write_model(tmp_path / "grey.onnx", LAYOUTS["yolov8"][0], images=("x", (1, 1, 640, 640)))
    with pytest.raises(
        BadFile, match=r"its inputs are x 1 x 1 x 640 x 640 of tensor\(float\); a detector takes"
    ):
        DetectorModel(grey)
    (tmp_path / "text.onnx").write_text("hello")
    with pytest.raises(BadFile, match=r"text\.onnx is not a valid ONNX model: "):
        DetectorModel(tmp_path / "text.onnx")
    with pytest.raises(BadFile, match="there is no file"):
        DetectorModel(tmp_path / "absent.onnx")


def test_several_images_are_in_work_at_once(tmp_path):
    model = DetectorModel(write_model(tmp_path / "m.onnx", LAYOUTS["yolov8"][0]))
    together, run = threading.Barrier(2, timeout=60), model._session.run

    class Session:
        def __getattr__(self, name):
            return getattr(model_session, name)

        def run(self, *given):
            together.wait()  # a broken barrier if one image waits for the other
            return run(*given)

    model_session, model._session = model._session, Session()
    with ThreadPoolExecutor(2) as threads:
        assert [found.boxes for found in threads.map(model, [IMAGE, IMAGE])] == [(BOX,)] * 2


def test_weak_detections_are_left_out(tmp_path):
    rows = yolov8([(*PADDED, CUP, 0.4), (100.0, 200.0, 50.0, 50.0, BOOK, 0.2)])
    path = write_model(tmp_path / "m.onnx", {"output0": rows})
    assert len(found_by(path)[1].boxes) == 1
    assert len(found_by(path, None, "", 0.1)[1].boxes) == 2
    assert not found_by(path, None, "", 0.5)[1].boxes


def test_names_are_those_of_the_model_or_of_a_file(tmp_path):
    rows = {"output0": yolov8([(*PADDED, 1, 0.9)], classes=2)}
    path = write_model(tmp_path / "m.onnx", rows, metadata={"names": "{0: 'drill', 1: 'power drill'}"})
    assert found_by(path)[1].detector_labels[0].label == "power drill"
    (tmp_path / "names.txt").write_text("a\nhand saw\n\n")
    assert found_by(path, tmp_path / "names.txt")[1].detector_labels[0].label == "hand saw"
