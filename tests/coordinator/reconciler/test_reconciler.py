from __future__ import annotations

import math
from concurrent.futures import Future
from itertools import count

import pytest
from msgspec import structs

from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.reconciler.reconcile import body_order
from semmap.nodes.coordinator.reconciler.reconciler import Reconciler
from semmap.nodes.coordinator.reconciler.spawn_batches import BATCH
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.commits import Effects
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import BodiesMoved, Body, BodyOrder, Deleted, Poses, Scene, Spawned
from tests.coordinator.conftest import immediate


def standing(order: BodyOrder) -> Body:
    return Body(
        **{name: getattr(order, name) for name in ("name", "class_", "model", "pose", "fixed", "commit")},
        size_m=(0.5, 0.5, 0.5),
        entity=True,
        ghost=False,
        resting=True,
        shape_commit=order.commit,
    )


def test_if_only_perception_updates_the_map_the_simulator_gets_no_orders(dispatcher):
    asked = []
    reconciler = Reconciler(
        CoordinatorConfig("perceived"),
        dispatcher,
        immediate(dispatcher),
        lambda *words: asked.append(words),
        asked.append,
    )
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))
    reconciler.scene.known = True
    reconciler.reconcile()
    assert asked == []
    assert reconciler.agreement().holds is None
    assert reconciler.body_state(dispatcher.map.entity("chair1")).status == "none"


@pytest.mark.parametrize(
    ("tracked", "way"), [("", "set one: semmap update chair1 --at X Y Z"), ("stream", "publish live poses")]
)
def test_an_order_for_an_entity_without_a_position_does_not_wait_for_its_body(dispatcher, tracked, way):
    reconciler = Reconciler(CoordinatorConfig("map"), dispatcher, immediate(dispatcher), print, print)
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))
    entity = structs.replace(dispatcher.map.entity("chair1"), pose=None, tracked=tracked)
    dispatcher.map.entities["chair1"] = entity
    reconciler.scene.known = True
    state = reconciler.body_state(entity)
    assert (state.status, state.detail) == ("none", f"it has no position; {way}")
    executed = Future()
    executed.set_result("executed")
    assert reconciler.when_placed("chair1", lambda: executed).result(0) == "executed"


def test_a_reset_tries_again_what_could_not_be_made(dispatcher):
    """A model file may have been repaired since."""
    spawns = []

    def ask(message):
        answer = {
            "spawn": Spawned(bodies=(), failed={"chair1": "its model file is broken"}),
            "snapshot": Scene(run="r", version=1, stamp_ns=1, sim_time_s=0.0, world="w", bodies=()),
            "move": BodiesMoved(bodies=(), failed={}),
        }[message.VERB]
        spawns.extend([message] if message.VERB == "spawn" else [])
        future = Future()
        future.set_result(answer)
        return future

    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), ask, lambda text: None
    )
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))
    reconciler.scene.known = True
    reconciler.reconcile()
    reconciler.reconcile()
    assert reconciler.body_state(dispatcher.map.entity("chair1")).status == "failed"
    assert len(spawns) == 1
    reconciler.place_all()
    assert len(spawns) == 2


def test_a_body_that_cannot_be_made_is_a_problem_only_as_long_as_its_entity_is_there(dispatcher):
    said = []

    def ask(call):
        answer = {
            "spawn": Spawned(bodies=(), failed={"chair1": "its model file is broken"}),
            "snapshot": Scene(run="r", version=1, stamp_ns=1, sim_time_s=0.0, world="w", bodies=()),
        }[call.VERB]
        future = Future()
        future.set_result(answer)
        return future

    reconciler = Reconciler(CoordinatorConfig("map"), dispatcher, immediate(dispatcher), ask, said.append)
    reconciler.scene.known = True
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))
    reconciler.reconcile()
    assert reconciler.problems() == ["chair1: failed: its model file is broken"]
    dispatcher.change(c.Remove(names=("chair1",)))
    reconciler.reconcile()
    assert (reconciler.problems(), said) == ([], [])  # and it is not in the heartbeat for an hour


