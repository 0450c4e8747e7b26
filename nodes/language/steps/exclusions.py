"""What a command excludes in other words than an exception: leave the blue one; the other cups."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from msgspec import structs

from semmap.nodes.language.steps.entity_tests import Meaning
from semmap.nodes.language.steps.phrase import NounPhrase
from semmap.schemas.language import CommandStep, Filler

PLACES: Final = frozenset(("Goal", "Source", "Ground", "Location", "Path"))
"""Roles of places."""
_MOVING: Final = frozenset(("Taking", "Bringing", "Giving", "Placing"))


@dataclass(slots=True)
class Mention:
    """A filler that a later pronoun may refer to."""

    step: int
    role: str
    filler: Filler
    is_person: bool
    is_plural: bool
    is_place: bool
    phrase: NounPhrase | None = None

    @property
    def denotes_some(self) -> bool:
        """Return whether only some of the filler's entities are meant: a cup, two of the three cups."""
        description = self.filler.description
        if description is not None and isinstance(description.quantity, int):
            return description.quantity < len(self.filler.entities)
        phrase = self.phrase
        is_any = phrase is not None and not (phrase.is_plural or phrase.is_definite or phrase.all_of)
        return is_any and len(self.filler.entities) > 1


def except_things(
    steps: list[CommandStep], last: CommandStep, is_left: bool, is_but: bool
) -> tuple[CommandStep, list[tuple[Filler, Filler]]]:
    """Exclude the thing of the step after `steps` from them if it must be left, or not be acted on.

    `is_left` tells whether the step is *leave*, and `is_but` whether it is *but leave*. Return the step,
    which without a place is a negated earlier one, and the fillers that were changed with their new values.
    """
    stays = is_left and "Goal" not in last.roles
    things = [f for role, fillers in last.roles.items() if role not in PLACES for f in fillers if f.entities]
    changed: list[tuple[Filler, Filler]] = []
    if not (stays or is_but or last.negated) or len(things) != 1:
        return last, changed
    (thing,) = things
    meant = last
    for k, step in enumerate(steps):
        if step.negated or not (is_left or _is_same(step.frame, last.frame)):
            continue
        roles = dict(step.roles)
        for role, fillers in step.roles.items():
            found = [f for f in fillers if role not in PLACES and set(thing.entities) < set(f.entities)]
            changed += ((filler, _without(filler, thing)) for filler in found)
            roles[role] = tuple(_without(f, thing) if f in found else f for f in fillers)
        # the other cups are apart from one cup, although any of them may be that one
        left = () if thing.description is None else thing.description.excluded
        is_apart = not any(
            set(thing.entities) & set(f.entities) and f.text not in left for f in roles.get("Theme", ())
        )
        if stays and is_apart and step.frame in _MOVING:  # leave the others
            meant = structs.replace(last, frame=step.frame, negated=True)
        steps[k] = structs.replace(step, roles=roles)
    return meant, changed


def keep_mentioned(meaning: Meaning, mentioned: list[Mention], text: str) -> None:
    """Keep only the last `mentioned` things in the meaning of the phrase `text`, such as *the same cup*."""
    names = set(meaning.names)
    fillers = (m.filler for m in reversed(mentioned))
    last = next((f for f in fillers if names.issuperset(f.entities) and f.entities), None)
    if last is None:
        meaning.doubts.append(f"'{text}': nothing of the kind was mentioned before")
    else:
        meaning.names, meaning.ambiguous = last.entities, False


def leave_mentioned(meaning: Meaning, mentioned: list[Mention], text: str) -> None:
    """Exclude what was `mentioned` from the meaning of the phrase `text`, such as *the other cups*.

    If only some of the entities of a mention are meant, any of them may be left: only the description
    excludes them.
    """
    names = set(meaning.names)
    some = [m.filler for m in mentioned if m.denotes_some and names & set(m.filler.entities)]
    if some and meaning.description is not None:
        excluded = (*meaning.description.excluded, *(filler.text for filler in some))
        meaning.description = structs.replace(meaning.description, excluded=excluded)
    fillers = (m.filler for m in mentioned if not m.denotes_some)
    before = [f for f in fillers if not names or (names & set(f.entities) and not names <= set(f.entities))]
    if not before and not some:
        meaning.doubts.append(f"'{text}': nothing of the kind was mentioned before")
    left = Filler(text, "", meaning.names, meaning.description)
    for filler in before:
        left = _without(left, filler)
    meaning.names, meaning.description = left.entities, left.description
    meaning.ambiguous = meaning.ambiguous and not some and len(meaning.names) > 1
    if names and not meaning.names:
        meaning.doubts.append(f"'{text}': no other one is known")


def _is_same(frame: str, other: str) -> bool:
    """Return whether two frames are of the same action if one of them is negated."""
    return frame == other or {frame, other} == {"Taking", "Bringing"}


def _without(filler: Filler, other: Filler) -> Filler:
    """Return a filler without what another one denotes."""
    names = tuple(name for name in filler.entities if name not in other.entities)
    description = filler.description
    if description is not None:
        description = structs.replace(description, excluded=(*description.excluded, other.text))
    return structs.replace(filler, entities=names, description=description)
