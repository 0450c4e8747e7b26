"""Frames on Zenoh: received on `semmap/frame/<name>`, and used in the positions of commands."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from functools import partial
from typing import Any, TypeVar

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.coordinator.commands.commit import find_earlier_result
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.frames.conversion import (
    Framed,
    convert_to_frame,
    convert_to_map,
    require_position,
)
from semmap.nodes.coordinator.frames.links import PART_OF, EntityLinks, camera_links
from semmap.nodes.coordinator.frames.published_frames import PublishedFrames
from semmap.nodes.coordinator.frames.tree import Link, Tree
from semmap.nodes.coordinator.kb_client import KbClient
from semmap.nodes.coordinator.kb_coroutines import run_async
from semmap.nodes.coordinator.live.feed import LiveFeed
from semmap.nodes.coordinator.reconciler.reconciler import AskSim
from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.nodes.coordinator.scheduler import Scheduler
from semmap.nodes.runtime.futures import SingleThreadFuture, settle
from semmap.nodes.runtime.loop import Node
from semmap.schemas import commands as c
from semmap.schemas import errors, keys
from semmap.schemas.entities import Pose
from semmap.schemas.frames import Frame, FramePose
from semmap.schemas.relations import Described
from semmap.schemas.scenes import CameraPose, CamerasQuery

R = TypeVar("R")
Cameras = Iterable[CameraPose]
_PERIOD_S = 0.1
_MOST = 20_000


class Frames:
    """Owned by the coordinator's thread. Published frames are read in batches, which costs little."""

    def __init__(
        self,
        node: Node,
        stale_s: float,
        map_view: MapView,
        live: LiveFeed,
        scene: SceneView,
        ask_sim: AskSim,
        kb: KbClient,
        scheduler: Scheduler,
    ) -> None:
        """`ask_sim(call)` calls the simulator; a frame without messages is stale after `stale_s`."""
        self._map, self._live, self._scene = map_view, live, scene
        self._ask_sim, self._kb, self._scheduler = ask_sim, kb, scheduler
        self._published = PublishedFrames(stale_s)
        self._stream = bus.NewestSamples(node.session, keys.FRAME, _MOST, deletions=True)
        node.every(_PERIOD_S, self._read)

    def problems(self) -> list[str]:
        """Return the problems of published frames, one sentence each."""
        return list(self._published.problems(time.monotonic()))

    def list(self, command: c.ListFrames) -> tuple[Frame, ...] | Future[tuple[Frame, ...]]:
        """Return the frames of the tree, or a part of it. Raises UnknownName."""
        return self._with_cameras(lambda tree: tuple(tree.frames(command.name)))

    def in_map_frame(self, handle: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """Wrap `handle`: convert the positions of its commands from their frame to the map frame."""

        def in_turn(command: Framed) -> Any:
            if command.frame is None:
                return handle(command)
            require_position(command)
            return self._scheduler.run_after(lambda: self._in_frame(command, handle))

        return in_turn

    def _in_frame(self, command: Framed, handle: Callable[[Any], Any]) -> Any:
        """Handle a command in its order: a frame is where the commands before it have left it."""
        word = command.frame
        if word is None:
            raise errors.InternalError("a command without a frame was to be converted")

        def answer(tree: Tree) -> Any:
            try:
                name = tree.resolve(word)
                frame = tree.map_pose(name)
                wanted = convert_to_map(command, frame)
            except (errors.Refused, errors.BadRequest) as error:
                return self._earlier_result_or_raise(command, error)
            if not isinstance(command, c.Get | c.List):
                return handle(wanted)
            made: Future[Any] = SingleThreadFuture()
            settle(made, lambda: handle(wanted))
            return _then(made, lambda found: self._told(tree, name, frame, found))

        tree = self._tree()
        if self._scene.known and tree.is_missing(word):
            return self._with_cameras(answer)
        return answer(tree)

    def _told(self, tree: Tree, name: str, frame: Pose, found: Any) -> Any:
        if isinstance(found, Described):
            return structs.replace(
                convert_to_frame(frame, self._with_pose_from_whole(tree, found)), frame=name
            )
        return tuple(convert_to_frame(frame, self._with_pose_from_whole(tree, entity)) for entity in found)

    def _with_pose_from_whole(self, tree: Tree, entity: Any) -> Any:
        """Return an untracked part with the pose that follows from the current pose of its whole."""
        if entity.tracked or PART_OF not in entity.properties:
            return entity
        try:
            return structs.replace(entity, pose=tree.map_pose(entity.name))
        except errors.Refused:
            return entity

    def _earlier_result_or_raise(self, command: Framed, error: errors.SemmapError) -> Any:
        """Return the earlier result of a repeated change whose frame is gone, or raise `error`."""
        if not isinstance(command, c.Add | c.Update) or not command.id or command.dry_run:
            raise error

        def result_or_raise(done: Any) -> Any:
            if done is None:
                raise error
            return done

        return _then(run_async(find_earlier_result(command), self._kb.ask_later), result_or_raise)

    def _with_cameras(self, use: Callable[[Tree], R]) -> R | Future[R]:
        """Return `use(tree)`; the tree includes the cameras of the simulator if one runs."""
        if not self._scene.known:
            return use(self._tree())
        future: Future[Any] = SingleThreadFuture()
        asked = self._ask_sim(CamerasQuery())
        asked.add_done_callback(lambda done: settle(future, lambda: use(self._tree(_cameras_of(done)))))
        return future

    def _tree(self, cameras: Cameras = ()) -> Tree:
        self._read()
        now_s, entities, published = time.monotonic(), self._map.entities, self._published
        of_entities = EntityLinks(entities, self._live.live_pose, self._scene.bodies, self._live.scene_age_s)
        of_cameras: dict[str, Link] = {}

        def find(name: str) -> Link | None:
            return of_entities.link(name) or published.link(name, now_s) or of_cameras.get(name)

        def carrier(name: str) -> Pose | None:
            try:
                return tree.map_pose(name) if name in entities else None
            except errors.Refused:
                return None

        def names() -> Iterable[str]:
            return {**dict.fromkeys(entities), **dict.fromkeys(published), **of_cameras}

        tree = Tree(find, names)
        of_cameras.update(camera_links(cameras, carrier))
        return tree

    def _read(self) -> None:
        now_s = time.monotonic()
        for key, read in self._stream.take():
            self._published.take(keys.of_frame(key), partial(_with_stamp, read), self._map.entities, now_s)
        self._published.forget(now_s)


def _with_stamp(read: Callable[[], FramePose | None]) -> tuple[FramePose, int] | None:
    """Return the message with its stamp, or with the time of arrival. Raises BadRequest."""
    message = read()
    return None if message is None else (message, message.stamp_ns or time.time_ns())


def _cameras_of(done: Future[tuple[CameraPose, ...]]) -> Cameras:
    """Return the camera poses; none if the simulator has ended in the meantime."""
    try:
        return done.result()
    except errors.NoAnswer:
        return ()


def _then(future: Future[Any], function: Callable[[Any], Any]) -> Future[Any]:
    following: Future[Any] = SingleThreadFuture()
    future.add_done_callback(lambda done: settle(following, lambda: function(done.result())))
    return following
