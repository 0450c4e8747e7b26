"""Transactions that are built from commands, and their reasons."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.coordinator.commands import transactions
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.commits import Edit, Statement
from semmap.schemas.entities import ClassInfo, Pose, orientation_from_yaw
from semmap.schemas.scene_files import Described
from tests.coordinator.reconciler.test_reconcile import entity

HERE = Pose(position_m=(1.0, 2.0, 0.0))
TURNED = Pose(position_m=(1.0, 2.0, 0.0), orientation_wxyz=orientation_from_yaw(1.0))
SQUARE = "POLYGON ((0 0, 4 0, 4 2, 0 2, 0 0))"


def class_(name, *, place=False):
    return ClassInfo(
        name=name,
        iri=f"http://example.org/{name}",
        parents=(),
        ancestors=(),
        labels={},
        spatial=True,
        place=place,
        fixed=False,
        model="",
    )


CHAIR, KITCHEN = class_("Chair"), class_("Kitchen", place=True)
ROOM = structs.replace(entity("kitchen1", HERE, place=True), size_m=(4.0, 2.0, 2.5))
DRAWN = structs.replace(ROOM, properties={"hasExtent": SQUARE})


def said(statements):
    return {one.property: one.values for one in statements}


def test_a_transaction_has_the_metadata_of_the_command():
    command = c.Update(
        name="chair1",
        id="u1",
        source="agent",
        agent="ann",
        reason="tidy",
        confidence=0.5,
        unchanged=("table1",),
        since=7,
        dry_run=True,
    )
    made = transactions.build(command, "update chair1")
    assert (made.id, made.source, made.agent, made.verb, made.reason) == (
        "u1",
        "agent",
        "ann",
        "update",
        "tidy",
    )
    assert (made.confidence, made.unchanged, made.since, made.dry_run, made.told) == (
        0.5,
        ("table1",),
        7,
        True,
        True,
    )


def test_a_command_without_metadata_has_the_defaults():
    made = transactions.build(c.Clear(id="c1"), "clear")
    assert (made.reason, made.confidence, made.unchanged, made.since, made.dry_run) == (
        "clear",
        None,
        (),
        0,
        False,
    )


def test_a_change_of_the_scene_has_no_verb():
    command = c.Add(class_="Chair", id="a", source="scene")
    assert transactions.add(command, "chair1", CHAIR, HERE, None).verb == ""
    assert (
        transactions.add(structs.replace(command, source="agent"), "chair1", CHAIR, HERE, None).verb == "add"
    )


def test_a_new_entity_is_as_the_command_describes_it():
    command = c.Add(
        class_="Chair",
        id="a",
        size=(1.0, 2.0, 3.0),
        alt=("stool",),
        set=("note=a=b", " isOpen =true"),
        track="sim",
    )
    made = transactions.add(command, "chair1", CHAIR, TURNED, "seat")
    (new,) = made.add
    assert (new.name, new.class_iri, new.pose, new.size) == ("chair1", CHAIR.iri, TURNED, (1.0, 2.0, 3.0))
    assert (new.ref, new.alt, new.tracked) == ("seat", ("stool",), "sim")
    assert said(new.set) == {"note": ("a=b",), "isOpen": ("true",)}
    assert made.reason == "add Chair chair1"


def test_a_new_place_with_an_extent_is_in_the_middle_of_it():
    command = c.Add(class_="Kitchen", id="a", extent=SQUARE)
    (new,) = transactions.add(command, "kitchen1", KITCHEN, Pose(position_m=(9.0, 9.0, 0.5)), None).add
    assert (new.pose, new.size) == (Pose(position_m=(2.0, 1.0, 0.5)), None)
    assert list(said(new.set)) == ["hasExtent"]
    sized = structs.replace(command, size=(9.0, 9.0, 3.0))
    (new,) = transactions.add(sized, "kitchen1", KITCHEN, HERE, None).add
    assert new.size == (4.0, 2.0, 3.0)


@pytest.mark.parametrize(
    ("found", "pose", "why"),
    [
        (
            CHAIR,
            HERE,
            "only places have an extent, and a Chair is not a place; use --size X Y Z",
        ),
        (KITCHEN, TURNED, "an extent is in the map frame and cannot be turned; remove the angle"),
    ],
)
def test_only_a_place_that_is_not_turned_has_an_extent(found, pose, why):
    with pytest.raises(errors.BadRequest) as refused:
        transactions.add(c.Add(class_="X", id="a", extent=SQUARE), "x1", found, pose, None)
    assert str(refused.value) == why


def test_an_update_changes_only_what_is_given():
    made = transactions.update(c.Update(name="chair1", id="u"), entity("chair1", HERE))
    assert made.edit == (Edit(name="chair1"),)
    command = c.Update(
        name="chair1",
        id="u",
        at=(3.0, 0.0, 0.0),
        yaw=1.0,
        size=(1.0, 1.0, 1.0),
        ref="seat",
        alt=("a",),
        conflict="gone",
        unset=("note", "isOpen=true", " hasColor ="),
        set=("weight=3",),
        carry=True,
        leave=("cup1",),
    )
    (edit,) = transactions.update(command, entity("chair1", HERE), CHAIR).edit
    assert edit == Edit(
        name="chair1",
        class_iri=CHAIR.iri,
        at=(3.0, 0.0, 0.0),
        yaw=1.0,
        size=(1.0, 1.0, 1.0),
        ref="seat",
        alt=("a",),
        conflict="gone",
        unset=(
            Statement(property="note"),
            Statement(property="isOpen", values=("true",)),
            Statement(property="hasColor", values=("",)),
        ),
        set=(Statement(property="weight", values=("3",)),),
        carry=True,
        leave=("cup1",),
    )


def test_an_extent_given_to_a_place_moves_and_resizes_it_only_where_that_is_given():
    (edit,) = transactions.update(c.Update(name="kitchen1", id="u", extent=SQUARE), ROOM).edit
    assert (edit.at, edit.size, list(said(edit.set))) == (None, None, ["hasExtent"])
    command = c.Update(name="kitchen1", id="u", extent=SQUARE, at=(0.0, 0.0, 1.0), size=(1.0, 1.0, 3.0))
    (edit,) = transactions.update(command, ROOM).edit
    assert (edit.at, edit.size) == ((2.0, 1.0, 1.0), (4.0, 2.0, 3.0))


@pytest.mark.parametrize(
    ("fields", "one", "found", "error"),
    [
        ({}, entity("chair1", HERE), None, "only places"),
        ({}, ROOM, CHAIR, "a Chair is not a place"),
        ({"yaw": 0.0}, ROOM, None, "cannot be turned"),
        ({"orientation": (1.0, 0.0, 0.0, 0.0)}, ROOM, None, "cannot be turned"),
    ],
)
def test_an_extent_is_rejected_for_objects_and_with_an_angle(fields, one, found, error):
    with pytest.raises(errors.BadRequest, match=error):
        transactions.update(c.Update(name=one.name, id="u", extent=SQUARE, **fields), one, found)


@pytest.mark.parametrize(
    "fields",
    [
        {"at": (9.0, 2.0, 0.0)},
        {"at": (1.0, 9.0, 0.0)},
        {"size": (9.0, 2.0, 2.5)},
        {"yaw": 0.0},
        {"orientation": (1.0, 0.0, 0.0, 0.0)},
        {"at": (9.0, 2.0, 0.0), "unset": ("note",)},
    ],
)
def test_a_place_with_a_polygon_is_neither_moved_nor_turned_as_a_box(fields):
    with pytest.raises(
        errors.Refused, match=r"^the extent of kitchen1 is a polygon: give another with --extent"
    ):
        transactions.update(c.Update(name="kitchen1", id="u", **fields), DRAWN)


@pytest.mark.parametrize(
    ("one", "fields"),
    [
        (DRAWN, {"at": (1.0, 2.0, 5.0)}),
        (DRAWN, {"size": (4.0, 2.0, 9.0)}),
        (DRAWN, {"ref": "galley"}),
        (DRAWN, {"at": (9.0, 2.0, 0.0), "unset": ("hasExtent",)}),
        (DRAWN, {"yaw": 1.0, "unset": ("hasExtent=old",)}),
        (ROOM, {"at": (9.0, 2.0, 0.0), "yaw": 1.0}),
        (structs.replace(DRAWN, pose=None), {"at": (9.0, 2.0, 0.0)}),
        (structs.replace(DRAWN, size_m=None), {"at": (9.0, 2.0, 0.0)}),
    ],
    ids=["height", "tall", "name", "unset", "unset value", "box", "nowhere", "no size"],
)
def test_fields_that_a_polygon_does_not_define_may_change(one, fields):
    transactions.update(c.Update(name="kitchen1", id="u", **fields), one)


@pytest.mark.parametrize(
    ("fields", "condition"),
    [
        ({}, ()),
        ({"if_unset": True}, (Statement(property="isOpen"),)),
        ({"if_is": False}, (Statement(property="isOpen", values=("false",)),)),
    ],
)
def test_property_values_are_written_as_text(fields, condition):
    command = c.Set(name="door1", id="s", property="isOpen", values=(True, 2, "x"), **fields)
    made = transactions.set_property(command)
    (edit,) = made.edit
    assert (said(edit.set), edit.only_if) == ({"isOpen": ("true", "2", "x")}, condition)
    assert made.reason == "set door1 isOpen true 2 x"


def test_a_set_needs_a_value_and_one_condition_at_most():
    with pytest.raises(errors.BadRequest, match=r"^give a value of isOpen; to have none: semmap unset$"):
        transactions.set_property(c.Set(name="door1", id="s", property="isOpen", values=()))
    both = c.Set(name="door1", id="s", property="isOpen", values=(True,), if_is=False, if_unset=True)
    with pytest.raises(errors.BadRequest, match=r"^give either --if-is or --if-unset$"):
        transactions.set_property(both)


@pytest.mark.parametrize(
    ("fields", "values", "condition", "reason"),
    [
        ({}, (), (), "unset door1 isOpen"),
        ({"value": False}, ("false",), (), "unset door1 isOpen false"),
        ({"if_is": 1}, (), (Statement(property="isOpen", values=("1",)),), "unset door1 isOpen"),
    ],
)
def test_a_property_loses_a_value_or_all(fields, values, condition, reason):
    made = transactions.unset_property(c.Unset(name="door1", id="s", property="isOpen", **fields))
    (edit,) = made.edit
    assert (said(edit.unset), edit.only_if, made.reason) == ({"isOpen": values}, condition, reason)


@pytest.mark.parametrize(
    ("count", "reason"),
    [
        (1, "update e0"),
        (4, "update e0; update e1; update e2; update e3"),
        (5, "update e0; update e1; update e2; and 2 more changes"),
    ],
)
def test_the_reason_names_each_change_of_a_small_batch(count, reason):
    changes = [
        transactions.update(c.Update(name=f"e{i}", id="u"), entity(f"e{i}", HERE)) for i in range(count)
    ]
    made = transactions.combine(c.Batch(changes=(), id="b"), changes)
    assert made.reason == reason
    assert [edit.name for edit in made.edit] == [f"e{i}" for i in range(count)]


@pytest.mark.parametrize(
    ("fields", "tracked", "reason"),
    [
        ({}, "stream", "track robot1 --from stream"),
        ({"from_": "sim"}, "sim", "track robot1 --from sim"),
        ({"from_": "sim", "off": True}, "", "track robot1 --off"),
    ],
)
def test_tracking_is_started_and_stopped(fields, tracked, reason):
    made = transactions.track(c.Track(name="robot1", id="t", **fields))
    assert (made.edit, made.reason) == ((Edit(name="robot1", tracked=tracked),), reason)


def test_attaching_stores_pose_holder_and_grip():
    taken = [
        transactions.Attachment("tray1", "hand1", HERE, TURNED),
        transactions.Attachment("cup1", "tray1", None, None),
    ]
    made = transactions.attach(c.Attach(name="tray1", to="hand1", id="a"), "hand1", taken)
    tray, cup = made.edit
    assert made.reason == "attach tray1 --to hand1"
    assert (tray.at, tray.orientation) == (TURNED.position_m, TURNED.orientation_wxyz)
    assert (said(tray.set), tray.unset) == ({"isGraspedBy": ("hand1",), "graspPose": ("1 2 0 1 0 0 0",)}, ())
    assert (cup.at, cup.orientation, said(cup.set)) == (None, None, {"isGraspedBy": ("tray1",)})
    assert said(cup.unset) == {"graspPose": ()}


def test_detaching_stores_the_pose_and_removes_the_holder():
    made = transactions.detach(c.Detach(name="cup1", id="d"), {"cup1": TURNED, "fork1": None})
    cup, fork = made.edit
    assert made.reason == "detach cup1"
    assert (cup.at, cup.orientation) == (TURNED.position_m, TURNED.orientation_wxyz)
    assert (fork.name, fork.at, fork.orientation) == ("fork1", None, None)
    assert said(cup.unset) == said(fork.unset) == {"isGraspedBy": (), "graspPose": ()}
    assert cup.set == fork.set == ()


def test_an_entity_of_a_file_is_as_it_is_described_there():
    given = Described(
        class_="Chair",
        at=(1.0, 2.0, 0.0),
        yaw=1.0,
        size=(1.0, 1.0, 1.0),
        ref="seat",
        alt=("stool",),
        affords=("supporting",),
        set=("note=x",),
    )
    new = transactions.new_entity("chair1", CHAIR, given)
    assert (new.name, new.class_iri, new.pose, new.size) == ("chair1", CHAIR.iri, TURNED, (1.0, 1.0, 1.0))
    assert (new.ref, new.alt, new.affordances, said(new.set)) == (
        "seat",
        ("stool",),
        ("supporting",),
        {"note": ("x",)},
    )


def test_a_place_of_a_file_is_where_its_extent_is_if_it_is_anywhere():
    given = Described(class_="Kitchen", extent=SQUARE)
    new = transactions.new_entity("kitchen1", KITCHEN, given)
    assert (new.pose, new.size, list(said(new.set))) == (None, None, ["hasExtent"])
    new = transactions.new_entity("kitchen1", KITCHEN, structs.replace(given, at=(0.0, 0.0, 0.0)))
    assert new.pose == Pose(position_m=(2.0, 1.0, 0.0))
    with pytest.raises(
        errors.BadRequest, match=r"^chair1: only places have an extent, and a Chair is not a place"
    ):
        transactions.new_entity("chair1", CHAIR, given)


@pytest.mark.parametrize("words", ["note", "=x", ""])
def test_an_invalid_assignment_is_rejected(words):
    with pytest.raises(errors.BadRequest, match=f"^'{words}' is not of the form PROPERTY=VALUE$"):
        transactions.add(c.Add(class_="Chair", id="a", set=(words,)), "chair1", CHAIR, HERE, None)


def test_an_assignment_may_have_an_empty_value():
    (new,) = transactions.add(c.Add(class_="Chair", id="a", set=("note=",)), "chair1", CHAIR, HERE, None).add
    assert said(new.set) == {"note": ("",)}


@pytest.mark.parametrize("fields", [{"at": (9.0, 2.0, 0.0)}, {"size": (9.0, 2.0, 2.5)}])
def test_a_file_does_not_move_a_place_with_a_polygon_as_a_box(fields):
    with pytest.raises(errors.Refused, match=r"^the extent of kitchen1 is a polygon"):
        transactions.edit_entity(DRAWN, KITCHEN, Described(class_="Kitchen", **fields))


def test_a_file_gives_a_place_with_a_polygon_another_one_or_another_word():
    another = "POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0))"
    edit = transactions.edit_entity(
        DRAWN, KITCHEN, Described(class_="Kitchen", extent=another, at=(1.0, 1.0, 0.0))
    )
    assert edit.at == (2.0, 2.0, 0.0)
    edit = transactions.edit_entity(DRAWN, KITCHEN, Described(class_="Kitchen", ref="galley"))
    assert (edit.at, edit.ref) == (None, "galley")