def test_a_manual_move_waits_until_the_map_s_order_is_executed(dispatcher):
    """Otherwise it would be lost, for example when an undo places the body."""
    asked = []
    reconciler = Reconciler(
        CoordinatorConfig("map"),
        dispatcher,
        immediate(dispatcher),
        lambda call: asked.append(Future()) or asked[-1],
        print,
    )
    reconciler.scene.known = True
    for name in ("chair1", "chair2"):
        dispatcher.change(c.Add(class_="Chair", name=name, at=(1.0, 1.0, 0.0)))
        reconciler.scene.bodies[name] = standing(
            body_order(dispatcher.map.entity(name), dispatcher.map.entity(name).pose)
        )
    dispatcher.change(c.Update(name="chair1", at=(3.0, 1.0, 0.0)))
    reconciler.reconcile()
    done = []

    def execute(name):
        done.append(name)
        future = Future()
        future.set_result(name)
        return future

    first = reconciler.when_placed("chair1", lambda: execute("chair1"))
    assert reconciler.when_placed("chair2", lambda: execute("chair2")).result() == "chair2"
    assert (done, first.done()) == (["chair2"], False)
    placed = standing(body_order(dispatcher.map.entity("chair1"), dispatcher.map.entity("chair1").pose))
    asked[0].set_result(BodiesMoved(bodies=(placed,), failed={}))
    there = (placed, reconciler.scene.bodies["chair2"])
    asked[1].set_result(Scene(run="r", version=1, stamp_ns=1, sim_time_s=0.0, world="w", bodies=there))
    assert (done, first.result()) == (["chair2", "chair1"], "chair1")


@pytest.mark.parametrize("failed", [{}, {"chair1": "its model file is broken"}])
def test_a_manual_move_of_a_new_entity_waits_until_its_body_is_there_or_has_failed(dispatcher, failed):
    asked = []
    reconciler = Reconciler(
        CoordinatorConfig("map"),
        dispatcher,
        immediate(dispatcher),
        lambda call: asked.append(Future()) or asked[-1],
        lambda text: None,
    )
    reconciler.scene.known = True
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))

    def execute():
        future = Future()
        future.set_result("chair1" in reconciler.scene.bodies)
        return future

    waiting = reconciler.when_placed("chair1", execute)
    reconciler.reconcile()
    assert not waiting.done()
    body = standing(body_order(dispatcher.map.entity("chair1"), dispatcher.map.entity("chair1").pose))
    bodies = () if failed else (body,)
    asked[0].set_result(Spawned(bodies=bodies, failed=failed))
    asked[1].set_result(Scene(run="r", version=1, stamp_ns=1, sim_time_s=0.0, world="w", bodies=bodies))
    reconciler.reconcile()
    assert waiting.result(timeout=0) is not bool(failed)


def test_a_waiting_manual_move_is_tried_when_the_simulator_is_gone(dispatcher):
    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), lambda call: Future(), print
    )
    reconciler.scene.known = True
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))
    reconciler.scene.bodies["chair1"] = standing(
        body_order(dispatcher.map.entity("chair1"), dispatcher.map.entity("chair1").pose)
    )
    dispatcher.change(c.Update(name="chair1", at=(3.0, 1.0, 0.0)))

    def execute():
        raise errors.NoAnswer("no simulator is running")

    waiting = reconciler.when_placed("chair1", execute)
    assert not waiting.done()
    reconciler.lose_scene()
    assert waiting.exception().text == "no simulator is running"


def test_a_foreign_body_is_a_problem_only_as_long_as_it_is_there(dispatcher):
    reconciler = Reconciler(
        CoordinatorConfig("scene"), dispatcher, immediate(dispatcher), lambda *_: Future(), print
    )
    gizmo = standing(BodyOrder(name="gizmo", class_="Gizmo", pose=Pose(position_m=(0.0, 0.0, 0.0)), commit=0))
    reconciler.scene.known = True
    reconciler.scene.bodies["gizmo"] = gizmo
    reconciler.reconcile()
    (problem,) = reconciler.problems()
    assert problem.startswith("gizmo: a scene body without a map entity: unknown class 'Gizmo'")
    del reconciler.scene.bodies["gizmo"]
    assert reconciler.problems() == []


