import pytest

from semmap.nodes.perception_node.detection.class_names import (
    COCO_80,
    COCO_91,
    coco_names,
    names_of,
    read_names,
)
from semmap.schemas.errors import BadFile


def test_the_numbers_of_coco():
    assert len(COCO_80) == len(set(COCO_80)) == 80
    assert (COCO_80[0], COCO_80[41], COCO_80[79]) == ("person", "cup", "toothbrush")
    assert (COCO_91[1], COCO_91[13], COCO_91[47], COCO_91[90]) == ("person", "stop sign", "cup", "toothbrush")
    assert COCO_91[12] == COCO_91[83] == ""


@pytest.mark.parametrize(("classes", "names"), [(0, COCO_80), (81, COCO_80), (91, COCO_91), (92, COCO_91)])
def test_a_model_of_coco_may_have_one_class_more(classes, names):
    assert coco_names(classes) == names


def test_names_come_from_the_user_then_the_model_then_coco():
    metadata = {"names": "['mug', 'jug']"}
    assert names_of(("a", "b"), metadata, 2, "m.onnx") == ("a", "b")
    assert names_of(None, metadata, 2, "m.onnx") == ("mug", "jug")
    assert names_of(None, {"names": "{1: 'jug'}"}, 2, "m.onnx") == ("", "jug")
    assert names_of(None, {}, 91, "m.onnx") == COCO_91
    assert names_of(("a", "b"), {}, 3, "m.onnx") == ("a", "b")  # the last class is of no thing


@pytest.mark.parametrize(
    "text", ["", "__import__('os')", "{'a': 1}", "[" * 500, "{0: 'cup'", "{1000000000: 'cup'}"]
)
def test_a_model_without_readable_names_needs_a_file(text):
    with pytest.raises(BadFile, match=r"m.onnx does not name its 7 classes; add --detector-names FILE\.txt"):
        names_of(None, {"names": text}, 7, "m.onnx")


def test_as_many_names_as_classes_are_needed(tmp_path):
    with pytest.raises(BadFile, match=r"m.onnx has 80 classes, but there are 2 names"):
        names_of(("a", "b"), {}, 80, "m.onnx")
    (tmp_path / "empty.txt").write_text("\n\n")
    with pytest.raises(BadFile, match="is empty"):
        read_names(tmp_path / "empty.txt")
    with pytest.raises(BadFile, match="cannot be read"):
        read_names(tmp_path / "absent.txt")
