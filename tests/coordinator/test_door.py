"""Commands as changes of a real map, without the wire between."""

from __future__ import annotations

import gzip
from concurrent.futures import Future

import pytest
from msgspec import structs

from semmap.nodes.coordinator.dialogues import hold_later
from semmap.nodes.coordinator.door import Door, loading
from semmap.nodes.coordinator.door.known_map import KnownMap
from semmap.nodes.coordinator.scene.settled import Settled
from semmap.nodes.coordinator.turns import Turns
from semmap.nodes.runtime.futures import settle
from semmap.ontology import vocabulary as v
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import LoadDocument
from semmap.schemas.commits import Commit, Transaction
from semmap.schemas.entities import Pose, orientation_from_yaw
from semmap.schemas.replies import Changed


def add(door: Door, class_: str = "Chair", name: str | None = None, **fields) -> Changed:
    return door.change(c.Add(class_=class_, name=name, **fields))


def everything(semantic_map) -> set:
    return set(semantic_map.abox())


def test_add_says_what_it_made(door):
    reply = add(door, at=(1.0, 2.0, 0.0), yaw=1.0, size=(0.4, 0.4, 0.9), ref="seat", alt=("stool",))
    (name,) = reply.names
    chair = door.map.entity(name)
    assert (name, chair.class_, reply.commit) == ("chair1", "Chair", 1)
    assert chair.pose == Pose(position_m=(1.0, 2.0, 0.0), orientation_wxyz=orientation_from_yaw(1.0))
    assert (chair.size_m, chair.preferred_reference, chair.alternative_references) == (
        (0.4, 0.4, 0.9),
        "seat",
        ("stool",),
    )


def test_add_with_all_defaults(door):
    add(door, default=True)
    add(door, default=True)
    first, second = door.map.entity("chair1"), door.map.entity("chair2")
    assert first.pose.position_m == (2.0, 2.0, 0.0)
    assert second.pose.position_m != first.pose.position_m
    assert first.preferred_reference == "chair"


def test_a_class_is_found_without_regard_to_case_and_underscores(door):
    reply = add(door, "livingroomtable", "t1")
    assert door.map.entity("t1").class_ == "Living_Room_Table"
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
def test_a_refused_add_changes_nothing(door, semantic_map, fields, error):
    add(door, name="chair1")
    before = everything(semantic_map), dict(door.map.entities), door.map.seq
    with pytest.raises(error):
        add(door, **{"name": "new", **fields})
    assert (everything(semantic_map), dict(door.map.entities), door.map.seq) == before


def test_what_is_not_named_in_an_update_stays(door):
    add(door, name="chair1", at=(1.0, 2.0, 3.0), yaw=1.0, size=(1.0, 1.0, 1.0), ref="seat", alt=("a", "b"))
    door.change(c.Update(name="chair1", at=(5.0, 6.0, 7.0)))
    chair = door.map.entity("chair1")
    assert chair.pose == Pose(position_m=(5.0, 6.0, 7.0), orientation_wxyz=orientation_from_yaw(1.0))
    assert (chair.size_m, chair.preferred_reference) == ((1.0, 1.0, 1.0), "seat")
    assert chair.alternative_references == ("a", "b")
    door.change(c.Update(name="chair1", ref="throne"))
    assert door.map.entity("chair1").pose == chair.pose
    assert door.map.entity("chair1").preferred_reference == "throne"
    door.change(c.Update(name="chair1", class_="Furniture"))
    assert door.map.entity("chair1").class_ == "Furniture"
    assert door.map.entity("chair1").size_m == (1.0, 1.0, 1.0)


def test_an_update_leaves_no_orphans(door, semantic_map):
    add(door, name="chair1", ref="seat", alt=("a", "b"), size=(1.0, 1.0, 1.0))
    before = len(everything(semantic_map))
    for text in ("x", "y", "z"):
        door.change(c.Update(name="chair1", ref=text, alt=(text, text + text), size=(2.0, 1.0, 1.0), yaw=0.0))
    assert len(everything(semantic_map)) == before


def test_an_update_that_changes_nothing_is_no_commit(door):
    add(door, name="chair1", at=(1.0, 2.0, 0.0), ref="seat", alt=("a",))
    reply = door.change(c.Update(name="chair1", at=(1.0, 2.0, 0.0), ref="seat", alt=("a",), class_="Chair"))
    assert reply.commit is None


