"""The simulator node: serves `semmap/sim/<verb>`, and publishes poses and camera images."""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import Future
from functools import partial
from typing import Any, Literal, TypeVar

import numpy as np
from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.runtime.class_names import ClassNames
from semmap.nodes.runtime.loop import Node, open_node
from semmap.nodes.sim_node.config import SimConfig
from semmap.nodes.sim_node.models.model_reader import ModelReader
from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.physics.build import run_in_background
from semmap.nodes.sim_node.robots.base_controller import Outcome
from semmap.nodes.sim_node.robots.robot import RobotSensor
from semmap.nodes.sim_node.scene_state import FILENAME, SceneStore
from semmap.nodes.sim_node.shape_sender import ShapeSender
from semmap.nodes.sim_node.vision.video_renderer import Plane, SceneSnapshot, VideoRenderer
from semmap.nodes.sim_node.vision.view import FROM_ABOVE, View, camera_view, overview
from semmap.nodes.sim_node.window import Window
from semmap.nodes.sim_node.world_file import is_scene, names_classes, open_world
from semmap.nodes.sim_node.world_shapes import world_shapes
from semmap.schemas import codec, errors, keys, wording
from semmap.schemas.calls import by_verb
from semmap.schemas.commands import Classes, Pause, Reset, StepOnce
from semmap.schemas.plans import Outline, WallsQuery
from semmap.schemas.replies import Done
from semmap.schemas.scenes import (
    BodiesMoved,
    CameraPose,
    CamerasQuery,
    Delete,
    Deleted,
    DriveBase,
    Driven,
    Grip,
    Gripped,
    JointsMoving,
    MoveBodies,
    MoveJoints,
    Picture,
    PictureQuery,
    Scene,
    SceneQuery,
    Spawn,
    Spawned,
    Surface,
    SurfaceQuery,
    Surfaces,
    WorldQuery,
)

Reply = TypeVar("Reply")
Timed = TypeVar("Timed", BodiesMoved, JointsMoving, Driven)

_ADVANCE_S = 0.01
_PUBLISH_S = 0.05
"""Periods of physics and of poses; while everything sleeps, that of poses holds for both."""

_REFRESH_S = 1.0 / 30.0
_PLANES: dict[str, Literal["rgb", "depth", "segments"]] = {
    "rgb8": "rgb",
    "depth32f": "depth",
    "segments16": "segments",
}
_BODY_STEPS = 5_000
"""This many steps of single bodies take 0.1 to 0.2 s; then other work is done."""

_SHOWN = 6
_LAG_S = 0.1
"""Lag of the simulated time beyond which time is dropped."""


