"""The figure that is drawn for an entity, a body, or both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from semmap.nodes.drawing.articulation import JointPositions, joint_positions_of
from semmap.schemas import errors
from semmap.schemas.entities import Entity, Pose, Size, angle_rad, distance_m
from semmap.schemas.polygons import Polygon, extent_of
from semmap.schemas.scenes import Body, Surface

Appearance = Literal["solid", "ghost", "believed", "furniture", "place"]
"""`believed`: without a body in the running simulator. `furniture`: a body of the world file."""

UNKNOWN_SIZE_M: Size = (0.2, 0.2, 0.2)
STILL_M = 0.001
STILL_RAD = 0.004


@dataclass(frozen=True)
class Figure:
    """How something is drawn, except its pose. `size_m` is along its own axes, from the bottom up.

    `surface` is known once the simulator has sent it.
    """

    label: str
    class_: str
    size_m: Size
    appearance: Appearance
    surface: Surface | None = None
    joint_positions: JointPositions = ()
    """The positions of the joints that move leaves of the surface, which has them at 0."""
    extent: Polygon | None = None
    """The polygon of a place, map frame, if it is not a box."""

    @property
    def group(self) -> str:
        """Return the branch of the recording to which the figure belongs."""
        return {"place": "places", "furniture": "furniture"}.get(self.appearance, "bodies")


def figure_of(
    entity: Entity | None, body: Body | None, *, simulated: bool, surface: Surface | None = None
) -> Figure | None:
    """Return the figure of an entity and its body; `simulated`: a simulator runs."""
    if entity is None and body is None:
        return None
    joints = () if body is None or surface is None else joint_positions_of(body.joints)
    if entity is None:
        if body is None:
            raise errors.InternalError("a figure needs an entity or a body")
        return Figure(body.name, body.class_ or "", body.size_m, _appearance_of(body), surface, joints)
    if entity.place:
        label = entity.preferred_reference or entity.name
        size_m = entity.size_m or UNKNOWN_SIZE_M
        return Figure(label, entity.class_, size_m, "place", extent=extent_of(entity))
    if body is not None:
        ghost: Appearance = "ghost" if body.ghost else "solid"
        return Figure(entity.name, entity.class_, body.size_m, ghost, surface, joints)
    appearance: Appearance = "believed" if simulated else "solid"
    return Figure(entity.name, entity.class_, entity.size_m or UNKNOWN_SIZE_M, appearance)


def _appearance_of(body: Body) -> Appearance:
    if not body.entity:
        return "furniture"
    return "ghost" if body.ghost else "solid"


def pose_of(entity: Entity | None, body: Body | None) -> Pose | None:
    """Return the pose: that of the body, else that of the entity."""
    if body is not None:
        return body.pose
    return entity.pose if entity is not None else None


def is_still(before: Pose, now: Pose) -> bool:
    """Return whether a motion is too small to be recorded."""
    return distance_m(before, now) < STILL_M and angle_rad(before, now) < STILL_RAD
