"""Relations depend on the state of doors, lids and drawers."""

import math

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.facts.contradictions import find_contradiction
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.geometry.fitting import fit_model
from semmap.nodes.kb_node.relations.geometry.opening import open_shape, positions_of
from semmap.nodes.kb_node.relations.measuring.proximity import gap_from_above
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.relation_reports import list_relations
from semmap.ontology.model_shapes import Interior, LeafShape, ModelShape, own_size_m, shapes
from semmap.schemas.commands import Relations
from tests.kb_node.relations.entities import ROOM, thing

CHEST = thing("chest1", (0.0, 0.0, 0.0), "drawer")
TRAVEL = shapes()["drawer"].leaves[-1].limits[1]
FLOOR_OF_TOP_DRAWER = shapes()["drawer"].leaves[-1].interiors[0].low[2]
IN_THE_DRAWER = (0.05, 0.0, FLOOR_OF_TOP_DRAWER)
OVEN = thing("oven1", (0.0, 0.0, 0.0), "oven")


def standing(entity, positions):
    return structs.replace(entity, properties={"jointPositions": positions, "isOpen": True})


def facts_of(*entities):
    facts = Facts()
    facts.update([ROOM, *entities])
    return set(facts)


def pulled(entity, by):
    x, y, z = entity.pose.position_m
    return structs.replace(entity, pose=structs.replace(entity.pose, position_m=(x + by, y, z)))


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0])
@pytest.mark.parametrize("yaw", [0.0, 0.7, math.pi / 2])
def test_contents_of_a_drawer_move_with_it(share, yaw):
    x, _, z = IN_THE_DRAWER
    out = x + share * TRAVEL
    chest = standing(thing("chest1", (1.0, 1.0, 0.0), "drawer", yaw=yaw), f"drawer_1={share * TRAVEL:.3f}")
    apple = thing("apple1", (1.0 + math.cos(yaw) * out, 1.0 + math.sin(yaw) * out, z))
    found = facts_of(chest, apple)
    assert ("apple1", "isInside", "chest1") in found
    assert ("apple1", "isOn", "chest1") not in found


def test_an_object_before_a_closed_drawer_is_not_in_it():
    apple = pulled(thing("apple1", IN_THE_DRAWER), TRAVEL)
    assert ("apple1", "isInside", "chest1") in facts_of(standing(CHEST, f"drawer_1={TRAVEL}"), apple)
    for chest in (CHEST, standing(CHEST, "drawer_1=0"), standing(CHEST, f"drawer_2={TRAVEL}")):
        assert ("apple1", "isInside", "chest1") not in facts_of(chest, apple)


def test_drawer_and_contents_are_added_and_removed():
    facts, apple = Facts(), thing("apple1", IN_THE_DRAWER)
    said = ("apple1", "isInside", "chest1")
    facts.update([ROOM, CHEST, apple])
    assert said in facts
    for share in (1.0, 0.4, 0.0):
        changed = facts.update([standing(CHEST, f"drawer_1={share * TRAVEL}"), pulled(apple, share * TRAVEL)])
        assert said not in changed.gone
        assert said in facts
    assert set(facts) == facts_of(standing(CHEST, "drawer_1=0"), apple)


def test_a_coarse_assertion_agrees_with_a_drawer():
    apple = pulled(thing("apple1", IN_THE_DRAWER), TRAVEL)
    for said in ({"isOpen": True}, {"openness": 1.0, "isOpen": True}):
        assert ("apple1", "isInside", "chest1") in facts_of(structs.replace(CHEST, properties=said), apple)
    said = {"openness": 0.0, "isOpen": False}
    assert ("apple1", "isInside", "chest1") not in facts_of(structs.replace(CHEST, properties=said), apple)


def test_an_object_on_an_open_oven_door_is_on_the_oven():
    door = shapes()["oven"].leaves[0]
    top = max(part.centre[2] for part in open_shape(shapes()["oven"], (math.pi / 2,)).parts[-1:]) + 0.01
    plate = thing("plate1", (door.anchor[0] + 0.22, 0.0, top))
    open_ = standing(OVEN, f"door={math.pi / 2:.4f}")
    assert ("plate1", "isOn", "oven1") in facts_of(open_, plate)
    assert ("plate1", "isInside", "oven1") not in facts_of(open_, plate)
    assert ("plate1", "isOn", "oven1") not in facts_of(OVEN, plate)
    assert ("plate1", "isOn", "oven1") not in facts_of(standing(OVEN, "door=0.8"), plate)


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.0, 1.745])
@pytest.mark.parametrize("y", [-0.3, 0.0, 0.3, 0.6])
def test_an_object_before_an_open_fridge_is_not_in_it(angle, y):
    fridge = standing(thing("fridge1", (0.0, 0.0, 0.0)), f"door={angle} freezer=0")
    milk = thing("carton1", (0.5, y, 0.0))
    shelf = thing("carton2", (-0.1, 0.0, shapes()["fridge"].surfaces[3].height))
    found = facts_of(fridge, milk, shelf)
    assert ("carton1", "isInside", "fridge1") not in found
    assert ("carton1", "isOn", "fridge1") not in found
    assert ("carton2", "isInside", "fridge1") in found


def test_an_object_against_an_open_door_touches_the_fridge():
    fridge = thing("fridge1", (0.0, 0.0, 0.0))
    open_ = standing(fridge, "door=1.5708 freezer=0")  # along the x axis, at y = 0.294
    poster = thing("poster1", (0.7, 0.294 + 0.0105, 0.5), "", size=(0.2, 0.02, 0.3))
    for one, holds in ((open_, True), (fridge, False)):
        found = list_relations(Space([one, poster]), Relations(name="poster1", other="fridge1"))
        found = {r.relation: r for r in found}
        assert ("touches" in found and found["touches"].holds) is holds
        assert (found["isNear"].gap_m < 0.001) is holds


