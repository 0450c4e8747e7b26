"""The bodies of a world file have shapes of their own, and relations are about these."""

import math

import mujoco
import pytest

from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.facts.precompute import compute_facts
from semmap.nodes.kb_node.relations.facts.precompute_messages import ExpectedEntities, PrecomputeRequest
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity, name_shape_source
from semmap.nodes.sim_node.world import World
from semmap.nodes.sim_node.world_shapes import world_shapes
from semmap.ontology import model_shapes
from semmap.ontology.model_shapes import WorldShapes
from semmap.schemas import codec
from tests.kb_node.relations.entities import thing

WORLD = """<mujoco><worldbody>
  <geom type="plane" size="5 5 .1"/>
  <body name="bookshelf1" pos="0 0 0" euler="0 0 90">
    <geom type="box" size=".15 .4 .01" pos="0 0 .4"/><geom type="box" size=".15 .4 .01" pos="0 0 .8"/>
    <geom type="box" size=".15 .01 .7" pos="0 -.4 .7"/><geom type="box" size=".15 .01 .7" pos="0 .4 .7"/>
  </body>
  <body name="cup1" pos=".2 0 .46"><freejoint/><geom type="cylinder" size=".04 .05"/></body>
  <body name="oven1" pos="0 2 0">
    <geom type="box" size=".3 .3 .45" pos="0 0 .45"/><geom type="box" size=".3 .02 .45" pos="0 .28 1.35"/>
    <geom type="box" size=".3 .3 .05" pos="0 0 1.75"/>
  </body>
  <body name="pot1" pos="0 1.9 .96"><freejoint/><geom type="cylinder" size=".1 .06"/></body>
  <body name="chair1" pos="2 2 0">
    <geom type="box" size=".2 .2 .15" pos="0 0 .15"/><geom type="box" size=".02 .2 .4" pos="-.18 0 .7"/>
  </body>
  <body name="cushion1" pos="2.03 2 .33"><freejoint/><geom type="box" size=".12 .12 .03"/></body>
  <body name="box1" pos="4 0 0">
    <geom type="box" size=".2 .2 .01" pos="0 0 .01"/>
    <geom type="box" size=".01 .2 .2" pos=".19 0 .2"/><geom type="box" size=".01 .2 .2" pos="-.19 0 .2"/>
    <geom type="box" size=".2 .01 .2" pos="0 .19 .2"/><geom type="box" size=".2 .01 .2" pos="0 -.19 .2"/>
    <body name="flap" pos="-.2 0 .41">
      <joint name="lid" type="hinge" axis="0 -1 0" range="0 100"/>
      <geom type="box" size=".2 .2 .01" pos=".2 0 0"/>
    </body>
  </body>
  <body name="apple1" pos="4 0 .06"><freejoint/><geom type="sphere" size=".04"/></body>
  <body name="marker1" pos="1 1 0"><geom type="box" size=".1 .1 .1" contype="0" conaffinity="0"/></body>
</worldbody></mujoco>"""


@pytest.fixture(scope="module")
def world():
    return World(mujoco.MjSpec.from_string(WORLD))


@pytest.fixture(scope="module")
def shapes(world):
    return world_shapes(world)


@pytest.fixture
def known(world, shapes, monkeypatch):
    """Return the entities of the world, whose shapes are known."""
    monkeypatch.setattr(model_shapes, "_world", WorldShapes.of(shapes))
    return entities(world)


def entities(world):
    return [
        thing(b.name, b.pose.position_m, turn=b.pose.orientation_wxyz, size=b.size_m)
        for b in world.scene().bodies
    ]


def computed(things):
    facts = Facts()
    facts.update(things)
    return set(facts)


EXPECTED = {
    ("cup1", "isOn", "bookshelf1"),
    ("pot1", "isOn", "oven1"),
    ("cushion1", "isOn", "chair1"),
    ("apple1", "isInside", "box1"),
}


def test_relations_are_about_the_bodies_of_the_world(known):
    assert computed(known) == EXPECTED


def test_without_them_they_are_about_the_models_of_their_classes(world, monkeypatch):
    monkeypatch.setattr(model_shapes, "_world", WorldShapes())
    assert ("pot1", "isInside", "oven1") in computed(entities(world))


