from dataclasses import replace

from semmap.nodes.perception_node.observer import Observer
from semmap.nodes.perception_node.pipeline import observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from tests.perception_node.scenes import shot


def test_cameras_that_stand_still_see_the_same_at_every_look():
    observer = Observer(shipped())
    clouds = [replace(cloud, camera=f"camera{n}") for n, cloud in enumerate(shot().clouds)]
    first, second = observer(clouds), observer(clouds)
    assert first.observations == second.observations == observe_clouds(clouds, shipped()).observations
    assert second.remembered.segments == ()
    assert not second.camera_moves
