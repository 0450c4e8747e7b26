"""Drawables of entities and bodies, and their batches."""

import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.extern.web.scene.drawables import BOX, batch_of, by_key, drawable_of
from tests.extern.web.scene.sample_scenes import body, entity, pose, surface


def known(model, size_m):
    return surface(size_m) if model == "chair" else None


def show(an_entity, a_body, at=None, **how):
    return drawable_of(an_entity, a_body, at, known, **{"simulated": True, **how})


def test_an_entity_with_a_body_has_its_model_and_current_pose():
    thing = show(entity("chair1"), body("chair1", pose(1.0)), pose(2.0))
    assert (thing.appearance, thing.model, thing.pose) == ("solid", "chair", pose(2.0))


@pytest.mark.parametrize(
    ("an_entity", "a_body", "appearance"),
    [
        (entity("chair1"), body("chair1", ghost=True), "ghost"),
        (entity("chair1"), None, "believed"),
        (None, body("chair1"), "solid"),
        (None, body("table", is_entity=False), "solid"),
    ],
)
def test_ghosts_and_entities_without_bodies_have_their_own_appearance(an_entity, a_body, appearance):
    assert show(an_entity, a_body).appearance == appearance


def test_without_a_simulator_entities_are_solid():
    assert show(entity("chair1"), None, simulated=False).appearance == "solid"


def test_past_entities_have_the_past_appearance():
    assert show(entity("chair1"), None, past=True).appearance == "past"


def test_past_entities_of_the_size_of_a_body_of_the_world_file_look_like_it():
    def known(model, size_m):
        return surface(size_m) if (model, size_m) == ("abc", (0.5, 0.5, 1.0)) else None

    def model(an_entity, present):
        return drawable_of(an_entity, None, None, known, simulated=True, past=True, present=present).model

    own = structs.replace(body("chair1", model=""), surface="abc")
    assert model(entity("chair1", size_m=None), own) == "abc"
    assert model(entity("chair1", size_m=(0.5, 0.5, 1.001)), own) == "abc"
    assert model(entity("chair1", size_m=(0.5, 0.5, 1.2)), own) == BOX
    assert model(entity("chair1"), body("chair1")) == BOX
    assert model(entity("chair1"), None) == BOX


def test_places_and_entities_without_a_pose_are_not_drawn():
    assert show(entity("kitchen1", "Kitchen", place=True), None) is None
    assert show(None, None) is None


def test_unknown_models_are_boxes_of_the_entity_size():
    thing = show(entity("vase1", "Vase", model="vase"), None)
    assert (thing.model, thing.size_m) == (BOX, (0.5, 0.5, 1.0))


def test_each_model_and_appearance_has_one_batch():
    things = {
        "chair1": show(entity("chair1"), body("chair1", pose(1.0))),
        "vase1": show(entity("vase1", "Vase", size_m=(0.1, 0.1, 0.3), model="vase"), None),
        "chair2": show(entity("chair2"), body("chair2", pose(2.0))),
        "ghost1": show(entity("ghost1"), body("ghost1", ghost=True)),
        "vase2": show(entity("vase2", "Vase", size_m=(0.2, 0.2, 0.4), model="vase"), None),
    }
    found = {batch.names: batch for batch in map(batch_of, by_key(things).values())}
    assert set(found) == {("chair1", "chair2"), ("vase1", "vase2"), ("ghost1",)}
    assert found["chair1", "chair2"].positions[:, 0].tolist() == [1.0, 2.0]
    assert found["vase1", "vase2"].sizes[1] == pytest.approx((0.2, 0.2, 0.4))


def test_a_large_map_is_one_batch():
    things = {f"chair{i}": show(entity(f"chair{i}"), body(f"chair{i}", pose(i))) for i in range(5000)}
    (batch,) = map(batch_of, by_key(things).values())
    assert len(batch.names) == 5000
    assert np.array_equal(batch.positions[:, 0], np.arange(5000, dtype=np.float32))


def test_joint_positions_come_from_the_body_or_from_the_map():
    ajar = structs.replace(entity("chair1"), properties={"jointPositions": "door=1.2 freezer=0"})
    assert show(ajar, None, past=True).joint_positions == (("door", 1.2),)
    open_wide = show(ajar, body("chair1"), joint_positions=(("door", 1.5),))
    assert open_wide.joint_positions == (("door", 1.5),)
    assert open_wide.key != show(ajar, body("chair1"), joint_positions=()).key
