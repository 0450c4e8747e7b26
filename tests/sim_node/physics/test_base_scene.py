"""Scenes of users: requirements, bodies, and joints that open."""

import math

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.body_classes import BodyClasses
from semmap.nodes.sim_node.physics import base_scene
from semmap.nodes.sim_node.physics.build import IMPEDANCE
from semmap.nodes.sim_node.vision.view import camera_view, look_at
from semmap.schemas.errors import BadFile
from tests.household import household_classes


def spec(body="", *, more="", option=""):
    return mujoco.MjSpec.from_string(
        f"<mujoco><option {option}/><worldbody>{body}</worldbody>{more}</mujoco>"
    )


def records(body, *, texts="", more="", classes=(), household=False):
    custom = "".join(f'<text name="{name}" data="{data}"/>' for name, data in dict(texts or {}).items())
    ground = spec(body, more=f"<custom>{custom}</custom>{more}")
    compiled = base_scene.prepare(ground)
    known = household_classes() if household else ()
    class_map = {word: word for word in classes}
    return base_scene.bodies_of(ground, compiled, BodyClasses(known, class_map))


def test_a_bare_floor_is_endless_and_has_a_camera_that_looks_over_it():
    ground = base_scene.bare_floor()
    model = ground.compile()
    assert (model.ngeom, model.geom_type[0]) == (1, mujoco.mjtGeom.mjGEOM_PLANE)
    assert model.geom_size[0, :2].tolist() == [0.0, 0.0]
    assert model.opt.timestep == 0.002
    assert model.light_type.tolist() == [mujoco.mjtLightType.mjLIGHT_DIRECTIONAL]
    assert model.light_dir[0, 2] < 0.0
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    view = camera_view(model, data, "overview", 4, 3)
    eye, ahead = view.map_from_camera[:3, 3], view.map_from_camera[:3, 2]
    assert eye == pytest.approx((5.0, -5.0, 5.0))
    assert ahead == pytest.approx(-eye / np.linalg.norm(eye))
    assert view.fovy_rad == pytest.approx(math.radians(58.0))


def test_a_floor_may_have_other_cameras_or_none():
    view = look_at(np.array([1.0, 2.0, 3.0]), np.zeros(3), 4, 3, 0.7)
    model = base_scene.bare_floor([("door", view)]).compile()
    assert model.camera(0).name == "door"
    assert model.cam_pos[0] == pytest.approx((1.0, 2.0, 3.0))
    assert math.radians(model.cam_fovy[0]) == pytest.approx(0.7)
    assert base_scene.bare_floor([]).compile().ncam == 0


def test_bodies_sleep_except_where_mujoco_cannot_have_them_sleep():
    ground = spec()
    base_scene.prepare(ground)
    assert ground.option.enableflags & int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    assert ground.option.disableflags & int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    tendon = spec(
        '<body><joint name="a"/><geom size="0.1"/></body><body><joint name="b"/><geom size="0.1"/></body>',
        more='<tendon><fixed name="t"><joint joint="a" coef="1"/></fixed></tendon>'
        '<equality><tendon tendon1="t"/></equality>',
    )
    tendon.option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    base_scene.prepare(tendon)
    assert not tendon.option.enableflags & int(mujoco.mjtEnableBit.mjENBL_SLEEP)


@pytest.mark.parametrize(
    ("option", "is_chosen"),
    [("", False), ('impratio="2"', True), ('cone="elliptic"', True)],
)
def test_contacts_are_made_hard_where_the_file_chooses_nothing(option, is_chosen):
    ground = spec(
        '<geom size="0.1"/><geom size="0.1" solimp="0.5 0.6 0.001 0.5 2"/>'.replace("solimp", "solimp"),
        option=option,
    )
    base_scene.prepare(ground)
    plain, chosen = ground.geoms[:2]
    assert np.array_equal(plain.solimp, IMPEDANCE) is not is_chosen
    assert chosen.solimp[0] == 0.5
    if not is_chosen:
        assert ground.option.cone == mujoco.mjtCone.mjCONE_ELLIPTIC


