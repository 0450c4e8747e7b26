"""The properties that can be set for an entity, and the kind of field for each."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Final, Literal, NamedTuple

from semmap.nodes.extern.phrasing import english, labelled
from semmap.ontology import vocabulary as v
from semmap.schemas.changes import stated_in_words
from semmap.schemas.entities import Entity, PropertyInfo, Stated
from semmap.schemas.relations import FACTS

Kind = Literal["switch", "number", "choice", "thing", "text"]

_BOOLEANS: Final = frozenset(("boolean",))
_NUMBERS: Final = frozenset(
    (
        *("float", "double", "decimal", "integer", "int", "long", "short", "byte", "nonNegativeInteger"),
        *("positiveInteger", "nonPositiveInteger", "negativeInteger", "unsignedInt", "unsignedLong"),
        *("unsignedShort", "unsignedByte"),
    )
)
_UNIT: Final = re.compile(r"^In ([a-z][a-z /]*)\.")
_ENTITY_TRIPLES: Final = frozenset(("hasReference", "hasPosition", "hasSize"))
_GEOMETRY: Final = FACTS | {"supports", "holds", "contains"}
"""Relations that are computed from poses; they are not offered for editing unless they are asserted."""
_ONLY_OF: Final = {
    v.TBOX + "isOpen": "Openable_Thing",
    v.TBOX + "openness": "Openable_Thing",
    v.TBOX + "jointPositions": "Openable_Thing",
    v.TBOX + "isSwitchedOn": "Switchable_Thing",
    v.TBOX + "switchPositions": "Switchable_Thing",
}
"""Class of the entities to which a property is offered, by IRI. Its domain, and thus `set`, is wider."""


class State(NamedTuple):
    """One property of an entity, with its field."""

    name: str
    label: str
    kind: Kind
    now: Stated | None
    """The asserted value; None without one."""
    multiple: bool
    """Whether it can have several values."""
    choices: Mapping[str, str]
    """The allowed individuals, by name, with the text to show for each."""
    unit: str
    hint: str

    @property
    def text(self) -> str:
        """The asserted value in words; empty without one."""
        if self.now is None:
            return ""
        values = self.now if isinstance(self.now, tuple) else (self.now,)
        return ", ".join(self.choices.get(str(v)) or stated_in_words(v) for v in values)


def list_states(
    entity: Entity, properties: Iterable[PropertyInfo], things: Mapping[str, Entity]
) -> tuple[State, ...]:
    """Return the states that fit the class of `entity`: asserted ones first, then by kind and label."""
    types = {*entity.types, entity.class_}
    found = [
        _state(entity, p, things)
        for p in properties
        if p.name not in _ENTITY_TRIPLES
        and (p.name in entity.properties or (_fits(p, types) and p.name not in _GEOMETRY))
    ]
    order: list[Kind] = ["switch", "number", "choice", "text", "thing"]
    return tuple(sorted(found, key=lambda s: (s.now is None, order.index(s.kind), s.label)))


def common_states(
    entities: Iterable[Entity], properties: Iterable[PropertyInfo], things: Mapping[str, Entity]
) -> tuple[State, ...]:
    """Return the states that all entities can have; `now` is their common value."""
    all_states = [list_states(entity, properties, things) for entity in entities]
    if not all_states:
        return ()
    by_name = [{state.name: state for state in found} for found in all_states]
    return tuple(
        state._replace(
            now=state.now if all(other[state.name].now == state.now for other in by_name) else None
        )
        for state in all_states[0]
        if all(state.name in other for other in by_name)
    )


def _fits(p: PropertyInfo, types: set[str]) -> bool:
    """Return whether an entity of these types is in the domain of the property."""
    only = _ONLY_OF.get(p.iri)
    return all(class_ in types for class_ in p.domain) and (only is None or only in types)


def _state(entity: Entity, p: PropertyInfo, things: Mapping[str, Entity]) -> State:
    kind = _kind(p)
    choices: Mapping[str, str] = {}
    if kind == "choice":
        choices = {
            name: label or name for name, label in sorted(p.values.items(), key=lambda v: v[1] or v[0])
        }
    elif kind == "thing":
        wanted = set(p.range)
        choices = {
            name: labelled(name, other.preferred_reference or "")
            for name, other in sorted(things.items())
            if name != entity.name and (not wanted or wanted <= {*other.types, other.class_})
        }
    unit = _UNIT.match(p.comment)
    return State(
        name=p.name,
        label=english(p.labels) or p.name,
        kind=kind,
        now=entity.properties.get(p.name),
        multiple=not p.functional,
        choices=choices,
        unit=unit[1] if unit else "",
        hint=p.comment,
    )


def _kind(p: PropertyInfo) -> Kind:
    if p.kind == "object":
        return "choice" if p.values else "thing"
    datatypes = set(p.datatypes)
    if datatypes & _BOOLEANS:
        return "switch"
    return "number" if datatypes & _NUMBERS else "text"
