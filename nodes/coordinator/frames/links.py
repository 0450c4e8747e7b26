"""The frames of entities and cameras: where they stand just now, and what they are a part of."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from semmap.nodes.coordinator.frames.tree import Link
from semmap.schemas import errors, wording
from semmap.schemas.entities import Entity, Live, Pose, relative
from semmap.schemas.frames import MAP, FrameSource
from semmap.schemas.scenes import Body, CameraPose

PART_OF = "isDirectPartOf"


class _Stand(NamedTuple):
    """Where an entity is in the map's frame, and how that is known."""

    pose: Pose | None
    source: FrameSource
    age_s: float | None = None
    stale: bool = False
    problem: str = ""


class EntityLinks:
    """An entity is in the map's frame, or in that of the whole that it is a part of."""

    def __init__(
        self,
        entities: Mapping[str, Entity],
        live: Callable[[Entity], Live | None],
        bodies: Mapping[str, Body],
        body_age_s: Callable[[], float],
    ) -> None:
        """`live(entity)` is where a tracked one is, `bodies` are those of the scene `body_age_s()` ago."""
        self._entities = entities
        self._live = live
        self._bodies = bodies
        self._body_age_s = body_age_s

    def link(self, name: str) -> Link | None:
        """The link of an entity to the frame that it is in; None where there is none of that name.

        A part that nobody tracks is where the map says it is on its whole, and goes with that.
        """
        entity = self._entities.get(name)
        if entity is None:
            return None
        stand, whole = self._stand(entity), self._whole_of(entity)
        if stand.pose is None or whole is None:
            return Link(MAP, stand.pose, stand.source, stand.age_s, stand.stale, stand.problem)
        above = self._stand(whole).pose if stand.source != "map" else whole.pose
        if above is None:
            above = whole.pose
        if above is None:
            raise errors.InternalError(f"{whole.name} is the parent of a frame, and has no pose")
        pose = relative(stand.pose, above)
        return Link(whole.name, pose, stand.source, stand.age_s, stand.stale, stand.problem)

    def _stand(self, entity: Entity) -> _Stand:
        name = entity.name
        if entity.tracked:
            return _of_live(entity, self._live(entity))
        body = self._bodies.get(name)
        if body is not None and body.robot:  # what a robot moves, the map follows only where it stops
            return _Stand(body.pose, "sim", self._body_age_s())
        problem = (
            "" if entity.pose is not None else f"{name} has no position, so nothing can be told from there"
        )
        return _Stand(entity.pose, "map", problem=problem)

    def _whole_of(self, entity: Entity) -> Entity | None:
        """What it is a part of, if that has a position and is not, in turn, a part of it."""
        whole = self._above(entity)
        passed, above = {entity.name}, whole
        while above is not None:
            if above.name in passed:
                return None
            passed.add(above.name)
            above = self._above(above)
        return whole

    def _above(self, entity: Entity) -> Entity | None:
        said = entity.properties.get(PART_OF)
        whole = self._entities.get(said) if isinstance(said, str) else None
        return whole if whole is not None and whole.pose is not None and not whole.place else None


def _of_live(entity: Entity, live: Live | None) -> _Stand:
    name = entity.name
    if live is None:
        source: FrameSource = "sim" if entity.tracked == "sim" else "stream"
        return _Stand(
            entity.pose,
            source,
            stale=True,
            problem=f"{name} is tracked, but where it is now is not known: no live pose of it has come yet",
        )
    if live.stale:
        problem = f"the live pose of {name} is stale: nothing has come for {wording.duration(live.age_s)}"
        return _Stand(live.pose, live.source, live.age_s, stale=True, problem=problem)
    return _Stand(live.pose, live.source, live.age_s)


def camera_links(cameras: Iterable[CameraPose], carrier: Callable[[str], Pose | None]) -> dict[str, Link]:
    """The optical frame of each camera, in that of the entity that carries it.

    `carrier(name)` is where an entity is in the map's frame just now; None for what is none, or is stale.
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
