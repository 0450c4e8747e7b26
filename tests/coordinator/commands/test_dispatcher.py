"""Commands change a real map, without Zenoh."""

from __future__ import annotations

import gzip
from concurrent.futures import Future

import pytest
from msgspec import structs

from semmap.nodes.coordinator.commands import load
from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.commands.registration import HANDLERS
from semmap.nodes.coordinator.kb_coroutines import run_async
from semmap.nodes.coordinator.reconciler.observed_state import ObservedState
from semmap.nodes.coordinator.scheduler import Scheduler
from semmap.nodes.kb_node.documents.isolated_parser import IsolatedParser
from semmap.nodes.runtime.futures import settle
from semmap.ontology import vocabulary as v
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import LoadDocument
from semmap.schemas.calls import reply_type
from semmap.schemas.commits import Commit, Transaction
from semmap.schemas.entities import Pose, orientation_from_yaw
from semmap.schemas.replies import Changed
from semmap.schemas.scenes import Body
from tests.kb_node import home


def add(dispatcher: CommandDispatcher, class_: str = "Chair", name: str | None = None, **fields) -> Changed:
    return dispatcher.change(c.Add(class_=class_, name=name, **fields))


def test_every_command_that_returns_a_commit_has_a_handler():
    returned = {kind for kind in c.COMMANDS.values() if reply_type(kind) is Changed}
    assert {kind.__name__ for kind in returned ^ HANDLERS.keys()} == set()


def everything(semantic_map) -> set:
    return set(semantic_map.abox())


def test_add_reports_the_entity(dispatcher):
    reply = add(dispatcher, at=(1.0, 2.0, 0.0), yaw=1.0, size=(0.4, 0.4, 0.9), ref="seat", alt=("stool",))
    (name,) = reply.names
    chair = dispatcher.map.entity(name)
    assert (name, chair.class_, reply.commit) == ("chair1", "Chair", 1)
    assert chair.pose == Pose(position_m=(1.0, 2.0, 0.0), orientation_wxyz=orientation_from_yaw(1.0))
    assert (chair.size_m, chair.preferred_reference, chair.alternative_references) == (
        (0.4, 0.4, 0.9),
        "seat",
        ("stool",),
    )


def test_add_with_all_defaults(dispatcher):
    add(dispatcher, default=True)
    add(dispatcher, default=True)
    first, second = dispatcher.map.entity("chair1"), dispatcher.map.entity("chair2")
    assert first.pose.position_m == (2.0, 2.0, 0.0)
    assert second.pose.position_m != first.pose.position_m
    assert first.preferred_reference == "chair"


def test_a_class_is_found_without_regard_to_case_and_underscores(dispatcher):
    reply = add(dispatcher, "livingroomtable", "t1")
    assert dispatcher.map.entity("t1").class_ == "Living_Room_Table"
    assert reply.notes == ("'livingroomtable' is read as Living_Room_Table",)


@pytest.mark.parametrize(
    ("fields", "error"),
    [
        ({"class_": "Chiar"}, errors.UnknownClass),
        ({"class_": "Color"}, errors.UnknownClass),
        ({"name": "chair1"}, errors.NameTaken),
        ({"yaw": 1.0, "orientation": (1.0, 0.0, 0.0, 0.0)}, errors.BadRequest),
        ({"orientation": (1.0, 1.0, 0.0, 0.0)}, errors.BadRequest),
    ],
)
def test_a_rejected_add_changes_nothing(dispatcher, semantic_map, fields, error):
    add(dispatcher, name="chair1")
    before = everything(semantic_map), dict(dispatcher.map.entities), dispatcher.map.seq
    with pytest.raises(error):
        add(dispatcher, **{"name": "new", **fields})
    assert (everything(semantic_map), dict(dispatcher.map.entities), dispatcher.map.seq) == before


def test_omitted_fields_of_an_update_are_kept(dispatcher):
    add(
        dispatcher,
        name="chair1",
        at=(1.0, 2.0, 3.0),
        yaw=1.0,
        size=(1.0, 1.0, 1.0),
        ref="seat",
        alt=("a", "b"),
    )
    dispatcher.change(c.Update(name="chair1", at=(5.0, 6.0, 7.0)))
    chair = dispatcher.map.entity("chair1")
    assert chair.pose == Pose(position_m=(5.0, 6.0, 7.0), orientation_wxyz=orientation_from_yaw(1.0))
    assert (chair.size_m, chair.preferred_reference) == ((1.0, 1.0, 1.0), "seat")
    assert chair.alternative_references == ("a", "b")
    dispatcher.change(c.Update(name="chair1", ref="throne"))
    assert dispatcher.map.entity("chair1").pose == chair.pose
    assert dispatcher.map.entity("chair1").preferred_reference == "throne"
    dispatcher.change(c.Update(name="chair1", class_="Furniture"))
    assert dispatcher.map.entity("chair1").class_ == "Furniture"
    assert dispatcher.map.entity("chair1").size_m == (1.0, 1.0, 1.0)


def test_an_update_leaves_no_orphans(dispatcher, semantic_map):
    add(dispatcher, name="chair1", ref="seat", alt=("a", "b"), size=(1.0, 1.0, 1.0))
    before = len(everything(semantic_map))
    for text in ("x", "y", "z"):
        dispatcher.change(
            c.Update(name="chair1", ref=text, alt=(text, text + text), size=(2.0, 1.0, 1.0), yaw=0.0)
        )
    assert len(everything(semantic_map)) == before


