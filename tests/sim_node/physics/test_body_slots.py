"""A body in a slot moves and is rendered as if it had been compiled."""

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.physics.body_slots import BodySlot
from semmap.nodes.sim_node.world import World
from tests.sim_node.orders import hand, order, pose

KINDS = ("chair", "cup", "vase", "apple", "table")


def laid(*, slotted: bool) -> World:
    """Return things in mid-air, tilted and rotating."""
    world = World()
    for i, kind in enumerate(KINDS):
        if not slotted:
            world._engine._free_slots.clear()
        world.spawn([order(kind, kind, pose(0.5 * i, 0.0, 0.8, yaw=0.3 * i))])
    for name in KINDS:
        dof = world._engine.index.dof[world._engine.index.row[name]]
        world.data.qvel[dof : dof + 6] = [0.2, 0.1, 0.0, 1.0, 0.5, 0.2]
    return world


def rows(world: World, name: str) -> dict[str, np.ndarray]:
    """Return all data of one body in the model."""
    model, slot = world.model, world._engine._slots[name]
    dof = int(model.body_dofadr[slot.body])
    count = int(model.body_bvhnum[slot.body])
    nodes = slice(slot.node, slot.node + count)
    seen = {}
    for prefix, where in (("body", slot.body), ("dof", slice(dof, dof + 6))):
        for field in ("mass", "inertia", "ipos", "iquat", "contype", "conaffinity", "invweight0", "M0"):
            if hasattr(model, f"{prefix}_{field}"):
                seen[f"{prefix}_{field}"] = getattr(model, f"{prefix}_{field}")[where]
    visible = [g for g in range(slot.geom, slot.geom + slot.geoms) if model.geom_group[g] != 3]
    felt = [g for g in range(slot.geom, slot.geom + slot.geoms) if model.geom_contype[g]]
    for field in [f for f in dir(model) if f.startswith("geom_") and f != "geom_bodyid"]:
        values = getattr(model, field)
        if isinstance(values, np.ndarray):
            seen[f"seen {field}"], seen[f"felt {field}"] = values[visible], values[felt]
    leaves = model.bvh_nodeid[nodes]
    seen["leaves"] = np.where(leaves < 0, leaves, leaves - slot.geom)
    seen["boxes"], seen["children"] = model.bvh_aabb[nodes], model.bvh_child[nodes]
    return {key: np.array(value) for key, value in seen.items()}


@pytest.mark.parametrize("name", KINDS)
def test_the_model_says_the_same_of_it(name):
    slotted, compiled = rows(laid(slotted=True), name), rows(laid(slotted=False), name)
    assert slotted.keys() == compiled.keys()
    for key, value in slotted.items():
        assert value == pytest.approx(compiled[key]), key


def test_it_falls_and_bounces_the_same_way():
    slotted, compiled = laid(slotted=True), laid(slotted=False)
    for _ in range(8):
        slotted.step(0.1)
        compiled.step(0.1)
        assert slotted.poses().poses == pytest.approx(compiled.poses().poses, abs=2e-3)


def test_one_berth_after_another_is_filled_before_anything_is_compiled():
    world = World()
    model = world.model
    for i in range(50):
        world.spawn([order(f"can{i}", "can", pose(0, 0))])
        world.step(0.02)
        world.delete([f"can{i}"])
    assert world.model is model


def test_who_left_is_gone_for_touch_and_sight_and_lets_the_world_sleep():
    world = World()
    world.spawn([order("table1", "table", pose(0, 0))])
    world.step(1.0)
    world.delete(["table1"])
    world.step(0.2)
    assert world.asleep
    assert world.body_names() == [""] * world.model.ngeom
    world.spawn([order("can1", "can", pose(0, 0, 1.5))])
    world.step(1.5)
    assert world.scene().bodies[0].pose.position_m[2] == pytest.approx(0.0, abs=0.002)


