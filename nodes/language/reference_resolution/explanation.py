"""What was found, in words: reasons, the question to ask back, and what is nearest where nothing fits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from semmap.nodes.language.nouns import counted, is_counted, listed
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

_MOST: Final = 50
"""Candidates that are told of."""
_NEAREST: Final = 5
_SPOKEN: Final = {
    "isOn": "on", "isInside": "in", "isLocatedIn": "in", "isUnder": "under", "isAbove": "above",
    "isNear": "near", "isNextTo": "next to", "isLeftOf": "left of", "isRightOf": "right of",
    "isInFrontOf": "in front of",     "isBehind": "behind", "touches": "touching",
}  # fmt: skip


def explain(answer: Answer) -> Found:
    """An answer with reasons, question and what is nearest."""
    resolver, names = answer.resolver, answer.names
    candidates = tuple(_candidates(answer.parts, names[:_MOST], resolver))
    question, text, nearest = "", "", tuple[Candidate, ...]()
    match answer.outcome:
        case "one":
            text = f"{names[0]} is meant"
        case "several":
            text = f"{len(names)} things are meant"
        case "ambiguous":
            text = f"any of {len(names)} things may be meant"
            question = _from_where(answer) or clarification.clarifying_question(names, resolver)
        case "none":
            part = next((part for part in answer.parts if _is_short(part)), answer.parts[-1])
            text = _missing(part, resolver)
            nearest = tuple(_nearest(part, resolver))
    return Found(
        outcome=answer.outcome, candidates=candidates, text=text, question=question, nearest=nearest,
        read_as=answer.reading.mended, others=max(len(names) - _MOST, 0),
    )  # fmt: skip


def _candidates(parts: Iterable[Resolved], names: tuple[str, ...], resolver: Resolver) -> Iterator[Candidate]:
    of_part = {name: part for part in parts for name in part.names}
    for name in names:
        yield _candidate(
            name, resolver, (_called(name, of_part[name], resolver), *_reasons(name, of_part[name], resolver))
        )


def _candidate(name: str, resolver: Resolver, reasons: Iterable[str]) -> Candidate:
    item = resolver.known.items[name]
    return Candidate(
        entity=name, class_=item.class_name, called=resolver.known.spoken(item, resolver.language),
        reasons=tuple(filter(None, reasons)),
    )  # fmt: skip


def _called(name: str, part: Resolved, resolver: Resolver) -> str:
    said, item = part.description, resolver.known.items[name]
    if said.head != "noun":
        return ""
    nouns = resolver.known.nouns[resolver.language]
    for reference in item.references:
        if said.key in nouns.keys(reference):
            return f"called {reference if nouns.is_plain(reference) else f'“{reference}”'}"
    label = resolver.known.label(item.class_name, "english")
    return counted(1, label) if is_counted(label) else f"some {label}"


def _reasons(name: str, part: Resolved, resolver: Resolver) -> Iterator[str]:
    said = part.description
    for restriction in said.restrictions:
        if resolver.fits(name, restriction, said, part.kind, Scope()):
            yield _reason(name, restriction, said, resolver)
    if said.order is not None:
        yield from _ordered(name, said.order, resolver)


def _ordered(name: str, order: Order, resolver: Resolver) -> Iterator[str]:
    """What an order says of a thing, and what was measured for it."""
    has_said_to = order.to is None or order.to.said in order.said
    yield order.said if has_said_to or order.to is None else f"{order.said} {order.to.said}"
    around = resolver.around
    if order.axis == "distance" and order.to is not None:
        others = [other for other in resolver.resolve(order.to).names if other != name]
        if others:
            nearest = min(others, key=lambda other: around.distance(name, other))
            yield f"{around.distance(name, nearest):.2f} m from {nearest}"
    elif order.axis == "distance":
        yield f"{around.distance_from_viewer(name):.2f} m from who looks"
    elif order.axis == "height" and (at := around.position(name)) is not None:
        yield f"at a height of {at[2]:.2f} m"
    elif order.axis in ("volume", "tallness", "length") and (size := around.size(name)) is not None:
        yield f"of {' x '.join(f'{extent:.2f}' for extent in size)} m"


def _from_where(answer: Answer) -> str:
    """What to ask where nothing says from where the first and second are counted."""
    if answer.resolver.around.has_viewer:
        return ""
    wording = answer.reading.nouns.describing.wording
    orders = (part.description.order for part in answer.parts if part.is_tied)
    unclear = (order.said for order in orders if order is not None and order.axis == "")
    return next((wording["from_where"].format(said) for said in unclear), "")


def _reason(name: str, restriction: Restriction, said: Description, resolver: Resolver) -> str:
    match restriction:
        case Related(relation=relation, others=others) if relation in _SPOKEN:
            inner = Scope((name,), said)
            for other in resolver.resolve(others[0], inner).names:
                if resolver.around.related(relation, name, other):
                    return f"{_SPOKEN[relation]} {other}"
        case Owned():
            owners = resolver.known.items[name].values.get("isOwnedBy", frozenset())
            return f"of {', '.join(sorted(map(str, owners)))}" if owners else restriction.said
    return restriction.said


def _is_short(part: Resolved) -> bool:
    return len(part.names) < (part.description.number or 1)


def _unsaid(part: Resolved, resolver: Resolver) -> str | None:
    """That nobody has said whether things are open or on, where that is why nothing fits."""
    failed = part.failed.restriction if isinstance(part.failed, Not) else part.failed
    if not isinstance(failed, State) or not isinstance(failed.value, bool) or failed.property == "holding":
        return None
    items = resolver.known.items
    others = [r for r in part.description.restrictions if r is not part.failed]
    unsaid = [
        name
        for name in part.kind
        if failed.property not in items[name].values
        and all(resolver.fits(name, r, part.description, part.kind, Scope()) for r in others)
    ]
    if not unsaid or part.description.head != "noun":
        return None
    few = unsaid if len(unsaid) <= _NEAREST else [*unsaid[:_NEAREST], f"{len(unsaid) - _NEAREST} others"]
    return f"nobody has said whether {listed(few)} {'is' if len(unsaid) == 1 else 'are'} {failed.said}"


def _missing(part: Resolved, resolver: Resolver) -> str:
    """Which part of a description nothing fits."""
    said, noun = part.description, part.description.noun or "something"
    if said.head == "one" and not said.restrictions and said.order is None:
        return f"'{said.said}' names nothing; describe a thing, such as: the red cup on the table"
    unknown = [r.said for r in said.restrictions if isinstance(r, Unknown)]
    if unknown and said.head != "noun":
        return f"nothing is called '{unknown[0]}', and the word is not known"
    if unknown:
        return f"'{said.said}' is not understood: the word '{unknown[0]}' is not known"
    if part.failed is not None and said.head == "anything":
        return f"nothing fits '{part.failed.said}'"
    if not part.kind:
        return f"there is nothing that is called '{noun}'"
    if (unsaid := _unsaid(part, resolver)) is not None:
        return unsaid
    if part.failed is not None and len(part.kind) == 1:
        return f"the only thing called '{noun}' does not fit '{part.failed.said}'"
    if part.failed is not None:
        return f"none of the {len(part.kind)} things called '{noun}' fits '{part.failed.said}'"
    if not part.names and said.order is None:
        return f"none of the {len(part.kind)} things called '{noun}' fits all of '{said.said}'"
    there = f"only {len(part.names) or len(part.kind)} {'fits' if len(part.names) == 1 else 'fit'}"
    return f"there are not so many: of '{said.said}' {there}"


def _nearest(part: Resolved, resolver: Resolver) -> Iterator[Candidate]:
    """What the most of a description fits, with what of it does not."""
    said = part.description
    if said.head != "noun":
        return
    against = {
        name: [r for r in said.restrictions if not resolver.fits(name, r, said, part.kind, Scope())]
        for name in part.kind
    }
    least = min(map(len, against.values()), default=0)
    for name in [name for name, unfit in against.items() if len(unfit) == least][:_NEAREST]:
        fitting = (_reason(name, r, said, resolver) for r in said.restrictions if r not in against[name])
        unfit = (f"not: {restriction.said}" for restriction in against[name])
        where = _whereabouts(name, resolver)
        yield _candidate(name, resolver, (_called(name, part, resolver), *fitting, *unfit, *where))


def _whereabouts(name: str, resolver: Resolver) -> Iterator[str]:
    for relation, other in resolver.around.whereabouts(name)[:1]:
        yield f"{_SPOKEN[relation]} {other}"
