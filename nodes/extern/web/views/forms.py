"""What is filled in, as commands. Raises BadRequest, with a sentence for whoever filled it in."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Final

from msgspec import Struct

from semmap.nodes.extern.phrasing import english
from semmap.nodes.extern.web.views.states import State
from semmap.schemas import errors
from semmap.schemas.changes import value_in_words
from semmap.schemas.commands import Add, Batch, Set, Unset, Update
from semmap.schemas.entities import NAME_PATTERN, ClassInfo, Entity, Size, Stated, Value, Vector

Numbers = Sequence[float | None]
Entered = str | float | bool | Sequence[str] | None
"""What a person enters for a state; None or an empty text is to unset it."""
_NAME: Final = re.compile(NAME_PATTERN)


class Filled(Struct, frozen=True, kw_only=True):
    """A form about one entity: metres, degrees; None and "" are what was left empty."""

    class_: str = ""
    name: str = ""
    at: tuple[float | None, ...] = (None, None, None)
    yaw_deg: float | None = None
    size: tuple[float | None, ...] = (None, None, None)
    ref: str = ""
    alt: str = ""
    """Alternative references, a line each."""


def add(filled: Filled) -> Add:
    """A new entity; without a place it goes to the next free one, without a reference it has its class's."""
    if not filled.class_.strip():
        raise errors.BadRequest("say what it is: choose a class, or type what people call such a thing")
    name = filled.name.strip()
    if name and not _NAME.match(name):
        raise errors.BadRequest(
            f"'{name}' is no name; a name has up to 128 letters, digits, '_', '.' and '-', and begins with a"
            " letter or '_'"
        )
    at = _vector(filled.at, "the position")
    return Add(
        class_=filled.class_.strip(),
        name=name or None,
        at=at,
        yaw=_radians(filled.yaw_deg),
        size=_size(filled.size),
        ref=filled.ref.strip() or None,
        alt=_references(filled.alt),
        default=at is None,
    )


def filled_from(entity: Entity) -> Filled:
    """The form with what an entity is now, to the digits that are shown."""
    pose, size = entity.pose, entity.size_m
    return Filled(
        class_=entity.class_,
        name=entity.name,
        at=(None, None, None) if pose is None else tuple(round(x, 3) + 0.0 for x in pose.position_m),
        yaw_deg=None if pose is None else round(math.degrees(pose.yaw_rad), 1) + 0.0,
        size=(None, None, None) if size is None else tuple(round(x, 4) for x in size),
        ref=entity.preferred_reference or "",
        alt="\n".join(entity.alternative_references),
    )


def edit(entity: Entity, filled: Filled, before: Filled | None = None) -> Update | None:
    """What was changed in the form since it was as `before`, and nothing else; None where nothing was.

    The entity may have changed meanwhile: what nobody touched in the form stays as it is now.
    """
    if before is None:
        before = filled_from(entity)
    if before == filled:
        return None
    if not filled.class_.strip():
        raise errors.BadRequest(f"{entity.name} needs a class; it is a {entity.class_} now")
    if filled.ref.strip() == "" and before.ref:
        raise errors.BadRequest("a thing that has a reference keeps one; write another in its place")
    at = _vector(filled.at, "the position") if filled.at != before.at else None
    if filled.at != before.at and at is None:
        raise errors.BadRequest(f"{entity.name} has a position; write another in its place")
    size = _size(filled.size) if filled.size != before.size else None
    if filled.size != before.size and size is None:
        raise errors.BadRequest(f"{entity.name} has a size; write another in its place")
    return Update(
        name=entity.name,
        class_=filled.class_.strip() if filled.class_ != before.class_ else None,
        at=at,
        yaw=_radians(filled.yaw_deg) if filled.yaw_deg != before.yaw_deg else None,
        size=size,
        ref=filled.ref.strip() if filled.ref != before.ref else None,
        alt=_references(filled.alt) if filled.alt != before.alt else None,
    )


