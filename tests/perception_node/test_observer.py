from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.detector import detected
from semmap.nodes.perception_node.input.masks import DetectorLabel, Masks
from semmap.nodes.perception_node.observer import Observer
from semmap.nodes.perception_node.pipeline import observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.schemas.errors import BadFile
from tests.perception_node.scenes import shot


def test_cameras_that_stand_still_see_the_same_at_every_look():
    observer = Observer(shipped())
    clouds = [replace(cloud, camera=f"camera{n}") for n, cloud in enumerate(shot().clouds)]
    first, second = observer(clouds), observer(clouds)
    assert first.observations == second.observations == observe_clouds(clouds, shipped()).observations
    assert second.remembered.segments == ()
    assert not second.camera_moves


class Model:
    """A detector of spoons, which are everywhere."""

    file = "spoons.onnx"

    def __call__(self, colours):
        height, width = colours.shape[:2]
        return Masks(np.ones((height, width), np.int32), (DetectorLabel("spoon", 0.9),), alone=True)


def test_a_model_runs_on_the_clouds_without_masks():
    observer = Observer(shipped(), detector=Model())
    clouds = list(shot().clouds)
    own = Masks(np.zeros(clouds[0].points_camera.shape[:2], np.int32), (), alone=True)
    both = observer(clouds).observations.observations
    assert {one.labelled for one in both} == {True}
    assert observer(clouds, [own, own]).observations.observations == ()


def test_a_model_needs_an_image():
    (cloud, _) = shot().clouds
    with pytest.raises(BadFile, match=r"spoons.onnx needs a colour image, and the cloud has no colours"):
        detected(Model(), replace(cloud, colors=None))
    row = cloud.points_camera.reshape(1, -1, 3)
    flat = replace(cloud, points_camera=row, colors=cloud.colors.reshape(1, -1, 3))
    with pytest.raises(BadFile, match="has no rows and columns of an image; remove --detector"):
        detected(Model(), flat)


@pytest.mark.parametrize(
    ("failure", "reason"),
    [
        (BadFile("spoons.onnx: it failed"), "spoons.onnx: it failed"),
        (IndexError("index 7"), "spoons.onnx failed: IndexError: index 7"),
    ],
)
def test_a_frame_is_processed_without_a_detector_that_fails(failure, reason):
    class Failing(Model):
        def __call__(self, colours):
            raise failure

    clouds = list(shot().clouds)
    found = Observer(shipped(), detector=Failing())(clouds)
    assert found.observations == Observer(shipped())(clouds).observations
    assert found.failures == tuple(
        f"camera {cloud.camera}: {reason}; objects are found without the detector" for cloud in clouds
    )