def test_the_process_that_precomputes_facts_has_them_too(known):
    placed = tuple(map(PlacedEntity.of, known))
    request = PrecomputeRequest(
        Facts().space.limits, placed, ExpectedEntities([], []), model_shapes.added_shapes()
    )
    sent = codec.decode(codec.encode(request), PrecomputeRequest)
    assert sent.shapes.world.bodies.keys() >= {"oven1"}
    assert ("isOn", "oven1") in compute_facts(sent).facts[0]["pot1"]


def test_a_joint_moves_the_parts_below_it(shapes):
    (lid,) = shapes["box1"].leaves
    assert (lid.name, lid.kind) == ("lid", "hinge")
    assert lid.anchor == pytest.approx((-0.2, 0.0, 0.41))
    assert len(lid.parts) == 1
    (room,) = shapes["box1"].interiors
    assert room.behind == ("lid",)


def test_a_handle_moves_with_its_door_and_a_hinged_body_with_its_pose():
    world = World(
        mujoco.MjSpec.from_string("""<mujoco><worldbody>
          <body name="wardrobe1"><geom type="box" size=".3 .6 .01" pos="0 0 .01"/>
            <body name="leaf" pos=".3 .6 1"><joint name="door" axis="0 0 1" range="0 90"/>
              <geom type="box" size=".01 .6 1" pos="0 -.6 0"/>
              <body name="handle" pos=".02 -1 0"><joint name="turn" axis="1 0 0" range="0 45"/>
                <geom type="box" size=".01 .05 .01"/></body></body></body>
          <body name="door1" pos="5 0 0"><joint name="hinge" axis="0 0 1" range="0 90"/>
            <geom type="box" size=".02 .4 1" pos="0 .4 1"/></body>
        </worldbody></mujoco>""")
    )
    shapes = world_shapes(world)
    assert [(leaf.name, len(leaf.parts)) for leaf in shapes["wardrobe1"].leaves] == [("door", 2)]
    assert shapes["door1"].leaves == ()


@pytest.mark.parametrize("yaw", [0.0, 25.0])
def test_a_bowl_of_the_world_is_round_and_does_not_contain_what_stands_beside_it(monkeypatch, yaw):
    """Its wall consists of boxes in a ring. The dice are in corners of the box around its hollow."""
    wall = "".join(
        f'<geom type="box" size=".01 .03 .05" pos="{0.1 * math.cos(k * math.pi / 6)}'
        f' {0.1 * math.sin(k * math.pi / 6)} .06" euler="0 0 {30 * k}"/>'
        for k in range(12)
    )
    corners = [math.radians(yaw + 45.0 + 90.0 * k) for k in range(4)]
    dice = "".join(
        f'<body name="die{k}" pos="{0.122 * math.cos(at)} {0.122 * math.sin(at)} .05" euler="0 0 {yaw}">'
        '<freejoint/><geom type="box" size=".005 .005 .05"/></body>'
        for k, at in enumerate(corners)
    )
    world = World(
        mujoco.MjSpec.from_string(
            f'<mujoco><worldbody><body name="bowl1" euler="0 0 {yaw}">'
            f'<geom type="cylinder" size=".1 .01" pos="0 0 .01"/>{wall}</body>{dice}'
            '<body name="egg1" pos=".04 .04 .045"><freejoint/><geom size=".025"/></body></worldbody></mujoco>'
        )
    )
    found = world_shapes(world)
    monkeypatch.setattr(model_shapes, "_world", WorldShapes.of(found))
    (room,) = found["bowl1"].interiors
    assert room.round
    assert math.dist(room.low[:2], room.high[:2]) / 2 > 0.122
    assert {fact for fact in computed(entities(world)) if fact[1] == "isInside"} == {
        ("egg1", "isInside", "bowl1")
    }


def test_get_names_the_source_of_a_shape(known):
    sources = {entity.name: name_shape_source(entity) for entity in known}
    assert sources["oven1"] == "world"
    assert sources["marker1"] == "box"  # nothing of it collides
    grown = thing("oven1", (0.0, 2.0, 0.0), size=(0.9, 0.9, 0.9))
    assert name_shape_source(grown) == "model"