def compiled_names(world: World) -> list[str | None]:
    kind = mujoco.mjtObj.mjOBJ_BODY
    return [mujoco.mj_id2name(world.model, kind, number) for number in range(world.model.nbody)]


def test_no_berth_keeps_the_name_of_who_left():
    world = World()
    world.spawn([order(f"chair{i}", "chair", pose(i, 0)) for i in range(20)])  # more than there are slots
    assert "chair1" in compiled_names(world)
    world.delete(["chair1"])
    world.spawn([order("chair_new", "chair", pose(1, 0))])
    for compiled, name in zip(
        compiled_names(world), world.names_of(np.arange(world.model.nbody)), strict=True
    ):
        assert compiled in (name, None, "world")
    assert "chair_new" in world.body_names()
    assert "chair1" not in world.body_names()


def test_those_that_leave_in_the_air_do_not_fall():
    world = World()
    world.spawn([order("can1", "can", pose(0, 0, 5.0))])
    world.step(0.1)
    world.delete(["can1"])
    before = world.data.qpos.copy()
    world.step(1.0)
    assert world.data.qpos == pytest.approx(before, abs=1e-6)


def test_a_sleeper_is_woken_with_its_heap():
    world = World()
    world.spawn([order("table1", "table", pose(0, 0)), order("cup1", "cup", pose(0, 0, 0.75))])
    world.spawn([order("far", "can", pose(4, 0))])
    world.step(2.0)
    assert world.asleep
    world._engine.wake(["cup1"])
    assert not world.asleep
    mujoco.mj_step(world.model, world.data)
    tree = world._engine.index.tree
    assert (world.data.tree_asleep[tree] < 0).tolist() == [True, True, False]


def test_held_and_free_berths_are_told_apart():
    world = World()
    world.spawn([order("shelf1", "shelf", pose(0, 0, 1.0), fixed=True), order("can1", "can", pose(3, 0))])
    held, free = (world._engine._slots[name] for name in ("shelf1", "can1"))
    assert (held.static, free.static) == (True, False)
    assert isinstance(held, BodySlot)
    world.step(0.5)
    world.move([hand("shelf1", pose(0, 2, 1.2))])
    world.spawn([order("cup1", "cup", pose(0, 2, 1.5))])
    world.step(1.0)
    assert world.scene().bodies[2].pose.position_m[2] == pytest.approx(1.4, abs=0.003)


@pytest.mark.parametrize("seed", range(3))
def test_whatever_comes_and_goes_everybody_has_one_berth_and_nobody_else_is_seen(seed):
    world, rng = World(), np.random.default_rng(seed)
    for turn in range(80):
        names = world.poses().names
        at = pose(*rng.uniform(-2.0, 2.0, 2), float(rng.choice([0.0, 0.5])))
        if not names or rng.random() < 0.5:
            kind, fixed = str(rng.choice([*KINDS, "plant", "shelf"])), bool(rng.random() < 0.2)
            world.spawn([order(f"{kind}{turn}", kind, at, fixed=fixed)])
        elif rng.random() < 0.5:
            world.delete([str(rng.choice(names))])
        else:
            world.move([hand(str(rng.choice(names)), at)])
        world.step(0.02)
        bodies = {body.name: body for body in world.scene().bodies}
        slots = world._engine._slots
        assert slots.keys() == bodies.keys()
        everyone = [slot.body for slot in (*slots.values(), *world._engine._free_slots)]
        assert len(set(everyone)) == len(everyone)
        visible = world.model.geom_group != 3
        assert {name for name, seen in zip(world.body_names(), visible, strict=True) if seen and name} == set(
            bodies
        )
        for name, body in bodies.items():
            assert slots[name].static == (body.fixed or body.ghost)
            solid = world.model.body_contype[slots[name].body]
            assert bool(solid) != body.ghost
    assert np.isfinite(world.data.qpos).all()
    world.delete(list(world.poses().names))
    world.step(0.2)
    assert world.asleep