def test_an_update_that_changes_nothing_is_no_commit(dispatcher):
    add(dispatcher, name="chair1", at=(1.0, 2.0, 0.0), ref="seat", alt=("a",))
    reply = dispatcher.change(
        c.Update(name="chair1", at=(1.0, 2.0, 0.0), ref="seat", alt=("a",), class_="Chair")
    )
    assert reply.commit is None


def test_a_removed_entity_leaves_nothing(dispatcher, semantic_map):
    before = everything(semantic_map)
    add(
        dispatcher,
        name="chair1",
        at=(1.0, 2.0, 0.0),
        yaw=1.0,
        size=(1.0, 1.0, 1.0),
        ref="seat",
        alt=("a", "b"),
    )
    dispatcher.change(c.Remove(names=("chair1",)))
    assert everything(semantic_map) == before
    assert dispatcher.map.entities == {}


def test_remove_removes_all_or_none(dispatcher):
    add(dispatcher, name="chair1")
    with pytest.raises(errors.UnknownName, match="chair2"):
        dispatcher.change(c.Remove(names=("chair1", "chair2")))
    assert set(dispatcher.map.entities) == {"chair1"}


def test_clear_on_an_empty_map_is_no_commit(dispatcher):
    assert dispatcher.change(c.Clear()).commit is None
    add(dispatcher)
    assert dispatcher.change(c.Clear()).names == ("chair1",)
    assert dispatcher.map.entities == {}


def test_a_name_can_be_used_again_after_removal_and_after_changes_of_references(dispatcher):
    for _ in range(3):
        add(dispatcher, name="chair1", ref="seat")
        dispatcher.change(c.Update(name="chair1", ref="stool"))
        dispatcher.change(c.Remove(names=("chair1",)))


def test_the_same_command_id_is_executed_once(dispatcher):
    first = add(dispatcher, name="chair1", id="42")
    again = add(dispatcher, name="chair1", id="42")
    assert (again.commit, again.names) == (first.commit, first.names)
    gone = dispatcher.change(c.Remove(names=("chair1",), id="43"))
    assert dispatcher.change(c.Remove(names=("chair1",), id="43")).commit == gone.commit
    assert add(dispatcher, name="chair1", id="42").commit == first.commit
    assert dispatcher.map.entities == {}


def test_a_renamed_entity_keeps_everything_and_its_references(dispatcher, semantic_map):
    add(dispatcher, name="chair1", at=(1.0, 2.0, 0.0), size=(1.0, 1.0, 1.0), ref="seat", alt=("a",))
    add(dispatcher, name="chair2", at=(5.0, 2.0, 0.0), set=("isDirectPartOf=chair1",))
    before, was = everything(semantic_map), dispatcher.map.entity("chair1")
    reply = dispatcher.change(c.Rename(name="chair1", new="throne"))
    assert (reply.text, reply.names, reply.commit) == ("renamed chair1 to throne", ("throne",), 3)
    now = dispatcher.map.entity("throne")
    assert (now.pose, now.size_m, now.preferred_reference) == (was.pose, was.size_m, "seat")
    assert dispatcher.map.entity("chair2").properties["isDirectPartOf"] == ("throne",)
    assert set(dispatcher.map.entities) == {"chair2", "throne"}
    tried = dispatcher.change(c.Undo(dry_run=True))
    text = "undid commit 3: renamed chair1 to throne; chair2: isDirectPartOf: + throne, - chair1"
    assert tried.text == f"dry run, nothing changed; it would be: {text}"
    undone = dispatcher.change(c.Undo())
    assert undone.names == ("chair1", "chair2", "throne")
    assert undone.text == text
    assert everything(semantic_map) == before
    assert dispatcher.map.entity("chair2").properties["isDirectPartOf"] == ("chair1",)


def test_the_old_name_is_free_after_a_rename(dispatcher):
    add(dispatcher, name="chair1", at=(1.0, 2.0, 0.0))
    dispatcher.change(c.Rename(name="chair1", new="throne"))
    add(dispatcher, name="chair1", at=(5.0, 2.0, 0.0))
    assert dispatcher.map.entity("chair1").pose.position_m == (5.0, 2.0, 0.0)
    assert dispatcher.map.entity("throne").pose.position_m == (1.0, 2.0, 0.0)
    dispatcher.change(c.Update(name="throne", at=(2.0, 2.0, 0.0)))
    assert dispatcher.map.entity("chair1").pose.position_m == (5.0, 2.0, 0.0)


def test_a_rename_is_executed_once_and_tried_without_effect(dispatcher, semantic_map):
    add(dispatcher, name="chair1", at=(1.0, 2.0, 0.0))
    before = everything(semantic_map)
    tried = dispatcher.change(c.Rename(name="chair1", new="throne", dry_run=True))
    assert tried.text == "dry run, nothing changed; it would be: renamed chair1 to throne"
    assert everything(semantic_map) == before
    first = dispatcher.change(c.Rename(name="chair1", new="throne", id="7"))
    assert dispatcher.change(c.Rename(name="chair1", new="throne", id="7")).commit == first.commit
    assert dispatcher.change(c.Rename(name="throne", new="throne")).commit is None
    with pytest.raises(errors.Refused, match="throne was defined by an operator"):
        dispatcher.change(c.Rename(name="throne", new="seat1", source="perception"))


