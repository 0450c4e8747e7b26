"""Changes of an entity between two states, as data and as text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Final, Literal

from msgspec import Struct, field

from semmap.schemas.entities import Entity, Pose, Stated, Value, angle_rad, distance_m

UNCHANGED: Final = "as they were"
_STILL_M = 5e-4
_SLIGHT_RAD = 0.0175
Kind = Literal[
    "added",
    "removed",
    "name",
    "pose",
    "size",
    "class",
    "reference",
    "alternatives",
    "conflict",
    "tracking",
    "property",
]


class Change(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One change of the entity `name`; a value is None if it did not exist before or afterwards.

    For `added` and `removed`, the value is the entity's class. For `name`, a renamed entity, `was` is its
    earlier name. For `property`, the field `property` is its name. Positions and sizes are in metres.
    """

    name: str
    kind: Kind
    property_: str = field(name="property", default="")
    was: Pose | Stated | None = None
    now: Pose | Stated | None = None

    @property
    def text(self) -> str:
        """The change without the entity's name: `moved from (8, 2.3, 0.76) to (9, 2.3, 0.76)`."""
        return _WORDS[self.kind](self)


def between(was: Entity | None, now: Entity) -> list[Change]:
    """Return all changes between two states of an entity, or that it was added."""
    name = now.name
    if was is None:
        return [Change(name=name, kind="added", now=now.class_)]
    compared: tuple[tuple[Kind, Pose | Stated | None, Pose | Stated | None], ...] = (
        ("name", was.name, now.name),
        ("class", was.class_, now.class_),
        ("pose", was.pose, now.pose),
        ("size", was.size_m, now.size_m),
        ("reference", was.preferred_reference, now.preferred_reference),
        ("alternatives", was.alternative_references, now.alternative_references),
        ("conflict", was.conflict or None, now.conflict or None),
        ("tracking", was.tracked or None, now.tracked or None),
    )
    found = [Change(name=name, kind=kind, was=w, now=n) for kind, w, n in compared if w != n]
    if was.properties != now.properties:
        names = sorted(was.properties.keys() | now.properties.keys())
        found += of_properties(name, ((p, was.properties.get(p), now.properties.get(p)) for p in names))
    return found


def of_properties(name: str, stated: Iterable[tuple[str, Stated | None, Stated | None]]) -> Iterator[Change]:
    """Yield the changes of properties, given their previous and new values."""
    return (
        Change(name=name, kind="property", property_=p, was=was, now=now)
        for p, was, now in stated
        if was != now
    )


def earlier_names(changes: Iterable[Change]) -> set[str]:
    """Return the names that renamed entities had before."""
    return {str(change.was) for change in changes if change.kind == "name"}


def removed(name: str, class_name: str) -> Change:
    """Return the change for the removal of an entity."""
    return Change(name=name, kind="removed", was=class_name)


def count_kinds(described: Iterable[tuple[Entity | None, Entity | None]]) -> dict[str, int]:
    """Return the number of entities by what has changed between two states: `new`, `moved and resized`, ...

    The second state is None for an entity that has not changed.
    """
    counts: dict[str, int] = {}
    for was, now in described:
        word = UNCHANGED
        if now is not None:
            kinds = {change.kind for change in between(was, now)}
            words = dict.fromkeys(word for kind, word in _PARTICIPLES.items() if kind in kinds)
            word = " and ".join(words) or "changed"
        counts[word] = counts.get(word, 0) + 1
    return counts


def counts_in_words(counts: Mapping[str, int]) -> str:
    """Return the counts of `count_kinds` as text: `2 new, 1 moved, 3 as they were`."""
    ordered = sorted(counts.items(), key=lambda item: (item[0] == UNCHANGED, item[0] != "new", -item[1]))
    return ", ".join(
        f"{count} {'as it was' if word == UNCHANGED and count == 1 else word}" for word, count in ordered
    )


def in_words(changes: Iterable[Change]) -> str:
    """Return the changes of one entity in one line."""
    return "; ".join(change.text for change in changes)


