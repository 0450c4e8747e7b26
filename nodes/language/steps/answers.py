"""Answers from the map to the questions in a command, with their evidence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from semmap.nodes.language.steps.entity_tests import Meaning, Verdicts, World
from semmap.nodes.language.steps.phrase import NounPhrase

_MOST: Final = 5
"""Names in one answer."""
_PROPERTIES: Final = {
    **dict.fromkeys(("color", "colour"), "Color"),
    **dict.fromkeys(("material",), "Material"),
    **dict.fromkeys(("weight", "mass", "weigh", "weighs"), "mass"),
    **dict.fromkeys(("size", "height"), "size"),
    **dict.fromkeys(("position", "location"), "where"),
    **dict.fromkeys(("name", "names", "identity", "called", "named"), "label"),
    **dict.fromkeys(("number", "amount", "count", "quantity", "total"), "number"),
}
"""Nouns of properties -> what the map has of them."""


def answer(message: str, head: str, topic: str, phrase: NounPhrase, meaning: Meaning, world: World) -> str:
    """Return the answer to a question about the `topic` of a command, or that one has to look.

    `message` states what is asked in lower case (*how many*, *where is*, *the color*) and `head` is its head.
    """
    description = meaning.description
    looks = (
        meaning.is_person and description is not None and (description.attributes or description.superlative)
    )
    is_tied = meaning.is_unordered and len(meaning.names) > 1
    if looks or is_tied or (not meaning.names and meaning.alike and _is_open(meaning)):
        return f"'{topic}': the map cannot tell; look there"
    names = meaning.names
    words = message.replace("'s", " is").replace("'re", " are").split()
    wanted = _PROPERTIES.get(head)
    if words[:1] in (["is"], ["are"]):
        if meaning.verdicts:
            return answer_states(phrase, meaning.verdicts, world)
        if not names and meaning.unknown:
            return _unknown(meaning.unknown, " and ".join(phrase.attributes))
        if not names and phrase.asked and not phrase.places:
            return _none(topic)
        if _asks_nothing(phrase, meaning):
            return f"'{topic}': the map cannot tell; look there"
        return _yes_or_no(topic, meaning, world)
    if words[:2] in (["how", "many"], ["how", "much"]) or wanted == "number":
        return _with_evidence(str(len(names)), names, world) if names else f"0: {_none(topic)}"
    if not names:
        return _none(topic)
    if words[:1] in (["which"], ["what"], ["who"]) and wanted is None:
        return _with_evidence("", names, world)
    if words[:1] == ["where"]:
        wanted = "where"
    if wanted is None:
        return f"'{topic}': the map does not have {message}; look there"
    return " ".join(filter(None, (_property(name, wanted, head, world) for name in names[:_MOST])))


def _asks_nothing(phrase: NounPhrase, meaning: Meaning) -> bool:
    """Return whether a question with *is* asks nothing of certain things that is understood."""
    is_certain = phrase.is_definite or meaning.is_person
    return is_certain and not (phrase.asked or phrase.places or phrase.asks_existence)


def answer_states(phrase: NounPhrase, verdicts: Mapping[str, Verdicts], world: World) -> str:
    """Return whether it is so what a question asks of each entity, or that it is not known."""
    asked = phrase.asked
    text = (" or " if phrase.asks_any else " and ").join(asked)
    decisive = phrase.asks_any  # one that holds is enough; else one that does not
    holding: list[tuple[str, str]] = []
    denied: list[tuple[str, str]] = []
    unknown: list[str] = []
    for name, each in verdicts.items():
        if decisive in each:
            found = asked[each.index(decisive)]
            (holding if decisive else denied).append((name, found if decisive else _denied(found)))
        elif None in each:
            unknown.append(name)
        else:
            (denied if decisive else holding).append((name, f"not {text}" if decisive else text))
    open_still = [_unknown(unknown, text)] if unknown else []
    said = [f"{name} is {state}" for name, state in (*denied, *(holding if phrase.asks_any else ()))]
    is_each = phrase.asks_any or (len(verdicts) > 1 and not (phrase.is_plural or phrase.all_of))
    if is_each:
        others = [] if phrase.asks_any else [f"{name} is {state}" for name, state in holding]
        return "; ".join(filter(None, (_listed([*others, *said]), *open_still)))
    if said:
        return f"no: {_listed(said)}"
    return open_still[0] if open_still else _with_evidence("yes", [name for name, _ in holding], world)


def _unknown(names: Sequence[str], state: str) -> str:
    be = "is" if len(names) == 1 else "are"
    return f"it is not known whether {_listed(names)} {be} {state}; look there"


def _denied(state: str) -> str:
    return state.removeprefix("not ") if state.startswith("not ") else f"not {state}"


def _is_open(meaning: Meaning) -> bool:
    return meaning.description is not None and bool(meaning.description.attributes) and not meaning.doubts


def _none(topic: str) -> str:
    return f"'{topic}': none is known; look there"


def _yes_or_no(topic: str, meaning: Meaning, world: World) -> str:
    """Return whether there are things of a description, as many as it states: are there two cups."""
    description, names = meaning.description, meaning.names
    least, most, number = None, None, None
    if description is not None:
        least, most, number = description.at_least, description.at_most, description.quantity
    if least is None and most is None and isinstance(number, int):
        least = number
    if not names:
        return _no(topic, meaning, world) if most is None or least is not None else "yes: 0"
    if number == "all" and not set(meaning.alike) <= set(names):
        return _no(topic, meaning, world)
    if (least is not None and len(names) < least) or (most is not None and len(names) > most):
        return _with_evidence(f"no: {len(names)}", names, world)
    return _with_evidence("yes", names, world)


def _no(topic: str, meaning: Meaning, world: World) -> str:
    """Return *no*, with where the things of this kind are."""
    if not meaning.alike:
        return _none(topic)
    return f"no: {_listed([f'{name} is {where}' for name in meaning.alike if (where := world.where(name))])}"


def _with_evidence(result: str, names: Sequence[str], world: World) -> str:
    """Return a result with the names that it is based on and when each was last seen."""
    known = [f"{name} ({seen})" if (seen := world.seen(name)) else name for name in names]
    return f"{result}: {_listed(known)}" if result else _listed(known)


def _listed(texts: Sequence[str]) -> str:
    more = f" ... and {len(texts) - _MOST} more" if len(texts) > _MOST else ""
    return ", ".join(texts[:_MOST]) + more


def _property(name: str, wanted: str, noun: str, world: World) -> str:
    """Return the sentence with a property of an entity."""
    item = world.index.items[name]
    value = ""
    if wanted == "where":
        place = world.where(name)
        seen = world.seen(name)
        evidence = f" ({seen})" if seen else ""
        return f"{name} is {place}{evidence}" if place else f"{name}: the place is not known; look for it"
    if wanted == "label":
        value = next(iter(item.references), "")
    elif wanted == "mass":
        mass = item.number("mass")
        value = f"{mass:g} kg" if mass is not None else ""
    elif wanted == "size":
        size = world.geometry.size(name)
        value = " x ".join(f"{length:g}" for length in size) + " m" if size is not None else ""
    else:
        values = sorted(str(v) for key, all_ in item.values.items() if key.endswith(wanted) for v in all_)
        value = ", ".join(world.index.label(one, "english") for one in values)
    return f"{name}: {noun} {value}" if value else f"{name}: the {noun} is not known; look at it"