@pytest.mark.parametrize(
    ("name", "new", "error", "text"),
    [
        ("chair1", "chair2", errors.NameTaken, "the name 'chair2' is taken; see: semmap get chair2"),
        ("chair1", "chair2_coordinates", errors.NameTaken, "is taken by an individual"),
        ("chair9", "throne", errors.UnknownName, "no entity is named 'chair9'"),
        ("cart1", "cart2", errors.Refused, "cart1 is tracked; to rename it, first: semmap track cart1 --off"),
        ("chair3", "throne", errors.Refused, "is attached to chair2; to rename it, first: semmap detach"),
        ("chair2", "throne", errors.Refused, "chair3 is attached to chair2; first: semmap detach chair3"),
    ],
)
def test_a_rename_is_rejected_with_the_next_step(dispatcher, semantic_map, name, new, error, text):
    for i in range(1, 4):
        add(dispatcher, name=f"chair{i}", at=(float(i), 2.0, 0.0))
    add(dispatcher, name="cart1", at=(8.0, 2.0, 0.0), track="stream")
    dispatcher.map.held["chair3"] = dispatcher.map.entities["chair3"] = structs.replace(
        dispatcher.map.entity("chair3"), properties={"isGraspedBy": "chair2"}
    )
    before = everything(semantic_map)
    with pytest.raises(error, match=text):
        dispatcher.change(c.Rename(name=name, new=new))
    assert everything(semantic_map) == before


@pytest.mark.parametrize(
    ("fields", "is_"),
    [
        ({"robot": True}, "a robot or a part of one"),
        ({"part_of": "kitchen1"}, "a body of the world file"),
        ({"entity": False}, "a body of the world file"),
    ],
)
def test_the_names_of_bodies_that_the_map_did_not_create_stay(dispatcher, fields, is_):
    add(dispatcher, name="chair1", at=(1.0, 2.0, 0.0))
    body = Body(
        **{
            "name": "chair1",
            "class_": "Chair",
            "model": "chair",
            "pose": Pose(position_m=(1.0, 2.0, 0.0)),
            "size_m": (0.4, 0.4, 0.9),
            "fixed": False,
            "entity": True,
            "ghost": False,
            "resting": True,
            "commit": 1,
            "shape_commit": 1,
            **fields,
        }
    )
    dispatcher.map.bodies = lambda: {"chair1": body}
    with pytest.raises(
        errors.Refused,
        match=f"chair1 is {is_}, so its name is fixed; to label it: semmap update chair1 --ref TEXT",
    ):
        dispatcher.change(c.Rename(name="chair1", new="throne"))


def test_perception_may_move_but_not_redefine_what_an_operator_put_in(dispatcher):
    add(dispatcher, name="chair1")
    dispatcher.change(c.Update(name="chair1", at=(1.0, 1.0, 0.0), source="perception"))
    for change in ({"class_": "Furniture"}, {"ref": "thing"}):
        with pytest.raises(errors.Refused, match="operator"):
            dispatcher.change(c.Update(name="chair1", source="perception", **change))
    with pytest.raises(errors.Refused, match="operator"):
        dispatcher.change(c.Remove(names=("chair1",), source="perception"))


def load_text(dispatcher: CommandDispatcher, text: str, **fields) -> Changed:
    return dispatcher.change(c.Load(content=text.encode(), filename="scene.json", **fields))


def test_a_scene_is_loaded_whole_or_not_at_all(dispatcher):
    with pytest.raises(errors.UnknownClass, match=r"'Ghost' \(of g1"):
        load_text(dispatcher, '{"entities": [{"class": "Chair"}, {"class": "Ghost", "name": "g1"}]}')
    assert dispatcher.map.entities == {}
    reply = load_text(
        dispatcher, '{"entities": [{"class": "Chair"}, {"class": "Ghost", "name": "g1"}]}', skip_unknown=True
    )
    assert reply.names == ("chair1",)
    assert reply.skipped == ("g1 (unknown class 'Ghost')",)


def test_replace_clears_the_map_in_the_same_commit(dispatcher):
    add(dispatcher, name="old")
    reply = load_text(dispatcher, '{"entities": [{"class": "Chair", "name": "new"}]}', replace=True)
    assert set(dispatcher.map.entities) == {"new"}
    assert reply.commit == 2


def test_loading_a_name_twice_is_rejected(dispatcher):
    load_text(dispatcher, '{"entities": [{"class": "Chair", "name": "a"}]}')
    with pytest.raises(errors.NameTaken, match=r"'a' is already taken; .* without --add-only"):
        load_text(
            dispatcher,
            '{"entities": [{"class": "Chair", "name": "b"}, {"class": "Chair", "name": "a"}]}',
            add_only=True,
        )
    with pytest.raises(errors.NameTaken, match="'c'"):
        load_text(
            dispatcher, '{"entities": [{"class": "Chair", "name": "c"}, {"class": "Chair", "name": "c"}]}'
        )
    assert set(dispatcher.map.entities) == {"a"}


SCENE = """{"entities": [
    {"class": "Chair", "name": "a", "at": [1, 2, 0], "yaw": 0.5, "size": [1, 1, 1], "ref": "seat"},
    {"class": "Chair", "name": "b", "at": [3, 2, 0], "alt": ["stool"]},
    {"class": "Chair", "name": "c", "at": [5, 2, 0], "set": ["isOpen=no"]}
]}"""


