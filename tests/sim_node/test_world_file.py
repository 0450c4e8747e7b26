import json

import numpy as np
import pytest

from nodes.sim_node.models.sources import Models
from nodes.sim_node.vision.view import camera_view
from nodes.sim_node.world_file import open_world
from schemas.errors import BadFile

SCENE = {
    "entities": [{"class": "Chair", "name": "chair9", "at": [1, 2, 0]}, {"class": "Cup", "at": [0, 0, 0]}]
}


def test_a_scene_in_json_is_a_world_with_furniture_of_its_own(tmp_path):
    path = tmp_path / "world.json"
    path.write_text(json.dumps(SCENE))
    bodies = {body.name: body for body in open_world(path, Models()).scene().bodies}
    assert {name: body.class_ for name, body in bodies.items()} == {"chair9": "Chair", "Cup_2": "Cup"}
    assert not any(body.entity for body in bodies.values())
    assert bodies["chair9"].model == "chair"
    assert bodies["chair9"].pose.position_m[:2] == pytest.approx((1.0, 2.0))


def test_its_camera_sees_all_of_it_from_near(tmp_path):
    path = tmp_path / "world.json"
    path.write_text(json.dumps(SCENE))
    world = open_world(path, Models())
    view = camera_view(world.model, world.data, "overview", 640, 480)
    for body in world.scene().bodies:
        seen = np.linalg.inv(view.map_from_camera) @ (*body.pose.position_m, 1.0)
        column, row, _ = view.intrinsics @ seen[:3] / seen[2]
        assert 0 < column < 640
        assert 0 < row < 480
        assert seen[2] < 5.0


@pytest.mark.parametrize(
    "content", ["{", '{"entities": [{"class": "Cup", "at": [0, 0]}]}', "<mujoco", "hello"]
)
def test_what_is_no_world_is_told(tmp_path, content):
    path = tmp_path / "world.json"
    path.write_text(content)
    with pytest.raises(BadFile, match=r"world\.json"):
        open_world(path, Models())


def test_a_missing_world_is_told(tmp_path):
    with pytest.raises(BadFile, match="cannot be read"):
        open_world(tmp_path / "none.xml", Models())
