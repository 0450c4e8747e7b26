"""Where things are relative to one another, with the measurement behind each relation."""

from __future__ import annotations

import re
from typing import Annotated, Final, Literal

from msgspec import Meta, Struct

from semmap.schemas.entities import REACH_M, Entity, Metres, Text, Vector
from semmap.schemas.errors import BadRequest

RelationName = Literal[
    "isOn", "isInside", "isLocatedIn", "isAttachedTo", "touches", "isUnder", "isAbove", "isNear", "isNextTo",
    "isLeftOf", "isRightOf", "isInFrontOf", "isBehind", "isBetween", "isVisibleFrom"
]  # fmt: skip

ViewPoint = tuple[Metres, Metres, Metres, Annotated[float, Meta(ge=-1e6, le=1e6)]]
"""Where a viewer stands and looks: x, y, z [m] and yaw [rad], map frame."""


_NUMBER: Final = r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*"
_POSITION: Final = re.compile(",".join([_NUMBER] * 3))


def position_in(word: str) -> Vector | None:
    """The position [m] that is written `2.5,1,0.8`; None for what names something.

    Raises BadRequest for one beyond `REACH_M`.
    """
    if (match := _POSITION.fullmatch(word)) is None:
        return None
    x, y, z = map(float, match.groups())
    if max(abs(x), abs(y), abs(z)) > REACH_M:
        raise BadRequest(f"'{word}' is too far away: coordinates go up to {REACH_M:,.0f} m")
    return x, y, z


class Relation(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """`subject` is on, in, near ... `object`, worked out from their poses, sizes and shapes.

    `gap_m` is the distance that counts for the relation [m], `share` the part of the base, volume or
    footprint that it is about (0 to 1), or of the lines of sight; of left, right, in front and behind `gap_m`
    is how far apart the centres are in that direction. `text` says both in one sentence. `holds` is
    False only where a pair was asked for, of what a viewer cannot see, and of what is on nothing.
    """

    relation: RelationName
    subject: str
    object: str
    """Of `isVisibleFrom` a pose, and where nothing bears the subject, it is ""."""
    and_object: str | None = None
    """Of `isBetween` the second of the two."""
    holds: bool = True
    gap_m: float = 0.0
    share: float = 1.0
    text: str = ""


class Described(Entity, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An entity with, if that was asked for, where it is.

    `whereabouts`: what it is inside, on and in, as measured. `denied`: what somebody said of that and is not
    so, as things stand. `withheld`: what is measured, or was said, and would contradict the map, with the
    reason, a sentence each; it is not among `whereabouts`. `on_nothing`: how high it is above what is below
    it, where nothing bears it, not even the floor; or that its size is not known.
    """

    whereabouts: tuple[Relation, ...] = ()
    denied: tuple[Relation, ...] = ()
    withheld: tuple[str, ...] = ()
    on_nothing: str = ""
    frame: str = ""

    @classmethod
    def of(
        cls,
        entity: Entity,
        whereabouts: tuple[Relation, ...] = (),
        denied: tuple[Relation, ...] = (),
        withheld: tuple[str, ...] = (),
        on_nothing: str = "",
    ) -> Described:
        """An entity with these relations."""
        fields = {name: getattr(entity, name) for name in Entity.__struct_fields__}
        return cls(**fields, whereabouts=whereabouts, denied=denied, withheld=withheld, on_nothing=on_nothing)


class Where(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Which entities by where they are; all that is given must hold. See `semmap.schemas.commands.List`.

    `near` and `to` may also be positions in the map frame (`position_in`).
    """

    on: Text | None = None
    in_: Text | None = None
    near: Text | None = None
    within: float | None = None
    nearest: int | None = None
    to: Text | None = None

    @property
    def words(self) -> tuple[str | None, str | None, str | None, str | None]:
        """What is meant by name, reference or class: on, in, near, to."""
        return self.on, self.in_, self.near, self.to
