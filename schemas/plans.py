"""Floor plans and paths: places, things and walls as outlines seen from above, map frame [m]."""

from __future__ import annotations

from typing import Annotated, ClassVar

from msgspec import Meta, Struct, field

from semmap.schemas.calls import Call

Point = tuple[float, float]
Corners = tuple[Point, ...]


class Outline(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """A convex outline, counterclockwise, from height `low` up to `high` [m]."""

    corners: Corners
    low: float
    high: float


class PlannedPlace(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A place: its outer border (counterclockwise), then its holes; at height `floor`, and `height` high."""

    name: str
    label: str
    class_: str = field(name="class")
    rings: tuple[Corners, ...]
    floor: float
    height: float
    part: bool = False
    """Whether it is a part of a room, such as a corner."""
    forbidden: bool = False
    """Whether robots must not enter it."""


class PlannedThing(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A thing with the outlines of its parts. A `door` can have a state and the places that it connects."""

    name: str
    label: str
    class_: str = field(name="class")
    parts: tuple[Outline, ...]
    footprint: Corners
    door: bool = False
    open: bool | None = None
    connects: tuple[str, ...] = ()


class Plan(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The content of a floor plan. `walls` are those of the simulated world; others can be things."""

    places: tuple[PlannedPlace, ...]
    things: tuple[PlannedThing, ...]
    walls: tuple[Outline, ...] = ()
    notes: tuple[str, ...] = ()
    """Notes about what is missing in the plan."""


class WallsQuery(Call[tuple[Outline, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the obstacles in the world's own geometry, without floors and bodies."""

    VERB: ClassVar[str] = "walls"


Clearance = Annotated[float, Meta(ge=0.0, le=5.0)]
Height = Annotated[float, Meta(ge=-100.0, le=100.0)]
HeightRange = tuple[Height, Height]
"""Heights above the floor [m] between which objects are obstacles."""
HEIGHTS_M: HeightRange = (0.05, 1.5)
RADIUS_M = 0.25


class Way(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A path: its length [m], the places and doors on it in order, and its corners, map frame [m].

    `closed` are the closed doors on it, which must be opened first; `text` mentions them. `notes` are the
    assumptions.
    """

    metres: float
    places: tuple[str, ...]
    doors: tuple[str, ...]
    closed: tuple[str, ...] = ()
    points: Corners
    text: str
    notes: tuple[str, ...] = ()
