"""What the tools take: one Struct a tool, whose fields are named as those of the commands.

The JSON schema that a model sees is made from these types and descriptions, and so are the sentences that
tell it what is wrong.
"""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal

import msgspec
from msgspec import Meta, Struct, field

from semmap.schemas.entities import Angle, Probability, Size, Text, Value, Vector, Word
from semmap.schemas.map_history import KeptRelation
from semmap.schemas.moments import When
from semmap.schemas.relations import ViewPoint

Moment = Annotated[
    When, Meta(description="A commit number, or a time in ISO 8601 such as 2026-03-01T12:30 or 12:30.")
]
Cursor = Annotated[
    str, Meta(max_length=100, description="The `next` of the page before, to read on from there.")
]
_NAME = "The name of an entity, such as cup1; or a reference or class that only one entity has."
Named = Annotated[str, Meta(max_length=1000, description=_NAME)]


class Arguments(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """What a tool is called with."""


class Paged(Arguments, frozen=True, kw_only=True):
    """Arguments of a tool whose answer may take several pages."""

    cursor: Cursor | None = None


class Overview(Arguments, frozen=True, kw_only=True):
    """Nothing is asked for in particular."""


class Find(Paged, frozen=True, kw_only=True):
    """A description."""

    text: Annotated[Text, Meta(description="A noun phrase: the red cup on the kitchen table.")]
    viewer: (
        Annotated[str, Meta(max_length=1000, description="Who sees what is left, right or behind.")] | None
    ) = None
    viewpoint: Annotated[ViewPoint, Meta(description="The same: x, y, z [m], yaw [rad].")] | None = None
    asker: Annotated[str, Meta(max_length=1000, description="Who says 'my'.")] | None = None


class Get(Paged, frozen=True, kw_only=True):
    """One entity."""

    name: Named
    as_of: Moment | None = None


class Relations(Paged, frozen=True, kw_only=True):
    """Where an entity is relative to others."""

    name: Named
    other: Annotated[str, Meta(max_length=1000, description="Only relations to this entity.")] | None = None
    viewer: (
        Annotated[str, Meta(max_length=1000, description="Adds left, right, front, behind as this one sees.")]
        | None
    ) = None
    viewpoint: (
        Annotated[ViewPoint, Meta(description="The same from a pose: x, y, z [m], yaw [rad].")] | None
    ) = None
    as_of: Moment | None = None


class List(Paged, frozen=True, kw_only=True):
    """Which entities."""

    class_: (
        Annotated[str, Meta(max_length=200, description="Only this class with its subclasses, e.g. Cup.")]
        | None
    ) = field(name="class", default=None)
    on: Annotated[Text, Meta(description="Only what stands on this entity.")] | None = None
    in_: Annotated[Text, Meta(description="Only what is in this place or container.")] | None = field(
        name="in", default=None
    )
    near: Annotated[Text, Meta(description="Only what is near this entity.")] | None = None
    within: Annotated[float, Meta(gt=0.0, le=20_000.0, description="With near: metres.")] | None = None
    nearest: Annotated[int, Meta(ge=1, le=10_000, description="With to: only so many.")] | None = None
    to: Annotated[Text, Meta(description="With nearest: to this entity.")] | None = None
    as_of: Moment | None = None


class Query(Paged, frozen=True, kw_only=True):
    """A SPARQL query."""

    query: Annotated[
        str, Meta(min_length=1, max_length=20_000, description="SELECT, ASK, CONSTRUCT or DESCRIBE.")
    ]
    inferred: Annotated[bool, Meta(description="Ask also what follows, and where things are measured.")] = (
        True
    )
    as_of: Moment | None = None


class Explain(Paged, frozen=True, kw_only=True):
    """Which statement is to be explained."""

    name: Named
    predicate: Annotated[Word, Meta(description="A property such as isLocatedIn, or type for a class.")]
    value: Annotated[str, Meta(max_length=1000, description="An entity, a class or a literal.")]
    negated: Annotated[bool, Meta(description="Explain why it cannot be so.")] = False


class History(Paged, frozen=True, kw_only=True):
    """Which commits."""

    name: (
        Annotated[str, Meta(max_length=1000, description="Only commits that touched this entity.")] | None
    ) = None
    since: Moment | None = None
    until: Moment | None = None
    limit: Annotated[int, Meta(ge=1, le=1000, description="The newest so many.")] = 20


class Diff(Paged, frozen=True, kw_only=True):
    """Between which two moments."""

    since: Moment
    until: Moment | None = None


class WasWhen(Paged, frozen=True, kw_only=True):
    """Which relation of which two entities."""

    name: Named
    relation: KeptRelation
    other: Named


class Picture(Arguments, frozen=True, kw_only=True):
    """Of what, and how large."""

    place: Annotated[str, Meta(max_length=1000, description="Only this place, by name.")] | None = None
    width: Annotated[int, Meta(ge=64, le=1600, description="Pixels.")] = 960
    height: Annotated[int, Meta(ge=64, le=1200, description="Pixels.")] = 720


class Propose(Arguments, frozen=True, kw_only=True):
    """A change to try out; which fields apply depends on the verb."""

    verb: Literal["add", "update", "set", "unset", "remove"]
    reason: Annotated[str, Meta(min_length=1, max_length=300, description="Why, in one sentence.")]
    name: (
        Annotated[str, Meta(max_length=1000, description="Of add: optional. Else: which entity.")] | None
    ) = None
    names: Annotated[tuple[Word, ...], Meta(description="Of remove: which entities.")] | None = None
    class_: Annotated[str, Meta(max_length=200, description="Of add; of update: the new class.")] | None = (
        field(name="class", default=None)
    )
    at: Annotated[Vector, Meta(description="Bottom centre x, y, z [m], map frame, z up.")] | None = None
    yaw: Annotated[Angle, Meta(description="Rotation about z [rad].")] | None = None
    size: Annotated[Size, Meta(description="Extent along its own x, y, z [m].")] | None = None
    ref: Annotated[Text, Meta(description="What it is called.")] | None = None
    alt: Annotated[tuple[Text, ...], Meta(description="What else it is called.")] | None = None
    carry: Annotated[bool, Meta(description="Of update with at: what stands on it moves along.")] | None = (
        None
    )
    property_: Annotated[Text, Meta(description="Of set and unset, e.g. isOpen.")] | None = field(
        name="property", default=None
    )
    values: Annotated[tuple[Value, ...], Meta(description="Of set.")] | None = None
    value: Annotated[Value, Meta(description="Of unset; all values without it.")] | None = None
    confidence: Probability | None = None


class Commit(Arguments, frozen=True, kw_only=True):
    """Which proposal."""

    token: Annotated[str, Meta(min_length=1, max_length=100, description="The token that propose gave.")]


class Undo(Arguments, frozen=True, kw_only=True):
    """Which commit."""

    commit: Annotated[int, Meta(ge=1, le=1 << 53, description="A commit of your own.")]
    reason: Annotated[str, Meta(max_length=300)] = ""


def schema(kind: type[Arguments]) -> dict[str, Any]:
    """The JSON schema of a tool's arguments: one object, without references and without our docstrings.

    Whoever may leave a field out need not be told that it could be null, too.
    """
    _, parts = msgspec.json.schema_components([kind])
    found = parts[kind.__name__]
    properties = {name: _given(field) for name, field in found["properties"].items()}
    return {"type": "object", "properties": properties, **{key: found[key] for key in _KEPT}}


_KEPT: Final = ("required", "additionalProperties")


def _given(field: dict[str, Any]) -> dict[str, Any]:
    """The schema of a field that is given."""
    choices = [choice for choice in field.get("anyOf", ()) if choice != {"type": "null"}]
    if len(choices) != 1 or "default" not in field:
        return field
    given: dict[str, Any] = choices[0]
    return given
