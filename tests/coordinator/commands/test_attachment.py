"""What attach and detach commit, and what they reply, without a knowledge base."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.coordinator.commands.attachment import attach, detach
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.commands.registration import HANDLERS
from semmap.nodes.coordinator.kb_coroutines import run
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import LoadOf
from semmap.schemas.commits import Effects, Trial
from semmap.schemas.entities import Pose
from tests.coordinator.commands.test_attachment_rules import thing
from tests.coordinator.reconciler.test_reconcile import at

NO_CHANGE = Trial(inserted=0, retracted=0, changed=(), gained=(), lost=())


class Kb:
    """A knowledge base that has `supported` on the entity and accepts all transactions."""

    def __init__(self, *entities, supported=(), changes=True):
        self.view = MapView()
        self.view.entities = {one.name: one for one in entities}
        self.view.held = {name: one for name, one in self.view.entities.items() if one.grip_provenance}
        self._supported, self._changes = supported, changes
        self.loads, self.committed = [], []

    def run(self, handler, command):
        return run(handler(self.view, command), self._ask)

    def _ask(self, call):
        if isinstance(call, LoadOf):
            self.loads.append(call)
            return self._supported
        self.committed.append(call)
        # as of a dry run: the view stays as it is
        return Effects(seq=4, id="a", trial=NO_CHANGE) if self._changes else None

    def edits(self):
        (transaction,) = self.committed
        return {edit.name: edit for edit in transaction.edit}


CUP, HAND, SUGAR = thing("cup1"), structs.replace(thing("hand1"), pose=at(1.0, 2.2)), thing("sugar1")
ATTACH = c.Attach(name="cup1", to="hand1")


def values(edit):
    return {statement.property: statement.values for statement in edit.set}


def test_an_entity_is_attached_where_it_is():
    kb = Kb(CUP, HAND)
    reply = kb.run(attach, ATTACH)
    (edit,) = kb.edits().values()
    assert (edit.name, edit.at) == ("cup1", (1.0, 2.0, 0.0))
    assert ("hand1",) in values(edit).values()
    assert (reply.text, reply.names, reply.notes) == (
        "cup1 is attached to hand1, at (0, -0.2, 0) in its frame",
        ("cup1",),
        (),
    )


def test_contents_that_are_not_carried_along_are_noted():
    kb = Kb(CUP, HAND, SUGAR, supported=("sugar1",))
    reply = kb.run(attach, ATTACH)
    assert list(kb.edits()) == ["cup1"]
    assert reply.notes == (
        "sugar1 is on or inside cup1 but not attached; to attach the contents too:"
        " semmap attach cup1 --carry",
    )


def test_contents_are_attached_in_the_same_commit():
    kb = Kb(CUP, HAND, SUGAR, thing("spoon1"), supported=("sugar1", "spoon1"))
    reply = kb.run(attach, structs.replace(ATTACH, carry=True, leave=("lid1",)))
    assert kb.loads == [LoadOf(name="cup1", leave=("lid1",))]
    edits = kb.edits()
    assert set(edits) == {"cup1", "sugar1", "spoon1"}
    assert ("cup1",) in values(edits["sugar1"]).values()
    assert ("hand1",) in values(edits["cup1"]).values()
    assert (reply.names, reply.notes) == (("cup1", "sugar1", "spoon1"), ())
    assert "sugar1 and spoon1" in reply.text


def test_an_entity_without_a_pose_has_no_contents():
    kb = Kb(structs.replace(CUP, pose=None), HAND)
    assert kb.run(attach, ATTACH).text == "cup1 is attached to hand1"
    assert kb.loads == []


def test_an_entity_that_is_attached_already_stays_so():
    held = thing("cup1", held_by="hand1")
    unchanged = "unchanged: cup1 is already attached to hand1"
    for command in (ATTACH, structs.replace(ATTACH, carry=True)):
        kb = Kb(held, HAND)
        assert kb.run(attach, command).text == unchanged
        assert kb.committed == []
    kb = Kb(held, HAND, changes=False)
    assert kb.run(attach, structs.replace(ATTACH, at=(0.0, 0.0, 0.1))).text == unchanged


def test_contents_are_not_added_to_an_entity_that_is_attached_already():
    kb = Kb(thing("cup1", held_by="hand1"), HAND, SUGAR, supported=("sugar1",))
    with pytest.raises(errors.Refused, match=r"attached to hand1, without sugar1; first: semmap detach"):
        kb.run(attach, structs.replace(ATTACH, carry=True))


def test_a_distant_entity_is_attached_only_by_force_or_at_a_position():
    far = structs.replace(HAND, pose=at(5.0))
    with pytest.raises(errors.Refused, match=r"farther than 0\.3 m"):
        Kb(CUP, far).run(attach, ATTACH)
    Kb(CUP, far).run(attach, structs.replace(ATTACH, force=True))
    reply = Kb(CUP, far).run(attach, structs.replace(ATTACH, at=(0.0, 0.0, 0.3), yaw=1.0))
    assert reply.text == "cup1 is attached to hand1, at (0, 0, 0.3) in its frame"


def test_contents_to_leave_require_contents_to_carry():
    with pytest.raises(errors.BadRequest, match="--leave requires --carry"):
        Kb(CUP, HAND).run(attach, structs.replace(ATTACH, leave=("sugar1",)))


def test_an_entity_is_detached_with_what_was_attached_together_with_it():
    held = (thing("cup1", held_by="hand1", since=5), thing("sugar1", held_by="cup1", since=5))
    kb = Kb(*held, thing("lid1", held_by="cup1", since=4), HAND)
    reply = kb.run(detach, c.Detach(name="cup1"))
    assert {name: edit.at for name, edit in kb.edits().items()} == dict.fromkeys(
        ("cup1", "sugar1"), (1.0, 2.0, 0.0)
    )
    assert (reply.text, reply.names) == (
        "cup1 is detached from hand1 at (1, 2, 0); also detached: sugar1",
        ("cup1", "sugar1"),
    )


def test_an_entity_without_a_pose_is_detached_nowhere():
    kb = Kb(structs.replace(thing("cup1", held_by="hand1"), pose=None), HAND)
    assert kb.run(detach, c.Detach(name="cup1")).text == "cup1 is detached from hand1"


def test_a_detached_entity_keeps_the_pose_that_its_holder_gave_it():
    kb = Kb(thing("cup1", held_by="hand1"), HAND)
    kb.view.pose_of = lambda name: Pose(position_m=(3.00000001, 0.0, 1.0))
    assert kb.run(detach, c.Detach(name="cup1")).text == "cup1 is detached from hand1 at (3, 0, 1)"
    assert kb.edits()["cup1"].at == (3.0, 0.0, 1.0)


def test_only_an_attached_entity_is_detached():
    with pytest.raises(errors.Refused, match=r"^cup1 is not attached$"):
        Kb(CUP, HAND).run(detach, c.Detach(name="cup1"))


def test_both_are_registered_as_handlers():
    assert (HANDLERS[c.Attach], HANDLERS[c.Detach]) == (attach, detach)