def test_a_removed_entity_leaves_nothing(door, semantic_map):
    before = everything(semantic_map)
    add(door, name="chair1", at=(1.0, 2.0, 0.0), yaw=1.0, size=(1.0, 1.0, 1.0), ref="seat", alt=("a", "b"))
    door.change(c.Remove(names=("chair1",)))
    assert everything(semantic_map) == before
    assert door.map.entities == {}


def test_remove_takes_all_or_none(door):
    add(door, name="chair1")
    with pytest.raises(errors.UnknownName, match="chair2"):
        door.change(c.Remove(names=("chair1", "chair2")))
    assert set(door.map.entities) == {"chair1"}


def test_clear_on_an_empty_map_is_no_commit(door):
    assert door.change(c.Clear()).commit is None
    add(door)
    assert door.change(c.Clear()).names == ("chair1",)
    assert door.map.entities == {}


def test_a_name_can_be_used_again_after_removal_and_after_changes_of_references(door):
    for _ in range(3):
        add(door, name="chair1", ref="seat")
        door.change(c.Update(name="chair1", ref="stool"))
        door.change(c.Remove(names=("chair1",)))


def test_the_same_command_id_is_executed_once(door):
    first = add(door, name="chair1", id="42")
    again = add(door, name="chair1", id="42")
    assert (again.commit, again.names) == (first.commit, first.names)
    gone = door.change(c.Remove(names=("chair1",), id="43"))
    assert door.change(c.Remove(names=("chair1",), id="43")).commit == gone.commit
    assert add(door, name="chair1", id="42").commit == first.commit
    assert door.map.entities == {}


def test_perception_may_move_but_not_redefine_what_an_operator_put_in(door):
    add(door, name="chair1")
    door.change(c.Update(name="chair1", at=(1.0, 1.0, 0.0), source="perception"))
    for change in ({"class_": "Furniture"}, {"ref": "thing"}):
        with pytest.raises(errors.Refused, match="operator"):
            door.change(c.Update(name="chair1", source="perception", **change))
    with pytest.raises(errors.Refused, match="operator"):
        door.change(c.Remove(names=("chair1",), source="perception"))


def load(door: Door, text: str, **fields) -> Changed:
    return door.change(c.Load(content=text.encode(), filename="scene.json", **fields))


def test_a_scene_is_loaded_whole_or_not_at_all(door):
    with pytest.raises(errors.UnknownClass, match=r"'Ghost' \(of g1"):
        load(door, '{"entities": [{"class": "Chair"}, {"class": "Ghost", "name": "g1"}]}')
    assert door.map.entities == {}
    reply = load(
        door, '{"entities": [{"class": "Chair"}, {"class": "Ghost", "name": "g1"}]}', skip_unknown=True
    )
    assert reply.names == ("chair1",)
    assert reply.skipped == ("g1 (unknown class 'Ghost')",)


def test_replace_takes_the_present_map_out_in_the_same_commit(door):
    add(door, name="old")
    reply = load(door, '{"entities": [{"class": "Chair", "name": "new"}]}', replace=True)
    assert set(door.map.entities) == {"new"}
    assert reply.commit == 2


def test_loading_a_name_twice_is_refused(door):
    load(door, '{"entities": [{"class": "Chair", "name": "a"}]}')
    with pytest.raises(errors.NameTaken, match="'a'"):
        load(door, '{"entities": [{"class": "Chair", "name": "b"}, {"class": "Chair", "name": "a"}]}')
    with pytest.raises(errors.NameTaken, match="'c'"):
        load(door, '{"entities": [{"class": "Chair", "name": "c"}, {"class": "Chair", "name": "c"}]}')
    assert set(door.map.entities) == {"a"}


def follow(door, name, pose):
    """The map takes over where a body came to rest."""
    return door.change(Settled.of(door.map.entities, {name: pose}))


def test_a_body_that_came_to_rest_changes_only_the_pose(door):
    add(door, name="chair1", at=(1.0, 1.0, 0.0), ref="seat")
    pose = Pose(position_m=(1.5, 1.0, 0.2), orientation_wxyz=orientation_from_yaw(0.3))
    follow(door, "chair1", pose)
    chair = door.map.entity("chair1")
    assert (chair.pose, chair.preferred_reference) == (pose, "seat")
    assert (chair.pose_provenance.source, chair.shape_provenance.source) == ("scene", "operator")


def test_a_missed_commit_is_noticed(door):
    add(door)
    assert door.map.take(Commit(seq=1, stamp_ns=0, id="a", source="operator"))
    assert not door.map.take(Commit(seq=3, stamp_ns=0, id="c", source="operator"))


