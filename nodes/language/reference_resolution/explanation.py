"""The reply to `find`: reasons, the clarification question, and near matches if nothing matches."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from semmap.nodes.language.nouns import enumerate_nouns, is_counted, with_count
from semmap.nodes.language.reference_resolution import clarification
from semmap.nodes.language.reference_resolution.description import (
    Description,
    Not,
    Order,
    Owned,
    Related,
    Restriction,
    State,
    Unknown,
)
from semmap.nodes.language.reference_resolution.resolution import Answer
from semmap.nodes.language.reference_resolution.resolver import Resolved, Resolver, Scope
from semmap.schemas.language import Candidate, Found
from semmap.schemas.relations import RELATIONS, RelationName

_MOST: Final = 50
"""The maximum number of candidates in a reply."""
_NEAREST: Final = 5
_SPOKEN: Final[dict[RelationName, str]] = {
    row.name: row.english[0] for row in RELATIONS if row.english and row.name != "isBetween"
}
_SPOKEN["isLocatedIn"] = _SPOKEN["isInside"]


def explain(answer: Answer) -> Found:
    """Return the reply for an answer, with reasons, question and near matches."""
    resolver, names = answer.resolver, answer.names
    candidates = tuple(_candidates(answer.parts, names[:_MOST], resolver))
    question, text, nearest = "", "", tuple[Candidate, ...]()
    match answer.outcome:
        case "one":
            text = f"{names[0]} matches"
        case "several":
            text = f"{len(names)} things match"
        case "ambiguous":
            text = f"the description is ambiguous: {len(names)} things match"
            question = _from_where(answer) or clarification.clarifying_question(names, resolver)
        case "none":
            part = next((part for part in answer.parts if _is_short(part)), answer.parts[-1])
            text = _missing(part, resolver)
            nearest = tuple(_nearest(part, resolver))
    return Found(
        outcome=answer.outcome, candidates=candidates, text=text, question=question, nearest=nearest,
        read_as=answer.reading.corrections, others=max(len(names) - _MOST, 0),
    )  # fmt: skip


def _candidates(parts: Iterable[Resolved], names: tuple[str, ...], resolver: Resolver) -> Iterator[Candidate]:
    of_part = {name: part for part in parts for name in part.names}
    for name in names:
        yield _candidate(
            name, resolver, (_called(name, of_part[name], resolver), *_reasons(name, of_part[name], resolver))
        )


def _candidate(name: str, resolver: Resolver, reasons: Iterable[str]) -> Candidate:
    item = resolver.index.items[name]
    return Candidate(
        entity=name, class_=item.class_name, called=resolver.index.noun_for(item, resolver.language),
        reasons=tuple(filter(None, reasons)),
    )  # fmt: skip


def _called(name: str, part: Resolved, resolver: Resolver) -> str:
    description, item = part.description, resolver.index.items[name]
    if description.head != "noun":
        return ""
    nouns = resolver.index.nouns[resolver.language]
    for reference in item.references:
        if description.key in nouns.keys(reference):
            return f"called {reference if nouns.is_plain(reference) else f'“{reference}”'}"
    label = resolver.index.label(item.class_name, "english")
    return with_count(1, label) if is_counted(label) else f"some {label}"


def _reasons(name: str, part: Resolved, resolver: Resolver) -> Iterator[str]:
    description = part.description
    for restriction in description.restrictions:
        if resolver.fits(name, restriction, description, part.kind, Scope()):
            yield _reason(name, restriction, description, resolver)
    if description.order is not None:
        yield from _ordered(name, description.order, resolver)


def _ordered(name: str, order: Order, resolver: Resolver) -> Iterator[str]:
    """Yield the text of an order and the measured value for the entity."""
    names_reference = order.to is None or order.to.text in order.text
    yield order.text if names_reference or order.to is None else f"{order.text} {order.to.text}"
    geometry = resolver.geometry
    if order.axis == "distance" and order.to is not None:
        others = [other for other in resolver.resolve(order.to).names if other != name]
        if others:
            nearest = min(others, key=lambda other: geometry.distance(name, other))
            yield f"{geometry.distance(name, nearest):.2f} m from {nearest}"
    elif order.axis == "distance":
        yield f"{geometry.distance_from_viewer(name):.2f} m from the viewer"
    elif order.axis == "height" and (at := geometry.position(name)) is not None:
        yield f"at a height of {at[2]:.2f} m"
    elif order.axis in ("volume", "tallness", "length") and (size := geometry.size(name)) is not None:
        yield f"of {' x '.join(f'{extent:.2f}' for extent in size)} m"
    elif order.axis == "mass" and (mass := resolver.index.items[name].number("mass")) is not None:
        yield f"of {mass:g} kg"


def _from_where(answer: Answer) -> str:
    """Return the question to ask if the direction of counting (*the first*) is undefined."""
    if answer.resolver.geometry.has_viewer:
        return ""
    wording = answer.reading.nouns.describing.wording
    orders = (part.description.order for part in answer.parts if part.is_tied)
    unclear = (order.text for order in orders if order is not None and order.axis == "")
    return next((wording["from_where"].format(text) for text in unclear), "")


def _reason(name: str, restriction: Restriction, description: Description, resolver: Resolver) -> str:
    match restriction:
        case Related(relation=relation, others=others) if relation in _SPOKEN:
            inner = Scope((name,), description)
            for other in resolver.resolve(others[0], inner).names:
                if resolver.geometry.related(relation, name, other):
                    return f"{_SPOKEN[relation]} {other}"
        case Owned():
            owners = resolver.index.items[name].values.get("isOwnedBy", frozenset())
            return f"of {', '.join(sorted(map(str, owners)))}" if owners else restriction.text
    return restriction.text


def _is_short(part: Resolved) -> bool:
    return len(part.names) < (part.description.number or 1)


def _unknown_state(part: Resolved, resolver: Resolver) -> str | None:
    """Return a note if nothing matches because it is not set whether things are open or on."""
    failed = part.failed.restriction if isinstance(part.failed, Not) else part.failed
    if not isinstance(failed, State) or not isinstance(failed.value, bool) or failed.property == "holding":
        return None
    items = resolver.index.items
    others = [r for r in part.description.restrictions if r is not part.failed]
    unknown = [
        name
        for name in part.kind
        if failed.property not in items[name].values
        and all(resolver.fits(name, r, part.description, part.kind, Scope()) for r in others)
    ]
    if not unknown or part.description.head != "noun":
        return None
    few = unknown if len(unknown) <= _NEAREST else [*unknown[:_NEAREST], f"{len(unknown) - _NEAREST} others"]
    return f"unknown whether {enumerate_nouns(few)} {'is' if len(unknown) == 1 else 'are'} {failed.text}"


def _missing(part: Resolved, resolver: Resolver) -> str:
    """Return a sentence about the part of a description that nothing matches."""
    description, noun = part.description, part.description.noun or "something"
    if description.head == "one" and not description.restrictions and description.order is None:
        return (
            f"'{description.text}' contains no noun;"
            " describe an object, for example: the red cup on the table"
        )
    unknown = [r.text for r in description.restrictions if isinstance(r, Unknown)]
    if unknown and description.head != "noun":
        return f"unknown word '{unknown[0]}': no class or entity has this name"
    if unknown:
        return f"unknown word '{unknown[0]}' in '{description.text}'"
    if part.failed is not None and description.head == "anything":
        return f"nothing matches '{part.failed.text}'"
    if not part.kind:
        return f"nothing in the map is called '{noun}'"
    if (unknown_state := _unknown_state(part, resolver)) is not None:
        return unknown_state
    if part.failed is not None and len(part.kind) == 1:
        return f"the only thing called '{noun}' does not match '{part.failed.text}'"
    if part.failed is not None:
        return f"none of the {len(part.kind)} things called '{noun}' matches '{part.failed.text}'"
    if not part.names and description.order is None:
        return f"none of the {len(part.kind)} things called '{noun}' matches all of '{description.text}'"
    count = len(part.names) or len(part.kind)
    return f"only {count} {'thing matches' if count == 1 else 'things match'} '{description.text}'"


def _nearest(part: Resolved, resolver: Resolver) -> Iterator[Candidate]:
    """Yield the entities that fail the fewest restrictions, with the ones that they fail."""
    description = part.description
    if description.head != "noun":
        return
    against = {
        name: [
            r for r in description.restrictions if not resolver.fits(name, r, description, part.kind, Scope())
        ]
        for name in part.kind
    }
    least = min(map(len, against.values()), default=0)
    for name in [name for name, unfit in against.items() if len(unfit) == least][:_NEAREST]:
        fitting = (
            _reason(name, r, description, resolver)
            for r in description.restrictions
            if r not in against[name]
        )
        unfit = (f"not: {restriction.text}" for restriction in against[name])
        where = _whereabouts(name, resolver)
        yield _candidate(name, resolver, (_called(name, part, resolver), *fitting, *unfit, *where))


def _whereabouts(name: str, resolver: Resolver) -> Iterator[str]:
    for relation, other in resolver.geometry.spatial_relations(name)[:1]:
        yield f"{_SPOKEN[relation]} {other}"