def test_a_robot_that_lies_on_its_side_is_a_problem(dispatcher):
    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), lambda *_: Future(), print
    )
    over = Pose(position_m=(1.0, 2.0, 0.1), orientation_wxyz=(math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0))
    robot = standing(BodyOrder(name="robot1", class_="Robot", pose=over, commit=0))
    reconciler.scene.bodies["robot1"] = structs.replace(robot, robot=True)
    assert reconciler.problems() == [
        "robot1 has fallen over at (1.00, 2.00);"
        " to put it upright: semmap move robot1 --at 1.00 2.00 0 --yaw 0"
    ]


def test_what_changes_while_orders_are_under_way_is_done_right_after_them(dispatcher):
    orders = []

    def ask(message):
        future = Future()
        orders.append((message, future))
        return future

    def answer():
        message, future = orders.pop()
        if message.VERB == "spawn":
            future.set_result(Spawned(bodies=tuple(map(standing, message.bodies)), failed={}))
        else:
            bodies = tuple(reconciler.scene.bodies.values())
            future.set_result(Scene(run="r", version=1, stamp_ns=1, sim_time_s=0.0, world="w", bodies=bodies))

    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), ask, lambda text: None
    )
    reconciler.scene.known = True
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))
    reconciler.reconcile({"chair1"})
    dispatcher.change(c.Add(class_="Chair", name="chair2", at=(3.0, 1.0, 0.0)))
    reconciler.reconcile({"chair2"})
    answer()
    answer()
    ((message, _),) = orders
    assert (message.VERB, [order.name for order in message.bodies]) == ("spawn", ["chair2"])


def test_a_reset_without_a_simulator_is_refused(dispatcher):
    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), lambda *_: Future(), print
    )
    with pytest.raises(errors.NoAnswer, match="no simulator is running"):
        reconciler.place_all()


def test_bodies_are_known_batch_by_batch(dispatcher):
    told = []

    def ask(message):
        told.append(len(reconciler.scene.bodies))
        future = Future()
        if message.VERB == "spawn":
            future.set_result(Spawned(bodies=tuple(map(standing, message.bodies)), failed={}))
        return future

    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), ask, lambda text: None
    )
    reconciler.scene.known = True
    entities = [f'{{"class": "Chair", "at": [{i}, 0, 0]}}' for i in range(2 * BATCH)]
    dispatcher.change(
        c.Load(content=f'{{"entities": [{", ".join(entities)}]}}'.encode(), filename="chairs.json")
    )
    reconciler.reconcile()
    assert told == [0, BATCH, 2 * BATCH]


def test_a_body_that_cannot_be_moved_where_the_map_says_has_a_reason_for_being_nowhere(dispatcher):
    bodies, asked, moments = {}, [], count(1)

    def ask(message):
        asked.append(message.VERB)
        reason = "it is too far"
        if message.VERB == "spawn":
            far = {o.name: reason for o in message.bodies if o.pose.position_m[0] > 1000.0}
            made = {o.name: standing(o) for o in message.bodies if o.name not in far}
            bodies.update(made)
            answer = Spawned(bodies=tuple(made.values()), failed=far)
        elif message.VERB == "delete":
            answer = Deleted(names=tuple(name for name in message.names if bodies.pop(name, None)))
        elif message.VERB == "move":
            answer = BodiesMoved(bodies=(), failed={p.name: reason for p in message.placements})
        else:
            answer = Scene(
                run="r",
                version=1,
                stamp_ns=next(moments),
                sim_time_s=0.0,
                world="w",
                bodies=tuple(bodies.values()),
            )
        future = Future()
        future.set_result(answer)
        return future

    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), ask, lambda text: None
    )
    reconciler.scene.known = True
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))
    reconciler.reconcile()
    assert reconciler.body_state(dispatcher.map.entity("chair1")).status == "present"
    dispatcher.change(c.Update(name="chair1", at=(2000.0, 0.0, 0.0)))
    reconciler.reconcile()
    assert reconciler.problems() == ["chair1: failed: it is too far"]
    assert reconciler.agreement().holds
    asked.clear()
    reconciler.reconcile()
    assert asked == []
    dispatcher.change(c.Update(name="chair1", at=(2.0, 0.0, 0.0)))
    reconciler.reconcile()
    assert reconciler.body_state(dispatcher.map.entity("chair1")).status == "present"


