"""Spatial relations with their measurements."""

from __future__ import annotations

import re
from typing import Annotated, Final, Literal, NamedTuple

from msgspec import Meta, Struct, field

from semmap.schemas.entities import REACH_M, Entity, Metres, Text, Vector
from semmap.schemas.errors import BadRequest

RelationName = Literal[
    "isOn", "isInside", "isLocatedIn", "isAttachedTo", "touches", "isLeaningAgainst", "isUnder", "isAbove",
    "isNextTo", "isNear", "isLeftOf", "isRightOf", "isInFrontOf", "isBehind", "isBetween", "isVisibleFrom"
]  # fmt: skip

Placing = Literal["on", "in", "next_to"]
"""How an object is placed relative to another one, without a position."""


class RelationRow(NamedTuple):
    """The name of a relation, where its facts come from, and its words."""

    name: RelationName
    phrase: str
    """As in "cup1 is on table1"."""
    kind: Literal["stored", "on demand", "side", "on request"]
    """Stored facts have a rule in the knowledge base, facts on demand a measure. Sides need a viewer."""
    inverse: RelationName | None = None
    """The relation with exchanged arguments, if it is in this table. A symmetric one is its own inverse."""
    english: tuple[str, ...] = ()
    """The words in descriptions: "the cup on the table". The first are used in replies."""
    italian: tuple[str, ...] = ()
    """The same in Italian. Contractions with articles ("accanto al") follow from the last word."""


RELATIONS: Final[tuple[RelationRow, ...]] = (
    RelationRow(
        "isOn", "is on", "stored",
        english=("on", "on top of", "atop", "upon", "on the top of", "onto", "resting on", "lying on",
                 "standing on", "sitting on", "attached to", "mounted on", "hanging on", "hanging from"),
        italian=("su", "sopra a", "in cima a", "appeso a", "appesa a", "attaccato a"),
    ),
    RelationRow(
        "isInside", "is inside", "stored",
        english=("in", "inside", "into", "within", "inside of", "contained in", "in the inside of"),
        italian=("in", "dentro", "dentro a", "all'interno di", "a"),
    ),
    RelationRow("isLocatedIn", "is in", "stored"),
    RelationRow("isAttachedTo", "is attached to", "stored"),
    RelationRow(
        "touches", "touches", "on demand", "touches",
        english=("touching", "against", "in contact with"),
        italian=("contro", "a contatto con"),
    ),
    RelationRow(
        "isLeaningAgainst", "is leaning against", "on demand",
        english=("leaning against", "leaning on", "leant against", "leaned against", "leans against",
                 "lean against", "propped against", "propped up against", "resting against"),
        italian=("appoggiato a", "appoggiata a", "appoggiati a", "appoggiate a", "appoggiato contro",
                 "appoggiata contro", "appoggiati contro", "appoggiate contro"),
    ),
    RelationRow(
        "isUnder", "is under", "on demand", "isAbove",
        english=("under", "below", "beneath", "underneath"),
        italian=("sotto", "sotto a", "al di sotto di"),
    ),
    RelationRow(
        "isAbove", "is above", "on demand", "isUnder",
        english=("above", "over"),
        italian=("sopra", "sopra al", "sopra alla", "al di sopra di"),
    ),
    RelationRow(
        "isNextTo", "is next to", "on demand", "isNextTo",
        english=("next to", "beside", "by", "alongside", "adjacent to", "by the side of", "at the side of"),
        italian=("accanto", "accanto a", "di fianco a", "a fianco di", "affianco a", "a lato di"),
    ),
    RelationRow(
        "isNear", "is near", "on demand", "isNear",
        english=("near", "close to", "near to", "around", "not far from", "in the vicinity of", "nearby"),
        italian=("vicino", "vicina", "vicini", "vicine", "vicino a", "vicina a", "vicini a", "vicine a",
                 "presso", "intorno a", "nei pressi di"),
    ),
    RelationRow(
        "isLeftOf", "is left of", "side",
        english=("left of", "to the left of", "on the left of", "on the left side of",
                 "on the left hand side of", "to the left side of"),
        italian=("a sinistra di", "alla sinistra di", "sulla sinistra di"),
    ),
    RelationRow(
        "isRightOf", "is right of", "side",
        english=("right of", "to the right of", "on the right of", "on the right side of",
                 "on the right hand side of", "to the right side of"),
        italian=("a destra di", "alla destra di", "sulla destra di"),
    ),
    RelationRow(
        "isInFrontOf", "is in front of", "side",
        english=("in front of", "before", "ahead of"),
        italian=("davanti", "davanti a", "di fronte a"),
    ),
    RelationRow(
        "isBehind", "is behind", "side",
        english=("behind", "in back of", "at the back of"),
        italian=("dietro", "dietro a", "dietro il", "dietro la", "dietro di"),
    ),
    RelationRow(
        "isBetween", "is between", "on request",
        english=("between", "in between", "connecting", "connects", "connect"),
        italian=("tra", "fra", "in mezzo a"),
    ),
    RelationRow("isVisibleFrom", "is visible from", "on request"),
)  # fmt: skip
"""The table of relations, in the order in which those of a pair are reported."""

PHRASES: Final[dict[RelationName, str]] = {row.name: row.phrase for row in RELATIONS}
SIDES: Final[tuple[RelationName, ...]] = tuple(row.name for row in RELATIONS if row.kind == "side")
"""The relations that name a side of another object."""
FACTS: Final[frozenset[RelationName]] = frozenset(
    row.name for row in RELATIONS if row.kind in ("stored", "on demand")
)
"""The relations that are facts of the map: they depend neither on a viewer nor on a third entity."""

ViewPoint = tuple[Metres, Metres, Metres, Annotated[float, Meta(ge=-1e6, le=1e6)]]
"""Position and direction of a viewer: x, y, z [m] and yaw [rad], map frame."""


_NUMBER: Final = r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*"
_POSITION: Final = re.compile(",".join([_NUMBER] * 3))


def placing_words(placing: Placing) -> str:
    """Return how a sentence says it: `next to`."""
    return placing.replace("_", " ")


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
    referred_by: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """What refers to an individual that is not in space: names by property. Empty for other entities."""
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
