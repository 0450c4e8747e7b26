from dataclasses import replace

from semmap.nodes.perception_node.pipeline import look
from semmap.nodes.perception_node.recognition.shipped_votes import shipped
from semmap.nodes.perception_node.watching import Watching
from tests.perception_node.scenes import shot


def test_cameras_that_stand_still_see_the_same_at_every_look():
    watching = Watching(shipped())
    clouds = [replace(cloud, camera=f"camera{n}") for n, cloud in enumerate(shot().clouds)]
    first, second = watching(clouds), watching(clouds)
    assert first.observations == second.observations == look(clouds, shipped()).observations
    assert second.remembered.segments == ()
    assert not second.on_the_move