def test_what_is_seen_against_an_operators_word_is_a_problem_of_the_system(dispatcher):
    reconciler = Reconciler(
        CoordinatorConfig("perceived"), dispatcher, immediate(dispatcher), lambda *_: None, print
    )
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))
    assert reconciler.problems() == []
    dispatcher.change(c.Update(name="chair1", conflict="not seen where it should stand", source="perception"))
    assert reconciler.problems() == ["chair1: perception: not seen where it should stand"]


def bodies_elsewhere(dispatcher, count):
    """A reconciler that sees chairs at rest elsewhere; its changes of the map, and its orders."""
    changes = []

    def change(change):
        changes.append((change, Future()))
        return changes[-1][1]

    def ask(message):
        future = Future()
        if message.VERB == "move":
            moved.extend(message.placements)
            future.set_result(BodiesMoved(bodies=(), failed={}))
        return future

    moved = []
    reconciler = Reconciler(CoordinatorConfig("map"), dispatcher, change, ask, print)
    reconciler.scene.known = True
    for i in range(count):
        dispatcher.change(c.Add(class_="Chair", name=f"chair{i}", at=(float(i), 1.0, 0.0)))
        order = BodyOrder(
            name=f"chair{i}", class_="Chair", pose=Pose(position_m=(float(i), 2.0, 0.0)), commit=i + 1
        )
        reconciler.scene.bodies[order.name] = standing(order)
    return reconciler, changes, moved


def test_the_map_follows_many_bodies_without_waiting_for_each(dispatcher):
    reconciler, changes, _ = bodies_elsewhere(dispatcher, 40)
    reconciler.reconcile()
    reconciler.reconcile()
    assert [*(name for change, _ in changes for name in change.poses)] == [f"chair{i}" for i in range(40)]
    assert not reconciler.agreement().holds
    for change, future in changes:
        future.set_result(dispatcher.change(change))
    assert reconciler.agreement().holds
    assert {e.pose.position_m[1] for e in dispatcher.map.entities.values()} == {2.0}
    assert {e.pose_provenance.source for e in dispatcher.map.entities.values()} == {"scene"}


def test_a_body_goes_back_when_the_map_does_not_follow(dispatcher):
    reconciler, changes, moved = bodies_elsewhere(dispatcher, 1)
    reconciler.reconcile()
    changes[0][1].set_exception(errors.Refused("it may not stand there"))
    reconciler.reconcile()
    assert [(p.name, p.pose.position_m) for p in moved] == [("chair0", (0.0, 1.0, 0.0))]


def test_a_body_is_followed_later_when_the_map_does_not_answer_now(dispatcher):
    reconciler, changes, moved = bodies_elsewhere(dispatcher, 1)
    reconciler.reconcile()
    changes[0][1].set_exception(MemoryError("no memory"))
    reconciler.reconcile()
    assert (len(changes), moved) == (2, [])


def test_a_command_before_the_map_follows_takes_precedence(dispatcher):
    reconciler, changes, _ = bodies_elsewhere(dispatcher, 1)
    reconciler.reconcile()
    dispatcher.change(c.Update(name="chair0", at=(7.0, 7.0, 0.0)))
    assert dispatcher.change(changes[0][0]).commit is None
    assert dispatcher.map.entity("chair0").pose.position_m == (7.0, 7.0, 0.0)


def test_a_body_whose_entity_is_gone_is_no_longer_followed(dispatcher):
    reconciler, changes, _ = bodies_elsewhere(dispatcher, 1)
    reconciler.reconcile()
    dispatcher.change(c.Remove(names=("chair0",)))
    assert dispatcher.change(changes[0][0]).commit is None


def test_an_invalid_reply_does_not_stop_the_reconciler(dispatcher):
    asked = []

    def ask(message):
        asked.append(message.VERB)
        future = Future()
        future.set_exception(MemoryError("no memory"))
        return future

    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), ask, lambda text: None
    )
    reconciler.scene.known = True
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))
    reconciler.reconcile()
    reconciler.reconcile()
    assert asked == ["spawn", "spawn"]