def shapes_of(mjcf):
    return WorldShapes.of(
        world_shapes(World(mujoco.MjSpec.from_string(f"<mujoco><worldbody>{mjcf}</worldbody></mujoco>")))
    )


def test_bodies_of_earlier_worlds_keep_their_shapes_and_equal_bodies_share_one():
    first = shapes_of(
        '<body name="cup1"><geom size=".1"/></body><body name="cup2" pos="1 0 0"><geom size=".1"/></body>'
    )
    assert len(first.shapes) == 1
    both = first.followed_by(shapes_of('<body name="mug2"><geom size=".2"/></body>'))
    assert both.bodies.keys() == {"cup1", "cup2", "mug2"}
    assert both.followed_by(first) == both


def test_a_later_world_does_not_replace_shapes_of_the_same_names_and_other_sizes(monkeypatch):
    monkeypatch.setattr(model_shapes, "_world", WorldShapes())
    for height in (0.4, 0.6, 0.5, 0.6):
        later = shapes_of(
            f'<body name="table1"><geom type="box" size=".5 .5 .01" pos="0 0 {height}"/>'
            '<geom type="box" size=".02 .02 .1" pos="0 0 .1"/></body>'
        )
        model_shapes.exchange_world(model_shapes.world().followed_by(later))
    found = [model_shapes.model_in_world("table1", "table", (1.0, 1.0, size)) for size in (0.61, 0.41, 0.51)]
    assert [model_shapes.shape_named(name).surfaces[0].height for name in found] == [0.61, 0.41, 0.51]
    assert model_shapes.model_in_world("table1", "table", None) == found[0]
    assert model_shapes.model_in_world("table1", "table", (1.0, 1.0, 0.9)) == "table"
    assert len(model_shapes.world().shapes) == 3


def test_a_later_shape_of_the_same_size_replaces_the_earlier_one():
    plain = shapes_of('<body name="box1"><geom type="box" size=".1 .1 .1"/></body>')
    round_one = shapes_of('<body name="box1"><geom type="cylinder" size=".1 .1"/></body>')
    assert plain.followed_by(round_one) == round_one


def test_a_robot_has_no_shape():
    world = World(
        mujoco.MjSpec.from_string(
            '<mujoco><worldbody><body name="robot1"><geom size=".1"/></body>'
            '<body name="cup1" pos="1 0 0"><geom size=".1"/></body></worldbody></mujoco>'
        )
    )
    world.mark_robot("robot1")
    assert world_shapes(world).keys() == {"cup1"}


def test_a_joint_of_the_body_itself_does_not_hide_those_of_its_parts():
    shapes = world_shapes(
        World(
            mujoco.MjSpec.from_string("""<mujoco><worldbody>
          <body name="cabinet1" pos="0 0 1"><joint name="whole" axis="0 0 1" range="0 90"/>
            <geom type="box" size=".3 .3 .5"/>
            <body name="ball" pos="0 0 .6"><joint name="socket" type="ball"/>
              <geom type="sphere" size=".05"/></body>
            <body name="leaf" pos=".31 .3 0"><joint name="door" axis="0 0 1" range="0 90"/>
              <geom type="box" size=".01 .3 .5" pos="0 -.3 0"/></body></body>
        </worldbody></mujoco>""")
        )
    )
    assert [leaf.name for leaf in shapes["cabinet1"].leaves] == ["door"]


def test_meshes_of_equal_boxes_and_other_forms_have_shapes_of_their_own():
    """Two tetrahedra fill the same box, one upside down."""
    corners = {"up": "0 0 0 1 0 0 0 1 0 0 0 1", "down": "0 0 1 1 0 1 0 1 1 0 0 0"}
    assets = "".join(f'<mesh name="{name}" vertex="{points}"/>' for name, points in corners.items())
    pieces = "".join(
        f'<body name="{name}1" pos="{x} 0 0"><geom type="mesh" mesh="{name}"/></body>'
        for x, name in enumerate(corners)
    )
    world = World(
        mujoco.MjSpec.from_string(f"<mujoco><asset>{assets}</asset><worldbody>{pieces}</worldbody></mujoco>")
    )
    shapes = world_shapes(world)
    assert shapes["up1"] != shapes["down1"]
