"""Spatial relations with their measurements."""

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
"""Position and direction of a viewer: x, y, z [m] and yaw [rad], map frame."""


_NUMBER: Final = r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*"
_POSITION: Final = re.compile(",".join([_NUMBER] * 3))


def position_in(word: str) -> Vector | None:
    """Return the position [m] that is written `2.5,1,0.8`, or None for any other word.

    Raises BadRequest for a coordinate beyond `REACH_M`.
    """
    if (match := _POSITION.fullmatch(word)) is None:
        return None
    x, y, z = map(float, match.groups())
    if max(abs(x), abs(y), abs(z)) > REACH_M:
        raise BadRequest(f"'{word}' is too far away: coordinates go up to {REACH_M:,.0f} m")
    return x, y, z


class Relation(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """`subject` is on, in, near ... `object`, computed from poses, sizes and shapes.

    `gap_m` is the relevant distance [m]; for left, right, in front and behind, it is the distance of the
    centres in that direction. `share` is the relevant part of the base, volume or footprint, or of the lines
    of sight (0 to 1). `text` describes both in one sentence. `holds` is False only if a pair was requested,
    for objects that a viewer cannot see, and for objects without a support.
    """

    relation: RelationName
    subject: str
    object: str
    """Empty for `isVisibleFrom` a pose, and if the subject has no support."""
    and_object: str | None = None
    """The second object of `isBetween`."""
    holds: bool = True
    gap_m: float = 0.0
    share: float = 1.0
    text: str = ""


class Described(Entity, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An entity with its spatial relations, if they were requested.

    `whereabouts`: what it is inside, on and in, as computed. `denied`: asserted relations of these kinds that
    the geometry contradicts. `withheld`: relations that are suppressed because they would contradict the map,
    with the reason. `on_nothing`: the height above what is below it if it has no support, or a note that its
    size is unknown.
    """

    whereabouts: tuple[Relation, ...] = ()
    denied: tuple[Relation, ...] = ()
    withheld: tuple[str, ...] = ()
    on_nothing: str = ""
    frame: str = ""
    shape: Literal["", "world", "model", "box"] = ""
    """Whence its shape is: its body in the world file, its model, or only its size. "" if not requested."""

    @classmethod
    def of(
        cls,
        entity: Entity,
        whereabouts: tuple[Relation, ...] = (),
        denied: tuple[Relation, ...] = (),
        withheld: tuple[str, ...] = (),
        on_nothing: str = "",
        shape: Literal["", "world", "model", "box"] = "",
    ) -> Described:
        """Return an entity with these relations."""
        fields = {name: getattr(entity, name) for name in Entity.__struct_fields__}
        return cls(
            **fields, whereabouts=whereabouts, denied=denied, withheld=withheld, on_nothing=on_nothing,
            shape=shape,
        )  # fmt: skip


class Where(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Spatial conditions that all must hold. See `semmap.schemas.commands.List`.

    `near` and `to` can also be positions in the map frame (`position_in`).
    """

    on: Text | None = None
    in_: Text | None = None
    near: Text | None = None
    within: float | None = None
    nearest: int | None = None
    to: Text | None = None

    @property
    def words(self) -> tuple[str | None, str | None, str | None, str | None]:
        """The names, labels or classes of `on`, `in`, `near` and `to`."""
        return self.on, self.in_, self.near, self.to