def _pose(change: Change) -> str:
    was, now = change.was, change.now
    if not isinstance(now, Pose):
        return "no longer has a position"
    if not isinstance(was, Pose):
        return f"placed at {_position(now)}"
    moved = f"moved from {_position(was)} to {_position(now)}" if distance_m(was, now) > _STILL_M else ""
    if was.orientation_wxyz == now.orientation_wxyz:
        return moved or f"moved by less than a millimetre, at {_position(now)}"
    turned = f"turned from {_degrees(was)} to {_degrees(now)}"
    if _degrees(was) == _degrees(now):
        is_slight = angle_rad(was, now) < _SLIGHT_RAD
        turned = "" if moved else "turned by less than a degree" if is_slight else "tilted"
    return " and ".join(filter(None, (moved, turned)))


def _position(pose: Pose) -> str:
    return "({:g}, {:g}, {:g})".format(*(round(value, 3) + 0.0 for value in pose.position_m))


def _degrees(pose: Pose) -> str:
    return f"{round(pose.yaw_rad * 57.29577951308232) + 0}°"


def _size(change: Change) -> str:
    return f"size: {_extent(change.was)} → {_extent(change.now)}"


def _extent(size: Pose | Stated | None) -> str:
    return " x ".join(f"{value:g}" for value in size) if isinstance(size, tuple) else "unknown"


def _reference(change: Change) -> str:
    if change.was is None:
        return f"label added: '{change.now}'"
    return f"label: '{change.was}' → '{change.now}'" if change.now else f"label removed: '{change.was}'"


def _alternatives(change: Change) -> str:
    came, gone = _differences(change)
    return (
        "; ".join(
            filter(
                None,
                (
                    f"alias added: {_quoted(came)}" if came else "",
                    f"alias removed: {_quoted(gone)}" if gone else "",
                ),
            )
        )
        or "aliases in another order"
    )


def _conflict(change: Change) -> str:
    return f"conflict: {change.now}" if change.now else "conflict resolved"


def _tracking(change: Change) -> str:
    if change.now is None:
        return "no longer tracked"
    return "tracked from the simulator" if change.now == "sim" else "tracked from a stream of poses"


def _property(change: Change) -> str:
    if not any(isinstance(value, tuple) for value in (change.was, change.now)):
        was, now = _shown(_values(change.was)), _shown(_values(change.now))
        if was == now == _NAMELESS:
            return f"{change.property_}: other content"
        return f"{change.property_}: {was or 'not set'} → {now or 'not set'}"
    came, gone = _differences(change)
    signed = [f"+ {_shown(came)}"] * bool(came) + [f"- {_shown(gone)}"] * bool(gone)
    return f"{change.property_}: {', '.join(signed)}"


def _differences(change: Change) -> tuple[list[Value], list[Value]]:
    """Return the added and the removed values."""
    was, now = _values(change.was), _values(change.now)
    return [value for value in now if value not in was], [value for value in was if value not in now]


def _values(stated: Pose | Stated | None) -> tuple[Value, ...]:
    if stated is None or isinstance(stated, Pose):
        return ()
    return stated if isinstance(stated, tuple) else (stated,)


def stated_in_words(stated: Stated) -> str:
    """Return a property's value as text: "true", "color_blue, color_red"."""
    return _shown(_values(stated))


def _shown(values: Iterable[Value]) -> str:
    """Return values as text, without the labels of blank nodes."""
    return ", ".join(
        _NAMELESS if isinstance(value, str) and value.startswith("_:") else value_in_words(value)
        for value in values
    )


def value_in_words(value: Value) -> str:
    """Return a value as text; an empty text is in quotation marks."""
    return str(value).lower() if isinstance(value, bool) else str(value) or "''"


def _quoted(values: Iterable[Value]) -> str:
    return ", ".join(f"'{value}'" for value in values)


_NAMELESS = "a nameless value"
_WORDS = {
    "added": lambda c: f"added as {c.now}",
    "removed": lambda c: "removed",
    "name": lambda c: f"renamed from {c.was}",
    "pose": _pose,
    "size": _size,
    "class": lambda c: f"class {c.was} → {c.now}",
    "reference": _reference,
    "alternatives": _alternatives,
    "conflict": _conflict,
    "tracking": _tracking,
    "property": _property,
}
_PARTICIPLES: Final[Mapping[Kind, str]] = {
    "added": "new",
    "pose": "moved",
    "size": "resized",
    "class": "reclassified",
    "reference": "relabelled",
    "alternatives": "relabelled",
}
"""Words for the kinds of changes that are counted; an entity with other changes is `changed`."""
