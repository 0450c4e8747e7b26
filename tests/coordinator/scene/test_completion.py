"""When an order is answered, and with which reply."""

from __future__ import annotations

from concurrent.futures import Future
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.coordinator.reconciler.observed_state import ObservedState
from semmap.nodes.coordinator.scene import completion as module
from semmap.nodes.coordinator.scene.completion import PAUSED, WAIT_S, Completion
from semmap.nodes.coordinator.scene.manual_moves import ManualMoves
from semmap.schemas import errors
from semmap.schemas.commands import Drive, Move, Undo
from semmap.schemas.entities import Entity, Pose, Provenance
from semmap.schemas.replies import Changed, Moved
from semmap.schemas.scenes import BodiesMoved, Body, Driven

START = Pose(position_m=(1.0, 2.0, 0.0))
THERE = Pose(position_m=(5.0, 2.0, 0.0))
MOVE = Move(name="cup1", at=(5.0, 2.0, 0.1), wait=True)
RELEASED = Moved(name="cup1", text="put cup1 and released it")


def entity(commit: int = 3) -> Entity:
    by = Provenance(commit=commit, stamp_ns=0, source="operator", agent="")
    return Entity(
        name="cup1", iri="urn:cup1", class_="Cup", types=("Cup",), place=False, fixed=False, pose=START,
        pose_provenance=by, shape_provenance=by, reference_provenance=by, provenance=by, properties={},
    )  # fmt: skip


def body(*, resting: bool) -> Body:
    return Body(
        name="cup1", class_="Cup", model="cup", pose=THERE, size_m=(0.1, 0.1, 0.1), fixed=False,
        entity=True, ghost=False, resting=resting, commit=3, shape_commit=3,
    )  # fmt: skip


class World:
    """A coordinator's view of a cup that is moved, without processes."""

    def __init__(self, truth="map"):
        self.now_s = 0.0
        self.followed, self.following, self.returned = False, False, []
        self.scene = SimpleNamespace(known=True, run="a", stamp_ns=0, bodies={"cup1": body(resting=True)})
        self.entities = {"cup1": entity()}
        self.manual_moves = ManualMoves()
        reconciler = SimpleNamespace(
            scene=self.scene,
            is_followed=lambda name: self.followed,
            is_following=lambda names: self.following,
            return_bodies=self._return,
        )
        dispatcher = SimpleNamespace(
            manual_moves=self.manual_moves, map=SimpleNamespace(entities=self.entities)
        )
        self.completion = Completion(truth, dispatcher, reconciler)
        self.asked = Future()

    def monotonic(self):
        return self.now_s

    def _return(self, names):
        self.returned.append(set(names))
        done = Future()
        done.set_result(None)
        return done

    def move(self, command=MOVE, *, paused=False):
        done = BodiesMoved(bodies=(), failed={}, paused=paused, stamp_ns=10)
        return self.completion.begin(command, RELEASED, lambda _: "moved cup1", done)

    def poses(self, stamp_ns, *, resting, followed=False):
        self.scene.stamp_ns, self.followed = stamp_ns, followed
        if "cup1" in self.scene.bodies:
            self.scene.bodies["cup1"] = body(resting=resting)
        self.completion.answer_waiting()

    def follow(self):
        """The map begins to follow the cup; returns the future commit."""
        made = Future()
        self.completion.watch(lambda _: made)(ObservedState.of(self.entities, {"cup1": THERE}))
        return made


@pytest.fixture
def world(monkeypatch):
    world = World()
    monkeypatch.setattr(module, "time", world)
    return world


def test_the_reply_comes_when_the_map_has_followed_and_names_the_commit(world):
    reply = world.move()
    world.poses(5, resting=True, followed=True)  # poses from before the move
    world.poses(11, resting=False)
    world.poses(12, resting=True)
    made = world.follow()
    assert not reply.done()
    made.set_result(Changed(commit=4, text=""))
    world.poses(13, resting=True, followed=True)
    assert reply.result() == Moved(name="cup1", text="moved cup1", commit=4)


def test_a_commit_from_poses_before_the_move_is_not_its_own(world):
    reply = world.move()
    made = world.follow()
    made.set_result(Changed(commit=4, text=""))
    world.poses(11, resting=True, followed=True)
    assert reply.result().commit is None


def test_without_wait_the_reply_is_immediate(world):
    assert world.move(structs.replace(MOVE, wait=False)) == RELEASED


def test_while_time_is_paused_nothing_is_waited_for(world):
    assert world.move(paused=True) == structs.replace(RELEASED, notes=(PAUSED,))
    world.now_s = 10 * WAIT_S
    world.poses(11, resting=False)
    assert "stopped the move" in world.completion.stop(Undo(), None).result().text


