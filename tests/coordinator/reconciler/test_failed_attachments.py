"""An attachment that the scene rejects is not ordered again before the map changes it."""

from __future__ import annotations

from concurrent.futures import Future

from msgspec import structs

from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.reconciler.reconcile import body_order
from semmap.nodes.coordinator.reconciler.reconciler import Reconciler
from semmap.schemas import commands as c
from semmap.schemas.attachments import pose_text
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import Gripped, Scene
from tests.coordinator.conftest import immediate
from tests.coordinator.reconciler.test_reconciler import standing

GRIP = {"isGraspedBy": "table1", "graspPose": pose_text(Pose(position_m=(0.0, 0.0, 1.0)))}


def test_it_is_tried_once_for_each_commit_and_reported_meanwhile(dispatcher):
    asked, rejects = [], [True]

    def ask(call):
        future = Future()
        if call.VERB == "grip":
            asked.append(call)
            failed = {"cup1": "it is too far away"} if rejects[0] else {}
            future.set_result(Gripped(bodies=(), failed=failed))
        else:
            bodies = tuple(reconciler.scene.bodies.values())
            future.set_result(Scene(run="r", version=1, stamp_ns=1, sim_time_s=0.0, world="w", bodies=bodies))
        return future

    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), ask, lambda text: None
    )
    reconciler.scene.known = True
    for i, name in enumerate(("cup1", "table1")):
        dispatcher.change(c.Add(class_="Chair", name=name, at=(float(i), 1.0, 0.0)))
    entities = dispatcher.map.entities
    for entity in entities.values():
        reconciler.scene.bodies[entity.name] = standing(body_order(entity, entity.pose))

    def attach(commit):
        said = structs.replace(entities["cup1"].provenance, commit=commit)
        entities["cup1"] = structs.replace(entities["cup1"], properties=GRIP, grip_provenance=said)
        reconciler.reconcile()

    attach(5)
    assert len(asked) == 1
    reconciler.reconcile()
    assert len(asked) == 1
    problem = "cup1: is not attached in the scene as in the map: it is too far away"
    assert problem in reconciler.problems()
    rejects[0] = False
    attach(6)
    assert len(asked) == 2
    assert problem not in reconciler.problems()
    reconciler.reconcile()
    assert len(asked) == 3  # the scene has not changed yet