def test_pictures_are_made_cheap():
    ground = spec()
    base_scene.prepare(ground)
    quality = ground.visual.quality
    assert (quality.shadowsize, quality.offsamples) == (0, 0)
    assert (quality.numslices, quality.numstacks, quality.numquads) == (24, 8, 1)


def test_an_endless_floor_is_drawn_ten_metres_far_or_as_far_as_the_world_is():
    small, large = spec('<geom size="0.1"/>'), spec('<geom size="0.1"/><geom size="0.1" pos="90 0 0"/>')
    stated = mujoco.MjSpec.from_string('<mujoco><statistic extent="3"/><worldbody/></mujoco>')
    for ground in (small, large, stated):
        base_scene.prepare(ground)
    assert small.stat.extent == 10.0
    assert large.stat.extent > 40.0
    assert stated.stat.extent == 3.0


def test_a_world_without_a_floor_gets_an_unseen_one_below_all_of_it():
    ground = spec('<geom type="box" size="1 1 0.5" pos="0 0 -2"/>')
    base_scene.prepare(ground)
    net = ground.geoms[-1]
    assert net.type == mujoco.mjtGeom.mjGEOM_PLANE
    assert net.pos[2] == pytest.approx(-2.5)
    assert (net.contype, net.conaffinity, net.group) == (1, 1, 3)
    floored = spec('<geom type="plane" size="1 1 1"/>')
    base_scene.prepare(floored)
    assert len(floored.geoms) == 1
    empty = spec()
    base_scene.prepare(empty)
    assert empty.geoms[-1].pos[2] == pytest.approx(0.0, abs=0.01)


def test_a_floor_that_moves_with_a_body_is_no_floor():
    ground = spec('<body><freejoint/><geom size="1"/></body>')
    base_scene.prepare(ground)
    assert ground.worldbody.geoms[-1].type == mujoco.mjtGeom.mjGEOM_PLANE


def test_what_moves_and_has_no_name_is_given_one_that_nobody_has():
    ground = spec(
        '<body name="body_2"/><body><freejoint/><geom size="1"/></body><body><geom size="1"/></body>'
        '<body><body><joint/><geom size="1"/></body></body><camera name="a b"/><camera name="door"/>'
    )
    base_scene.prepare(ground)
    assert [body.name for body in ground.worldbody.bodies] == ["body_2", "body_3", "", "body_4"]
    assert [joint.name for joint in ground.joints] == ["joint_1", "joint_2"]
    assert [camera.name for camera in ground.cameras] == ["camera_1", "door"]


def test_a_body_has_the_box_around_all_its_geometry_in_its_own_frame():
    crate = """<body name="crate_1" pos="1 2 3" euler="0 0 90"><freejoint/>
      <geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0.3"/>
      <body><geom type="box" size="0.1 0.1 0.1" pos="0.1 0 0.9" euler="0 0 45"/></body></body>
      <body name="after" pos="9 9 9"><geom size="1"/></body>"""
    crate_1 = records(crate)["crate_1"]
    assert crate_1.size_m == pytest.approx((0.1 * math.sqrt(8), 0.4, 1.0))
    assert crate_1.origin_m == pytest.approx((0.1, 0.0, 0.0))
    assert crate_1.ordered.position_m == pytest.approx((1.0, 2.1, 3.0))
    assert crate_1.ordered.yaw_rad == pytest.approx(math.pi / 2)
    assert crate_1.class_ == "crate"
    assert (crate_1.fixed, crate_1.entity, crate_1.anchored) == (False, False, False)
    assert crate_1.masks == [(1, 1)]


def test_a_body_without_geometry_is_a_centimetre_large_and_what_is_flat_has_some_height():
    found = records('<body name="a"/><body name="b"><geom type="box" size="1 1 1e-6"/></body>')
    assert found["a"].size_m == pytest.approx((0.01, 0.01, 0.01))
    assert found["b"].size_m == pytest.approx((2.0, 2.0, 0.001))


