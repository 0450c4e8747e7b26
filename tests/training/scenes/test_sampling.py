import json
from collections import Counter

import numpy as np
import pytest
import trimesh
from PIL import Image

from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.parts import bounds
from semmap.nodes.training.scenes.distractors import _lump, distractor_parts, size_of
from semmap.nodes.training.scenes.families.table import FAMILIES
from semmap.nodes.training.scenes.foreign_things import foreign_things, texture_of
from semmap.nodes.training.scenes.sampling import SMALL, of_model, small_things
from semmap.nodes.training.scenes.simulated_scenes import DISTRACTOR, foreign_class, tinted
from semmap.nodes.training.scenes.varieties import VARIETIES, any_size, carton, is_like_another


@pytest.fixture
def folder(tmp_path):
    told = [
        {
            "name": name,
            "file": f"{name}/model.obj",
            "classes": ["Ball"],
            "new": new,
            "size_m": [0.1, 0.1, 0.1],
        }
        | {"group": "made", "use": use}
        for name, new, use in [("mine", False, "measure and train"), ("odd", True, "measure only")]
    ]
    for thing in told:
        mesh = trimesh.creation.icosphere(subdivisions=1, radius=0.05)
        mesh.apply_translation([0.0, 0.0, 0.05])
        (tmp_path / thing["name"]).mkdir()
        mesh.export(tmp_path / thing["file"])
    (tmp_path / "things.json").write_text(json.dumps(told))
    return tmp_path


def test_foreign_things_are_those_of_their_table(folder, tmp_path):
    mine, odd = foreign_things(folder)
    assert (mine.name, mine.classes, mine.new, mine.learnable) == ("mine", ("Ball",), False, True)
    assert (odd.new, odd.learnable) == (True, False)
    assert foreign_things(tmp_path / "nowhere") == []


def test_there_are_things_of_all_sorts_and_each_can_be_built(folder):
    lot = small_things(foreign_things(folder), np.random.default_rng(0))
    things = [lot() for _ in range(300)]
    labels = Counter(thing.label for thing in things)
    assert labels[DISTRACTOR] > 20
    assert labels["mine@Ball"] > 5
    assert labels["odd@"] > 5
    families = {family.kind for family in FAMILIES}
    assert set(labels) - {DISTRACTOR, "mine@Ball", "odd@"} <= {*MODELS, *families}
    assert sum(labels[kind] for kind in families) > 50
    assert sum(thing.form is None for thing in things) > 80
    for thing in things[:60]:
        assert tinted(thing).parts


def test_a_texture_has_the_colours_of_the_picture_where_they_are(tmp_path):
    image = np.zeros((8, 8, 3), np.uint8)
    image[:4], image[4:] = (250, 10, 10), (10, 10, 250)  # red above, blue below
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.05)
    up = (ball.vertices[:, 2] / 0.05 + 1.0) / 2.0
    material = trimesh.visual.material.SimpleMaterial(image=Image.fromarray(image))
    ball.visual = trimesh.visual.TextureVisuals(uv=np.column_stack([up * 0.0 + 0.5, up]), material=material)
    ball.export(tmp_path / "ball.obj")
    pattern = texture_of(tmp_path / "ball.obj")
    assert pattern is not None
    above, below = pattern(np.array([[0.0, 0.0, 0.9], [0.0, 0.0, -0.9]], np.float32))
    assert above[0] > 0.9 > 0.1 > above[2]
    assert below[2] > 0.9 > 0.1 > below[0]


def test_a_thing_without_a_texture_keeps_none(folder):
    mine, _ = foreign_things(folder)
    assert texture_of(mine.mesh) is None


def test_without_a_folder_nothing_is_foreign():
    lot = small_things([], np.random.default_rng(0))
    families = {family.kind for family in FAMILIES}
    labels = {lot().label for _ in range(200)}
    assert all(label in families or foreign_class(label) is None for label in labels)


@pytest.mark.parametrize("variety", VARIETIES, ids=lambda v: f"{v.model}-{getattr(v.form, '__name__', '')}")
def test_a_variety_measures_about_what_it_is_to_measure(variety):
    rng = np.random.default_rng(0)
    for _ in range(5):
        size = any_size(variety, rng)
        assert (np.array(size) >= np.array(variety.low_m) - 1e-9).all()
        assert (np.array(size) <= np.array(variety.high_m) + 1e-9).all()
        low, high = bounds(variety.form(*size, (0.5, 0.5, 0.5)))
        assert low[2] == pytest.approx(0.0, abs=0.1 * size[2])
        np.testing.assert_allclose(np.sort(high - low), np.sort(size), rtol=0.35, atol=0.004)
    assert variety.model in SMALL


def test_a_cuboid_as_large_as_cereals_is_not_said_to_be_a_box():
    box = next(variety for variety in VARIETIES if variety.form is carton)
    assert is_like_another(box, (0.07, 0.19, 0.29))
    assert is_like_another(box, (0.19, 0.07, 0.28))
    assert not is_like_another(box, (0.10, 0.10, 0.10))


def test_strange_things_stand_on_the_ground_and_hang_together():
    rng = np.random.default_rng(0)
    for _ in range(50):
        parts = distractor_parts(rng, (0.5, 0.5, 0.5))
        low, high = bounds(parts)
        assert low[2] == pytest.approx(0.0, abs=1e-9)
        assert low[:2] + high[:2] == pytest.approx([0.0, 0.0], abs=1e-9)
        assert max(size_of(parts)) < 1.0


def test_strange_things_are_lumps_too_and_often_alike_on_both_sides():
    rng = np.random.default_rng(1)
    found = [distractor_parts(rng, (0.5, 0.5, 0.5)) for _ in range(200)]
    lumps = [parts for parts in found if len(parts) == 1]
    assert 15 < len(lumps) < 50
    assert all(part.mesh is not None and part.mesh.key for (part,) in lumps)
    assert len({part.mesh.key for (part,) in lumps if part.mesh}) == len(lumps)
    assert sum(_alike(parts) for parts in found) > 30


def test_no_strange_thing_is_a_plain_ball_rod_or_box():
    rng = np.random.default_rng(2)
    for _ in range(100):
        parts = distractor_parts(rng, (0.5, 0.5, 0.5))
        spans = [2.0 * part.reach() / size_of(parts) for part in parts if part.mesh is None]
        assert all(span.min() < 0.9 for span in spans)


def _alike(parts):
    middles = sorted(
        np.round([(abs(part.centre[0] + 1e-12), *part.centre[1:]) for part in parts], 9).tolist()
    )
    return len(parts) % 2 == 0 and len(parts) > 2 and middles[::2] == middles[1::2]


def test_a_foreign_label_tells_thing_and_class():
    assert foreign_class("ycb can@Can") == ("ycb can", "Can")
    assert foreign_class("ycb drill@") == ("ycb drill", "")
    assert foreign_class("cup") is None


def test_lumps_of_all_seeds_have_a_hull():
    for seed in range(400):
        lump = _lump(0.1, (0.0, 0.0, 0.0), (0.5, 0.5, 0.5), np.random.default_rng(seed))
        low, high = bounds([lump])
        assert min(high - low) > 0.002


def test_apples_are_of_several_colours_and_lemons_of_one():
    rng = np.random.default_rng(0)
    apples = np.array([of_model("apple", rng).colour for _ in range(60)])
    lemons = np.array([of_model("lemon", rng).colour for _ in range(60)])
    assert {"red", "green", "yellow"} == {
        "yellow" if red > 0.6 and green > 0.6 else "green" if green > red else "red"
        for red, green, _ in apples
    }
    assert lemons.std(axis=0).max() < 0.1
