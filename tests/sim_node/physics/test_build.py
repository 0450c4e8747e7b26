"""Models become MuJoCo bodies: pose, mass, collision, and joints."""

import math
import threading
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.models.library import build as library_model
from semmap.nodes.sim_node.models.parts import Role, Shape, ball, box, collision, mesh, pill, rod, visual
from semmap.nodes.sim_node.order_validation import validate_spawn
from semmap.nodes.sim_node.physics import build
from tests.sim_node.orders import order, pose

RED = (1.0, 0.0, 0.0)


def compiled(*orders, degrees=True, **how):
    made, failed = validate_spawn(orders, library_model, lambda name: False)
    assert failed == {}
    spec = mujoco.MjSpec()
    spec.compiler.degree = degrees
    for record, _ in made.values():
        for key, value in how.items():
            setattr(record, key, value)
    build.add_bodies(spec, [(record, model, record.ordered) for record, model in made.values()])
    return spec.compile(), made


def test_a_body_stands_at_its_pose_with_the_mass_of_its_model():
    model, made = compiled(order("cup1", "cup", pose(1.0, 2.0, 0.7)))
    _, shape = made["cup1"]
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    body = model.body("cup1")
    assert data.xpos[body.id] == pytest.approx(np.add((1.0, 2.0, 0.7), shape.inertial.centre_m))
    assert body.mass == pytest.approx(shape.mass_kg)
    assert body.inertia == pytest.approx(shape.inertial.moments)
    assert body.ipos == pytest.approx((0, 0, 0))
    assert body.iquat == pytest.approx((1, 0, 0, 0))
    assert model.joint("cup1").type == mujoco.mjtJoint.mjJNT_FREE
    assert model.dof_damping.tolist() == pytest.approx([max(shape.inertial.moments)] * 6)
    assert model.geom_bodyid.tolist() == [body.id] * len(shape.parts)
    lowest = (data.geom_xpos[:, 2] - model.geom_aabb[:, 5]).min()
    assert lowest == pytest.approx(0.7, abs=0.01)


def test_a_fixed_body_has_no_joint():
    assert compiled(order("cup1", "cup", pose(1.0, 2.0), fixed=True))[0].njnt == 0


def test_many_bodies_keep_their_names_and_places():
    orders = [order(f"can{i}", "can", pose(0.5 * i, 0.0)) for i in range(103)]
    model, _ = compiled(*orders)
    assert model.nbody == 104
    for i in (0, 49, 50, 99, 100, 102):
        assert model.body(f"can{i}").pos[0] == pytest.approx(0.5 * i)
        assert model.joint(f"can{i}").type == mujoco.mjtJoint.mjJNT_FREE


def test_what_is_only_seen_does_not_collide_and_what_is_only_felt_is_seen_by_no_camera():
    model, made = compiled(order("table1", "table", pose(0.0, 0.0)))
    for geom, part in enumerate(made["table1"][1].frame):
        masks = (model.geom_contype[geom], model.geom_conaffinity[geom])
        assert masks == ((0, 0) if part.role is Role.VISUAL else (1, 1))
        assert (model.geom_group[geom] == build.COLLISION_GROUP) == (part.role is Role.COLLISION)
        assert model.geom_rgba[geom] == pytest.approx([*part.colour, 1.0])


def test_a_ghost_collides_with_nothing():
    model, _ = compiled(order("fridge1", "fridge", pose(0.0, 0.0)), ghost=True)
    assert not model.geom_contype.any()
    assert not model.geom_conaffinity.any()


@pytest.mark.parametrize(
    ("part", "kind", "size"),
    [
        (box((0.2, 0.4, 0.6), (0, 0, 0), RED), mujoco.mjtGeom.mjGEOM_BOX, (0.1, 0.2, 0.3)),
        (ball((0.2, 0.4, 0.6), (0, 0, 0), RED), mujoco.mjtGeom.mjGEOM_ELLIPSOID, (0.1, 0.2, 0.3)),
        (rod(0.1, 0.6, (0, 0, 0), RED), mujoco.mjtGeom.mjGEOM_CYLINDER, (0.1, 0.3, 0.0)),
        (pill(0.1, 0.6, (0, 0, 0), RED), mujoco.mjtGeom.mjGEOM_CAPSULE, (0.1, 0.2, 0.0)),
    ],
    ids=["box", "ball", "rod", "pill"],
)
def test_a_part_is_a_geom_of_the_same_shape_and_place(part, kind, size):
    spec = mujoco.MjSpec()
    build.add_part(spec.worldbody, part, origin_m=(1.0, 2.0, 3.0))
    model = spec.compile()
    assert model.geom_type[0] == kind
    assert model.geom_size[0] == pytest.approx(size)
    assert model.geom_pos[0] == pytest.approx((1.0, 2.0, 3.0))
    rolls = part.shape is Shape.ELLIPSOID
    assert model.geom_condim[0] == (6 if rolls else 3)  # what is round needs friction against rolling
    assert model.geom_friction[0] == pytest.approx((0.8, 0.01, 0.004))
    assert model.geom_solimp[0] == pytest.approx(build.IMPEDANCE)