def test_a_scene_that_is_loaded_again_replaces_what_it_describes(dispatcher):
    assert load_text(dispatcher, SCENE).text == "loaded 3 entities from scene.json"
    same = load_text(dispatcher, SCENE)
    assert (same.commit, same.text) == (None, "scene.json changes nothing in the map: 3 as they were")
    edited = (
        SCENE.replace("[1, 2, 0]", "[9, 2, 0]").replace("[1, 1, 1]", "[2, 1, 1]").replace("stool", "perch")
    )
    edited = edited.replace("isOpen=no", "isOpen=yes")
    edited = edited.replace("\n]}", ',\n{"class": "Chair", "name": "d"}]}')
    dry = load_text(dispatcher, edited, dry_run=True)
    reply = load_text(dispatcher, edited)
    assert reply.text == (
        "loaded 4 entities from scene.json: 1 new, 1 moved and resized, 1 relabelled, 1 changed"
    )
    assert dry.text.endswith(reply.text)
    a, b, c, _ = (dispatcher.map.entity(name) for name in "abcd")
    assert (a.pose.position_m, a.pose.yaw_rad, a.size_m) == (
        (9.0, 2.0, 0.0),
        pytest.approx(0.5),
        (2.0, 1.0, 1.0),
    )
    assert (a.preferred_reference, b.alternative_references, c.properties) == (
        "seat",
        ("perch",),
        {"isOpen": True},
    )
    assert reply.commit == 2


def test_an_abox_that_is_loaded_again_replaces_what_it_describes(dispatcher):
    position = "dm:float_coordinates_x {} ; dm:float_coordinates_y 0 ; dm:float_coordinates_z 0"
    text = home.PREFIXES + ":a a dm:Chair ; dm:hasPosition [ " + position + " ] . :b a dm:Chair ."

    def loaded(x, **fields):
        content = text.replace("{}", str(x)).encode()
        return dispatcher.change(c.Load(content=content, filename="map.ttl", **fields))

    assert loaded(1).text == "loaded 2 entities from map.ttl"
    assert loaded(1).text == "map.ttl changes nothing in the map: 2 as they were"
    with pytest.raises(errors.NameTaken, match=r"map.ttl has other values for a; .* without --add-only"):
        loaded(2, add_only=True)
    assert loaded(2, dry_run=True).text.endswith("loaded 2 entities from map.ttl: 1 moved, 1 as it was")
    assert loaded(2).text == "loaded 2 entities from map.ttl: 1 moved, 1 as it was"
    assert dispatcher.map.entity("a").pose.position_m == (2.0, 0.0, 0.0)
    with pytest.raises(errors.BadRequest, match="either --add-only or --replace"):
        loaded(2, add_only=True, replace=True)


def test_a_scene_in_parts_also_replaces(dispatcher, monkeypatch):
    monkeypatch.setattr("semmap.nodes.coordinator.commands.load.PART", 2)
    dispatcher.change(c.Load(content=five_chairs(), filename="five.json"))
    moved = five_chairs().replace(b'"name"', b'"at": [1, 1, 0], "name"')
    reply = dispatcher.change(c.Load(content=moved, filename="five.json", parts=True))
    assert reply.text == "loaded 5 entities from five.json: 5 moved"


def follow(dispatcher, name, pose):
    """Commit where a body came to rest."""
    return dispatcher.change(ObservedState.of(dispatcher.map.entities, {name: pose}))


def test_a_body_that_came_to_rest_changes_only_the_pose(dispatcher):
    add(dispatcher, name="chair1", at=(1.0, 1.0, 0.0), ref="seat")
    pose = Pose(position_m=(1.5, 1.0, 0.2), orientation_wxyz=orientation_from_yaw(0.3))
    follow(dispatcher, "chair1", pose)
    chair = dispatcher.map.entity("chair1")
    assert (chair.pose, chair.preferred_reference) == (pose, "seat")
    assert (chair.pose_provenance.source, chair.shape_provenance.source) == ("scene", "operator")


def test_a_missed_commit_is_noticed(dispatcher):
    add(dispatcher)
    assert dispatcher.map.take(Commit(seq=1, stamp_ns=0, id="a", source="operator"))
    assert not dispatcher.map.take(Commit(seq=3, stamp_ns=0, id="c", source="operator"))


def test_another_knowledge_base_may_have_fewer_commits(dispatcher, semantic_map):
    before = semantic_map.snapshot()
    add(dispatcher, name="chair1")
    dispatcher.map.begin(before)
    assert set(dispatcher.map.entities) == {"chair1"}
    dispatcher.map.doubt()
    assert not dispatcher.map.take(Commit(seq=1, stamp_ns=0, id="a", source="operator"))
    dispatcher.map.begin(before)
    assert (dispatcher.map.entities, dispatcher.map.seq) == ({}, 0)
    assert dispatcher.map.take(Commit(seq=1, stamp_ns=0, id="a", source="operator"))


@pytest.mark.parametrize("refusals", [1, 4])
def test_another_name_is_generated_if_one_is_taken(dispatcher, monkeypatch, refusals):
    """The replica may have a forged commit."""
    ask, left = dispatcher._ask, [refusals]

    def refuse_first(call):
        if call.VERB == "commit" and left[0]:
            left[0] -= 1
            raise errors.NameTaken("it is taken")
        return ask(call)

    monkeypatch.setattr(dispatcher, "_ask", refuse_first)
    assert add(dispatcher, at=(1.0, 1.0, 0.0)).names == ("chair1",)
    left[0] = 9
    with pytest.raises(errors.NameTaken):
        add(dispatcher, at=(2.0, 1.0, 0.0))
    left[0] = 1
    with pytest.raises(errors.NameTaken):
        add(dispatcher, name="throne", at=(2.0, 1.0, 0.0))