class Refusing:
    """Pending changes of the map that the test completes, and the orders to the simulator."""

    def __init__(self, dispatcher, *entities: str, truth="map"):
        self.changes, self.said, self.asked = [], [], []
        for i, name in enumerate(entities):
            dispatcher.change(c.Add(class_="Chair", name=name, at=(float(i), 1.0, 0.0)))
        self.reconciler = Reconciler(
            CoordinatorConfig(truth), dispatcher, self.change, self.ask, self.said.append
        )
        self.reconciler.scene.known = True
        for entity in dispatcher.map.entities.values():
            self.reconciler.scene.bodies[entity.name] = standing(body_order(entity, entity.pose))

    def change(self, change):
        self.changes.append((change, Future()))
        return self.changes[-1][1]

    def ask(self, call):
        self.asked.append(call)
        return Future()

    def become(self, name, **fields):
        body = self.reconciler.scene.bodies[name]
        self.reconciler.scene.bodies[name] = structs.replace(body, **fields)

    def refuse(self, error):
        self.changes[-1][1].set_exception(error)
        self.reconciler.reconcile()


OPENED = (Joint(name="door1", kind="hinge", lower=0.0, upper=1.0, closed=0.0, position=0.5),)
GRIP = Pose(position_m=(0.0, 0.0, 1.0))


def test_joints_are_restored_when_the_map_rejects_them(dispatcher):
    map_ = Refusing(dispatcher, "chair1")
    map_.become("chair1", joints=OPENED, joint_commit=1)
    map_.reconciler.reconcile()
    assert map_.changes[0][0].joints == {"chair1": OPENED}
    map_.refuse(errors.Refused("it is locked"))
    assert map_.said == ["the joints of chair1 were moved back, because the map rejected them: it is locked"]
    ((moved,),) = [call.orders for call in map_.asked if call.VERB == "move-joints"]
    assert moved.name == "chair1"
    assert len(map_.changes) == 1


@pytest.mark.parametrize(
    ("error", "tries", "said"),
    [
        (errors.BadRequest("no such property"), 1, []),
        (MemoryError("no memory"), 2, ["chair1: joint positions are not committed yet: no memory"]),
    ],
)
def test_joints_that_are_not_committed_are_tried_again(dispatcher, error, tries, said):
    map_ = Refusing(dispatcher, "chair1")
    map_.become("chair1", joints=OPENED, joint_commit=1)
    map_.reconciler.reconcile()
    map_.refuse(error)
    assert (len(map_.changes), map_.said, map_.asked) == (tries, said, [])
    assert map_.reconciler.is_followed("chair1") is (tries == 1)


def test_the_map_follows_attachments_in_the_scene(dispatcher):
    map_ = Refusing(dispatcher, "chair1", "chair2", "table1")
    map_.become("chair1", held_by="stranger1", grip=GRIP, grip_commit=0)
    map_.become("chair2", held_by="table1", grip=GRIP, grip_commit=0)
    map_.reconciler.reconcile()
    ((change, _),) = map_.changes  # an unknown body is not an entity yet
    assert change.grips == {"chair2": ("table1", GRIP)}
    assert change.reason == "chair2 was attached to table1 in the scene"
    map_.reconciler.reconcile()
    assert len(map_.changes) == 1  # it is under way


def test_the_map_follows_detachments_in_the_scene(dispatcher):
    dispatcher.map.bodies = dict
    map_ = Refusing(dispatcher, "chair1", "table1")
    said = structs.replace(
        dispatcher.map.entities["chair1"],
        properties={"isGraspedBy": "table1"},
        grip_provenance=structs.replace(dispatcher.map.entities["chair1"].provenance, source="scene"),
    )
    dispatcher.map.entities["chair1"] = said
    map_.become("chair1", grip_commit=1)
    map_.reconciler.reconcile()
    ((change, _),) = map_.changes
    assert change.grips == {"chair1": ("", None)}
    assert change.reason == "chair1 was detached from table1 in the scene"


