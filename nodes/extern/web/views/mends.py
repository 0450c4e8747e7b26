"""What would mend a change that was refused: other commands, each with what it does in words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final, NamedTuple

from msgspec import structs

from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.changes import value_in_words
from semmap.schemas.commands import Add, Batch, Command, Remove, Set, Unset, Update
from semmap.schemas.entities import ClassInfo, Entity, Value, free_name, name_stem
from semmap.schemas.explanations import Explanation

_FORCE: Final = "add --force"
_MOST: Final = 6


class Mend(NamedTuple):
    """One way out: commands to send one after the other, and what they come to."""

    text: str
    commands: tuple[Command[Any], ...]
    is_grave: bool = False
    """It takes out or overrides what somebody said, so it is asked about first."""


def mends(
    command: Command[Any],
    error: errors.SemmapError,
    entities: Mapping[str, Entity],
    classes: Iterable[ClassInfo] = (),
) -> tuple[Mend, ...]:
    """The ways out of a refusal, the mildest first; none where there is no command that would help."""
    found = [*_by_kind(command, error, entities, classes), *_by_explanation(command, error, entities)]
    return tuple(found[:_MOST])


def _by_kind(
    command: Command[Any],
    error: errors.SemmapError,
    entities: Mapping[str, Entity],
    classes: Iterable[ClassInfo],
) -> Iterator[Mend]:
    if isinstance(error, errors.Busy):
        yield Mend("try again", (command,))
    if isinstance(error, errors.NameTaken) and isinstance(command, Add):
        name = free_name(_stem(command), entities)
        yield Mend(f"call it {name}", (structs.replace(command, name=name),))
    if isinstance(error, errors.UnknownClass) and isinstance(command, (Add, Update)) and command.class_:
        for name in errors.nearest(command.class_, [c.name for c in classes if c.spatial]):
            yield Mend(f"make it a {name}", (structs.replace(command, class_=name),))
    if isinstance(command, Update) and _FORCE in error.text:
        yield Mend("do it nevertheless", (structs.replace(command, force=True),), is_grave=True)


def _by_explanation(
    command: Command[Any], error: errors.SemmapError, entities: Mapping[str, Entity]
) -> Iterator[Mend]:
    """What the refusal rests on and somebody said before may be taken back, and the change be tried again."""
    if error.explanation is None:
        return
    for name, property_, value in _said_before(error.explanation, command, entities):
        spoken = value_in_words(value)
        yield Mend(
            f"take back that {name} {property_} {spoken}, and try again",
            (Unset(name=name, property=property_, value=value), command),
            is_grave=True,
        )
    for name in _by_their_class(error.explanation, command, entities):
        yield Mend(
            f"remove {name} (a {entities[name].class_}), and try again",
            (Remove(names=(name,)), command),
            is_grave=True,
        )


def _said_before(
    explanation: Explanation, command: Command[Any], entities: Mapping[str, Entity]
) -> Iterator[tuple[str, str, Value]]:
    """The asserted properties that a contradiction rests on, but not what the command itself would say."""
    for subject, predicate, object_ in explanation.support:
        entity = entities.get(v.entity_name(subject))
        if entity is None or v.iri(entity.iri) != subject:
            continue
        property_ = v.local_name(predicate)
        stated = entity.properties.get(property_)
        if stated is None:
            continue
        for value in stated if isinstance(stated, tuple) else (stated,):
            if _is(value, object_):
                yield entity.name, property_, value


def _by_their_class(
    explanation: Explanation, command: Command[Any], entities: Mapping[str, Entity]
) -> Iterator[str]:
    """Other things whose class is a reason: not what the command is about, nor places."""
    parts = command.changes if isinstance(command, Batch) else (command,)
    about = {*(getattr(part, "name", None) for part in parts), *getattr(command, "names", ())}
    values = {str(value) for part in parts if isinstance(part, Set) for value in part.values}
    for subject, predicate, _ in explanation.support:
        name = v.entity_name(subject)
        if predicate != v.RDF_TYPE or name in about or name in values or name not in entities:
            continue
        if not entities[name].place and v.iri(entities[name].iri) == subject:
            yield name


def _is(value: Value, term: str) -> bool:
    """Whether a stated value is this term."""
    if not term.startswith('"'):
        return v.entity_name(term) == str(value) or v.local_name(term) == str(value)
    text = v.lexical(term)
    if isinstance(value, bool):
        return text in (("true", "1") if value else ("false", "0"))
    if isinstance(value, (int, float)):
        try:
            return float(text) == float(value)
        except ValueError:
            return False
    return text == str(value).rpartition("@")[0] or text == str(value)


def _stem(command: Add) -> str:
    """What a name of the same kind begins with: that of the taken name without its number."""
    stem = (command.name or "").rstrip("0123456789")
    return stem or name_stem(command.class_)
