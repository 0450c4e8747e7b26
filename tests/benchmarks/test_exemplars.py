"""Things shown once and looked for, with two made here."""

import json

import numpy as np
import trimesh
from PIL import Image

from benchmarks.perception.exemplars import measure
from semmap.nodes.perception_node.pipeline import shipped

THINGS = {"carton": ((0.12, 0.08, 0.2), (200, 30, 30)), "crate": ((0.3, 0.2, 0.12), (30, 60, 200))}


def test_what_was_shown_is_found_and_nothing_else_is_called_so(tmp_path):
    told = []
    for name, (size_m, colour) in THINGS.items():
        mesh = trimesh.creation.box(size_m)
        mesh.visual = trimesh.visual.TextureVisuals(
            uv=mesh.vertices[:, :2] / 0.2 + 0.5,
            image=Image.fromarray(np.full((8, 8, 3), colour, np.uint8)),
        )
        (tmp_path / name).mkdir()
        mesh.export(tmp_path / name / "model.obj")
        one = {"name": name, "file": f"{name}/model.obj", "classes": ["Box"], "new": False}
        told.append(one | {"size_m": size_m, "group": "made", "use": "measure only"})
    (tmp_path / "things.json").write_text(json.dumps(told))
    rows = {row.what: row.value for row in measure(tmp_path, 2, shipped())}
    assert rows["shown once, recognised among 20"] == rows["all 2 shown at once: recognised"] == 1.0
    assert rows["shown once: others called so, a look"] == 0.0


def test_without_things_there_are_no_rows(tmp_path, capsys):
    assert measure(tmp_path, 2, shipped()) == []
    assert "holds no things" in capsys.readouterr().out
