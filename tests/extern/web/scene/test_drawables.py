"""What is shown of entities and bodies, and how it is batched."""

import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.extern.web.scene.drawables import BOX, batch_of, by_key, drawable_of
from tests.extern.web.scene.sample_scenes import body, entity, pose, surface


def known(model, size_m):
    return surface(size_m) if model == "chair" else None


def show(an_entity, a_body, at=None, **how):
    return drawable_of(an_entity, a_body, at, known, **{"simulated": True, **how})


def test_an_entity_with_a_body_is_drawn_as_its_model_where_the_body_stands_by_now():
    thing = show(entity("chair1"), body("chair1", pose(1.0)), pose(2.0))
    assert (thing.look, thing.model, thing.pose) == ("solid", "chair", pose(2.0))


@pytest.mark.parametrize(
    ("an_entity", "a_body", "look"),
    [
        (entity("chair1"), body("chair1", ghost=True), "ghost"),
        (entity("chair1"), None, "believed"),
        (None, body("chair1"), "solid"),
        (None, body("table", is_entity=False), "solid"),
    ],
)
def test_ghosts_and_beliefs_are_told_apart(an_entity, a_body, look):
    assert show(an_entity, a_body).look == look


def test_without_a_simulator_nothing_is_a_mere_belief():
    assert show(entity("chair1"), None, simulated=False).look == "solid"


def test_what_was_is_drawn_as_of_the_past():
    assert show(entity("chair1"), None, past=True).look == "past"


def test_places_and_what_is_nowhere_are_not_drawn():
    assert show(entity("kitchen1", "Kitchen", place=True), None) is None
    assert show(None, None) is None


def test_a_model_that_is_not_known_is_a_box_of_the_thing_s_size():
    thing = show(entity("vase1", "Vase", model="vase"), None)
    assert (thing.model, thing.size_m) == (BOX, (0.5, 0.5, 1.0))


def test_there_is_one_batch_for_each_model_and_look():
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


def test_a_large_map_is_batched_quickly_and_whole():
    things = {f"chair{i}": show(entity(f"chair{i}"), body(f"chair{i}", pose(i))) for i in range(5000)}
    (batch,) = map(batch_of, by_key(things).values())
    assert len(batch.names) == 5000
    assert np.array_equal(batch.positions[:, 0], np.arange(5000, dtype=np.float32))


def test_a_door_is_drawn_as_its_joint_stands_and_in_the_past_as_the_map_states():
    ajar = structs.replace(entity("chair1"), properties={"jointPositions": "door=1.2 freezer=0"})
    assert show(ajar, None, past=True).bends == (("door", 1.2),)
    open_wide = show(ajar, body("chair1"), bends=(("door", 1.5),))
    assert open_wide.bends == (("door", 1.5),)
    assert open_wide.key != show(ajar, body("chair1"), bends=()).key