def test_a_mesh_is_known_once_and_two_bodies_share_it():
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
    faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], dtype=np.int32)
    part = mesh(corners, faces, RED)
    part = replace(part, mesh=replace(part.mesh, key="corner"))
    spec = mujoco.MjSpec()
    for _ in range(2):
        build.add_mesh(spec, part.mesh)
        build.add_part(spec.worldbody, part)
    model = spec.compile()
    assert (model.nmesh, model.ngeom) == (1, 2)
    assert model.mesh_vertnum.tolist() == [4]


@pytest.mark.parametrize("degrees", [True, False])
def test_what_opens_has_the_joints_of_its_model_whatever_the_unit_of_angles(degrees):
    model, made = compiled(order("fridge1", "fridge", pose(0.0, 0.0)), degrees=degrees)
    shape = made["fridge1"][1]
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    for leaf in shape.leaves:
        name = build.leaf_name("fridge1", leaf.joint.name)
        joint, body = model.joint(name), model.body(name)
        assert joint.range == pytest.approx(leaf.joint.range)
        assert model.jnt_limited[joint.id]
        assert data.xanchor[joint.id] == pytest.approx(leaf.joint.anchor)
        assert data.xaxis[joint.id] == pytest.approx(leaf.joint.axis)
        assert data.xpos[body.id] == pytest.approx(leaf.inertial.centre_m)
        assert body.mass == pytest.approx(leaf.inertial.mass_kg)
        assert body.inertia == pytest.approx(leaf.inertial.moments)
        assert body.ipos == pytest.approx((0, 0, 0))
        assert model.body_gravcomp[body.id] == 1.0  # a lid does not creep down
        dof = int(model.jnt_dofadr[joint.id])
        assert model.dof_frictionloss[dof] == pytest.approx(leaf.joint.friction)
        assert model.dof_damping[dof] == pytest.approx(0.1 * leaf.joint.friction)
        assert model.jnt_solimp[joint.id] == pytest.approx(build.IMPEDANCE)
    assert model.nexclude == 3  # neither door touches the frame, nor the other door


def test_the_parts_of_a_door_are_where_the_model_has_them():
    model, made = compiled(order("fridge1", "fridge", pose(0.0, 0.0)))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    parts = {tuple(np.round(part.centre, 6)) for part in made["fridge1"][1].parts}
    assert {tuple(np.round(centre, 6)) for centre in data.geom_xpos} == parts


def test_spares_are_static_or_free_with_as_many_parts_as_asked_for():
    spec = mujoco.MjSpec()
    names = build.add_spare_bodies(spec, [(False, 2), (True, 3)])
    model = spec.compile()
    assert names == ["slot/0", "slot/1"]
    bodies = [model.body(name).id for name in names]
    assert model.body_geomnum[bodies].tolist() == [2, 3]
    assert model.body_jntnum[bodies].tolist() == [1, 0]
    assert model.body("slot/0").mass == 1.0
    assert model.body("slot/0").inertia == pytest.approx([1.0] * 3)
    assert model.geom_size.max() == pytest.approx(0.001)


WORLD = """<mujoco><worldbody>
  <body name="box" pos="9 9 9" euler="0 0 45"><freejoint name="free"/><geom type="box" size="0.1 0.1 0.1"/>
    <geom type="box" size="0.1 0.1 0.1" contype="2" conaffinity="0"/></body>
  <body name="shelf"><geom type="box" size="0.1 0.1 0.1"/></body>
</worldbody></mujoco>"""


@pytest.mark.parametrize("ghost", [False, True])
@pytest.mark.parametrize("name", ["box", "shelf"])
def test_a_body_of_the_world_is_held_or_set_free_solid_or_not_as_its_record_says(name, ghost):
    made, _ = validate_spawn(
        [order(name, "", pose(0.0, 0.0), size_m=(0.2, 0.2, 0.2))], library_model, lambda _: 0
    )
    record, _ = made[name]
    record.ghost = ghost
    record.masks = [(1, 1), (2, 0)][: 2 if name == "box" else 1]
    spec = mujoco.MjSpec.from_string(WORLD)
    build.set_standing(spec, record, pose(1.0, 2.0, 0.5, yaw=0.3))
    model = spec.compile()
    body = model.body(name)
    assert body.pos == pytest.approx((1.0, 2.0, 0.6))
    assert body.quat == pytest.approx((math.cos(0.15), 0.0, 0.0, math.sin(0.15)))
    assert model.body_jntnum[body.id] == (0 if ghost else 1)
    masks = [(int(model.geom_contype[g]), int(model.geom_conaffinity[g])) for g in _geoms(model, body.id)]
    assert masks == ([(0, 0)] * len(record.masks) if ghost else record.masks)


