"""Suggested fixes for a rejected change: commands that would make it possible."""

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


class SuggestedFix(NamedTuple):
    """One fix: commands to send one after the other, and their effect in words."""

    text: str
    commands: tuple[Command[Any], ...]
    is_destructive: bool = False
    """Whether it removes or overrides asserted facts."""


def suggest_fixes(
    command: Command[Any],
    error: errors.SemmapError,
    entities: Mapping[str, Entity],
    classes: Iterable[ClassInfo] = (),
) -> tuple[SuggestedFix, ...]:
    """Return fixes for a rejected command, the least destructive first; none if there are none."""
    found = [*_by_kind(command, error, entities, classes), *_by_explanation(command, error, entities)]
    return tuple(found[:_MOST])


def _by_kind(
    command: Command[Any],
    error: errors.SemmapError,
    entities: Mapping[str, Entity],
    classes: Iterable[ClassInfo],
) -> Iterator[SuggestedFix]:
    if isinstance(error, errors.Busy):
        yield SuggestedFix("Retry", (command,))
    if isinstance(error, errors.NameTaken) and isinstance(command, Add):
        name = free_name(_stem(command), entities)
        yield SuggestedFix(f"Use the name {name}", (structs.replace(command, name=name),))
    if isinstance(error, errors.UnknownClass) and isinstance(command, (Add, Update)) and command.class_:
        for name in errors.nearest(command.class_, [c.name for c in classes if c.spatial]):
            yield SuggestedFix(f"Use the class {name}", (structs.replace(command, class_=name),))
    if isinstance(command, Update) and _FORCE in error.text:
        yield SuggestedFix("Force the change", (structs.replace(command, force=True),), is_destructive=True)


def _by_explanation(
    command: Command[Any], error: errors.SemmapError, entities: Mapping[str, Entity]
) -> Iterator[SuggestedFix]:
    """Yield fixes that remove an asserted premise of the contradiction and retry the change."""
    if error.explanation is None:
        return
    for name, property_, value in _asserted_premises(error.explanation, entities):
        yield SuggestedFix(
            f"Unset {name} {property_} {value_in_words(value)} and retry",
            (Unset(name=name, property=property_, value=value), command),
            is_destructive=True,
        )
    for name in _removable_entities(error.explanation, command, entities):
        yield SuggestedFix(
            f"Remove {name} (a {entities[name].class_}) and retry",
            (Remove(names=(name,)), command),
            is_destructive=True,
        )


def _asserted_premises(
    explanation: Explanation, entities: Mapping[str, Entity]
) -> Iterator[tuple[str, str, Value]]:
    """Yield the premises that are asserted in the map, as name, property and value."""
    for subject, predicate, object_ in explanation.support:
        entity = entities.get(v.entity_name(subject))
        if entity is None or v.iri(entity.iri) != subject:
            continue
        property_ = v.local_name(predicate)
        stated = entity.properties.get(property_)
        if stated is None:
            continue
        for value in stated if isinstance(stated, tuple) else (stated,):
            if _is_term(value, object_):
                yield entity.name, property_, value


def _removable_entities(
    explanation: Explanation, command: Command[Any], entities: Mapping[str, Entity]
) -> Iterator[str]:
    """Yield the entities whose class is a premise, without places and those in the command."""
    parts = command.changes if isinstance(command, Batch) else (command,)
    about = {*(getattr(part, "name", None) for part in parts), *getattr(command, "names", ())}
    values = {str(value) for part in parts if isinstance(part, Set) for value in part.values}
    for subject, predicate, _ in explanation.support:
        name = v.entity_name(subject)
        if predicate != v.RDF_TYPE or name in about or name in values or name not in entities:
            continue
        if not entities[name].place and v.iri(entities[name].iri) == subject:
            yield name


def _is_term(value: Value, term: str) -> bool:
    """Return whether an asserted value is this term."""
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
    """Return the name without its number, or a stem for the class if there is no name."""
    stem = (command.name or "").rstrip("0123456789")
    return stem or name_stem(command.class_)