@pytest.mark.parametrize(
    ("error", "tries", "said", "asked"),
    [
        (errors.BadRequest("no such property"), 1, [], []),
        (MemoryError("no memory"), 2, ["chair1: the attachment is not committed yet: no memory"], []),
        (
            errors.Refused("it is too heavy"),
            1,
            ["the attachment of chair1 was restored, because the map rejected the new: it is too heavy"],
            ["grip"],
        ),
    ],
)
def test_an_attachment_is_restored_when_the_map_rejects_it(dispatcher, error, tries, said, asked):
    map_ = Refusing(dispatcher, "chair1", "table1")
    map_.become("chair1", held_by="table1", grip=GRIP, grip_commit=0)
    map_.reconciler.reconcile()
    map_.refuse(error)
    assert (len(map_.changes), map_.said) == (tries, said)
    assert [call.VERB for call in map_.asked] == asked


@pytest.mark.parametrize(
    ("error", "tries"), [(errors.Refused("too large for its room"), 1), (MemoryError("no memory"), 2)]
)
def test_the_map_follows_the_size_of_a_body_of_another_world_once_unless_it_rejects_it(
    dispatcher, error, tries
):
    dispatcher.map.bodies = dict
    map_ = Refusing(dispatcher, "chair1", truth="scene")
    chair = dispatcher.map.entities["chair1"]
    of_scene = structs.replace(chair.shape_provenance, source="scene")
    known = structs.replace(chair, size_m=(0.5, 0.5, 1.0), shape_provenance=of_scene)
    dispatcher.map.entities["chair1"] = known
    map_.become("chair1", surface="abc")
    map_.reconciler.reconcile()
    map_.reconciler.reconcile()
    ((change, _),) = map_.changes
    assert change.sizes_m == {"chair1": (0.5, 0.5, 0.5)}
    assert change.reason == "chair1 has another size in the scene"
    map_.refuse(error)
    assert len(map_.changes) == tries
    assert map_.said == [f"chair1: its new size is not committed: {error}"]


@pytest.mark.parametrize(
    ("names", "told", "were"),
    [(("chair1",), "its new pose", "was"), (("chair1", "chair2"), "their new poses", "were")],
)
def test_bodies_that_the_map_rejects_are_put_back_and_that_is_reported(dispatcher, names, told, were):
    map_ = Refusing(dispatcher, *names)
    for name in names:
        map_.become(name, pose=Pose(position_m=(7.0, 7.0, 0.0)))
    if len(names) > 1:
        dispatcher.manual_moves.register(c.Move(name=names[0], at=(7.0, 7.0, 0.0)), names[1:])
    map_.reconciler.reconcile()
    map_.refuse(errors.Refused("they may not stand there"))
    who = " and ".join(names)
    assert map_.said == [f"{who} {were} put back, because the map rejected {told}: they may not stand there"]
    ((back),) = [call.placements for call in map_.asked if call.VERB == "move"]
    assert {p.name: p.pose for p in back} == {n: dispatcher.map.entity(n).pose for n in names}


def test_poses_that_show_a_body_elsewhere_are_followed_and_older_ones_are_not(dispatcher):
    map_ = Refusing(dispatcher, "chair1", "chair2")
    bodies = tuple(map_.reconciler.scene.bodies.values())
    map_.reconciler.scene.take(
        Scene(run="r", version=1, stamp_ns=10, sim_time_s=0.0, world="w", bodies=bodies)
    )

    def poses(x, stamp_ns, *, resting=True, version=1):
        entity = dispatcher.map.entity("chair1")
        return Poses(
            run="r",
            version=version,
            stamp_ns=stamp_ns,
            sim_time_s=0.0,
            names=("chair1",),
            poses=(x, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0),
            resting=(resting,),
            commits=(entity.pose_provenance.commit,),
        )

    map_.reconciler.on_poses(poses(5.0, 11, resting=False))
    map_.reconciler.on_poses(poses(6.0, 9))
    assert map_.changes == []
    map_.reconciler.on_poses(poses(7.0, 12))
    ((change, _),) = map_.changes
    assert [pose.position_m for pose in change.poses.values()] == [(7.0, 1.0, 0.0)]
    assert map_.asked == []
    map_.reconciler.on_poses(poses(8.0, 13, version=2))
    assert [call.VERB for call in map_.asked] == ["snapshot"]


