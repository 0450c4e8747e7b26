import pytest

from semmap.nodes.extern.cli.detector_options import detector_settings
from semmap.schemas.errors import BadFile, BadRequest
from semmap.schemas.perception import LEAST_SCORE
from tests.perception_node.detection.models import write_model, yolov8

pytest.importorskip("onnxruntime")


@pytest.fixture
def model(tmp_path):
    return write_model(tmp_path / "m.onnx", {"output0": yolov8([(320, 320, 9, 9, 1, 0.9)])})


def test_paths_of_a_detector_are_absolute_for_the_nodes(model, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = tmp_path / "names.txt"
    names.write_text("\n".join(map(str, range(80))))
    relative = [path.relative_to(tmp_path) for path in (model, names)]
    assert detector_settings(*relative, None, None, perception=True) == {
        "detector": str(model),
        "detector_names": str(names),
        "detector_layout": "",
        "detector_score": LEAST_SCORE,
    }


def test_without_a_detector_there_are_no_settings(model):
    assert detector_settings(None, None, None, None, perception=False) == {}
    for options in ((None, None, "yolox", None), (None, None, None, 0.5)):
        with pytest.raises(BadRequest, match=r"requires --detector MODEL\.onnx"):
            detector_settings(*options, perception=True)
    with pytest.raises(BadRequest, match="--detector-score must be a number from 0 to 1"):
        detector_settings(model, None, None, float("nan"), perception=True)
    with pytest.raises(BadRequest, match="--detector requires --perception"):
        detector_settings(model, None, None, None, perception=False)


def test_a_model_that_cannot_be_used_is_reported_before_the_start(model):
    with pytest.raises(BadFile, match="its outputs are not of the layout yolox: output0 1 x 84 x 8400"):
        detector_settings(model, None, "yolox", None, perception=True)
