"""What `it` and `them` stand for: the last thing acted on before that suits what is to be done with it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from nodes.language.grounding import Scene
from schemas.language import Argument, Frame

_PRONOUNS: Final = ("it", "them", "they", "one")
_DOERS: Final = ("Agent", "Perceiver", "Cognizer", "Inspector", "Donor")
_PEOPLE: Final = ("Beneficiary", "Recipient")
_ACTED_ON: Final = (
    *("Theme", "Item", "Device", "Entity", "Sought_entity", "Phenomenon", "Containing_object", "Ground"),
    "Container_portal",
)


_FOR_OPENING: Final = dict.fromkeys(("Containing_object", "Container_portal"), "Openable_Thing")
_WANTED: Final = {  # frame -> role -> class of the household TBox: what affords it
    "Closure": _FOR_OPENING,
    "Change_operational_state": {"Device": "Switchable_Thing"},
}
_WHERE: Final = {  # preposition -> class of what is spoken of so
    **dict.fromkeys(("in", "into", "inside", "out of"), "Containing_Thing"),
    **dict.fromkeys(("on", "onto", "on top of"), "Supporting_Thing"),
}
_CARRYING: Final = ("Bringing", "Giving", "Manipulation", "Placing", "Releasing", "Taking")
_NEVER_CARRIED: Final = frozenset({"Location", "Connecting_Architecture"})


def antecedent(
    pronoun: str, preposition: str, frame: str, role: str, before: Sequence[Frame], scene: Scene
) -> str | None:
    """The name of the entity that a pronoun stands for, None for what has none.

    preposition: the words before the pronoun, "" for none. frame, role: what it fills. before: the frames of
    the sentence so far; what fills the same frame is not meant (*put the pizza in it*). The last that was
    acted on comes first, then the last of the others: the first that affords what is to be done is meant,
    and the first of all where none does. Places are not carried.
    """
    if pronoun not in _PRONOUNS:
        return None
    named = list(dict.fromkeys(argument.entity for argument in _mentioned(before) if argument.entity))
    if frame in _CARRYING and role in _ACTED_ON:
        named = [name for name in named if not _NEVER_CARRIED & scene.kinds_of(name)]
    wanted = _WHERE.get(preposition) or _WANTED.get(frame, {}).get(role)
    suited = (name for name in named if wanted is None or wanted in scene.kinds_of(name))
    return next(suited, named[0] if named else None)


def _mentioned(before: Sequence[Frame]) -> Iterator[Argument]:
    last_first = [a for frame in reversed(before) for a in reversed(frame.arguments)]
    yield from (a for a in last_first if a.role in _ACTED_ON)
    yield from (a for a in last_first if a.role not in (*_ACTED_ON, *_DOERS, *_PEOPLE))