def test_a_scene_that_is_silent_is_forgotten_unless_it_has_orders_of_ours(dispatcher):
    map_ = Refusing(dispatcher, "chair1")
    map_.reconciler.lose_scene()
    assert not map_.reconciler.scene.known
    map_ = Refusing(dispatcher, "chair2")
    dispatcher.change(c.Add(class_="Chair", name="chair3", at=(5.0, 5.0, 0.0)))
    map_.reconciler.reconcile()
    map_.reconciler.lose_scene()
    assert map_.reconciler.scene.known


def test_a_reset_puts_back_what_stands_by_itself_and_moves_joints(dispatcher):
    map_ = Refusing(dispatcher, "chair1", "chair2", "chair3")
    map_.become("chair1", joints=OPENED, joint_commit=1)
    map_.become("chair2", held_by="chair3", grip=GRIP, grip_commit=1)
    dispatcher.change(c.Add(class_="Kitchen", name="kitchen1"))
    map_.reconciler.place_all()
    moves = {call.VERB: call for call in map_.asked}
    assert [p.name for p in moves["move"].placements] == ["chair1", "chair3"]
    assert [o.name for o in moves["move-joints"].orders] == ["chair1"]


@pytest.mark.parametrize(
    ("name", "fields", "status", "detail"),
    [
        ("chair1", {}, "present", ""),
        (
            "chair1",
            {"ghost": True},
            "ghost",
            "overlaps another body, so it does not collide until there is room",
        ),
        (
            "chair1",
            {"ghost": True, "in_the_way": "table1"},
            "ghost",
            "overlaps table1, so it does not collide until there is room",
        ),
        ("kitchen1", None, "none", "a place has no body"),
        ("chair2", None, "pending", ""),
    ],
)
def test_the_state_of_a_body(dispatcher, name, fields, status, detail):
    map_ = Refusing(dispatcher, "chair1")
    dispatcher.change(c.Add(class_="Kitchen", name="kitchen1"))
    dispatcher.change(c.Add(class_="Chair", name="chair2", at=(9.0, 9.0, 0.0)))
    if fields is not None:
        map_.become(name, **fields)
    state = map_.reconciler.body_state(dispatcher.map.entity(name))
    assert (state.status, state.detail) == (status, detail)
    map_.reconciler.lose_scene()
    lost = map_.reconciler.body_state(dispatcher.map.entity(name))
    assert lost.status == ("none" if name == "kitchen1" else "unknown")


def test_world_bodies_without_entities_are_problems_if_the_scene_is_the_truth(dispatcher):
    reconciler = Reconciler(
        CoordinatorConfig("scene"), dispatcher, lambda change: Future(), lambda call: Future(), print
    )
    reconciler.scene.known = True
    dispatcher.change(c.Add(class_="Chair", name="chair1", at=(1.0, 1.0, 0.0)))
    assert reconciler.problems() == ["chair1: missing: it is not in the scene"]
    fallen = standing(BodyOrder(name="sofa", class_="Chair", pose=Pose(position_m=(0.0, 0.0, 0.0)), commit=0))
    reconciler.scene.bodies["sofa"] = structs.replace(fallen, resting=False)
    reconciler.scene.bodies["leg"] = structs.replace(fallen, name="leg", part_of="sofa")
    reconciler.scene.left_out = ("screw",)
    assert reconciler.problems()[1:] == [
        "sofa: a scene body that becomes an entity when it comes to rest",
        "leg: a part of sofa, which is not an entity yet",
        "1 body of the world is only a part of another: screw (to have one, start with --class-map FILE)",
    ]
    reconciler.scene.left_out = ("screw", "nut")
    assert "are only parts of others: screw and nut" in reconciler.problems()[-1]


def test_a_body_of_the_scene_becomes_an_entity_after_what_it_is_part_of(dispatcher):
    added = []
    reconciler = Reconciler(
        CoordinatorConfig("scene"),
        dispatcher,
        lambda change: added.append(change) or Future(),
        lambda call: Future(),
        print,
    )
    reconciler.scene.known = True
    sofa = standing(BodyOrder(name="sofa", class_="Chair", pose=Pose(position_m=(1.0, 2.0, 0.0)), commit=0))
    reconciler.scene.bodies["leg"] = structs.replace(sofa, name="leg", part_of="sofa")
    reconciler.scene.bodies["sofa"] = sofa
    reconciler.reconcile()
    reconciler.reconcile()
    ((add),) = added
    assert (add.name, add.class_, add.at, add.size) == ("sofa", "Chair", (1.0, 2.0, 0.0), (0.5, 0.5, 0.5))
    assert (add.source, add.reason, add.track, add.set) == ("scene", "sofa stands in the scene", None, ())
    dispatcher.change(add)
    reconciler.reconcile({"leg"})
    assert (added[-1].name, added[-1].set) == ("leg", ("isDirectPartOf=sofa",))