def test_a_removed_entity_frees_its_name_and_is_no_longer_tracked(dispatcher):
    for _ in range(2):
        add(dispatcher, at=(1.0, 1.0, 0.0))
    dispatcher.change(c.Track(name="chair1"))
    assert set(dispatcher.map.tracked) == {"chair1"}
    dispatcher.change(c.Remove(names=("chair1",)))
    assert dispatcher.map.tracked == {}
    assert add(dispatcher, at=(5.0, 1.0, 0.0)).names == ("chair1",)


def test_tracked_entities_and_places_are_indexed(dispatcher):
    add(dispatcher, name="chair1", at=(1.0, 1.0, 0.0))
    dispatcher.change(c.Track(name="chair1", from_="sim"))
    assert dispatcher.change(c.Track(name="chair1", from_="sim")).text == (
        "unchanged: chair1 is tracked from the simulator already"
    )
    dispatcher.change(c.Track(name="chair1", from_="stream"))
    assert (
        dispatcher.change(c.Track(name="chair1")).text
        == "unchanged: chair1 is tracked from a stream of poses already"
    )
    dispatcher.change(c.Track(name="chair1", off=True))
    assert dispatcher.map.tracked == {}
    assert dispatcher.change(c.Track(name="chair1", off=True)).text == "unchanged: chair1 is not tracked"
    assert list(dispatcher.map.places) == []
    add(dispatcher, class_="Kitchen", name="kitchen1", at=(0.0, 0.0, 0.0))
    assert [place.name for place in dispatcher.map.places] == ["kitchen1"]
    with pytest.raises(errors.Refused, match="kitchen1 is a place and does not move"):
        dispatcher.change(c.Track(name="kitchen1"))
    dispatcher.change(c.Update(name="kitchen1", size=(3.0, 3.0, 2.5)))
    assert [place.size_m for place in dispatcher.map.places] == [(3.0, 3.0, 2.5)]
    dispatcher.change(c.Remove(names=("kitchen1",)))
    assert list(dispatcher.map.places) == []


def test_an_entity_is_listed_by_its_classes_in_the_order_of_names(dispatcher):
    for name in ("b", "a"):
        add(dispatcher, name=name, at=(1.0, 1.0, 0.0))
    add(dispatcher, class_="Kitchen", name="k", at=(0.0, 0.0, 0.0))
    assert [e.name for e in dispatcher.map.entities_of(None)] == ["a", "b", "k"]
    assert [e.name for e in dispatcher.map.entities_of("Furniture")] == ["a", "b"]
    assert dispatcher.map.pose_of("a").position_m == (1.0, 1.0, 0.0)
    assert dispatcher.map.pose_of("unknown") is None
    with pytest.raises(errors.UnknownName, match="no entity is named 'c'"):
        dispatcher.map.entity("c")


def test_undo_includes_the_settling_after_a_command(dispatcher):
    add(dispatcher, name="chair1", at=(1.0, 1.0, 0.0))
    follow(dispatcher, "chair1", Pose(position_m=(1.5, 1.0, 0.0)))
    add(dispatcher, name="chair2")
    assert dispatcher.change(c.Undo()).text == "undid commit 3: added chair2 as Chair"
    reply = dispatcher.change(c.Undo())
    assert reply.text == "undid commit 1 and what settled after it (commit 2): added chair1 as Chair"
    assert reply.names == ("chair1",)
    assert dispatcher.map.entities == {}
    with pytest.raises(errors.Refused, match="nothing to undo"):
        dispatcher.change(c.Undo())


def test_a_manual_move_is_attributed_and_can_be_undone(dispatcher):
    add(dispatcher, name="chair1", at=(1.0, 1.0, 0.0))
    dispatcher.manual_moves.register(c.Move(name="chair1", at=(3.0, 1.0, 0.0), agent="ann"))
    follow(dispatcher, "chair1", Pose(position_m=(3.0, 1.0, 0.0)))
    posed = dispatcher.map.entity("chair1").pose_provenance
    assert (posed.source, posed.agent, posed.reason) == ("scene", "ann", "chair1 was moved by hand")
    follow(dispatcher, "chair1", Pose(position_m=(3.5, 1.0, 0.0)))
    assert dispatcher.map.entity("chair1").pose_provenance.reason == "chair1 came to rest"
    dispatcher.change(c.Undo())
    assert dispatcher.map.entity("chair1").pose.position_m == (1.0, 1.0, 0.0)
    assert dispatcher.map.entity("chair1").pose_provenance.source == "operator"


def test_a_manual_move_is_attributed_after_a_restart_of_the_knowledge_base(dispatcher, monkeypatch):
    add(dispatcher, name="chair1", at=(1.0, 1.0, 0.0))
    dispatcher.manual_moves.register(c.Move(name="chair1", at=(3.0, 1.0, 0.0), agent="ann"))
    rests = Pose(position_m=(3.0, 1.0, 0.0))
    with monkeypatch.context() as away:
        away.setattr(dispatcher, "_ask", lambda call: raise_(errors.NoAnswer("it is being restarted")))
        with pytest.raises(errors.NoAnswer):
            follow(dispatcher, "chair1", rests)
    follow(dispatcher, "chair1", rests)
    assert dispatcher.map.entity("chair1").pose_provenance.agent == "ann"
    assert dispatcher.change(c.Undo()).text == "undid commit 2: moved chair1 from (1, 1, 0) to (3, 1, 0)"