def test_a_pause_answers_those_who_wait(world):
    reply = world.move()
    world.completion.pause()
    assert reply.result().notes == (PAUSED,)


def test_a_body_at_its_committed_pose_makes_no_commit(world):
    reply = world.move()
    world.poses(11, resting=True, followed=True)
    assert (reply.result().commit, reply.result().notes) == (
        None,
        ("no commit: cup1 rests at its committed pose",),
    )


def test_a_change_by_another_commit_is_reported(world):
    reply = world.move()
    world.entities["cup1"] = entity(commit=9)
    world.poses(11, resting=True, followed=True)
    assert reply.result().notes == ("no commit: commit 9 has changed the position of cup1 since",)


def test_a_body_that_rolls_on_is_not_waited_for_for_ever(world):
    reply = world.move()
    world.now_s = WAIT_S + 1.0
    world.poses(11, resting=False)
    assert reply.result().text == RELEASED.text
    assert reply.result().notes == ("no commit yet: cup1 is still moving; the map is updated when it rests",)


def test_a_place_that_the_map_rejects_is_an_error(world):
    reply = world.move()
    world.poses(11, resting=True)
    world.follow().set_exception(errors.Refused("it may not be there"))
    with pytest.raises(errors.Refused, match="cup1 was put back, because the map rejected its new state: it"):
        reply.result()


@pytest.mark.parametrize(
    ("end", "kind", "text"),
    [
        (lambda w: w.entities.clear(), errors.Refused, "cup1 was removed before it came to rest"),
        (lambda w: w.scene.bodies.clear(), errors.Refused, "cup1 lost its body before it came to rest"),
        (lambda w: setattr(w.scene, "run", "b"), errors.NoAnswer, "the simulator ended before cup1"),
        (lambda w: setattr(w.scene, "known", False), errors.NoAnswer, "the simulator ended before cup1"),
    ],
)
def test_the_reason_why_a_body_cannot_rest_is_reported(world, end, kind, text):
    reply = world.move()
    end(world)
    world.poses(11, resting=False)
    with pytest.raises(kind, match=text):
        reply.result()


def test_a_second_move_answers_the_first(world):
    first, second = world.move(), world.move(structs.replace(MOVE, at=(6.0, 2.0, 0.0)))
    assert first.result().text == "cup1 was moved again before the map had followed"
    assert not second.done()


def test_an_undo_stops_the_move_and_answers_its_client(world):
    reply = world.move()
    undo = Undo(id="u1")
    stopped = world.completion.stop(undo, None).result()
    assert (stopped.commit, stopped.names) == (None, ("cup1",))
    assert stopped.text == "stopped the move of cup1: it returns to its committed pose"
    assert world.returned == [{"cup1"}]
    with pytest.raises(errors.Refused, match="stopped the move of cup1: an undo came before"):
        reply.result()
    assert world.completion.stop(undo, None).result() == stopped  # sent again, it is done once
    assert world.completion.stop(Undo(id="u2"), None) is None


@pytest.mark.parametrize(
    "undo",
    [Undo(commit=2), Undo(dry_run=True), Undo(source="agent")],
    ids=["a commit", "a trial", "an agent"],
)
def test_an_undo_that_is_about_commits_stops_nothing(world, undo):
    world.move()
    assert world.completion.stop(undo, None) is None


def test_an_undo_while_the_commit_is_being_made_is_about_that_commit(world):
    world.move()
    world.following = True
    assert world.completion.stop(Undo(), None) is None


def test_a_drive_is_waited_for_until_its_commit(world):
    drive = Drive(name="cup1", to=((5.0, 2.0),), wait=True)
    reply = world.completion.begin(drive, RELEASED, lambda _: "", None)
    world.now_s = 10 * WAIT_S
    world.poses(11, resting=True, followed=True)
    assert not reply.done()
    world.completion.arrive(
        drive, "cup1 is at (5.00, 2.00)", Driven(name="cup1", outcome="there", pose=THERE)
    )
    world.poses(12, resting=True)
    world.follow().set_result(Changed(commit=4, text=""))
    world.poses(13, resting=True, followed=True)
    assert reply.result() == Moved(name="cup1", text="cup1 is at (5.00, 2.00)", commit=4)


def test_a_rejected_drive_is_an_error(world):
    drive = Drive(name="cup1", to=((5.0, 2.0),), wait=True)
    reply = world.completion.begin(drive, RELEASED, lambda _: "", None)
    world.completion.fail(drive, errors.Refused("cup1 is blocked at (1, 2)"))
    with pytest.raises(errors.Refused, match="is blocked at"):
        reply.result()
    assert world.completion.stop(Undo(), None) is None