def test_a_new_entity_has_the_words_of_its_body_and_what_is_open_and_closed(dispatcher):
    added = []
    reconciler = Reconciler(
        CoordinatorConfig("scene"),
        dispatcher,
        lambda change: added.append(change) or Future(),
        lambda call: Future(),
        print,
    )
    reconciler.scene.known = True
    order = BodyOrder(name="wardrobe_1", class_="Wardrobe", pose=Pose(position_m=(1.0, 2.0, 0.0)), commit=0)
    hinge = Joint(name="hinge", kind="hinge", position=0.0, lower=0.0, upper=1.57, closed=0.0)
    reconciler.scene.bodies["wardrobe_1"] = structs.replace(
        standing(order), joints=(hinge,), label="oak wardrobe", body="wardrobe 1"
    )
    reconciler.reconcile()
    ((add),) = added
    assert (add.ref, add.set) == ("oak wardrobe", ("isOpen=false", "openness=0", "jointPositions=hinge=0"))
    dispatcher.change(structs.replace(add, class_="Chair", set=()))
    assert reconciler.body_state(dispatcher.map.entities["wardrobe_1"]).body == "wardrobe 1"


def test_bodies_moved_together_are_committed_together_once_all_rest(dispatcher):
    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), lambda call: Future(), lambda text: None
    )
    reconciler.scene.known = True
    for i, name in enumerate(("chair1", "chair2", "chair3")):
        dispatcher.change(c.Add(class_="Chair", name=name, at=(1.0 + i, 1.0, 0.0)))
    put = {
        name: structs.replace(
            standing(body_order(entity, entity.pose)),
            pose=Pose(position_m=(entity.pose.position_m[0], 5.0, 0.0)),
            resting=name != "chair3",
        )
        for name, entity in dispatcher.map.entities.items()
    }
    dispatcher.manual_moves.register(c.Move(name="chair1", at=(1.0, 5.0, 0.0), agent="ann"), ["chair3"])
    reconciler.scene.bodies.update(put)
    reconciler.reconcile()
    assert [e.pose.position_m[1] for e in dispatcher.map.entities.values()] == [1.0, 5.0, 1.0]
    seq = dispatcher.map.seq
    reconciler.scene.bodies["chair3"] = structs.replace(put["chair3"], resting=True)
    reconciler.reconcile({"chair3"})
    assert [e.pose.position_m[1] for e in dispatcher.map.entities.values()] == [5.0, 5.0, 5.0]
    assert dispatcher.map.seq == seq + 1
    assert dispatcher.map.entity("chair3").pose_provenance.agent == "ann"
    assert dispatcher.change(c.Undo()).names == ("chair1", "chair3")


def test_map_and_scene_do_not_agree_by_a_commit_that_the_knowledge_base_has_not_confirmed(dispatcher):
    reconciler, _, _ = bodies_elsewhere(dispatcher, 0)
    dispatcher.change(c.Add(class_="Kitchen", name="kitchen1"))
    assert reconciler.agreement().holds
    dispatcher.map.take(Effects(seq=dispatcher.map.seq + 1, id="forged", digest="00"))
    assert reconciler.agreement().holds is False


def test_bodies_that_are_not_stable_are_problems(dispatcher):
    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), lambda call: Future(), lambda text: None
    )
    scene = Scene(run="r", version=1, stamp_ns=1, sim_time_s=0.0, world="w", bodies=(), unstable=("chain_1",))
    reconciler.scene.take(scene)
    assert reconciler.problems() == [
        "chain_1: its simulated state was not finite, so it was stopped; use a smaller timestep, a larger"
        " mass, or softer joints and contacts in its world file or model"
    ]
    reconciler.lose_scene()
    assert reconciler.problems() == []
