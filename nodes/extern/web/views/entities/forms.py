"""Commands from the contents of forms. Invalid contents raise BadRequest with a message for the user."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Final

from msgspec import Struct

from semmap.nodes.extern.phrasing import english
from semmap.nodes.extern.web.views.entities.states import State
from semmap.schemas import errors
from semmap.schemas.changes import value_in_words
from semmap.schemas.commands import Add, Batch, Set, Unset, Update
from semmap.schemas.entities import NAME_PATTERN, ClassInfo, Entity, Size, Stated, Value, Vector

Numbers = Sequence[float | None]
StateInput = str | float | bool | Sequence[str] | None
"""The value that a user enters for a state; None or an empty text unsets it."""
_NAME: Final = re.compile(NAME_PATTERN)


class EntityForm(Struct, frozen=True, kw_only=True):
    """The form of one entity, in metres and degrees. None and "" are empty fields."""

    class_: str = ""
    name: str = ""
    at: tuple[float | None, ...] = (None, None, None)
    yaw_deg: float | None = None
    size: tuple[float | None, ...] = (None, None, None)
    ref: str = ""
    alt: str = ""
    """Aliases, one per line."""


def build_add(filled: EntityForm) -> Add:
    """Return the command that adds the entity.

    Without a position it is placed at a free one, and without a label it has that of its class.
    """
    if not filled.class_.strip():
        raise errors.BadRequest("class is required; choose a class, or type its label")
    name = filled.name.strip()
    if name and not _NAME.match(name):
        raise errors.BadRequest(
            f"invalid name '{name}'; use up to 128 letters, digits, '_', '.' and '-', beginning with a letter"
            " or '_'"
        )
    at = _vector(filled.at, "the position")
    return Add(
        class_=filled.class_.strip(),
        name=name or None,
        at=at,
        yaw=_radians(filled.yaw_deg),
        size=_size(filled.size),
        ref=filled.ref.strip() or None,
        alt=_split_aliases(filled.alt),
        default=at is None,
    )


def form_of(entity: Entity) -> EntityForm:
    """Return the form with the current values of an entity, rounded as they are shown."""
    pose, size = entity.pose, entity.size_m
    return EntityForm(
        class_=entity.class_,
        name=entity.name,
        at=(None, None, None) if pose is None else tuple(round(x, 3) + 0.0 for x in pose.position_m),
        yaw_deg=None if pose is None else round(math.degrees(pose.yaw_rad), 1) + 0.0,
        size=(None, None, None) if size is None else tuple(round(x, 4) for x in size),
        ref=entity.preferred_reference or "",
        alt="\n".join(entity.alternative_references),
    )


def build_update(entity: Entity, filled: EntityForm, before: EntityForm | None = None) -> Update | None:
    """Return the command that sets the fields which differ from the form `before`; None without a difference.

    Fields that were not edited are not sent, because the entity may have been changed by others since.
    """
    if before is None:
        before = form_of(entity)
    if before == filled:
        return None
    if not filled.class_.strip():
        raise errors.BadRequest(f"{entity.name}: class is required; the current class is {entity.class_}")
    if filled.ref.strip() == "" and before.ref:
        raise errors.BadRequest(f"{entity.name}: the label cannot be removed; enter another label")
    at = _vector(filled.at, "the position") if filled.at != before.at else None
    if filled.at != before.at and at is None:
        raise errors.BadRequest(f"{entity.name}: the position cannot be removed; enter another position")
    size = _size(filled.size) if filled.size != before.size else None
    if filled.size != before.size and size is None:
        raise errors.BadRequest(f"{entity.name}: the size cannot be removed; enter another size")
    return Update(
        name=entity.name,
        class_=filled.class_.strip() if filled.class_ != before.class_ else None,
        at=at,
        yaw=_radians(filled.yaw_deg) if filled.yaw_deg != before.yaw_deg else None,
        size=size,
        ref=filled.ref.strip() if filled.ref != before.ref else None,
        alt=_split_aliases(filled.alt) if filled.alt != before.alt else None,
    )


def build_move(entities: Iterable[Entity], by: Numbers) -> Batch:
    """Return the command that moves all entities with a position, and their contents, by an offset [m]."""
    moved = tuple(0.0 if value is None else value for value in by)
    if not any(moved):
        raise errors.BadRequest("offset is required; enter metres along x, y or z")
    changes = tuple(
        Update(name=e.name, at=_sum(e.pose.position_m, moved), carry=not e.place)
        for e in entities
        if e.pose is not None
    )
    if not changes:
        raise errors.BadRequest("none of the selected entities has a position")
    return Batch(changes=changes)


def build_state_changes(state_: State, entered: StateInput, now: Mapping[str, Stated | None]) -> Batch | None:
    """Return the command that sets a state of several entities, or None if all of them have the value.

    `now` has the current value of each entity, by name.
    """
    found = (build_state_change(name, state_._replace(now=value), entered) for name, value in now.items())
    changes = tuple(change for change in found if change is not None)
    return Batch(changes=changes) if changes else None


def build_state_change(name: str, state: State, text: StateInput) -> Set | Unset | Update | None:
    """Return the command that sets a state, or unsets it if `text` is empty; None if it has that value."""
    values = _values(state, text)
    now = () if state.now is None else state.now if isinstance(state.now, tuple) else (state.now,)
    if set(values) == set(now):
        return None
    if not values:
        return Unset(name=name, property=state.name)
    removed = [value for value in now if value not in values]
    new = tuple(value for value in values if value not in now)
    if removed and state.multiple:
        if len(removed) == 1 and not new:
            return Unset(name=name, property=state.name, value=removed[0])
        assignments = tuple(f"{state.name}={value_in_words(value)}" for value in values)
        return Update(name=name, unset=(state.name,), set=assignments)
    return Set(name=name, property=state.name, values=new)


def class_choices(classes: Iterable[ClassInfo]) -> dict[str, str]:
    """Return the classes that can be added, each with its labels, by which it is found when typing."""
    found = {}
    for c in classes:
        if c.spatial:
            labels = dict.fromkeys([english(c.labels), *c.labels.values(), *c.also])
            words = ", ".join(word for word in labels if word and word != c.name)
            found[c.name] = f"{c.name} · {words}" if words else c.name
    return dict(sorted(found.items(), key=lambda item: item[0].casefold()))


def match_class(typed: str, choices: Mapping[str, str]) -> str:
    """Return the class with this name, or else the first class that has a similar label.

    Without a match `typed` is returned.
    """
    search = typed.strip().casefold()
    labels = {name: label.casefold() for name, label in choices.items()}
    tests: tuple[Callable[[str, str], bool], ...] = (
        lambda name, _: name.casefold() == search,
        lambda _, label: search in re.split(" · |, ", label),
        lambda _, label: search in label,
    )
    for fits in tests:
        if found := next((name for name, label in labels.items() if fits(name, label)), ""):
            return found
    return typed


def _values(state: State, text: StateInput) -> tuple[Value, ...]:
    if text is None or text == "":
        return ()
    if isinstance(text, bool) or state.kind == "switch":
        return (text,) if isinstance(text, bool) else (str(text),)
    if isinstance(text, (int, float)):
        if not math.isfinite(text):
            raise errors.BadRequest(f"{state.label}: the value must be a finite number")
        return (text,)
    if isinstance(text, str):
        if state.kind == "number":
            try:
                return (float(text),)
            except ValueError:
                raise errors.BadRequest(f"{state.label}: '{text}' is not a number") from None
        return (text,)
    return tuple(text)


def _vector(values: Numbers, what: str) -> Vector | None:
    given = [value for value in values if value is not None]
    if not given:
        return None
    if len(given) != 3:
        raise errors.BadRequest(f"{what} is incomplete; enter x, y and z, or leave all of them empty")
    x, y, z = given
    return (float(x), float(y), float(z))


def _size(values: Numbers) -> Size | None:
    size = _vector(values, "the size")
    if size is not None and min(size) <= 0.0:
        raise errors.BadRequest("size: all values must be greater than 0 m")
    return size


def _radians(degrees: float | None) -> float | None:
    return None if degrees is None else math.radians(degrees)


def _split_aliases(lines: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys(line.strip() for line in lines.splitlines() if line.strip()))


def _sum(position_m: Vector, by: Sequence[float]) -> Vector:
    x, y, z = (round(p + d, 6) + 0.0 for p, d in zip(position_m, by, strict=True))
    return (x, y, z)