def test_explanations_include_the_joint_state():
    apple = pulled(thing("apple1", IN_THE_DRAWER), 0.5 * TRAVEL)
    chest = standing(CHEST, f"drawer_1={0.5 * TRAVEL:.3f}")
    carton = thing("carton1", (3.0 - 0.1, 0.0, 0.867))
    fridge = standing(thing("fridge1", (3.0, 0.0, 0.0)), "door=0.873 freezer=0")
    space = Space([ROOM, chest, apple, fridge, carton])

    def said(name, other):
        found = {r.relation: r.text for r in list_relations(space, Relations(name=name, other=other))}
        return found["isInside"]

    assert said("apple1", "chest1") == (
        "apple1 is inside chest1: 100% of its volume is within drawer_1 of chest1, which is open to 50%"
    )
    assert said("carton1", "fridge1") == (
        "carton1 is inside fridge1: 100% of its volume is within a hollow of fridge1, behind door,"
        " which is open to 50%"
    )


def test_joint_positions_are_clamped_and_play_is_ignored():
    size = own_size_m("drawer")
    assert positions_of("drawer", size, {"jointPositions": "drawer_1=0.001"}) == ()
    found = positions_of("drawer", size, {"jointPositions": "drawer_1=9 drawer_9=1 nonsense"})
    assert found == (0.0, 0.0, 0.0, pytest.approx(TRAVEL))
    assert positions_of("drawer", size, {"isOpen": False}) == ()
    assert positions_of("laptop", own_size_m("laptop"), {"isOpen": False}) != ()  # it is drawn open
    assert positions_of("table", own_size_m("table"), {"isOpen": True}) == ()
    assert positions_of("drawer", None, {"isOpen": True}) == ()


def test_a_larger_chest_has_longer_drawer_travel():
    size = tuple(2.0 * extent for extent in own_size_m("drawer"))
    (*_, most) = positions_of("drawer", size, {"openness": 1.0})
    assert most == pytest.approx(2.0 * TRAVEL)
    wide = open_shape(
        fit_model("drawer", (0.8, 0.45, 0.9)), (0.0, 0.0, 0.0, 0.3)
    )  # long where it was wide: turned
    shut = fit_model("drawer", (0.8, 0.45, 0.9))
    assert wide.parts[-1].centre[1] == pytest.approx(shut.parts[-1].centre[1] - 0.3)


@pytest.mark.parametrize("model", sorted(name for name, shape in shapes().items() if shape.leaves))
def test_opening_keeps_sizes_and_closing_restores_the_shape(model):
    shape = shapes()[model]
    ends = tuple(leaf.limits[1] for leaf in shape.leaves)
    moved = open_shape(shape, ends)
    still = set(range(len(shape.parts))) - {k for leaf in shape.leaves for k in leaf.parts}
    for k, (was, now) in enumerate(zip(shape.parts, moved.parts, strict=True)):
        for before, after in zip(was.straight, now.straight, strict=True):
            assert math.hypot(*after) == pytest.approx(math.hypot(*before))
        assert (was == now) == (k in still)
    assert open_shape(shape, (0.0,) * len(shape.leaves)) == shape


@pytest.mark.parametrize("position", [0.0, 0.1, 0.3])
def test_a_drawer_below_a_desk_without_a_hollow_has_its_own(position):
    tray = Interior(low=(0.2, -0.2, 0.6), high=(0.5, 0.2, 0.7))
    drawer = LeafShape(
        name="drawer", kind="slide", anchor=(0, 0, 0), axis=(0, -1, 0), limits=(0, 0.3), interiors=(tray,)
    )
    desk = ModelShape(size_m=(1.4, 0.7, 0.75), leaves=(drawer,))
    (hollow,) = open_shape(desk, (position,)).interiors
    assert hollow.low == pytest.approx((0.2, -0.2 - position, 0.6))
    assert hollow.carried_by == "drawer"
    if not position:
        assert open_shape(desk, ()) == open_shape(desk, (0.0,))


@pytest.mark.parametrize(
    ("x", "joints", "text"),
    [
        (0.34, f"drawer_1={TRAVEL}", None),
        (0.34, "drawer_1=0", "to be under chest1; seen from above they are 7.5 cm apart"),
        (1.5, f"drawer_1={TRAVEL}", "to be under chest1; seen from above they are"),
    ],
)
def test_an_object_under_an_open_drawer_is_under_the_chest(x, joints, text):
    cup, chest = thing("cup1", (x, 0.0, 0.0), size=(0.08, 0.08, 0.1)), standing(CHEST, joints)
    space = Space([ROOM, chest, cup])
    is_under, is_above = ("cup1", "isUnder", "chest1"), ("chest1", "isAbove", "cup1")
    for denied in (find_contradiction(space, is_under), find_contradiction(space, is_above)):
        assert (denied is None) == (text is None)
    assert text is None or text in find_contradiction(space, is_under).text


def test_the_distance_from_above_is_that_of_the_open_drawer():
    cup, chest = thing("cup1", (1.5, 0.0, 0.0)), standing(CHEST, f"drawer_1={TRAVEL}")
    gaps = [
        gap_from_above(solids["cup1"], solids["chest1"])
        for solids in (Space([ROOM, each, cup]).solids for each in (CHEST, chest))
    ]
    assert gaps[0] - gaps[1] == pytest.approx(TRAVEL, abs=0.05)
