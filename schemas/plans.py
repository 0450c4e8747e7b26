"""Floor plans and ways through them: places, things and walls as outlines seen from above, map frame [m]."""

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
    """A place: its outer border counterclockwise, then its holes; on the floor at `floor`, `height` high."""

    name: str
    label: str
    class_: str = field(name="class")
    rings: tuple[Corners, ...]
    floor: float
    height: float
    part: bool = False
    """It is a part of a room, such as a corner."""
    forbidden: bool = False
    """Robots are to stay out."""


class PlannedThing(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A thing as it stands, part by part. A `door` may say whether it is open and what it connects."""

    name: str
    label: str
    class_: str = field(name="class")
    parts: tuple[Outline, ...]
    footprint: Corners
    door: bool = False
    open: bool | None = None
    connects: tuple[str, ...] = ()


class Plan(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a plan is drawn from. `walls` are those of the simulated world; a map may have some as things."""

    places: tuple[PlannedPlace, ...]
    things: tuple[PlannedThing, ...]
    walls: tuple[Outline, ...] = ()
    notes: tuple[str, ...] = ()
    """What the plan lacks."""


class WallsQuery(Call[tuple[Outline, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What of the world itself stands in the way: its solid geometry, but for floors and for its bodies."""

    VERB: ClassVar[str] = "walls"


Clearance = Annotated[float, Meta(ge=0.0, le=5.0)]
Height = Annotated[float, Meta(ge=-100.0, le=100.0)]
HeightRange = tuple[Height, Height]
"""Above the floor [m]: what is between is in a robot's way."""
HEIGHTS_M: HeightRange = (0.05, 1.5)
RADIUS_M = 0.25


class Way(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A way: its length [m], the places and doors on it in order, and its corners, map frame [m].

    `closed` are the doors of it that are closed: with any, it is no way until they are opened, and
    `text` says so. `notes` say what was assumed.
    """

    metres: float
    places: tuple[str, ...]
    doors: tuple[str, ...]
    closed: tuple[str, ...] = ()
    points: Corners
    text: str
    notes: tuple[str, ...] = ()
