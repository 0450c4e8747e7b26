"""Clarification questions that distinguish several candidates by as few properties as possible."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import combinations, islice
from typing import Final

from semmap.nodes.language.reference_resolution import reading
from semmap.nodes.language.reference_resolution.description import OneOf
from semmap.nodes.language.reference_resolution.map_index import Item
from semmap.nodes.language.reference_resolution.parsing import parses
from semmap.nodes.language.reference_resolution.resolver import Resolver

_MOST: Final = 5
"""The maximum number of candidates that a question lists."""
_MOST_PARSES: Final = 8
_Tail = tuple[str, bool]
"""A distinguishing phrase, and whether it precedes the noun."""
_Feature = _Tail | None


def clarifying_question(names: Sequence[str], resolver: Resolver) -> str:
    """Return `Which one: the cup on the table or the one in the sink?`, in the language of the request."""
    describing = resolver.index.nouns[resolver.language].describing
    wording = describing.wording
    items = [resolver.index.items[name] for name in names[: _MOST + 1]]
    choices = _choices(items, _best_tails(items, names, resolver), resolver)
    if len(choices) > _MOST:
        choices = [*choices[:_MOST], wording["another"]]
    listed = ", ".join(choices[:-1]) + wording["either"] + choices[-1]
    return describing.contract(wording["question"].format(listed))


def _best_tails(items: Sequence[Item], names: Sequence[str], resolver: Resolver) -> list[_Tail]:
    """Return phrases that denote the items when they are typed back.

    If there are none for all items, those of one feature that denote most of them are used, and the names of
    the others.
    """
    best: list[_Tail] = []
    denoted = [False] * len(items)
    for tails, features in _distinguish(items, resolver):
        choices = _choices(items, tails, resolver)
        found = [
            _denotes(choice, names, resolver) == (i.name,) for choice, i in zip(choices, items, strict=True)
        ]
        if features and all(found):
            return tails
        if features == 1 and sum(found) > max(len(items) / 2, sum(denoted)):
            best, denoted = tails, found
    return [
        tail if is_clear else name for tail, name, is_clear in zip(best or tails, tails, denoted, strict=True)
    ]


def _choices(items: Sequence[Item], tails: Sequence[_Tail], resolver: Resolver) -> list[str]:
    """Return the phrases that name the items, such as *the cup on the table* and *the one in the sink*."""
    describing = resolver.index.nouns[resolver.language].describing
    choices: list[str] = []
    first = ""
    for item, (tail, is_before) in zip(items, tails, strict=True):
        noun = resolver.index.label(item.class_name, resolver.language)
        if tail == noun:
            choices.append(describing.with_article(noun))
        else:
            is_like = noun == first and noun not in describing.pluralia
            form = ("other" if is_like else "first") + ("_before" if is_before else "")
            choices.append(
                describing.wording[form].format(
                    noun=noun, the=describing.with_article(noun), that=describing.pronoun_for(noun), tail=tail
                )
            )
        first = first or noun
    return choices


def _denotes(choice: str, names: Sequence[str], resolver: Resolver) -> Sequence[str]:
    """Return the candidates that a choice denotes when it is typed back."""
    nouns = resolver.index.nouns[resolver.language]
    read = reading.read(nouns.describing.contract(choice), nouns)
    one_of = OneOf(choice, frozenset(names))
    for descriptions in islice(parses(read), _MOST_PARSES):
        if len(descriptions) == 1:
            described = replace(descriptions[0], restrictions=(*descriptions[0].restrictions, one_of))
            if found := resolver.resolve(described).names:
                return found
    return ()


def _distinguish(items: Sequence[Item], resolver: Resolver) -> Iterator[tuple[list[_Tail], int]]:
    """Yield unique phrases for the items, and of how many features: one, two, and at last the names (0)."""
    features = [[feature(item, resolver) for item in items] for feature in _FEATURES]
    features.append(_across(items, resolver))
    for candidates in features:
        if (apart := _apart(candidates)) is not None:
            yield apart, 1
    apart_from_kind = [
        found for feature, found in zip(_FEATURES, features, strict=False) if feature is not _kind
    ]
    for first, second in combinations([*apart_from_kind, features[-1]], 2):
        if (apart := _apart([_joined(a, b) for a, b in zip(first, second, strict=True)])) is not None:
            yield apart, 2
    called = resolver.index.nouns[resolver.language].describing.wording["called"]
    yield [(called.format(item.name), False) for item in items], 0


def _joined(one: _Feature, other: _Feature) -> _Feature:
    if one is None or other is None or one[1] or other[1]:
        return None
    return f"{one[0]} {other[0]}", False


def _apart(candidates: Sequence[_Feature]) -> list[_Tail] | None:
    """Return the phrases if every item has one and all of them differ, else None."""
    tails = [tail for tail in candidates if tail is not None]
    return tails if len(tails) == len(candidates) == len(set(tails)) else None


def _label(item: Item, resolver: Resolver) -> _Feature:
    """Return the first label of the item itself."""
    describing = resolver.index.nouns[resolver.language].describing
    is_plain = resolver.index.nouns[resolver.language].is_plain
    reference = next(filter(is_plain, item.references), "")
    return (describing.wording["called"].format(reference), False) if reference else None


def _kind(item: Item, resolver: Resolver) -> _Feature:
    return resolver.index.label(item.class_name, resolver.language), False


def _color(item: Item, resolver: Resolver) -> _Feature:
    found = _quality(item, "Color", resolver)
    describing = resolver.index.nouns[resolver.language].describing
    noun = resolver.index.label(item.class_name, resolver.language)
    return (describing.inflect(found, noun), True) if found else None


def _material(item: Item, resolver: Resolver) -> _Feature:
    found = _quality(item, "Material", resolver)
    wording = resolver.index.nouns[resolver.language].describing.wording
    return (wording["material"].format(found), False) if found else None


def _quality(item: Item, of: str, resolver: Resolver) -> str:
    """Return the label of the item's colour or material, or an empty string."""
    values = (value for name, all_ in sorted(item.values.items()) if name.endswith(of) for value in all_)
    return next((resolver.index.label(str(value), resolver.language) for value in values), "")