def raise_(error):
    raise error


def test_a_repeated_undo_returns_its_first_result(dispatcher):
    add(dispatcher, name="chair1")
    add(dispatcher, name="chair2")
    assert dispatcher.change(c.Undo(id="u")).commit == dispatcher.change(c.Undo(id="u")).commit == 3
    assert set(dispatcher.map.entities) == {"chair1"}


def test_an_undo_with_the_id_of_another_command_is_rejected(dispatcher):
    dispatcher.change(c.Add(class_="Chair", name="chair1", id="x"))
    assert dispatcher.change(c.Undo(id="x")).text == "already done: add Chair chair1"
    assert set(dispatcher.map.entities) == {"chair1"}


def in_their_turn(dispatcher: CommandDispatcher, changes: list) -> list:
    """Return the results or errors of concurrent changes."""

    def ask_later(call):
        future: Future = Future()
        settle(future, lambda: dispatcher._ask(call))
        return future

    turns = Scheduler(
        lambda group, _: run_async(dispatcher.run_together(group), ask_later),
        is_name=lambda word: word in dispatcher.map.entities,
    )
    futures = [turns.change(change) for change in changes]
    turns.run_ready()
    return [future.exception() or future.result() for future in futures]


def test_changes_together_are_as_if_made_one_after_the_other(dispatcher, semantic_map):
    results = in_their_turn(
        dispatcher,
        [
            c.Add(class_="Chair", name="a", at=(1.0, 0.0, 0.0), ref="seat"),
            c.Add(class_="Chair", name="b", at=(2.0, 0.0, 0.0), id="42"),
            c.Update(name="a", at=(3.0, 0.0, 0.0)),
            c.Update(name="c", at=(3.0, 0.0, 0.0)),
            c.Add(class_="Chair"),
            c.Add(class_="Chair", name="b", at=(2.0, 0.0, 0.0), id="42"),
            c.Add(class_="Chair", name="chair1", at=(2.0, 0.0, 0.0)),
        ],
    )
    assert [getattr(result, "commit", type(result)) for result in results] == [
        1,
        2,
        3,
        errors.UnknownName,
        4,
        2,
        errors.NameTaken,
    ]
    assert {e.name: e for e in semantic_map.entities()} == dispatcher.map.entities
    assert dispatcher.map.seq == semantic_map.seq == 4
    assert dispatcher.map.entity("a").pose == Pose(position_m=(3.0, 0.0, 0.0))


def test_changes_of_one_entity_by_its_label_and_its_name_keep_their_order(dispatcher):
    add(dispatcher, name="a", ref="seat")
    changes = [
        c.Set(name=word, property="isOpen", values=(value,))
        for word, value in (("seat", True), ("a", False), ("a chair", True), ("a", False))
    ]
    assert [made.commit for made in in_their_turn(dispatcher, changes)] == [2, 3, 4, 5]
    assert dispatcher.map.entity("a").properties["isOpen"] is False


def test_a_change_costs_one_request_also_with_an_id(dispatcher, monkeypatch):
    asked, ask = [], dispatcher._ask
    monkeypatch.setattr(dispatcher, "_ask", lambda call: asked.append(call.VERB) or ask(call))
    add(dispatcher, name="chair1", at=(1.0, 1.0, 0.0), id="a")
    dispatcher.change(c.Update(name="chair1", at=(2.0, 1.0, 0.0), id="b"))
    dispatcher.change(c.Remove(names=("chair1",), id="c"))
    assert asked == ["commit"] * 3


@pytest.mark.parametrize(
    "command",
    [
        c.Add(class_="Chair", id="x"),
        c.Add(class_="Chair", name="chair1", id="x"),
        c.Update(name="chair0", ref="seat", id="x"),
        c.Remove(names=("chair0",), id="x"),
        c.Clear(id="x"),
        c.Load(content=b'{"entities": [{"class": "Chair"}]}', filename="scene.json", id="x"),
        c.Undo(id="x"),
    ],
)
def test_a_command_whose_reply_was_lost_with_the_coordinator_is_not_done_twice(
    dispatcher, semantic_map, command
):
    dispatcher.change(c.Add(class_="Chair", name="chair0"))
    first = dispatcher.change(command)
    next_dispatcher = CommandDispatcher(dispatcher._ask)  # of the restarted coordinator
    next_dispatcher.map.classes = dispatcher.map.classes
    next_dispatcher.map.begin(semantic_map.snapshot())
    again = next_dispatcher.change(command)
    assert (again.commit, again.names) == (first.commit, first.names)
    assert again.text.startswith("already done: ")
    assert semantic_map.seq == 2


def test_a_shared_reference_stays_when_all_who_use_it_change_together(dispatcher, semantic_map):
    for name in ("a", "b"):
        add(dispatcher, name=name, at=(1.0, 2.0, 0.0), ref="seat")
    seat, hers = (v.entity_iri(f"{name}_preferred_reference") for name in ("a", "b"))
    other = semantic_map.stars(["b"])[0]
    shared = Transaction(
        id="share",
        source="operator",
        retract=tuple(t for t in other.own if t[1] == v.HAS_PREFERRED_REFERENCE or t[0] == hers),
        insert=((other.iri, v.HAS_PREFERRED_REFERENCE, seat),),
    )
    dispatcher.map.take(semantic_map.commit(shared))
    in_their_turn(dispatcher, [c.Update(name=name, ref=f"the {name}") for name in ("a", "b")])
    assert [dispatcher.map.entity(name).preferred_reference for name in ("a", "b")] == ["the a", "the b"]


