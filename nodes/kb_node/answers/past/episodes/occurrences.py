"""When something that a question states happened or was so."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Final, NamedTuple

from msgspec import structs

from semmap.nodes.kb_node.answers.past.episodes.episode_lists import find_common, find_overlaps, touches
from semmap.nodes.kb_node.answers.past.episodes.resolved import Referent
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline
from semmap.nodes.language.past.question import Claim
from semmap.schemas import errors
from semmap.schemas.episodes import Episode
from semmap.schemas.map_history import TimedRelation

_STATES: Final[Mapping[str, tuple[str, bool]]] = {
    "open": ("isOpen", True),
    "closed": ("isOpen", False),
    "on": ("isSwitchedOn", True),
    "off": ("isSwitchedOn", False),
}
_STATE_AFTER: Final = {"open": "open", "close": "closed", "switch_on": "on", "switch_off": "off"}
_DONE: Final = {
    "open": "opened",
    "close": "closed",
    "switch_on": "switched on",
    "switch_off": "switched off",
    "move": "moved",
    "put": "put down",
    "take": "taken away",
    "add": "added",
    "remove": "removed",
    "change": "changed",
}
_LEAVING: Final = frozenset(("take", "leave", "remove", "missing"))


class NotKnown(Exception):
    """Raised if a question has no answer in the history; the text states why."""


class Place(NamedTuple):
    """A place of a claim: how something is there, and the entities that are meant."""

    how: str
    names: tuple[str, ...]
    text: str

    def is_from(self) -> bool:
        """Return whether something left it."""
        return self.how == "from"


class Occurrences:
    """The events and intervals of claims, whose noun phrases are resolved by `referents`."""

    def __init__(self, timeline: Timeline, referents: Mapping[str, Referent], it: Sequence[str]) -> None:
        self._timeline, self._referents, self._it = timeline, referents, tuple(it)
        self._used: set[str] = set()

    def unused(self) -> list[Referent]:
        """Return the referents that no answer was computed from so far."""
        return [found for text, found in self._referents.items() if text not in self._used]

    def subjects(self, claim: Claim) -> tuple[str, ...]:
        """Return the entities that a claim is about. Raises NotKnown."""
        if claim.is_it and not claim.subjects:
            if not self._it:
                raise NotKnown("'it' refers to nothing that was mentioned")
            return self._it
        return tuple(dict.fromkeys(name for text in claim.subjects for name in self.names(text)))

    def names(self, text: str) -> tuple[str, ...]:
        """Return the entities that a noun phrase denotes. Raises NotKnown."""
        if text == "it":
            return self._it
        self._used.add(text)
        found = self._referents[text]
        if found.problem or not found.names:
            raise NotKnown(found.problem or _is_author(text))
        return found.names

    def kind(self, text: str) -> tuple[str, ...]:
        """Return the entities of a kind that a question asks for. Raises NotKnown if there are none."""
        self._used.add(text)
        found = self._referents[text]
        if not found.names:
            raise NotKnown(found.problem or _is_author(text))
        return found.names

    def author(self, claim: Claim) -> str:
        """Return the author that a claim names, or "". Raises NotKnown for one without commits."""
        if not claim.agent:
            return ""
        self._used.add(claim.agent)
        found = self._referents[claim.agent]
        if not found.author:
            raise NotKnown(found.problem or f"no commit is by {claim.agent}")
        return found.author

    def places(self, claim: Claim) -> list[Place]:
        """Return the places of a claim. Raises NotKnown."""
        return [Place(how, self.names(text), text) for how, text in claim.places if text]

    def what(self, claim: Claim, places: Sequence[Place]) -> str:
        """Return what a claim states of its subject: `moved`, `open`, `on table1`."""
        where = " ".join(f"{self.preposition(place)} {'/'.join(place.names)}" for place in places)
        if claim.event in _DONE and claim.event not in ("put", "take"):
            return f"{_DONE[claim.event]} {where}".strip()
        if claim.event in ("put", "take") and not where:
            return _DONE[claim.event]
        if claim.event == "missing":
            return "missing"
        return claim.state or (f"moved {where}" if where.startswith("from ") else where)

    def preposition(self, place: Place) -> str:
        """Return the preposition for what is at a place."""
        if place.how in ("on", "near", "from"):
            return place.how
        return "in" if all(self.is_place(name) for name in place.names) or place.how == "in" else "on"

    def is_place(self, name: str) -> bool:
        """Return whether an entity is a place, now or when it last existed."""
        entity = self._timeline.present.entities.get(name) or self._timeline.last_state_of(name)
        return entity is not None and entity.place

    def relations(self, how: str, name: str) -> tuple[TimedRelation, ...]:
        """Return the relations that count for a preposition and a place."""
        if self.is_place(name):
            return ("isLocatedIn",)
        match how:
            case "on":
                return ("isOn",)
            case "in":
                return ("isInside",)
            case "near":
                return ("isNear",)
            case "attached":
                return ("isAttachedTo",)
        return ("isOn", "isInside")

    def there(self, subjects: Iterable[str], place: Place) -> dict[str, list[Episode]]:
        """Return for each subject when it was at a place."""
        names = list(subjects)
        found: dict[str, list[Episode]] = {name: [] for name in names}
        for other in place.names:
            preposition = self.preposition(place._replace(names=(other,)))
            if preposition == "from":
                preposition = "in" if self.is_place(other) else "on"
            what = f"{preposition} {other}"
            relations = self.relations(place.how, other)
            for name, episodes in self._timeline.intervals(names, relations, other, what).items():
                found[name] = sorted([*found[name], *episodes], key=lambda e: e.since_ns)
        return found

    def of(self, claim: Claim, subjects: Sequence[str]) -> list[Episode]:
        """Return the events or intervals of a claim about these subjects, in order. Raises NotKnown."""
        author = self.author(claim)
        found = [episode for name in subjects for episode in self._of_one(claim, name)]
        if author:
            found = [e for e in found if e.by.casefold() == author.casefold()]
        return sorted(found, key=lambda e: e.since_ns)

    def _of_one(self, claim: Claim, name: str) -> list[Episode]:
        places = self.places(claim)
        what = self.what(claim, places)
        if claim.event in _STATE_AFTER:  # also of who left it open
            return self._changes_of_state(name, claim.event)
        if claim.state:
            return self._states(name, claim.state)
        if claim.event == "missing":
            return self._absences(name)
        if not claim.event:
            return self._lasting(name, places)
        leaves = claim.event in _LEAVING or any(place.is_from() for place in places)
        is_within = all(place.how in ("in", "near", "at") for place in places)
        if claim.event == "move" and not leaves and is_within:
            return self._moves_in(name, places, what)
        if not places:
            return self._events(name, claim.event, what)
        arrivals = [place for place in places if not place.is_from() and claim.event not in _LEAVING]
        departures = [place for place in places if place not in arrivals]
        found: list[Episode] | None = None
        for place in arrivals:
            found = find_common(found, self._starts(name, place))
        for place in departures:
            found = find_common(found, self._ends(name, place))
        return found or []

    def _events(self, name: str, event: str, what: str) -> list[Episode]:
        if event in ("enter", "leave", "go"):
            raise NotKnown("the question names no place")
        kinds = {"put": ("move", "add"), "take": ("move", "remove")}.get(event, (event,))
        found = [e for kind in kinds for e in self._timeline.events(name, kind, what)]
        return sorted(found, key=lambda e: e.since_ns)

    def _moves_in(self, name: str, places: Sequence[Place], what: str) -> list[Episode]:
        """Return the moves of an entity to, from and within places."""
        moves = self._timeline.events(name, "move", what)
        for place in places if moves else ():
            spans = self.there((name,), place)[name]
            moves = [m for m in moves if any(touches(span, m) for span in spans)]
        return moves

    def _lasting(self, name: str, places: Sequence[Place]) -> list[Episode]:
        found: list[Episode] | None = None
        for place in places:
            spans = self.there((name,), place)[name]
            found = spans if found is None else find_overlaps(found, spans)
        return found or []

    def _absences(self, name: str) -> list[Episode]:
        """Return when an entity was missing: from a removal until it was added again."""
        added = self._timeline.events(name, "add", "added")
        found = []
        for gone in self._timeline.events(name, "remove", "missing"):
            back = next((e for e in added if e.since_ns > gone.since_ns), None)
            found.append(
                gone if back is None else structs.replace(gone, until=back.since, until_ns=back.since_ns)
            )
        return found

    def _starts(self, name: str, place: Place) -> list[Episode]:
        """Return when an entity came to a place, each with the author of the commit."""
        spans = self.there((name,), place)[name]
        begun = [span for span in spans if self._has_begun(span)]
        return [self._event(name, f"{_came(span)} {span.what}", span.since, span.since_ns) for span in begun]

    def _has_begun(self, span: Episode) -> bool:
        """Return whether an interval began within the history; live poses begin where they begin."""
        if span.since is None:
            return span.since_ns > self._timeline.trails(span.subject).kept_since_ns
        return span.since > 0

    def _ends(self, name: str, place: Place) -> list[Episode]:
        """Return when an entity left a place, each with the author of the commit."""
        spans = self.there((name,), place)[name]
        return [
            self._event(name, f"no longer {span.what}", span.until, span.until_ns)
            for span in spans
            if span.until_ns is not None
        ]

    def _event(self, name: str, what: str, seq: int | None, ns: int) -> Episode:
        by = self._timeline.author(seq) if seq else ""
        return Episode(subject=name, what=what, since=seq, since_ns=ns, by=by)

    def _states(self, name: str, state: str) -> list[Episode]:
        property_name, value = _STATES[state]
        try:
            return self._timeline.state_intervals(name, property_name, value, state)
        except errors.BadRequest:
            raise NotKnown(f"whether {name} was {state} was never stated") from None

    def _changes_of_state(self, name: str, event: str) -> list[Episode]:
        """Return when an entity was opened, closed or switched, each with the author of the commit."""
        added = {e.since for e in self._timeline.events(name, "add", "")}
        found = []
        for span in self._states(name, _STATE_AFTER[event]):
            if span.since and span.since not in added:
                by = self._timeline.author(span.since)
                found.append(structs.replace(span, what=_DONE[event], until=None, until_ns=None, by=by))
        return found


def _is_author(text: str) -> str:
    return f"'{text}' is the author of commits, and no entity of the map"


def _came(span: Episode) -> str:
    """Return how something came to a place: put there by an author, or seen there by live poses."""
    return "put" if span.since else "newly"