@pytest.mark.parametrize(
    ("name", "size_m", "bottom_m"),
    [
        ("coffee_table", (0.8, 0.6, 0.4), 0.0),  # with its drawer, and without the book
        ("coffee_table_drawer", None, None),
        ("book", (0.2, 0.14, 0.04), 0.4),
        ("kitchen", (2.0, 2.0, 2.5), 0.0),  # a place extends over what is in it
        ("fridge", (1.0, 1.0, 2.0), 0.0),
        ("board", (0.4, 0.4, 0.2), 1.0),  # without geoms of its own
    ],
)
def test_the_size_of_a_body_is_that_of_its_parts_without_nested_entities(name, size_m, bottom_m):
    worlds = """<body name="coffee_table"><geom type="box" size=".4 .3 .1" pos="0 0 .3"/>
      <body name="coffee_table_drawer"><joint type="slide"/><geom type="box" size=".1 .1 .1" pos="0 0 .1"/>
        <body name="spoon_2" pos="0 0 .9"><geom type="box" size=".1 .1 .1"/></body></body>
      <body name="book" pos="0 0 .42"><geom type="box" size=".1 .07 .02"/></body></body>
      <body name="kitchen"><geom type="box" size="1 1 .01" pos="0 0 .01"/>
        <body name="fridge"><geom type="box" size=".5 .5 1" pos="0 0 1"/>
          <body name="pot_1" pos="0 0 2.25"><geom type="box" size=".1 .1 .25"/></body></body></body>
      <body name="board" pos="5 0 1">
        <body name="cup_1"><geom type="box" size=".1 .1 .1" pos=".1 .1 .1"/></body>
        <body name="cup_2"><geom type="box" size=".1 .1 .1" pos="-.1 -.1 .1"/></body></body>"""
    found = records(worlds, household=True)
    if size_m is None:
        assert name not in found
        return
    assert found[name].size_m == pytest.approx(size_m)
    assert found[name].ordered.position_m[2] == pytest.approx(bottom_m)


def test_what_stands_is_fixed_and_what_a_joint_holds_is_anchored():
    found = records(
        '<body name="wall"><geom size="1"/></body>'
        '<body name="door"><joint/><geom size="1"/></body>'
        '<body name="can"><freejoint/><geom size="1"/></body>'
    )
    assert {name: (r.fixed, r.anchored) for name, r in found.items()} == {
        "wall": (True, False),
        "door": (True, True),
        "can": (False, False),
    }


CUPBOARD = """<body name="cupboard"><geom size="1"/>
  <body name="drawer_1"><joint name="slide" type="slide" range="0 0.5"/><geom size="1"/>
    <body name="spoon_1"><geom size="0.1"/></body></body>
  <body name="hinge part"><geom size="0.1"/></body></body>"""


def test_a_part_is_a_body_of_its_own_by_a_text_or_a_name_like_a_class():
    assert records(CUPBOARD).keys() == {"cupboard"}
    found = records(CUPBOARD, classes=("drawer", "hinge part"))
    assert found.keys() == {"cupboard", "drawer_1", "hinge_part"}
    assert found["hinge_part"].body == "hinge part"
    assert (found["drawer_1"].part_of, found["drawer_1"].anchored) == ("cupboard", True)
    assert found["drawer_1"].joint_names == ("slide",)
    assert found["cupboard"].joints == ()
    declared = records(CUPBOARD, texts={"semmap:spoon_1": "Tea_Spoon"})
    assert declared["spoon_1"].class_ == "Tea_Spoon"
    assert declared["spoon_1"].part_of == "cupboard"
    assert declared["cupboard"].joint_names == ("slide",)


