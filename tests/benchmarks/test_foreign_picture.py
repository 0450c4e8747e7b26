"""The contact sheet of foreign things: each one is on it once, and the results are counted."""

import json

import numpy as np
import pytest
import trimesh

from benchmarks.perception.foreign_picture import ACROSS, TABLES, drawn, tables
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.training.scenes.foreign_things import foreign_things

SIZE_M = (0.12, 0.08, 0.2)


@pytest.fixture
def things(tmp_path):
    trimesh.creation.box(SIZE_M).export(tmp_path / "model.obj")
    told = {"file": "model.obj", "classes": ["Bottle"], "new": False, "size_m": SIZE_M}
    told |= {"group": "made", "use": "measure and train"}
    (tmp_path / "things.json").write_text(json.dumps([told | {"name": f"box{n}"} for n in range(40)]))
    return foreign_things(tmp_path)


def test_each_thing_is_on_a_table_once_and_none_in_another(things):
    found = tables(things, np.random.default_rng(1))
    assert len(found) == TABLES
    assert sorted(one.thing.name for stood in found for one in stood) == sorted(t.name for t in things)
    for stood in found:
        at = np.array([(one.x, one.y) for one in stood])
        apart = np.linalg.norm(at[:, None] - at, axis=-1)[np.triu_indices(len(at), 1)]
        assert apart.min() > min(SIZE_M[:2])


def test_what_came_of_each_is_counted_and_shown_in_its_colour(things):
    picture, total = drawn(shipped(), things[:2], seed=1)
    assert total.total() == 2
    assert not total["exact"]  # a box is not a bottle
    pixels = np.asarray(picture)
    assert pixels.shape[1] % ACROSS == 0
    assert (pixels[:, -pixels.shape[1] // ACROSS :][:300] == 255).all()  # two tables, and no third
