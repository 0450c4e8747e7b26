"""The frames of entities and cameras: their current poses and parent frames."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from semmap.nodes.coordinator.frames.tree import Link
from semmap.schemas import errors, wording
from semmap.schemas.entities import Entity, Live, Pose, relative
from semmap.schemas.frames import MAP, FrameSource
from semmap.schemas.scenes import Body, CameraPose

PART_OF = "isDirectPartOf"


class _CurrentPose(NamedTuple):
    """The pose of an entity in the map frame, and its source."""

    pose: Pose | None
    source: FrameSource
    age_s: float | None = None
    stale: bool = False
    problem: str = ""


class EntityLinks:
    """The frame of an entity is relative to the map, or to the entity that it is a part of."""

    def __init__(
        self,
        entities: Mapping[str, Entity],
        live: Callable[[Entity], Live | None],
        bodies: Mapping[str, Body],
        body_age_s: Callable[[], float],
    ) -> None:
        """`live(entity)` returns the live pose; `bodies` are those of the scene, `body_age_s()` old."""
        self._entities = entities
        self._live = live
        self._bodies = bodies
        self._body_age_s = body_age_s

    def link(self, name: str) -> Link | None:
        """Return the link of an entity to its parent frame; None if there is no entity of that name.

        A part that is not tracked has its committed pose relative to its whole, and moves with it.
        """
        entity = self._entities.get(name)
        if entity is None:
            return None
        current, whole = self._current_pose(entity), self._whole_of(entity)
        if current.pose is None or whole is None:
            return Link(MAP, current.pose, current.source, current.age_s, current.stale, current.problem)
        above = self._current_pose(whole).pose if current.source != "map" else whole.pose
        if above is None:
            above = whole.pose
        if above is None:
            raise errors.InternalError(f"{whole.name} is the parent of a frame, and has no pose")
        pose = relative(current.pose, above)
        return Link(whole.name, pose, current.source, current.age_s, current.stale, current.problem)

    def _current_pose(self, entity: Entity) -> _CurrentPose:
        name = entity.name
        if entity.tracked:
            return _of_live(entity, self._live(entity))
        body = self._bodies.get(name)
        if body is not None and body.robot:  # the map follows a robot only when it stops
            return _CurrentPose(body.pose, "sim", self._body_age_s())
        problem = (
            "" if entity.pose is not None else f"{name} has no position, so it cannot be used as a frame"
        )
        return _CurrentPose(entity.pose, "map", problem=problem)

    def _whole_of(self, entity: Entity) -> Entity | None:
        """Return the whole of a part, if that has a position and is not itself a part of it."""
        whole = self._above(entity)
        passed, above = {entity.name}, whole
        while above is not None:
            if above.name in passed:
                return None
            passed.add(above.name)
            above = self._above(above)
        return whole

    def _above(self, entity: Entity) -> Entity | None:
        parent = entity.properties.get(PART_OF)
        whole = self._entities.get(parent) if isinstance(parent, str) else None
        return whole if whole is not None and whole.pose is not None and not whole.place else None


def _of_live(entity: Entity, live: Live | None) -> _CurrentPose:
    name = entity.name
    if live is None:
        source: FrameSource = "sim" if entity.tracked == "sim" else "stream"
        return _CurrentPose(
            entity.pose,
            source,
            stale=True,
            problem=f"{name} is tracked, but its current pose is unknown: no live pose has been received yet",
        )
    if live.stale:
        problem = f"the live pose of {name} is stale: none received for {wording.duration(live.age_s)}"
        return _CurrentPose(live.pose, live.source, live.age_s, stale=True, problem=problem)
    return _CurrentPose(live.pose, live.source, live.age_s)


def camera_links(cameras: Iterable[CameraPose], carrier: Callable[[str], Pose | None]) -> dict[str, Link]:
    """Return the optical frame of each camera, relative to the entity that carries it.

    `carrier(name)` returns the current pose of an entity in the map frame; None if it is unknown or stale.
    """
    found = {}
    for camera in cameras:
        above = carrier(camera.part_of) if camera.part_of else None
        found[camera.camera] = (
            Link(MAP, camera.pose, "camera")
            if above is None
            else Link(camera.part_of, relative(camera.pose, above), "camera")
        )
    return found