@pytest.mark.parametrize(
    ("at", "ends", "texts", "closed"),
    [
        ("0 0", "0 90", {}, 0.0),
        ("0 0", "-90 0", {}, 0.0),
        ("80 0", "0 90", {}, math.pi / 2),
        ("45 0", "0 90", {}, 0.0),  # in the middle: the lower
        ("0 0", "0 90", {"semmap-closed:j": "upper"}, math.pi / 2),
        ("80 0", "0 90", {"semmap-closed:j": "lower"}, 0.0),
    ],
)
def test_a_joint_is_shut_at_the_end_that_it_stands_at_or_that_a_text_names(at, ends, texts, closed):
    start = at.split()[0]
    body = f'<body name="box"><geom size="1"/><body><joint name="j" ref="{start}" range="{ends}"/>'
    (joint,) = records(body + '<geom size="1"/></body></body>', texts=texts)["box"].joints
    assert joint.closed == pytest.approx(closed)
    low, high = (math.radians(float(end)) for end in ends.split())
    assert (joint.lower, joint.upper) == pytest.approx((low, high))
    assert joint.position == joint.initial == pytest.approx(math.radians(float(start)))
    assert (joint.kind, joint.switch) == ("hinge", False)


def test_a_joint_without_limits_opens_nothing_and_a_ball_has_no_position_of_its_own():
    body = '<body name="box"><geom size="1"/><body><joint name="{}" type="{}"/><geom size="1"/></body></body>'
    (wheel,) = records(body.format("wheel", "hinge"))["box"].joints
    (gimbal,) = records(body.format("gimbal", "ball"))["box"].joints
    assert (wheel.lower, wheel.upper, wheel.closed) == (None, None, None)
    assert (gimbal.kind, gimbal.closed) == ("ball", None)


BOX = '<geom type="box" size="{}" {}/>'
HALF = '<geom type="box" size="1 1 .5" pos="0 0 {}"/>'
SEEN = 'group="1" contype="0" conaffinity="0"'


@pytest.mark.parametrize(
    ("geoms", "groups"),
    [
        ((BOX.format("1 1 1", SEEN), BOX.format("1 1 1", "")), [1, 3]),
        ((HALF.format(".5"), BOX.format(".9 1 1", SEEN), HALF.format("-.5")), [3, 1, 3]),
        ((BOX.format("1 1 1", ""), BOX.format(".2 .2 .01", SEEN)), [0, 1]),  # a sticker
        ((BOX.format("1 1 1", ""), BOX.format("1 1 1", 'group="1"')), [0, 1]),
        ((BOX.format("1 1 1", ""), BOX.format("1 1 1", "contype='0' conaffinity='0' group='2'")), [0, 2]),
        ((BOX.format("1 1 1", ""),), [0]),
    ],
)
def test_colliding_geoms_that_visual_ones_of_robosuite_cover_are_hidden(geoms, groups):
    ground = spec(f'<body name="box_1" pos="1 2 0" euler="0 0 30">{"".join(geoms)}</body>')
    compiled = base_scene.prepare(ground)
    number = compiled.model.body("box_1").id
    assert compiled.model.geom_group[compiled.model.geom_bodyid == number].tolist() == groups
    again = ground.compile()
    assert again.geom_group[again.geom_bodyid == again.body("box_1").id].tolist() == groups


def test_the_joints_of_a_robot_open_nothing_unless_a_text_declares_it():
    part = '<body><joint name="{}" range="-90 90"/><geom size="1"/></body>'
    parts = "".join(map(part.format, ("elbow", "power_button", "finger")))
    arm = f'<body name="arm_1"><geom size="1"/>{parts}</body>'
    cabinet = f'<body name="cabinet_1"><geom size="1"/>{part.format("door")}</body>'
    texts = {"semmap:arm_1": "Robot", "semmap-closed:finger": "lower"}
    found = records(arm + cabinet, texts=texts, household=True)
    joints = {joint.name: joint for record in found.values() for joint in record.joints}
    assert {name for name, joint in joints.items() if joint.opens} == {"finger", "door"}
    assert not any(joint.switches for joint in joints.values())
    assert (joints["elbow"].lower, joints["elbow"].upper) == pytest.approx((-math.pi / 2, math.pi / 2))