def offset(entities: Iterable[Entity], by: Numbers) -> Batch:
    """All of them moved by the same [m], with what is on them; those without a position stay as they are."""
    moved = tuple(0.0 if value is None else value for value in by)
    if not any(moved):
        raise errors.BadRequest("say how far: metres along x, y or z")
    changes = tuple(
        Update(name=e.name, at=_sum(e.pose.position_m, moved), carry=not e.place)
        for e in entities
        if e.pose is not None
    )
    if not changes:
        raise errors.BadRequest("none of them has a position to be moved from")
    return Batch(changes=changes)


def states(state_: State, entered: Entered, now: Mapping[str, Stated | None]) -> Batch | None:
    """What is entered for a state of several; `now` is by name how it is. None if it is so of all."""
    changes = (state(name, state_._replace(now=value), entered) for name, value in now.items())
    wanted = tuple(change for change in changes if change is not None)
    return Batch(changes=wanted) if wanted else None


def state(name: str, state: State, text: Entered) -> Set | Unset | Update | None:
    """What is entered for a state: to be set, or where it is empty to be unset; None if it is so already."""
    values = _values(state, text)
    now = () if state.now is None else state.now if isinstance(state.now, tuple) else (state.now,)
    if set(values) == set(now):
        return None
    if not values:
        return Unset(name=name, property=state.name)
    gone = [value for value in now if value not in values]
    new = tuple(value for value in values if value not in now)
    if gone and state.several:
        if len(gone) == 1 and not new:
            return Unset(name=name, property=state.name, value=gone[0])
        said = tuple(f"{state.name}={value_in_words(value)}" for value in values)
        return Update(name=name, unset=(state.name,), set=said)
    return Set(name=name, property=state.name, values=new)


def class_choices(classes: Iterable[ClassInfo]) -> dict[str, str]:
    """The classes that may be added, each with all that it is called: found by typing any of that."""
    found = {}
    for c in classes:
        if c.spatial:
            called = dict.fromkeys([english(c.labels), *c.labels.values(), *c.also])
            words = ", ".join(word for word in called if word and word != c.name)
            found[c.name] = f"{c.name} · {words}" if words else c.name
    return dict(sorted(found.items(), key=lambda item: item[0].casefold()))


def best_class(typed: str, choices: Mapping[str, str]) -> str:
    """The class that was meant by what was typed: its name, or the first that is called something like it.

    What no class is called is returned as it is.
    """
    wanted = typed.strip().casefold()
    called = {name: label.casefold() for name, label in choices.items()}
    tests: tuple[Callable[[str, str], bool], ...] = (
        lambda name, _: name.casefold() == wanted,
        lambda _, label: wanted in re.split(" · |, ", label),
        lambda _, label: wanted in label,
    )
    for fits in tests:
        if found := next((name for name, label in called.items() if fits(name, label)), ""):
            return found
    return typed


def _values(state: State, text: Entered) -> tuple[Value, ...]:
    if text is None or text == "":
        return ()
    if isinstance(text, bool) or state.kind == "switch":
        return (text,) if isinstance(text, bool) else (str(text),)
    if isinstance(text, (int, float)):
        if not math.isfinite(text):
            raise errors.BadRequest(f"{state.label} takes a number")
        return (text,)
    if isinstance(text, str):
        if state.kind == "number":
            try:
                return (float(text),)
            except ValueError:
                raise errors.BadRequest(f"{state.label} takes a number, not '{text}'") from None
        return (text,)
    return tuple(text)


def _vector(values: Numbers, what: str) -> Vector | None:
    given = [value for value in values if value is not None]
    if not given:
        return None
    if len(given) != 3:
        raise errors.BadRequest(f"{what} takes all of x, y and z, in metres, or none of them")
    x, y, z = given
    return (float(x), float(y), float(z))


def _size(values: Numbers) -> Size | None:
    size = _vector(values, "the size")
    if size is not None and min(size) <= 0.0:
        raise errors.BadRequest("the size takes lengths above 0, in metres")
    return size


def _radians(degrees: float | None) -> float | None:
    return None if degrees is None else math.radians(degrees)


def _references(lines: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys(line.strip() for line in lines.splitlines() if line.strip()))


def _sum(position_m: Vector, by: Sequence[float]) -> Vector:
    x, y, z = (round(p + d, 6) + 0.0 for p, d in zip(position_m, by, strict=True))
    return (x, y, z)