def test_another_knowledge_base_may_know_less(door, semantic_map):
    before = semantic_map.snapshot()
    add(door, name="chair1")
    door.map.begin(before)
    assert set(door.map.entities) == {"chair1"}
    door.map.doubt()
    assert not door.map.take(Commit(seq=1, stamp_ns=0, id="a", source="operator"))
    door.map.begin(before)
    assert (door.map.entities, door.map.seq) == ({}, 0)
    assert door.map.take(Commit(seq=1, stamp_ns=0, id="a", source="operator"))


@pytest.mark.parametrize("refusals", [1, 4])
def test_a_name_that_turns_out_to_be_taken_is_thought_of_again(door, monkeypatch, refusals):
    """Somebody may have published what was never committed."""
    ask, left = door._ask, [refusals]

    def refuse_first(call):
        if call.VERB == "commit" and left[0]:
            left[0] -= 1
            raise errors.NameTaken("it is taken")
        return ask(call)

    monkeypatch.setattr(door, "_ask", refuse_first)
    assert add(door, at=(1.0, 1.0, 0.0)).names == ("chair1",)
    left[0] = 9
    with pytest.raises(errors.NameTaken):
        add(door, at=(2.0, 1.0, 0.0))
    left[0] = 1
    with pytest.raises(errors.NameTaken):
        add(door, name="throne", at=(2.0, 1.0, 0.0))


def test_a_removed_entity_frees_its_name_and_is_no_longer_tracked(door):
    for _ in range(2):
        add(door, at=(1.0, 1.0, 0.0))
    door.change(c.Track(name="chair1"))
    assert set(door.map.tracked) == {"chair1"}
    door.change(c.Remove(names=("chair1",)))
    assert door.map.tracked == {}
    assert add(door, at=(5.0, 1.0, 0.0)).names == ("chair1",)


def test_what_is_tracked_no_more_is_forgotten_and_places_are_known_as_they_come_and_go(door):
    add(door, name="chair1", at=(1.0, 1.0, 0.0))
    door.change(c.Track(name="chair1", from_="sim"))
    assert door.change(c.Track(name="chair1", from_="sim")).text == (
        "unchanged: chair1 is tracked from the simulator already"
    )
    door.change(c.Track(name="chair1", from_="stream"))
    assert (
        door.change(c.Track(name="chair1")).text
        == "unchanged: chair1 is tracked from a stream of poses already"
    )
    door.change(c.Track(name="chair1", off=True))
    assert door.map.tracked == {}
    assert door.change(c.Track(name="chair1", off=True)).text == "unchanged: chair1 is not tracked"
    assert list(door.map.places) == []
    add(door, class_="Kitchen", name="kitchen1", at=(0.0, 0.0, 0.0))
    assert [place.name for place in door.map.places] == ["kitchen1"]
    with pytest.raises(errors.Refused, match="kitchen1 is a place, which stays where it is"):
        door.change(c.Track(name="kitchen1"))
    door.change(c.Update(name="kitchen1", size=(3.0, 3.0, 2.5)))
    assert [place.size_m for place in door.map.places] == [(3.0, 3.0, 2.5)]
    door.change(c.Remove(names=("kitchen1",)))
    assert list(door.map.places) == []


def test_an_entity_is_listed_by_its_classes_in_the_order_of_names(door):
    for name in ("b", "a"):
        add(door, name=name, at=(1.0, 1.0, 0.0))
    add(door, class_="Kitchen", name="k", at=(0.0, 0.0, 0.0))
    assert [e.name for e in door.map.entities_of(None)] == ["a", "b", "k"]
    assert [e.name for e in door.map.entities_of("Furniture")] == ["a", "b"]
    assert door.map.where("a").position_m == (1.0, 1.0, 0.0)
    assert door.map.where("nobody") is None
    with pytest.raises(errors.UnknownName, match="no entity is named 'c'"):
        door.map.entity("c")


def test_bare_undo_takes_back_what_was_asked_for_with_its_settling(door):
    add(door, name="chair1", at=(1.0, 1.0, 0.0))
    follow(door, "chair1", Pose(position_m=(1.5, 1.0, 0.0)))
    add(door, name="chair2")
    assert door.change(c.Undo()).text == "undid commit 3: added chair2 as Chair"
    reply = door.change(c.Undo())
    assert reply.text == "undid commit 1 and what settled after it (commit 2): added chair1 as Chair"
    assert reply.names == ("chair1",)
    assert door.map.entities == {}
    with pytest.raises(errors.Refused, match="nothing to undo"):
        door.change(c.Undo())