def test_the_entities_of_a_class_are_those_of_the_map(dispatcher, semantic_map):
    for i, class_ in enumerate(("Kitchen", "Living_Room_Table", "Chair", "Furniture")):
        add(dispatcher, class_, f"e{9 - i}", at=(float(i), 0.0, 0.0))
    for name, iri in semantic_map.classes.iris.items():
        assert dispatcher.map.entities_of(name) == tuple(semantic_map.entities(iri))
    assert dispatcher.map.entities_of(None) == tuple(semantic_map.entities())


def test_an_abridged_change_is_visible_to_the_next_command(dispatcher, monkeypatch):
    monkeypatch.setattr("semmap.schemas.commits.MANY_ENTITIES", 2)
    monkeypatch.setattr("semmap.nodes.runtime.map_replica.PAGE", 2)
    entities = b",".join(b'{"class": "Chair", "name": "seat%d"}' % i for i in range(5))
    loaded = dispatcher.change(c.Load(content=b'{"entities": [' + entities + b"]}", filename="five.json"))
    assert len(loaded.names) == 5
    assert dispatcher.map.seq == loaded.commit
    assert dispatcher.map.is_current
    assert {f"seat{i}" for i in range(5)} <= set(dispatcher.map.entities)
    dispatcher.change(c.Remove(names=("seat3",)))
    assert "seat3" not in dispatcher.map.entities


def five_chairs(name="seat"):
    entities = b",".join(b'{"class": "Chair", "name": "%s%d"}' % (name.encode(), i) for i in range(5))
    return b'{"entities": [' + entities + b"]}"


def test_a_scene_in_parts_is_several_commits(dispatcher, monkeypatch):
    monkeypatch.setattr("semmap.nodes.coordinator.commands.load.PART", 2)
    before = dispatcher.map.seq
    loaded = dispatcher.change(c.Load(id="five", content=five_chairs(), filename="five.json", parts=True))
    assert len(loaded.names) == 5
    assert loaded.commit == dispatcher.map.seq == before + 3
    assert {f"seat{i}" for i in range(5)} <= set(dispatcher.map.entities)
    again = dispatcher.change(c.Load(id="five", content=five_chairs(), filename="five.json", parts=True))
    assert again.commit == loaded.commit


def test_a_replacement_is_one_commit(dispatcher):
    with pytest.raises(errors.BadRequest, match="without --parts"):
        dispatcher.change(c.Load(content=five_chairs(), filename="five.json", parts=True, replace=True))
    with pytest.raises(errors.BadRequest, match="--tbox makes one commit"):
        dispatcher.change(c.Load(content=b"x", filename="t.ttl", parts=True, tbox=True))


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"tbox": True}, "applies to maps only"),
        ({"parts": True}, "makes one commit"),
        ({"content": b'{"entities": []}', "filename": "a.json"}, "applies to maps in RDF or OWL only"),
        ({"source": "agent"}, "only an operator may extend the TBox"),
    ],
)
def test_declarations_are_added_to_the_tbox_from_whole_maps_by_operators(dispatcher, fields, text):
    fields = {"content": b"<urn:a> <urn:b> <urn:c> .", "filename": "a.ttl", **fields}
    with pytest.raises((errors.BadRequest, errors.Refused), match=text):
        dispatcher.change(c.Load(tbox_from_abox=True, **fields))


def test_classes_that_a_map_adds_to_the_tbox_can_be_used(dispatcher, monkeypatch):
    monkeypatch.setattr(IsolatedParser, "close_tbox", lambda *_, **__: None)  # no process
    content = home.PREFIXES + "dm:Stool a owl:Class ; rdfs:subClassOf dm:Chair . :stool1 a dm:Stool ."
    loaded = dispatcher.change(c.Load(content=content.encode(), filename="own.ttl", tbox_from_abox=True))
    assert (loaded.names, loaded.commit) == (("stool1",), 1)
    assert add(dispatcher, "Stool").names == ("stool2",)


def test_extend_requires_a_tbox(dispatcher):
    with pytest.raises(errors.BadRequest, match="--extend applies to TBoxes only; add --tbox"):
        dispatcher.change(c.Load(content=five_chairs(), filename="five.json", extend=True))


