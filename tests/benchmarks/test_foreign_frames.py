"""Frames of other people's meshes, with one made here: what is written is what perception reads."""

import json

import numpy as np
import pytest
import trimesh
from PIL import Image

from benchmarks.perception.foreign_frames import write_frame
from semmap.nodes.perception_node.input.files.frame_folders import read_frame
from semmap.nodes.training.scenes.foreign_things import foreign_things
from semmap.nodes.training.scenes.textured_scenes import Studio, scenes

SIZE_M = (0.12, 0.08, 0.2)


@pytest.fixture
def things(tmp_path):
    mesh = trimesh.creation.box(SIZE_M)
    mesh.visual = trimesh.visual.TextureVisuals(
        uv=mesh.vertices[:, :2] / 0.2 + 0.5,
        image=Image.fromarray(np.full((8, 8, 3), (200, 30, 30), np.uint8)),
    )
    mesh.apply_translation((1.0, 0.0, 0.0))  # it need not lie about its own origin
    (tmp_path / "carton").mkdir()
    mesh.export(tmp_path / "carton" / "model.obj")
    told = {"name": "carton", "file": "carton/model.obj", "classes": ["Box"], "new": False}
    told |= {"size_m": SIZE_M, "group": "made", "use": "measure only"}
    (tmp_path / "things.json").write_text(json.dumps([told]))
    return foreign_things(tmp_path)


def test_a_mesh_becomes_a_frame_with_its_truth(tmp_path, things):
    rng = np.random.default_rng(1)
    ((kind, stood),) = scenes(things, 1, 0, rng)
    write_frame(tmp_path / "0000", Studio().shoot(stood, 1.0, rng), kind, "near", stood)
    (told,) = json.loads((tmp_path / "0000" / "truth.json").read_text())["objects"]
    assert (told["name"], told["fits"]) == ("carton", ["Box"])
    mask = np.asarray(Image.open(tmp_path / "0000" / "mask.png")) == 1
    assert told["pixels"] == mask.sum() > 1000
    frame = read_frame(tmp_path / "0000")
    assert (frame.shape, frame.step) == (mask.shape, 1)
    points = frame.cloud.points_camera[mask]
    turn, at = frame.cloud.map_from_camera[:3, :3], frame.cloud.map_from_camera[:3, 3]
    top = np.nanquantile((points @ turn.T + at)[:, 2], 0.99)
    assert top == pytest.approx(stood[0].z + SIZE_M[2], abs=0.02)
    red, green, blue = np.median(frame.cloud.colors[mask], axis=0)
    assert red > 2 * green
    assert red > 2 * blue
