"""The frames that other programs publish and the coordinator accepts: no cycles, and none that are stale."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Future
from typing import Any, Final

from semmap.nodes import bus
from semmap.nodes.runtime.loop import Node
from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas import errors, keys
from semmap.schemas.commands import ListFrames
from semmap.schemas.entities import Pose
from semmap.schemas.frames import Frame

_ASK_S: Final = 1.0

Placed = tuple[str, Pose]
"""The parent of a frame, and the pose in it."""


class PublishedFrames:
    """The accepted frames, requested every second, with their newest poses. Owned by the node's thread."""

    def __init__(self, node: Node, replica: MapReplica[Any]) -> None:
        """Frames with the name of an entity of `replica` are ignored."""
        self._node, self._map = node, replica
        self._stream = bus.NewestSamples(node.session, keys.FRAME)
        self._known: dict[str, Placed] = {}
        self._asking = False
        node.every(_ASK_S, self._ask)

    def now(self) -> Mapping[str, Placed]:
        """Return each frame with its parent and newest pose."""
        known = self._known
        for key, read in self._stream.take():
            name = keys.of_frame(key)
            if name not in known:
                continue
            try:
                message = read()
                if message.parent == known[name][0]:
                    known = {**known, name: (message.parent, message.require_pose())}
            except errors.BadRequest:
                continue  # the coordinator reports it
        self._known = known
        return known

    def _ask(self) -> None:
        if self._asking:
            return
        self._asking = True

        def on_frames(done: Future[tuple[Frame, ...]]) -> None:
            self._asking = False
            found = () if done.exception() is not None else done.result()
            self._known = {
                frame.name: (frame.parent, frame.pose)
                for frame in found
                if frame.source == "stream" and frame.pose is not None and frame.map_pose is not None
                if frame.name not in self._map.entities
            }

        self._node.ask_later(keys.CMD, ListFrames()).add_done_callback(on_frames)