def test_a_knob_is_a_switch_and_what_it_turns_opens_nothing():
    stove = """<body name="stove"><geom size="1"/>
      <body name="knob"><joint name="k" range="0 90"/><geom size="1"/></body>
      <body name="burner"><joint name="b" type="slide" range="0 1"/><geom size="1"/></body></body>"""
    tie = '<equality><joint joint1="b" joint2="k"/></equality>'
    knob, burner = records(stove, more=tie)["stove"].joints
    assert (knob.switch, knob.closed) == (True, 0.0)
    assert (burner.switch, burner.closed) == (False, None)
    _, alone = records(stove)["stove"].joints
    assert alone.closed == 0.0


def test_what_texts_declare_in_vain_is_named():
    ground = spec(
        '<body name="a b"><joint name="j" range="0 1"/><geom size="1"/></body>',
        more="""<custom><text name="semmap:missing" data="Cup"/><text name="semmap:a b" data="Cup"/>
        <text name="semmap-closed:x" data="lower"/><text name="semmap-closed:j" data="left"/>
        <text name="semmap-off:j" data="right"/><text name="other" data="x"/></custom>""",
    )
    assert base_scene.ignored(ground) == [
        "missing (no such body)",
        "x (no such joint)",
        "j (closed at 'left'; use lower or upper)",
        "j (off at 'right'; use lower or upper)",
    ]
    assert base_scene.ignored(spec()) == []


def test_what_is_only_a_part_is_named_by_itself_or_by_what_it_is_part_of():
    model = spec('<body name="a"><body name="b"/><body><body/></body></body><body/>').compile()
    assert base_scene.left_out(model, ["a"]) == (
        "b",
        "a nameless part of a",
        "a nameless part of a",
        "a nameless part of the ground",
    )
    assert base_scene.left_out(model, ["a", "b"])[0] == "a nameless part of a"


@pytest.mark.parametrize(
    ("body", "text", "depends"),
    [
        ('<body name="a"/>', "", True),
        ("<body/>", "", False),
        ('<body name="a"><body name="b"/></body>', "", True),
        ('<body name="a"><body/></body>', '<custom><text name="semmap:a" data="A"/></custom>', False),
        (
            '<body name="a"><body name="b"/></body>',
            '<custom><text name="semmap:a" data="A"/><text name="semmap:b" data="B"/></custom>',
            False,
        ),
    ],
)
def test_classes_matter_only_for_named_bodies_that_are_not_declared(body, text, depends):
    assert base_scene.names_classes(spec(body, more=text)) is depends


def test_a_scene_is_read_from_a_file_and_what_does_not_compile_is_told_only_if_that_is_asked_for(tmp_path):
    path = tmp_path / "world.xml"
    path.write_text("<mujoco><worldbody><geom type='plane' size='1 1 1'/></worldbody></mujoco>")
    assert len(base_scene.read_mjcf(path).geoms) == 1
    path.write_text("<mujoco><actuator><motor joint='missing'/></actuator></mujoco>")
    with pytest.raises(BadFile, match=r"cannot compile world file .*world\.xml: .*missing"):
        base_scene.read_mjcf(path)
    assert len(base_scene.read_mjcf(path, compiles=False).actuators) == 1
    with pytest.raises(BadFile, match="cannot compile world file"):
        base_scene.read_mjcf(tmp_path / "nothing.xml")


def test_a_scene_that_is_nested_too_deeply_is_rejected(tmp_path):
    path = tmp_path / "world.xml"
    path.write_text(f"<mujoco><worldbody>{'<body>' * 250}{'</body>' * 250}</worldbody></mujoco>")
    with pytest.raises(BadFile, match=r"cannot compile world file .*nested deeper than 200 levels"):
        base_scene.read_mjcf(path)
