"""Objects in a tray are on the tray, within the pose tolerance."""

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.support import describe_unsupported
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas.entities import Pose
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing
from tests.kb_node.relations.facts.test_many_at_once import require_alike

HALF_M = own_size_m("tray")[0] / 2
FLOOR_M = 0.01
RIM_M = 0.015


def on_tray(x, above=0.0, model="cup"):
    """Return an object at `x` in a tray on a table, at this height above the tray's floor in the map [m]."""
    return [TABLE, thing("tray1", (0.0, 0.0, TOP)), thing(f"{model}1", (x, 0.0, TOP + FLOOR_M + above))]


def carriers(name, things):
    space = Space([ROOM, *things])
    solid = space.solids[name]
    assert describe_unsupported(space, solid) is None
    return [other.name for other, _ in space.spatial_relations(solid).supports]


@pytest.mark.parametrize("model", ["cup", "glass", "bottle"])
@pytest.mark.parametrize("above", [-0.01, 0.0, 0.005, 0.03])
@pytest.mark.parametrize("x", [0.0, 0.09, HALF_M - RIM_M - 0.03, HALF_M - RIM_M - 0.015])
def test_an_object_in_a_tray_is_not_on_the_table(x, above, model):
    """Also if its pose overlaps the rim or the floor within the tolerance."""
    things = on_tray(x, above, model)
    assert carriers(f"{model}1", things) == ["tray1"]
    require_alike([ROOM, *things])


def test_an_object_is_on_a_raised_tray():
    _, tray, cup = on_tray(0.11, 0.03)
    assert carriers("cup1", [tray, cup]) == ["tray1"]


def test_a_board_across_the_rims_is_on_them():
    """A board wider than the tray rests on its rims, slightly above the floor."""
    pose = Pose(position_m=(0.0, 0.0, TOP + 0.04), orientation_wxyz=(1.0, 0.0, 0.0, 0.0))
    board = PlacedEntity(
        name="board1", iri="urn:board1", pose=pose, size_m=(0.4, 0.1, 0.01), place=False, model=""
    )
    space = Space([TABLE, thing("tray1", (0.0, 0.0, TOP)), board])
    ((tray, made),) = space.spatial_relations(space.solids["board1"]).supports
    assert (tray.name, made.gap_m) == ("tray1", pytest.approx(0.0))


def test_two_trays_at_one_spot_do_not_support_each_other():
    trays = [thing("tray1", (0.0, 0.0, TOP)), thing("tray2", (0.0, 0.0, TOP))]
    assert [carriers(tray.name, [TABLE, *trays]) for tray in trays] == [["table1"], ["table1"]]


def held(entity, holder):
    """Return an entity that is attached at its pose."""
    return structs.replace(PlacedEntity.of(entity), held_by=holder)


def test_the_contents_of_a_carried_tray_stay_on_it():
    """The tray itself has no support, although it is just above the table."""
    _, tray, cup = on_tray(0.0)
    bowl = thing("bowl1", (0.0, 0.15, TOP + FLOOR_M))
    apple = thing("apple1", (0.0, 0.15, TOP + FLOOR_M + 0.02))
    along = [held(one, "tray1") for one in (cup, bowl, apple)]
    space = Space([TABLE, held(tray, "gripper1"), *along])
    found = {name: space.spatial_relations(solid) for name, solid in space.solids.items()}
    assert [other.name for other, _ in found["cup1"].supports] == ["tray1"]
    assert [other.name for other, _ in found["bowl1"].supports] == ["tray1"]
    assert found["apple1"].container[0].name == "bowl1"
    assert (found["tray1"].container, found["tray1"].supports) == (None, ())
    assert space.may_support(space.solids["tray1"], space.solids["cup1"])
    assert not space.may_support(space.solids["table1"], space.solids["tray1"])


def test_an_attached_object_has_no_support():
    """Also on a tray that is not carried, and on one that another holder carries."""
    table, tray, cup = on_tray(0.0)
    for things in (
        [held(cup, "gripper1"), tray],
        [held(cup, "tray1"), tray],
        [held(cup, "tray2"), held(tray, "gripper1"), thing("tray2", (1.0, 0.0, TOP))],
    ):
        space = Space([table, *things])
        assert space.spatial_relations(space.solids["cup1"]).supports == ()


def test_a_temporary_detachment_restores_the_support():
    table, tray, cup = on_tray(0.0)
    space = Space([table, held(tray, "gripper1"), held(cup, "tray1")])
    with space.with_changes([PlacedEntity.of(tray)], without=("cup1",)):
        assert [other.name for other, _ in space.spatial_relations(space.solids["tray1"]).supports] == [
            "table1"
        ]
    assert space.spatial_relations(space.solids["tray1"]).supports == ()
    assert [other.name for other, _ in space.spatial_relations(space.solids["cup1"]).supports] == ["tray1"]


@pytest.mark.parametrize(("low", "tray"), [("newspaper", "tray1"), ("phone", "tray1")])
def test_flat_objects_in_a_tray_are_on_it(low, tray):
    """Although most of their volume is below its rim."""
    things = on_tray(0.0, model=low)
    assert carriers(f"{low}1", things) == [tray]
    assert Space(things).spatial_relations(Space(things).solids[f"{low}1"]).container is None
    require_alike([ROOM, *things])