def test_a_property_is_set_and_unset(dispatcher):
    add(dispatcher, name="chair1", set=("isOpen=no",))
    assert dispatcher.map.entity("chair1").properties == {"isOpen": False}
    reply = dispatcher.change(c.Set(name="chair1", property="isOpen", values=(True,)))
    assert (reply.text, reply.commit) == ("chair1: isOpen: false → true", 2)
    again = dispatcher.change(c.Set(name="chair1", property="isOpen", values=("yes",)))
    assert (again.text, again.commit) == ("chair1: unchanged: isOpen is true", None)
    for value, word in ((False, "isOpen"), (False, "is open")):
        left = dispatcher.change(c.Unset(name="chair1", property=word, value=value))
        assert (left.text, left.commit) == ("chair1: unchanged: isOpen is true", None)
    add(dispatcher, name="chair2")
    none = dispatcher.change(c.Unset(name="chair2", property="isOpen"))
    assert none.text == "chair2: unchanged: isOpen is not set"
    follows = dispatcher.change(c.Unset(name="chair2", property="fits"))
    assert follows.text == (
        "chair2: unchanged: fits is not set, but kitchen is inferred; for the reason:"
        " semmap explain chair2 fits kitchen"
    )
    other = dispatcher.change(c.Unset(name="chair2", property="fits", value="chair1"))
    assert other.text == "chair2: unchanged: fits is not set"
    with pytest.raises(errors.PreconditionFailed, match="isOpen is true, not false"):
        dispatcher.change(c.Set(name="chair1", property="isOpen", values=(True,), if_is=False))
    with pytest.raises(errors.PreconditionFailed, match="isOpen is true, not unset"):
        dispatcher.change(c.Set(name="chair1", property="isOpen", values=(True,), if_unset=True))
    dispatcher.change(c.Unset(name="chair1", property="isOpen", value=True, if_is=True))
    assert dispatcher.map.entity("chair1").properties == {}
    dispatcher.change(c.Set(name="chair1", property="isOpen", values=(False,), if_unset=True))
    dispatcher.change(c.Undo())
    assert dispatcher.map.entity("chair1").properties == {}


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (c.Set(name="chair1", property="isOpen", values=()), "give a value of isOpen"),
        (c.Set(name="chair1", property="isOpen", values=(1,), if_is=1, if_unset=True), "either"),
        (c.Update(name="chair1", set=("isOpen",)), "'isOpen' is not of the form PROPERTY=VALUE"),
        (c.Update(name="chair1", unset=("isOpne",)), "did you mean isOpen"),
    ],
)
def test_an_invalid_statement_is_rejected(dispatcher, command, said):
    add(dispatcher, name="chair1")
    with pytest.raises(errors.BadRequest, match=said):
        dispatcher.change(command)
    assert dispatcher.map.seq == 1


def test_an_update_also_changes_properties(dispatcher):
    add(dispatcher, name="chair1", at=(1.0, 0.0, 0.0), set=("note=a", "note=b"))
    reply = dispatcher.change(
        c.Update(name="chair1", at=(2.0, 0.0, 0.0), unset=("note=a",), set=("isOpen=true",))
    )
    assert reply.text == (
        "updated chair1: moved from (1, 0, 0) to (2, 0, 0); isOpen: not set → true; note: - a"
    )
    assert reply.commit == 2


@pytest.mark.parametrize(
    "command",
    [
        c.Add(class_="Chair", name="chair2", at=(1.0, 0.0, 0.0), wait=True, dry_run=True),
        c.Update(name="chair1", ref="stool", dry_run=True),
        c.Set(name="chair1", property="isOpen", values=(True,), dry_run=True),
        c.Unset(name="chair1", property="note", dry_run=True),
        c.Remove(names=("chair1",), dry_run=True),
        c.Clear(dry_run=True),
        c.Load(content=b'{"entities": [{"class": "Chair"}]}', filename="scene.json", dry_run=True),
        c.Undo(dry_run=True),
    ],
    ids=lambda command: command.VERB,
)
def test_a_dry_run_reports_the_change_and_makes_none(dispatcher, semantic_map, command):
    add(dispatcher, name="chair1", ref="seat", set=("note=a",))
    before = everything(semantic_map), dict(dispatcher.map.entities), dispatcher.map.seq, semantic_map.seq
    (reply,) = in_their_turn(dispatcher, [command])
    assert reply.dry_run
    assert reply.commit is None
    assert reply.text.startswith("dry run, nothing changed; it would be: ")
    assert (
        everything(semantic_map),
        dict(dispatcher.map.entities),
        dispatcher.map.seq,
        semantic_map.seq,
    ) == before
    done = dispatcher.change(structs.replace(command, dry_run=False))
    assert done.commit == 2
    assert not done.dry_run
    assert reply.text.endswith(done.text)


def test_a_dry_run_reports_inferences(dispatcher):
    add(dispatcher, name="chair1")
    reply = add(dispatcher, name="chair2", dry_run=True)
    assert "chair2 type Furniture" in reply.follows
    assert "chair1 type Furniture" in dispatcher.change(c.Clear(dry_run=True)).no_longer_follows
    with pytest.raises(errors.NameTaken):
        add(dispatcher, name="chair1", dry_run=True)


def test_doubtful_values_are_noted_and_a_chair_cannot_become_a_kitchen(dispatcher):
    add(dispatcher, "Kitchen", "kitchen1", at=(0.0, 0.0, 0.0), size=(4.0, 4.0, 2.0))
    assert add(dispatcher, name="near", at=(1.0, 1.0, 0.0)).notes == ()
    (note,) = add(dispatcher, name="far", at=(90.0, 1.0, 0.0)).notes
    assert note == "far at (90, 1) is outside every place of the map"
    assert (
        dispatcher.change(c.Update(name="near", at=(-90.0, 0.0, 0.0))).notes[0].startswith("near at (-90, 0)")
    )
    with pytest.raises(errors.Refused, match="--force"):
        dispatcher.change(c.Update(name="near", class_="Kitchen"))
    dispatcher.change(c.Update(name="near", class_="Kitchen", force=True))
    assert dispatcher.map.entity("near").place


def test_a_packed_scene_is_loaded(dispatcher):
    content = gzip.compress(b'{"entities": [{"class": "Chair"}]}')
    assert dispatcher.change(c.Load(content=content, filename="scene.json.gz")).names == ("chair1",)


def test_a_packed_document_is_forwarded_unchanged():
    command = c.Load(id="1", content=gzip.compress(b":a a :B ."), filename="map.ttl.gz", source="file")
    asked = next(load.load(MapView(), command))
    assert isinstance(asked, LoadDocument)
    assert asked.content is command.content
