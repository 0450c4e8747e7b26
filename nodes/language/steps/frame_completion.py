"""The frame and roles of a clause once its arguments are read: the same verb has several frames."""

from __future__ import annotations

from typing import Final

from semmap.nodes.language.steps.clause import Clause, Role
from semmap.nodes.language.steps.clause_boundaries import ClauseBoundaries
from semmap.nodes.language.steps.phrase import NounPhrase

_PLACED: Final = (
    "Locating",
    "Placing",
    "Being_located",
    "Motion",
    "Arriving",
    "Inspecting",
    "Pouring",
    "Perception_active",
)
"""Frames of which a place after the object is a role of its own."""


class FrameCompletion(ClauseBoundaries):
    """Completes the frames of clauses."""

    def _finish(self, clause: Clause) -> None:
        """Give places after the object their role, and the frame its name for a person."""
        match clause.frame:
            case "Cause_to_perceive":
                self._show(clause)
            case "Change_operational_state":
                self._operate(clause)
            case "Emptying" | "Filling":
                self._empty(clause)
        roles = self._g.frames[clause.frame].roles
        main = clause.role(roles.get("object", "")) if "object" in roles else None
        if main is not None and main.phrases and clause.frame in _PLACED and "place" in roles:
            phrase = main.phrases[-1]
            is_last = phrase.places and phrase.end == phrase.places[-1].end and not phrase.places[-1].negated
            if is_last and clause.role(roles["place"]) is None:
                place = phrase.places.pop()
                phrase.end = main.end = place.first
                both = [place.other] if place.other.second is None else [place.other, place.other.second]
                clause.roles.append(Role(roles["place"], place.first, place.end, place.other.head, both))
        if self._t.is_translated and clause.frame in ("Bringing", "Guiding", "Emptying"):
            self._move_goal(clause, main)
        given = clause.role("Theme")
        is_left = clause.verb.lower() == "leave" and given is not None and clause.role("Goal") is None
        if is_left and given is not None and self._np.is_place(given.phrases[0]):  # leave the kitchen
            clause.frame, given.role = "Motion", "Source"
            return
        if (
            clause.frame == "Giving"
            and given is not None
            and given.phrases
            and self._g.is_a(self._words[given.head], "property")
        ):
            self._tells(clause, given)
        led = clause.role("Cotheme") if clause.verb.lower() in ("take along", "bring along") else None
        if (
            led is not None
            and led.phrases
            and led.phrases[0].kind == "thing"
            and not self._is_person(led.phrases[0])
        ):
            clause.frame, led.role = "Bringing", "Theme"
        if clause.frame == "Taking" and clause.role("Goal") is not None:
            clause.frame = "Bringing"
        if clause.frame == "Taking" and clause.role("Beneficiary") is not None:
            clause.frame = "Bringing"
        theme = clause.role("Theme")
        is_unnamed = theme is not None and bool(theme.phrases) and self._is_unnamed(clause, theme.phrases[0])
        if (
            not is_unnamed
            and clause.frame in self._g.persons
            and theme is not None
            and theme.phrases
            and self._is_person(theme.phrases[0])
        ):
            clause.frame, theme.role = self._g.persons[clause.frame], "Cotheme"
            for role in clause.roles:
                role.role = "Goal" if role.role == "Beneficiary" else role.role
        if (
            clause.frame == "Closure"
            and (opened := clause.role("Containing_object")) is not None
            and opened.phrases
        ) and (
            any(name in ("Door", "Window") for name in self._nouns.classes.get(opened.phrases[0].key, ()))
            or opened.phrases[0].noun.endswith("door")
        ):
            opened.role = "Container_portal"

    def _move_goal(self, clause: Clause, main: Role | None) -> None:
        """Make a Goal of the place after the object: Italian *in* is also *to*."""
        phrase = main.phrases[-1] if main is not None and main.phrases else None
        if main is None or phrase is None or not phrase.places or clause.role("Goal") is not None:
            return
        goes = clause.frame == "Emptying" or self._np.is_place(phrase.places[-1].other)
        goes = goes or (clause.verb == "bring" and clause.role("Beneficiary") is None)  # porta X sul tavolo
        if goes and not phrase.places[-1].negated:
            place = phrase.places.pop()
            phrase.end = main.end = min(phrase.end, place.first)
            clause.roles.append(Role("Goal", place.first, place.end, place.other.head, [place.other]))

    def _tells(self, clause: Clause, given: Role) -> None:
        """Make Telling of *give me the name of the person*."""
        of = given.phrases[0].of
        clause.frame, given.role = "Telling", "Message"
        for role in clause.roles:
            role.role = "Addressee" if role.role == "Recipient" else role.role
        if of is not None:
            end, given.end, given.phrases = given.end, given.head + 1, []
            clause.roles.append(Role("Topic", given.head + 1, end, of.head, [of]))

    def _is_unnamed(self, clause: Clause, phrase: NounPhrase) -> bool:
        """Return whether a lower-case word that could be a name is a thing: take SALT, without a goal."""
        goes = any(clause.role(role) for role in ("Goal", "Source"))
        if phrase.kind != "name" or goes or self._t.tokens[phrase.first].is_capital:
            return False
        phrase.kind, phrase.name = "thing", ""
        return True

    def _show(self, clause: Clause) -> None:
        """Read *show Nora to the sofa* and *show me the kitchen* as Guiding; a thing is only shown."""
        shown, to = clause.role("Phenomenon"), clause.role("Perceiver")
        if shown is None or not shown.phrases:
            return
        if to is not None and self._np.is_place(shown.phrases[0]):
            clause.frame, to.role, shown.role = "Guiding", "Cotheme", "Goal"
        elif to is None and (
            self._is_person(shown.phrases[0]) or shown.phrases[0].kind in ("speaker", "pronoun")
        ):
            clause.frame, shown.role = "Guiding", "Cotheme"

    def _operate(self, clause: Clause) -> None:
        """Read *stop* without a device as the end of an activity, and report a person as not understood."""
        device = clause.role("Device")
        if device is not None and device.phrases and self._is_person(device.phrases[0]):
            self.found.unused.append(self._t.between(device.first, device.end))
            clause.roles.remove(device)
        elif device is None and self._words[clause.first] in ("stop", "halt"):
            clause.frame = "Activity_stop"

    def _empty(self, clause: Clause) -> None:
        """Read *empty the trash* as Removing, and of *fill the glass of water* (Italian) the contents."""
        main = clause.role(self._g.frames[clause.frame].roles["object"])
        if main is None or not main.phrases:
            return
        phrase = main.phrases[0]
        if clause.frame == "Emptying" and self._g.is_a(phrase.noun, "refuse"):
            clause.frame, main.role = "Removing", "Theme"
        elif clause.frame == "Filling" and phrase.of is not None and clause.role("Theme") is None:
            of, phrase.of = phrase.of, None
            phrase.end, main.end = of.first - 1, of.first - 1
            clause.roles.insert(0, Role("Theme", of.first - 1, of.end, of.head, [of]))
