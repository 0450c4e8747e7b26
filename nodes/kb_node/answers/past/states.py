"""When a property of an entity had a value, such as since when a drawer is open, from the journal."""

from __future__ import annotations

import re
import time
from collections.abc import Iterable, Mapping
from typing import Final

from semmap.nodes.kb_node.answers.past.span_texts import describe_spells, stamp_of
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas import errors
from semmap.schemas.commands import WasWhen
from semmap.schemas.entities import Entity, Stated, Value
from semmap.schemas.joints import IS_OPEN
from semmap.schemas.map_history import Spell, Spells

_WORDS: Final = {(IS_OPEN, "true"): "open", (IS_OPEN, "false"): "closed"}
_CONDITION: Final = re.compile(r"is[A-Z]\w*")
_TRUTHS: Final = frozenset(("true", "false"))
_RELATIONS: Final = ("isOn", "isInside", "isLocatedIn", "isAttachedTo", "isNear")


def find_state_spells(journal: Journal, past: HistoryReader, query: WasWhen) -> Spells:
    """Return when a property had a value, as far as it was stated.

    Raises UnknownName; BadRequest for an ambiguous name, or a property that the entity never had.
    """
    name = past.resolve_renamed(query.name, past.entities(past.last) if past.last else ())
    states: list[tuple[int, Mapping[str, Stated]]] = []
    if (first := past.initial_entities().get(past.list_names(name)[-1][1])) is not None:
        states.append((0, first.properties))
    for seq, had in past.touching(name):
        states.append((seq, _properties_after(journal.commit(seq).changed, had)))
    known = {key for _, properties in states for key in properties}
    key = _find_property(query.relation, known, name)
    wanted = _format_value(query.other)
    known_values = {text for _, properties in states for text in _format_values(properties.get(key, ()))}
    if known_values <= _TRUTHS and wanted not in _TRUTHS:
        raise errors.BadRequest(f"{key} of {name} is true or false, not '{query.other}'")
    spells: list[Spell] = []
    for seq, properties in states:
        holds = key in properties and wanted in _format_values(properties[key])
        is_holding = bool(spells) and spells[-1].until is None
        stamp_ns = stamp_of(journal, seq)
        if holds and not is_holding:
            spells.append(Spell(since=seq, since_ns=stamp_ns))
        elif is_holding and not holds:
            begun = spells.pop()
            spells.append(Spell(since=begun.since, since_ns=begun.since_ns, until=seq, until_ns=stamp_ns))
    now_ns = time.time_ns()
    return Spells(
        subject=name,
        relation=key,
        object=wanted,
        spells=tuple(spells),
        total_s=sum(((spell.until_ns or now_ns) - spell.since_ns) / 1e9 for spell in spells),
        text=describe_spells(name, _describe_state(key, wanted), spells, now_ns),
    )


def _properties_after(changed: Iterable[Entity], name: str) -> Mapping[str, Stated]:
    """Return the properties of an entity after a commit; none if the commit removed it."""
    return next((entity.properties for entity in changed if entity.name == name), {})


def _find_property(word: str, known: Iterable[str], name: str) -> str:
    """Return the property of an entity that a word means, with or without its prefix. Raises BadRequest."""
    names = sorted(known)
    found = [key for key in names if word.casefold() in (key.casefold(), key.rpartition(":")[2].casefold())]
    if word in names:
        return word
    if len(found) == 1:
        return found[0]
    if found:
        raise errors.BadRequest(f"'{word}' is ambiguous: {', '.join(found)}; name one of them")
    hint = errors.did_you_mean(word, names) or errors.did_you_mean(word, _RELATIONS)
    relations = f"{', '.join(_RELATIONS[:-1])} and {_RELATIONS[-1]}"
    raise errors.BadRequest(f"{name} never had the property '{word}'{hint}; relations are {relations}")


def _format_values(stated: Stated) -> tuple[str, ...]:
    return tuple(map(_format_value, stated if isinstance(stated, tuple) else (stated,)))


def _format_value(value: Value) -> str:
    """Return a value as text, the same for a number or boolean and its text."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        try:
            return f"{float(value):g}"
        except ValueError:
            return value.casefold() if value.casefold() in _TRUTHS else value
    return f"{value:g}"


def _describe_state(key: str, value: str) -> str:
    """Return `open`, `not turned on`, or `at openness 0.5`."""
    local = key.rpartition(":")[2]
    if (words := _WORDS.get((local, value))) is not None:
        return words
    if _CONDITION.fullmatch(local) and value in _TRUTHS:
        condition = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", local[2:]).lower()
        return condition if value == "true" else f"not {condition}"
    return f"at {local} {value}"
