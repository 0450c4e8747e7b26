"""Antecedents of `it` and `them`: the last object acted on that affords the requested action."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from semmap.nodes.language.understanding.grounding import Scene
from semmap.schemas.language import Argument, SemanticFrame

_PRONOUNS: Final = ("it", "them", "they", "one")
_SEVERAL: Final = ("them", "they")
_DOERS: Final = ("Agent", "Perceiver", "Cognizer", "Inspector", "Donor")
_PEOPLE: Final = ("Beneficiary", "Recipient")
_ACTED_ON: Final = (
    *("Theme", "Item", "Device", "Entity", "Sought_entity", "Phenomenon", "Containing_object", "Ground"),
    "Container_portal",
)


_FOR_OPENING: Final = dict.fromkeys(("Containing_object", "Container_portal"), "Openable_Thing")
AFFORDANCES: Final[Mapping[str, Mapping[str, str]]] = {
    "Closure": _FOR_OPENING,
    "Change_operational_state": {"Device": "Switchable_Thing"},
}
"""For the roles of a frame, the class of the household TBox whose things afford the action."""
_WHERE: Final = {  # preposition -> class of its object
    **dict.fromkeys(("in", "into", "inside", "out of"), "Containing_Thing"),
    **dict.fromkeys(("on", "onto", "on top of"), "Supporting_Thing"),
}
_CARRYING: Final = ("Bringing", "Giving", "Manipulation", "Placing", "Releasing", "Taking")
_NEVER_CARRIED: Final = frozenset({"Location", "Connecting_Architecture"})


def antecedent(
    pronoun: str, preposition: str, frame: str, role: str, before: Sequence[SemanticFrame], scene: Scene
) -> tuple[str, ...]:
    """Return the names of the entities that a pronoun denotes, or none.

    `preposition` precedes the pronoun (or is ""), which fills `role` of `frame`. `before` are the earlier
    frames of the sentence; fillers of the same frame are excluded (*put the pizza in it*). Candidates are
    the objects acted on, the last first, then other fillers. The first one that affords the action is
    chosen, or the first of all if none does. Places are never carried. Several names are returned if the
    antecedent was ambiguous, and for *them*.
    """
    if pronoun not in _PRONOUNS:
        return ()
    named = list(dict.fromkeys(_mentioned(before, pronoun in _SEVERAL)))
    if frame in _CARRYING and role in _ACTED_ON:
        named = [names for names in named if not any(_NEVER_CARRIED & scene.kinds_of(name) for name in names)]
    wanted = _WHERE.get(preposition) or AFFORDANCES.get(frame, {}).get(role)
    suited = (
        names for names in named if wanted is None or all(wanted in scene.kinds_of(name) for name in names)
    )
    return next(suited, named[0] if named else ())


def _mentioned(before: Sequence[SemanticFrame], together: bool) -> Iterator[tuple[str, ...]]:
    """Yield the entities mentioned before, the last first; `together` groups those of one frame."""
    for frame in reversed(before):
        acted_on = [names for a in frame.arguments if a.role in _ACTED_ON and (names := _names(a))]
        if together and len(acted_on) > 1:
            yield tuple(name for names in acted_on for name in names)
        yield from reversed(acted_on)
    for frame in reversed(before):
        for argument in reversed(frame.arguments):
            if argument.role not in (*_ACTED_ON, *_DOERS, *_PEOPLE) and (names := _names(argument)):
                yield names


def _names(argument: Argument) -> tuple[str, ...]:
    return (argument.entity,) if argument.entity else argument.candidates