def test_a_hand_s_move_is_asked_for_and_can_be_undone(door):
    add(door, name="chair1", at=(1.0, 1.0, 0.0))
    door.hands.let_go(c.Move(name="chair1", at=(3.0, 1.0, 0.0), agent="ann"))
    follow(door, "chair1", Pose(position_m=(3.0, 1.0, 0.0)))
    posed = door.map.entity("chair1").pose_provenance
    assert (posed.source, posed.agent, posed.reason) == ("scene", "ann", "chair1 was moved by hand")
    follow(door, "chair1", Pose(position_m=(3.5, 1.0, 0.0)))
    assert door.map.entity("chair1").pose_provenance.reason == "chair1 came to rest"
    door.change(c.Undo())
    assert door.map.entity("chair1").pose.position_m == (1.0, 1.0, 0.0)
    assert door.map.entity("chair1").pose_provenance.source == "operator"


def test_a_hand_s_move_is_its_client_s_when_the_knowledge_base_was_away_at_first(door, monkeypatch):
    add(door, name="chair1", at=(1.0, 1.0, 0.0))
    door.hands.let_go(c.Move(name="chair1", at=(3.0, 1.0, 0.0), agent="ann"))
    rests = Pose(position_m=(3.0, 1.0, 0.0))
    with monkeypatch.context() as away:
        away.setattr(door, "_ask", lambda call: raise_(errors.NoAnswer("it is being restarted")))
        with pytest.raises(errors.NoAnswer):
            follow(door, "chair1", rests)
    follow(door, "chair1", rests)
    assert door.map.entity("chair1").pose_provenance.agent == "ann"
    assert door.change(c.Undo()).text == "undid commit 2: moved chair1 from (1, 1, 0) to (3, 1, 0)"


def raise_(error):
    raise error


def test_an_undo_sent_again_is_answered_with_its_result(door):
    add(door, name="chair1")
    add(door, name="chair2")
    assert door.change(c.Undo(id="u")).commit == door.change(c.Undo(id="u")).commit == 3
    assert set(door.map.entities) == {"chair1"}


def test_an_undo_under_the_id_of_another_command_is_answered_as_that(door):
    door.change(c.Add(class_="Chair", name="chair1", id="x"))
    assert door.change(c.Undo(id="x")).text == "already done: add Chair chair1"
    assert set(door.map.entities) == {"chair1"}


def in_their_turn(door: Door, changes: list) -> list:
    """The results or errors of changes that come at the same time."""

    def ask_later(call):
        future: Future = Future()
        settle(future, lambda: door._ask(call))
        return future

    turns = Turns(lambda group: hold_later(door.together(group), ask_later))
    futures = [turns.change(change) for change in changes]
    turns.go_on()
    return [future.exception() or future.result() for future in futures]