def _geoms(model, body):
    return np.flatnonzero(model.geom_bodyid == body)


@pytest.mark.parametrize("ghost", [False, True])
def test_only_a_robot_that_can_move_may_sleep(ghost):
    made, _ = validate_spawn(
        [order("box", "", pose(0.0, 0.0), size_m=(0.2, 0.2, 0.2))], library_model, lambda _: 0
    )
    record, _ = made["box"]
    record.ghost, record.robot, record.masks = ghost, True, [(1, 1), (2, 0)]
    spec = mujoco.MjSpec.from_string(WORLD)
    build.set_standing(spec, record, pose(1.0, 2.0))
    policies = mujoco.mjtSleepPolicy
    assert spec.body("box").sleep == (policies.mjSLEEP_AUTO if ghost else policies.mjSLEEP_ALLOWED)


def test_others_are_heard_while_something_is_made():
    go_on, heard = threading.Event(), []

    def while_waiting():
        heard.append(threading.current_thread())
        if len(heard) == 3:
            go_on.set()

    def make():
        assert threading.current_thread() is not threading.main_thread()
        assert go_on.wait(60.0)
        return "made"

    assert build.run_in_background(make, while_waiting) == "made"
    assert len(heard) >= 3
    assert set(heard) == {threading.current_thread()}


def test_what_fails_aside_fails_here():
    def make():
        raise ValueError("it does not compile")

    with pytest.raises(ValueError, match="does not compile"):
        build.run_in_background(make, lambda: None)


def test_there_is_room_for_the_contacts_of_all_bodies():
    few, many = mujoco.MjSpec(), mujoco.MjSpec()
    build.set_memory(few, 0)
    build.set_memory(many, 1000)
    assert few.memory == 32 * 1024 * 1024
    assert many.memory - few.memory == 1000 * 100 * 1024


STATE = """<mujoco><worldbody>
  {first}
  <body><joint name="hinge" type="hinge"/><geom size="0.1"/></body>
  <body><joint name="slide" type="slide"/><geom size="0.1"/></body>
  <body><joint name="ball" type="{ball}"/><geom size="0.1"/></body>
  <body><freejoint name="free"/><geom size="0.1"/></body>
  <body mocap="true"><geom size="0.1"/></body>
</worldbody><actuator><position joint="hinge"/>{more}</actuator></mujoco>"""
FIRST = '<body><joint name="new" type="slide"/><geom size="0.1"/></body>'
NAMES = ("hinge", "slide", "ball", "free", "new", "unknown")


def state(first="", ball="ball", more=""):
    model = mujoco.MjModel.from_xml_string(STATE.format(first=first, ball=ball, more=more))
    return model, mujoco.MjData(model)


def test_joints_keep_their_places_and_speeds_in_another_model():
    old, old_data = state()
    old_data.qpos[:] = np.arange(13.0)
    old_data.qvel[:] = 100.0 + np.arange(11.0)
    old_data.ctrl[:], old_data.mocap_pos[:], old_data.mocap_quat[:] = 7.0, 8.0, 9.0
    new, new_data = state(first=FIRST)
    build.carry_joints(old, old_data, new, new_data, NAMES)
    assert new_data.qpos.tolist() == [0.0, *range(13)]
    assert new_data.qvel.tolist() == [0.0, *range(100, 111)]
    assert new_data.ctrl.tolist() == [7.0]
    assert new_data.mocap_pos.tolist() == [[8.0] * 3]
    assert new_data.mocap_quat.tolist() == [[9.0] * 4]


def test_a_joint_of_another_kind_and_one_that_is_not_named_begin_anew():
    old, old_data = state()
    old_data.qpos[:] = np.arange(13.0)
    new, new_data = state(ball="slide")
    build.carry_joints(old, old_data, new, new_data, ["ball", "slide"])
    assert new_data.qpos[:3].tolist() == [0.0, 1.0, 0.0]


def test_controls_of_other_actuators_are_not_taken_over():
    old, old_data = state()
    old_data.ctrl[:] = 7.0
    new, new_data = state(more='<position joint="slide"/>')
    build.carry_joints(old, old_data, new, new_data, NAMES)
    assert new_data.ctrl.tolist() == [0.0, 0.0]


def test_decoration_collides_with_nothing_and_a_stand_in_does():
    part = box((1, 1, 1), (0, 0, 0), RED)
    masks = [build.mask_of(one) for one in (part, *visual(part), *collision(part))]
    assert masks == [(1, 1), (0, 0), (1, 1)]