def _where(*relations: str) -> Callable[[Item, Resolver], _Feature]:
    def describe(item: Item, resolver: Resolver) -> _Feature:
        describing = resolver.index.nouns[resolver.language].describing
        for relation, other in resolver.geometry.spatial_relations(item.name):
            if relation in relations and other in resolver.index.items:
                noun = resolver.index.noun_for(resolver.index.items[other], resolver.language)
                return describing.wording[relation].format(describing.with_article(noun)), False
        return None

    return describe


def _owner(item: Item, resolver: Resolver) -> _Feature:
    describing = resolver.index.nouns[resolver.language].describing
    for owner in sorted(map(str, item.values.get("isOwnedBy", ()))):
        if owner in resolver.index.items:
            noun = resolver.index.noun_for(resolver.index.items[owner], resolver.language)
            return describing.wording["own"].format(describing.with_article(noun)), False
    return None


def _state(property_name: str) -> Callable[[Item, Resolver], _Feature]:
    def describe(item: Item, resolver: Resolver) -> _Feature:
        wording = resolver.index.nouns[resolver.language].describing.wording
        values = item.values.get(property_name, frozenset())
        return next(((wording[f"{str(v).lower()} {property_name}"], False) for v in values), None)

    return describe


def _across(items: Sequence[Item], resolver: Resolver) -> list[_Feature]:
    """Return each item's position from the left, if there is a viewer."""
    if not resolver.geometry.has_viewer:
        return [None] * len(items)
    wording = resolver.index.nouns[resolver.language].describing.wording
    order = sorted(items, key=lambda item: -resolver.geometry.bearing(item.name))
    return [(wording["across"].format(order.index(item) + 1), False) for item in items]


def _next_to(item: Item, resolver: Resolver) -> _Feature:
    """Return the unique object that the item stands next to."""
    describing = resolver.index.nouns[resolver.language].describing
    for name, other in _single(resolver):
        if name != item.name and resolver.geometry.related("isNextTo", item.name, name):
            return describing.wording["isNextTo"].format(describing.with_article(other)), False
    return None


def _single(resolver: Resolver) -> Iterator[tuple[str, str]]:
    """Yield name and label of the objects whose label is unique in the map."""
    index = resolver.index
    if len(index.items) > 200:
        return
    labels = {
        name: index.noun_for(item, resolver.language)
        for name, item in index.items.items()
        if not item.is_place
    }
    values = list(labels.values())
    yield from ((name, text) for name, text in sorted(labels.items()) if values.count(text) == 1)


_FEATURES: Final[tuple[Callable[[Item, Resolver], _Feature], ...]] = (
    _where("isInside", "isOn"),
    _color,
    _where("isLocatedIn"),
    _owner,
    _kind,
    _label,
    _material,
    _state("isOpen"),
    _state("isSwitchedOn"),
    _next_to,
)