def test_changes_together_are_as_if_made_one_after_the_other(door, semantic_map):
    results = in_their_turn(
        door,
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
    assert {e.name: e for e in semantic_map.entities()} == door.map.entities
    assert door.map.seq == semantic_map.seq == 4
    assert door.map.entity("a").pose == Pose(position_m=(3.0, 0.0, 0.0))


def test_a_change_costs_one_question_also_with_an_id(door, monkeypatch):
    asked, ask = [], door._ask
    monkeypatch.setattr(door, "_ask", lambda call: asked.append(call.VERB) or ask(call))
    add(door, name="chair1", at=(1.0, 1.0, 0.0), id="a")
    door.change(c.Update(name="chair1", at=(2.0, 1.0, 0.0), id="b"))
    door.change(c.Remove(names=("chair1",), id="c"))
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
def test_a_command_whose_reply_was_lost_with_the_coordinator_is_not_done_twice(door, semantic_map, command):
    door.change(c.Add(class_="Chair", name="chair0"))
    first = door.change(command)
    next_door = Door(door._ask)  # that of the coordinator which takes its place
    next_door.map.classes = door.map.classes
    next_door.map.begin(semantic_map.snapshot())
    again = next_door.change(command)
    assert (again.commit, again.names) == (first.commit, first.names)
    assert again.text.startswith("already done: ")
    assert semantic_map.seq == 2


def test_a_shared_reference_stays_when_all_who_use_it_change_together(door, semantic_map):
    for name in ("a", "b"):
        add(door, name=name, at=(1.0, 2.0, 0.0), ref="seat")
    seat, hers = (v.entity_iri(f"{name}_preferred_reference") for name in ("a", "b"))
    other = semantic_map.stars(["b"])[0]
    shared = Transaction(
        id="share",
        source="operator",
        retract=tuple(t for t in other.own if t[1] == v.HAS_PREFERRED_REFERENCE or t[0] == hers),
        insert=((other.iri, v.HAS_PREFERRED_REFERENCE, seat),),
    )
    door.map.take(semantic_map.commit(shared))
    in_their_turn(door, [c.Update(name=name, ref=f"the {name}") for name in ("a", "b")])
    assert [door.map.entity(name).preferred_reference for name in ("a", "b")] == ["the a", "the b"]


def test_the_entities_of_a_class_are_those_of_the_map(door, semantic_map):
    for i, class_ in enumerate(("Kitchen", "Living_Room_Table", "Chair", "Furniture")):
        add(door, class_, f"e{9 - i}", at=(float(i), 0.0, 0.0))
    for name, iri in semantic_map.classes.iris.items():
        assert door.map.entities_of(name) == tuple(semantic_map.entities(iri))
    assert door.map.entities_of(None) == tuple(semantic_map.entities())


def test_a_change_too_large_to_be_passed_on_is_known_to_the_next_command(door, monkeypatch):
    monkeypatch.setattr("semmap.schemas.commits.MANY_ENTITIES", 2)
    monkeypatch.setattr("semmap.nodes.runtime.map_replica.PAGE", 2)
    entities = b",".join(b'{"class": "Chair", "name": "seat%d"}' % i for i in range(5))
    loaded = door.change(c.Load(content=b'{"entities": [' + entities + b"]}", filename="five.json"))
    assert len(loaded.names) == 5
    assert door.map.seq == loaded.commit
    assert door.map.is_current
    assert {f"seat{i}" for i in range(5)} <= set(door.map.entities)
    door.change(c.Remove(names=("seat3",)))
    assert "seat3" not in door.map.entities


def five_chairs(name="seat"):
    entities = b",".join(b'{"class": "Chair", "name": "%s%d"}' % (name.encode(), i) for i in range(5))
    return b'{"entities": [' + entities + b"]}"


def test_a_scene_in_parts_is_several_commits(door, monkeypatch):
    monkeypatch.setattr("semmap.nodes.coordinator.door.loading.PART", 2)
    before = door.map.seq
    loaded = door.change(c.Load(id="five", content=five_chairs(), filename="five.json", parts=True))
    assert len(loaded.names) == 5
    assert loaded.commit == door.map.seq == before + 3
    assert {f"seat{i}" for i in range(5)} <= set(door.map.entities)
    again = door.change(c.Load(id="five", content=five_chairs(), filename="five.json", parts=True))
    assert again.commit == loaded.commit


def test_what_takes_the_place_of_something_else_is_one_commit(door):
    with pytest.raises(errors.BadRequest, match="without --parts"):
        door.change(c.Load(content=five_chairs(), filename="five.json", parts=True, replace=True))
    with pytest.raises(errors.BadRequest, match="--tbox makes one commit"):
        door.change(c.Load(content=b"x", filename="t.ttl", parts=True, tbox=True))


def test_extend_is_for_a_tbox(door):
    with pytest.raises(errors.BadRequest, match="--extend applies to TBoxes only; add --tbox"):
        door.change(c.Load(content=five_chairs(), filename="five.json", extend=True))


def test_a_property_is_set_and_unset(door):
    add(door, name="chair1", set=("isOpen=no",))
    assert door.map.entity("chair1").properties == {"isOpen": False}
    reply = door.change(c.Set(name="chair1", property="isOpen", values=(True,)))
    assert (reply.text, reply.commit) == ("chair1: isOpen: false → true", 2)
    again = door.change(c.Set(name="chair1", property="isOpen", values=("yes",)))
    assert (again.text, again.commit) == ("chair1: unchanged: isOpen is true", None)
    for value, word in ((False, "isOpen"), (False, "is open")):
        left = door.change(c.Unset(name="chair1", property=word, value=value))
        assert (left.text, left.commit) == ("chair1: unchanged: isOpen is true", None)
    add(door, name="chair2")
    none = door.change(c.Unset(name="chair2", property="isOpen"))
    assert none.text == "chair2: unchanged: isOpen is not set"
    follows = door.change(c.Unset(name="chair2", property="fits"))
    assert follows.text == (
        "chair2: unchanged: fits is not set, but kitchen follows; for the reason:"
        " semmap explain chair2 fits kitchen"
    )
    other = door.change(c.Unset(name="chair2", property="fits", value="chair1"))
    assert other.text == "chair2: unchanged: fits is not set"
    with pytest.raises(errors.PreconditionFailed, match="isOpen is true, not false"):
        door.change(c.Set(name="chair1", property="isOpen", values=(True,), if_is=False))
    with pytest.raises(errors.PreconditionFailed, match="isOpen is true, not unset"):
        door.change(c.Set(name="chair1", property="isOpen", values=(True,), if_unset=True))
    door.change(c.Unset(name="chair1", property="isOpen", value=True, if_is=True))
    assert door.map.entity("chair1").properties == {}
    door.change(c.Set(name="chair1", property="isOpen", values=(False,), if_unset=True))
    door.change(c.Undo())
    assert door.map.entity("chair1").properties == {}


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (c.Set(name="chair1", property="isOpen", values=()), "give a value of isOpen"),
        (c.Set(name="chair1", property="isOpen", values=(1,), if_is=1, if_unset=True), "either"),
        (c.Update(name="chair1", set=("isOpen",)), "'isOpen' is not of the form PROPERTY=VALUE"),
        (c.Update(name="chair1", unset=("isOpne",)), "did you mean isOpen"),
    ],
)
def test_a_statement_that_makes_no_sense_is_refused(door, command, said):
    add(door, name="chair1")
    with pytest.raises(errors.BadRequest, match=said):
        door.change(command)
    assert door.map.seq == 1


