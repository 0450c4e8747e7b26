"""The arguments of the tools: one Struct per tool, with the field names of the commands.

The JSON schema of a tool, and the error texts for invalid arguments, are made from these types.
"""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal

import msgspec
from msgspec import Meta, Struct, field

from semmap.schemas.entities import Angle, Probability, Size, Text, Value, Vector, Word
from semmap.schemas.language import Language
from semmap.schemas.moments import When
from semmap.schemas.plans import RADIUS_M, Clearance, Point
from semmap.schemas.relations import ViewPoint

MOST: Final = 50
"""The maximum number of entities, aliases or values in a change; it keeps the map and its journal small."""
Moment = Annotated[
    When,
    Meta(description="A commit number, or a time: 2026-03-01T12:30, 12:30, yesterday 10:00, 5 minutes ago."),
]
Cursor = Annotated[
    str, Meta(max_length=100, description="The `next` of the previous page, to get the next page.")
]
_NAME = "Name of an entity, such as cup1; or a label or class that only one entity has."
_END = "A place, thing or person, or a position such as 2.5,1 [m]."
Named = Annotated[str, Meta(max_length=1000, description=_NAME)]


Reason = Annotated[str, Meta(min_length=1, max_length=300, description="Reason, in one sentence.")]


class Arguments(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """The arguments of a tool."""


class Paged(Arguments, frozen=True, kw_only=True):
    """The arguments of a tool whose reply may have several pages."""

    cursor: Cursor | None = None


class Overview(Arguments, frozen=True, kw_only=True):
    """No arguments."""


class Find(Paged, frozen=True, kw_only=True):
    """A noun phrase, and its speaker and viewer."""

    text: Annotated[Text, Meta(description="A noun phrase: the red cup on the kitchen table.")]
    viewer: Annotated[str, Meta(max_length=1000, description="Viewer for left, right and behind.")] | None = (
        None
    )
    viewpoint: (
        Annotated[ViewPoint, Meta(description="Pose of the viewer: x, y, z [m], yaw [rad].")] | None
    ) = None
    asker: (
        Annotated[str, Meta(max_length=1000, description="Speaker: the person that 'my' refers to.")] | None
    ) = None
    answer: (
        Annotated[Text, Meta(description="Answer to the clarification question about the text.")] | None
    ) = None
    as_of: Moment | None = None


class Understand(Paged, frozen=True, kw_only=True):
    """A command in words."""

    text: Annotated[Text, Meta(description="A command: take the red cup and bring it to Anna.")]
    language: Annotated[Language, Meta(description="Detected if not given.")] | None = None


class Get(Paged, frozen=True, kw_only=True):
    """An entity."""

    name: Named
    as_of: Moment | None = None


class Relations(Paged, frozen=True, kw_only=True):
    """An entity and, optionally, another one and a viewer."""

    name: Named
    other: Annotated[str, Meta(max_length=1000, description="Only relations to this entity.")] | None = None
    viewer: (
        Annotated[str, Meta(max_length=1000, description="Viewer: adds left, right, front and behind.")]
        | None
    ) = None
    viewpoint: (
        Annotated[ViewPoint, Meta(description="Pose of the viewer: x, y, z [m], yaw [rad].")] | None
    ) = None
    as_of: Moment | None = None


class List(Paged, frozen=True, kw_only=True):
    """A selection of entities."""

    class_: (
        Annotated[str, Meta(max_length=200, description="Only this class with its subclasses, e.g. Cup.")]
        | None
    ) = field(name="class", default=None)
    on: Annotated[Text, Meta(description="Only entities on this entity.")] | None = None
    in_: Annotated[Text, Meta(description="Only entities in this place or container.")] | None = field(
        name="in", default=None
    )
    near: Annotated[Text, Meta(description="Only entities near this entity.")] | None = None
    within: (
        Annotated[float, Meta(gt=0.0, le=20_000.0, description="With near: maximum distance [m].")] | None
    ) = None
    nearest: Annotated[int, Meta(ge=1, le=10_000, description="With to: number of entities.")] | None = None
    to: Annotated[Text, Meta(description="With nearest: reference entity.")] | None = None
    all: Annotated[bool, Meta(description="Also individuals that are not in space.")] = False
    as_of: Moment | None = None


class Query(Paged, frozen=True, kw_only=True):
    """A SPARQL query."""

    query: Annotated[
        str, Meta(min_length=1, max_length=20_000, description="SELECT, ASK, CONSTRUCT or DESCRIBE.")
    ]
    inferred: Annotated[bool, Meta(description="Include inferred and computed facts.")] = True
    as_of: Moment | None = None


class Explain(Paged, frozen=True, kw_only=True):
    """A statement."""

    name: Named
    predicate: Annotated[Word, Meta(description="A property such as isLocatedIn, or type for a class.")]
    value: Annotated[str, Meta(max_length=1000, description="An entity, a class or a literal.")]
    negated: Annotated[bool, Meta(description="Explain why the statement cannot hold.")] = False


class History(Paged, frozen=True, kw_only=True):
    """A selection of commits."""

    name: (
        Annotated[str, Meta(max_length=1000, description="Only commits that changed this entity.")] | None
    ) = None
    since: Moment | None = None
    until: Moment | None = None
    limit: Annotated[int, Meta(ge=1, le=1000, description="Number of commits; the newest are returned.")] = 20
    by: Annotated[Text, Meta(description="Only commits of this agent or source.")] | None = None
    in_: Annotated[Text, Meta(description="Only commits that changed something in this place.")] | None = (
        field(name="in", default=None)
    )
    on: Annotated[Text, Meta(description="Only commits that changed something on this object.")] | None = None


class Could(Paged, frozen=True, kw_only=True):
    """A statement."""

    name: Named
    predicate: Annotated[Word, Meta(description="A property such as isOn, or type for a class.")]
    value: Annotated[str, Meta(max_length=1000, description="An entity, a class or a literal.")]


class FindWay(Paged, frozen=True, kw_only=True):
    """The ends of a path, and the size of the robot."""

    from_: Annotated[Text, Meta(description=f"{_END} Start.")] = field(name="from")
    to: Annotated[Text, Meta(description=f"{_END} Goal.")]
    radius: Annotated[Clearance, Meta(description="Radius of the robot [m].")] = RADIUS_M
    as_of: Moment | None = None


class Diff(Paged, frozen=True, kw_only=True):
    """Two commits or times."""

    since: Moment
    until: Moment | None = None
    on: Annotated[Text, Meta(description="Only what came onto or left this object.")] | None = None
    in_: Annotated[Text, Meta(description="Only what came into or left this place.")] | None = field(
        name="in", default=None
    )


class WasWhen(Paged, frozen=True, kw_only=True):
    """A relation of two entities, or a property and its value."""

    name: Named
    relation: Annotated[
        Word,
        Meta(description="isOn, isInside, isLocatedIn, isNear, isAttachedTo; or a property, e.g. isOpen."),
    ]
    other: Annotated[Value, Meta(description="The other entity, or the value of the property.")] = True


class FindTrail(Paged, frozen=True, kw_only=True):
    """A tracked entity and a period or time."""

    name: Named
    since: Moment | None = None
    until: Moment | None = None
    at: Moment | None = None
    in_: Annotated[Text, Meta(description="Only visits of this place.")] | None = field(
        name="in", default=None
    )


class LastSeen(Arguments, frozen=True, kw_only=True):
    """An entity, present or removed."""

    name: Named


class Picture(Arguments, frozen=True, kw_only=True):
    """A place and an image size."""

    place: Annotated[str, Meta(max_length=1000, description="Only this place, by name.")] | None = None
    width: Annotated[int, Meta(ge=64, le=1600, description="Pixels.")] = 960
    height: Annotated[int, Meta(ge=64, le=1200, description="Pixels.")] = 720


class Propose(Arguments, frozen=True, kw_only=True):
    """A change; which fields apply depends on `verb`."""

    verb: Literal["add", "update", "set", "unset", "remove", "attach", "detach"]
    reason: Reason
    name: Annotated[str, Meta(max_length=1000, description="Entity; optional for add.")] | None = None
    names: Annotated[tuple[Word, ...], Meta(max_length=MOST, description="Remove: entities.")] | None = None
    class_: Annotated[str, Meta(max_length=200, description="Add: class. Update: new class.")] | None = field(
        name="class", default=None
    )
    at: Annotated[Vector, Meta(description="Bottom centre x, y, z [m], map frame, z up.")] | None = None
    on: Annotated[Word, Meta(description="Instead of at: on this object, where there is room.")] | None = None
    in_: Annotated[Word, Meta(description="Instead of at: in this object or place.")] | None = field(
        name="in", default=None
    )
    next_to: Annotated[Word, Meta(description="Instead of at: next to this object.")] | None = None
    yaw: Annotated[Angle, Meta(description="Rotation about z [rad].")] | None = None
    size: Annotated[Size, Meta(description="Size along its own x, y, z [m].")] | None = None
    ref: Annotated[Text, Meta(description="Label.")] | None = None
    alt: Annotated[tuple[Text, ...], Meta(max_length=MOST, description="Aliases.")] | None = None
    carry: Annotated[bool, Meta(description="Update of the pose, attach: with the objects on it.")] | None = (
        None
    )
    to: Annotated[Word, Meta(description="Attach: the robot, gripper or tray.")] | None = None
    property_: Annotated[Text, Meta(description="Set and unset: property, e.g. isOpen.")] | None = field(
        name="property", default=None
    )
    values: Annotated[tuple[Value, ...], Meta(max_length=MOST, description="Set: values.")] | None = None
    value: Annotated[Value, Meta(description="Unset: value; without it, all values.")] | None = None
    confidence: Probability | None = None


class Open(Arguments, frozen=True, kw_only=True):
    """An object with joints."""

    name: Named
    reason: Reason
    to: Annotated[Probability, Meta(description="Share of the range of the joints.")] = 1.0
    joint: Annotated[str, Meta(max_length=1000, description="Only this joint.")] | None = None


class Close(Arguments, frozen=True, kw_only=True):
    """An object with joints."""

    name: Named
    reason: Reason
    joint: Annotated[str, Meta(max_length=1000, description="Only this joint.")] | None = None


class Drive(Arguments, frozen=True, kw_only=True):
    """A robot and the points of its path."""

    name: Named
    reason: Reason
    to: Annotated[
        tuple[Point, ...], Meta(max_length=MOST, description="Points x, y [m], in straight lines.")
    ] = ()
    yaw: Annotated[Angle, Meta(description="Final rotation about z [rad].")] | None = None
    stop: Annotated[bool, Meta(description="Stop it where it is.")] = False
    wait: Annotated[bool, Meta(description="Return when it has arrived.")] = False


class Commit(Arguments, frozen=True, kw_only=True):
    """A proposal."""

    token: Annotated[str, Meta(min_length=1, max_length=100, description="Token that propose returned.")]


class Undo(Arguments, frozen=True, kw_only=True):
    """A commit."""

    commit: Annotated[int, Meta(ge=1, le=1 << 53, description="One of your own commits.")]
    reason: Annotated[str, Meta(max_length=300)] = ""


def schema(kind: type[Arguments]) -> dict[str, Any]:
    """Return the JSON schema of the arguments: one object, without references and docstrings.

    Optional fields are not described as nullable: they can be left out.
    """
    _, parts = msgspec.json.schema_components([kind])
    found = parts[kind.__name__]
    properties = {name: _with_items(_without_null(field)) for name, field in found["properties"].items()}
    return {"type": "object", "properties": properties, **{key: found[key] for key in _KEPT}}


_KEPT: Final = ("required", "additionalProperties")


def _without_null(field: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of a field without null."""
    choices = [choice for choice in field.get("anyOf", ()) if choice != {"type": "null"}]
    if len(choices) != 1 or "default" not in field:
        return field
    found: dict[str, Any] = choices[0]
    return found


def _with_items(schema: Any) -> Any:
    """Return a schema whose tuples have `items` beside `prefixItems`: some hosts reject them without it."""
    if isinstance(schema, list):
        return [_with_items(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    found = {key: _with_items(each) for key, each in schema.items()}
    if "prefixItems" in found:
        kinds = [each for n, each in enumerate(found["prefixItems"]) if each not in found["prefixItems"][:n]]
        found["items"] = kinds[0] if len(kinds) == 1 else {"anyOf": kinds}
    return found