class Simulator:
    """Connects the world to the network; the node's thread owns the world."""

    def __init__(self, node: Node, config: SimConfig) -> None:
        self._node = node
        self._reader = ModelReader()
        models = Models(config.models, config.data, self._reader)
        classes = self._classes(config)
        if config.world is not None:
            node.describe(f"compiling the world {config.world.name}")
        self._world = open_world(config.world, models, node.tick, classes, config.robot, config.class_map)
        self._send_shapes(config)
        self._store: SceneStore | None = None
        if config.is_truth and config.world is not None and config.data is not None:
            self._store = SceneStore(config.data / FILENAME, self._world, config.world)
            node.note((*self._world.notes, *self._store.restore()))
        self._paused = config.still
        self._clock_s = self._published_s = time.monotonic()
        self._is_idle = False
        self._poses = bus.publisher(node.session, keys.POSES)
        self._renderer = VideoRenderer(config.cameras, bus.subscriber_check(node.session, keys.SEGMENTS))
        self._planes: dict[str, Any] = {}
        self._sensor: RobotSensor | None = None
        if config.robot is not None:
            self._sensor = run_in_background(partial(RobotSensor, config.robot), node.tick)
            key = keys.robot_state_key(config.robot.name)
            self._states = bus.publisher(node.session, keys.ROBOT_STATE, key)
        self._driving: dict[str, Future[Driven]] = {}
        """The pending replies to drive commands, by robot."""
        node.serve(
            keys.SIM,
            by_verb(
                Spawn.answered_by(self._spawn),
                Delete.answered_by(self._delete),
                MoveBodies.answered_by(self._move),
                MoveJoints.answered_by(self._move_joints),
                Grip.answered_by(self._grip),
                SceneQuery.answered_by(self._snapshot),
                CamerasQuery.answered_by(self._cameras),
                DriveBase.answered_by(self._drive),
                Pause.answered_by(self._pause),
                StepOnce.answered_by(self._step),
                Reset.answered_by(self._reset),
                PictureQuery.answered_by(self._picture),
                SurfaceQuery.answered_by(self._surfaces),
                WallsQuery.answered_by(self._walls),
                WorldQuery.answered_by(self._world_surface),
            ),
        )
        self._window = Window(self._world) if config.window else None
        if self._window is not None:
            node.every(_REFRESH_S, self._window.refresh)
        self._set_period = node.every(_ADVANCE_S, self._advance)
        if config.cameras.rate_hz > 0.0:
            node.every(1.0 / config.cameras.rate_hz, self._render_cameras)
        node.ready(self._summary())
        node.describe(self._summary)

    def _classes(self, config: SimConfig) -> ClassNames:
        """Return the TBox's classes, if the world file needs them."""
        if not names_classes(config.world):
            return ClassNames()
        self._node.describe("waiting for the knowledge base")
        try:
            found = self._node.ask(
                keys.BRIDGE, Classes(), timeout_s=bus.TIMEOUT_S, patience_s=config.patience_s, beating=True
            )
        except errors.NoAnswer:
            self._node.report("no response from the knowledge base; using models named like the classes")
            return ClassNames()
        return ClassNames(found)

    def _send_shapes(self, config: SimConfig) -> None:
        """Send the shapes of the bodies of an MJCF world to the knowledge base, as soon as it is there.

        The bodies of a JSON scene have the shapes of their models.
        """
        if config.world is None or is_scene(config.world):
            return
        found = run_in_background(lambda: world_shapes(self._world), self._node.tick)
        if found:
            send = partial(self._node.ask_later, keys.BRIDGE, patience_s=config.patience_s)
            self._node.follow(keys.HEALTH, ShapeSender(found, send, self._node.report).on_health)

    def close(self) -> None:
        """Store the scene, stop the renderer and the reader of models, and close the window."""
        if self._store is not None:
            self._store.write()
        self._renderer.close()
        self._reader.close()
        if self._window is not None:
            self._window.close()

    def _spawn(self, message: Spawn) -> Spawned:
        return self._published(self._world.spawn(message.bodies))

    def _delete(self, message: Delete) -> Deleted:
        return self._published(self._world.delete(message.names))

    def _move(self, message: MoveBodies) -> BodiesMoved:
        return self._timed(self._world.move(message.placements))

    def _move_joints(self, message: MoveJoints) -> JointsMoving:
        return self._timed(self._world.move_joints(message.orders))

    def _grip(self, message: Grip) -> Gripped:
        return self._published(self._world.grip(message.orders))

    def _drive(self, message: DriveBase) -> Driven | Future[Driven]:
        self._world.drive(message)
        self._report_ended()
        if not message.wait or not message.to or self._paused:
            return self._timed(self._driven(message.name, "driving" if message.to else "stopped"))
        future: Future[Driven] = Future()
        self._driving[message.name] = future
        return future

    def _report_ended(self) -> None:
        """Reply to drive commands that ended."""
        for name, outcome in self._world.ended().items():
            future = self._driving.pop(name, None)
            if future is not None:
                future.set_result(self._timed(self._driven(name, outcome)))

    def _driven(self, name: str, outcome: Outcome | Literal["driving"]) -> Driven:
        return Driven(name=name, outcome=outcome, pose=self._world.pose(name))

    def _timed(self, reply: Timed) -> Timed:
        """Publish the poses, and add time stamp and pause state to the reply."""
        stamp_ns = self._world.clock.stamp_ns()  # later poses have newer stamps
        return self._published(structs.replace(reply, paused=self._paused, stamp_ns=stamp_ns))

    def _snapshot(self, _: SceneQuery) -> Scene:
        return self._world.scene()

    def _cameras(self, _: CamerasQuery) -> tuple[CameraPose, ...]:
        return self._world.cameras()

    def _pause(self, message: Pause) -> Done:
        state = "running" if message.off else "paused"
        if self._paused is not message.off:
            return Done(text=f"time is already {state}")
        self._paused = not message.off
        self._clock_s = time.monotonic()
        if self._paused:
            self._release_waiting()
        self._set_pace()
        return Done(text=f"time is {state}")

    def _release_waiting(self) -> None:
        """Reply to drive commands, which cannot end while time is paused."""
        waiting, self._driving = self._driving, {}
        for name, future in waiting.items():
            future.set_result(self._timed(self._driven(name, "driving")))

    def _step(self, message: StepOnce) -> Done:
        if not self._paused:
            raise errors.Refused("time is running; pause it first with: semmap pause")
        timestep_s, before_s = float(self._world.model.opt.timestep), self._now_s
        end_s = before_s + max(message.seconds, timestep_s)
        while (left_s := end_s - self._now_s) > timestep_s / 2:
            self._world.step(min(left_s, _PUBLISH_S, self._slice_s()))
            self._node.tick()  # a long step must not stop the heartbeat
        passed_s = round(self._now_s - before_s, 6)
        return self._published(Done(text=f"advanced by {passed_s:g} s to {self._now_s:.2f} s"))

    @property
    def _now_s(self) -> float:
        """Return the simulated time."""
        return float(self._world.data.time)

    def _reset(self, _: Reset) -> Done:
        count = self._world.reset()
        return self._published(Done(text=f"reset to the ordered poses: {wording.bodies(count)}"))

    def _picture(self, query: PictureQuery) -> Future[Picture]:
        box = None if query.box is None else (np.array(query.box[0]), np.array(query.box[1]))
        labels = self._world.tops(box) if query.labels else {}
        return self._renderer.render_picture(self._scene_snapshot(), self._view(query), labels)

    def _surfaces(self, query: SurfaceQuery) -> Surfaces:
        return self._world.surfaces(query.names)

    def _world_surface(self, _: WorldQuery) -> Surface:
        return self._world.surface()

    def _walls(self, _: WallsQuery) -> tuple[Outline, ...]:
        return self._world.walls()

    def _scene_snapshot(self) -> SceneSnapshot:
        return SceneSnapshot(*self._world.snapshot())

    def _render_cameras(self) -> None:
        self._renderer.render_cameras(self._measured_snapshot, self._publish_plane)

    def _measured_snapshot(self) -> SceneSnapshot:
        """Return the scene of the next frames, and publish the state of the robot in it."""
        taken = self._scene_snapshot()
        if self._sensor is not None:
            state = self._sensor.state(taken.model, taken.data, taken.stamp_ns)
            self._states.put(codec.encode(state), encoding=codec.encoding_of(state))
        return taken

    def _publish_plane(self, plane: Plane) -> None:
        frame, pixels = plane
        key = keys.camera_key(frame.camera, _PLANES[frame.encoding])
        if key not in self._planes:
            self._planes[key] = bus.publisher(self._node.session, keys.CAMERA, key)
        self._planes[key].put(pixels.tobytes(), attachment=codec.encode(frame))

    def _view(self, query: PictureQuery) -> View:
        world = self._world
        if query.camera:
            return camera_view(world.model, world.data, query.camera, query.width, query.height)
        if query.box is not None:
            low, high = np.array(query.box[0]), np.array(query.box[1])
            return overview(low, high, query.width, query.height, back=FROM_ABOVE)
        low, high = world.extent()
        return overview(low, high, query.width, query.height)

    def _published(self, reply: Reply) -> Reply:
        """Publish the poses immediately, so that subscribers do not wait for the next period."""
        self._publish()
        self._set_pace()
        return reply

    def _advance(self) -> None:
        now = time.monotonic()
        if not self._paused:
            before = self._world.joints_at_rest
            self._world.step(min(now - self._clock_s, _LAG_S, self._slice_s()))
            if self._world.joints_at_rest > before:
                self._publish()  # the end of a motion is published immediately
        if now - self._published_s > _PUBLISH_S - _ADVANCE_S / 2:
            self._publish()
        self._clock_s = now
        self._set_pace()
        self._report_ended()

    def _set_pace(self) -> None:
        """Advance seldom while nothing can move: a wake-up costs more than the physics of sleeping bodies."""
        was_idle, self._is_idle = self._is_idle, self._paused or self._world.asleep
        if was_idle and not self._is_idle:
            self._clock_s = time.monotonic()
        self._set_period(_PUBLISH_S if self._is_idle else _ADVANCE_S)

    def _slice_s(self) -> float:
        """Return the simulated time that can be computed without delaying other work."""
        timestep_s = float(self._world.model.opt.timestep)
        return timestep_s * max(1, _BODY_STEPS // max(1, self._world.awake))

    def _publish(self) -> None:
        poses = self._world.poses()
        if self._store is not None:
            self._store.update(poses)
        self._published_s = time.monotonic()
        self._poses.put(codec.encode(poses), encoding=codec.encoding_of(poses))

    def _summary(self) -> str:
        state = ", paused" if self._paused else ""
        world = self._world
        bodies = (
            f"{wording.bodies(len(world))} in " if len(world) else ""
        )  # the map's bodies are not spawned yet
        compiling = ", compiling" if world.compiling else ""
        ignored = f"; declared but ignored: {_few(world.ignored)}" if world.ignored else ""
        return f"{bodies}{world.name}{state}{compiling}{ignored}"


def _few(words: Sequence[str]) -> str:
    more = f" and {len(words) - _SHOWN} more" if len(words) > _SHOWN else ""
    return ", ".join(words[:_SHOWN]) + more


def run(config: SimConfig) -> None:
    """Run the node until it is stopped."""
    with open_node("sim_node", config.network) as node:
        simulator = Simulator(node, config)
        try:
            node.run()
        finally:
            simulator.close()