def test_an_update_changes_properties_with_the_rest_and_says_so(door):
    add(door, name="chair1", at=(1.0, 0.0, 0.0), set=("note=a", "note=b"))
    reply = door.change(c.Update(name="chair1", at=(2.0, 0.0, 0.0), unset=("note=a",), set=("isOpen=true",)))
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
def test_a_dry_run_says_what_would_be_and_does_nothing(door, semantic_map, command):
    add(door, name="chair1", ref="seat", set=("note=a",))
    before = everything(semantic_map), dict(door.map.entities), door.map.seq, semantic_map.seq
    (reply,) = in_their_turn(door, [command])
    assert reply.dry_run
    assert reply.commit is None
    assert reply.text.startswith("dry run, nothing changed; it would be: ")
    assert (everything(semantic_map), dict(door.map.entities), door.map.seq, semantic_map.seq) == before
    done = door.change(structs.replace(command, dry_run=False))
    assert done.commit == 2
    assert not done.dry_run
    assert reply.text.endswith(done.text)


def test_what_a_dry_run_would_bring(door):
    add(door, name="chair1")
    reply = add(door, name="chair2", dry_run=True)
    assert "chair2 type Furniture" in reply.follows
    assert "chair1 type Furniture" in door.change(c.Clear(dry_run=True)).no_longer_follows
    with pytest.raises(errors.NameTaken):
        add(door, name="chair1", dry_run=True)


def test_doubtful_values_are_noted_and_a_chair_is_no_kitchen(door):
    add(door, "Kitchen", "kitchen1", at=(0.0, 0.0, 0.0), size=(4.0, 4.0, 2.0))
    assert add(door, name="near", at=(1.0, 1.0, 0.0)).notes == ()
    (note,) = add(door, name="far", at=(90.0, 1.0, 0.0)).notes
    assert note == "far at (90, 1) is outside every place of the map"
    assert door.change(c.Update(name="near", at=(-90.0, 0.0, 0.0))).notes[0].startswith("near at (-90, 0)")
    with pytest.raises(errors.Refused, match="--force"):
        door.change(c.Update(name="near", class_="Kitchen"))
    door.change(c.Update(name="near", class_="Kitchen", force=True))
    assert door.map.entity("near").place


def test_a_packed_scene_is_loaded(door):
    content = gzip.compress(b'{"entities": [{"class": "Chair"}]}')
    assert door.change(c.Load(content=content, filename="scene.json.gz")).names == ("chair1",)


def test_a_packed_document_is_passed_on_as_it_came():
    command = c.Load(id="1", content=gzip.compress(b":a a :B ."), filename="map.ttl.gz", source="file")
    asked = next(loading.load(KnownMap(), command))
    assert isinstance(asked, LoadDocument)
    assert asked.content is command.content
