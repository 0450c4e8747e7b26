"""Questions about a recorded day with their answers, from the record alone."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Final

from benchmarks.episodes.day import (
    OPENABLE,
    PERSONS,
    ROOMS,
    SURFACES,
    THINGS,
    WALKERS,
    Record,
    Stay,
)
from semmap.schemas.episodes import PastAnswer

LABELS: Final[Mapping[str, str]] = {
    "kitchen1": "the kitchen",
    "studio1": "the studio",
    "livingroom1": "the living room",
    "bedroom1": "the bedroom",
    "bathroom1": "the bathroom",
    "corridor1": "the corridor",
    "desk1": "the desk",
    "counter1": "the counter",
    "coffee_table1": "the coffee table",
    "bedstand1": "the bedstand",
    "washing_machine1": "the washing machine",
    "console1": "the console",
    "fridge1": "the fridge",
    "oven1": "the oven",
    "wardrobe1": "the wardrobe",
    "cabinet1": "the cabinet",
    "cup2": "the red cup",
    "keys1": "the keys",
    "glass1": "the glass",
    "remote_control1": "the remote control",
    "smartphone1": "the smartphone",
    "anna1": "Anna",
    "bruno1": "Bruno",
}
_S: Final = 1_000_000_000
_TOLERANCE_S: Final = 1.5


@dataclass(slots=True)
class Expected:
    """The right answer: names of which one is in the answer, a time, a duration, a number or a verdict."""

    names: frozenset[str] | None = None
    is_exact: bool = False
    """Whether all of the names and no others are right."""
    among: frozenset[str] | None = None
    """The names that count, if not all do."""
    ignored: frozenset[str] = frozenset()
    time_ns: int | None = None
    may_be_age: bool = False
    """Whether the time since then is right as well."""
    seconds: Callable[[int], float] | None = None
    """The duration [s] if it is asked at a time [ns]."""
    count: int | None = None
    verdict: bool | None = None
    is_said: bool = False
    """Whether the verdict is of what is so, also if the question contains *never*."""
    word: str = ""
    """A word that the text of the answer begins with."""

    def fault(self, found: PastAnswer, asked_ns: int, *, is_negated: bool = False) -> str:
        """Return what is wrong with an answer, or ""."""
        if not found.is_known:
            return "not known"
        if self.names is not None:
            return self._fault_of_names(set(found.names) - self.ignored)
        if self.time_ns is not None:
            return self._fault_of_time(found, asked_ns)
        if self.seconds is not None:
            right_s = self.seconds(asked_ns)
            wrong = found.seconds is None or abs(found.seconds - right_s) > _TOLERANCE_S + 0.02 * right_s
            return f"not {right_s:.1f} s" if wrong else ""
        if self.count is not None:
            return "" if found.count == self.count else f"not {self.count} times"
        if self.word:
            return "" if found.text.startswith(self.word) else f"not {self.word}"
        verdict = self.verdict != (is_negated and not self.is_said)
        return "" if found.verdict == verdict else f"not {verdict}"

    def _fault_of_names(self, names: set[str]) -> str:
        wanted = self.names or frozenset()
        names = names if self.among is None else names & self.among
        right = names == wanted if self.is_exact else bool(wanted & names)
        return "" if right else f"not {', '.join(sorted(wanted)) or 'nothing'}"

    def _fault_of_time(self, found: PastAnswer, asked_ns: int) -> str:
        right_ns = self.time_ns or 0
        times = list(found.times_ns)
        if self.may_be_age and found.seconds is not None:
            times = [asked_ns - round(found.seconds * _S)]
        if len(times) == 1 and abs(times[0] - right_ns) <= _TOLERANCE_S * _S:
            return ""
        return f"not {datetime.fromtimestamp(right_ns / 1e9):%H:%M:%S}"


@dataclass(slots=True)
class Question:
    """A question of a kind and form: the words for its slots, and the right answer."""

    kind: str
    form: str
    slots: dict[str, str]
    expected: Expected
    key: tuple[str, ...] = field(default=())
    """What is asked of: different questions have different keys."""


class Asker:
    """Makes questions about a record."""

    def __init__(self, record: Record, rng: random.Random) -> None:
        self._record, self._rng = record, rng

    def make(self, kind: str, form: str) -> Question:
        """Return a question of a form with a known answer. Raises KeyError for an unknown form."""
        makers = {
            ("where", "thing_at"): self._where_thing,
            ("where", "walker_at"): self._where_walker,
            ("when", "moved_last"): self._moved_last,
            ("when", "opened_last"): self._opened_last,
            ("when", "entered_last"): self._entered_last,
            ("since", "state"): self._open_since,
            ("since", "on"): self._on_since,
            ("how_long", "on"): self._how_long_on,
            ("how_long", "stayed"): self._how_long_stayed,
            ("how_long", "opened"): self._how_long_open,
            ("how_often", "entered"): self._entered_often,
            ("how_often", "moved"): self._moved_often,
            ("how_often", "opened"): self._opened_often,
            ("who", "moved_last"): self._who_moved,
            ("who", "put_last"): self._who_put,
            ("who", "opened_last"): self._who_opened,
            ("changed", "room"): self._changed_room,
            ("changed", "surface"): self._changed_surface,
            ("missing", "surface"): self._missing,
            ("before_after", "before"): self._before,
            ("before_after", "after"): self._after,
            ("never", "thing"): self._thing_ever,
            ("never", "walker"): self._walker_ever,
        }
        made = makers[kind, form]()
        slots = {slot: self._word(value) for slot, value in made[0].items()}
        return Question(kind, form, slots, made[1], tuple(made[0].values()))

    def _word(self, value: str) -> str:
        label = LABELS.get(value)
        return value if label is None or (value not in PERSONS and self._rng.random() < 0.3) else label

    def _pick(self, subjects: Sequence[str], *kinds: str) -> str:
        """Return a subject to which something of these kinds happened."""
        return self._rng.choice([s for s in subjects if self._record.of(s, *kinds)])

    def _quiet(self) -> tuple[int, str]:
        """Return a whole second in a pause [ns], and it as a clock time."""
        begun_ns, _ = self._rng.choice(self._record.quiet[1:-1])
        second = begun_ns // _S + 1
        return second * _S, f"{datetime.fromtimestamp(second):%H:%M:%S}"

    def _place_at(self, subject: str, ns: int) -> str:
        """Return where a subject was, or ""."""
        stays = self._record.stays(subject)
        return next((s.place for s in stays if s.begun_ns <= ns and (s.end_ns is None or s.end_ns > ns)), "")

    def _stay(self, subjects: Sequence[str], *, is_over: bool) -> tuple[str, Stay]:
        """Return a subject and one of its stays after the first one."""
        stays = [
            (s, stay)
            for s in subjects
            for stay in self._record.stays(s)[1:]
            if (stay.end_ns is not None) == is_over
        ]
        return self._rng.choice(stays)

    # One method for each form

    def _where_thing(self) -> tuple[dict[str, str], Expected]:
        ns, time = self._quiet()
        thing = self._rng.choice([t for t in THINGS if self._place_at(t, ns)])
        place = self._place_at(thing, ns)
        return {"thing": thing, "time": time}, Expected(names=frozenset((place,)))

    def _where_walker(self) -> tuple[dict[str, str], Expected]:
        ns, time = self._quiet()
        walker = self._rng.choice(WALKERS)
        return {"walker": walker, "time": time}, Expected(names=frozenset((self._place_at(walker, ns),)))

    def _moved_last(self) -> tuple[dict[str, str], Expected]:
        thing = self._pick(THINGS, "moved")
        return {"thing": thing}, Expected(time_ns=self._record.of(thing, "moved")[-1].ns)

    def _opened_last(self) -> tuple[dict[str, str], Expected]:
        device = self._pick(OPENABLE, "open")
        return {"device": device}, Expected(time_ns=self._record.of(device, "open")[-1].ns)

    def _entered_last(self) -> tuple[dict[str, str], Expected]:
        walker, stay = self._stay(WALKERS, is_over=True)
        last = [s for s in self._record.stays(walker)[1:] if s.place == stay.place][-1]
        return {"walker": walker, "room": stay.place}, Expected(time_ns=last.begun_ns)

    def _open_since(self) -> tuple[dict[str, str], Expected]:
        device = self._rng.choice([d for d in OPENABLE if self._record.stays(d)[-1].place == "open"])
        return {"device": device}, Expected(time_ns=self._record.stays(device)[-1].begun_ns)

    def _on_since(self) -> tuple[dict[str, str], Expected]:
        thing, stay = self._stay(THINGS, is_over=False)
        return {"thing": thing, "surface": stay.place}, Expected(time_ns=stay.begun_ns)

    def _total(self, subject: str, place: str) -> Callable[[int], float]:
        stays = [s for s in self._record.stays(subject) if s.place == place]
        return lambda now_ns: sum((s.end_ns or now_ns) - s.begun_ns for s in stays) / _S

    def _how_long_on(self) -> tuple[dict[str, str], Expected]:
        while True:
            thing, stay = self._stay(THINGS, is_over=True)
            if stay.place != self._record.stays(thing)[0].place:  # that began before the history
                total = self._total(thing, stay.place)
                return {"thing": thing, "surface": stay.place}, Expected(seconds=total)

    def _how_long_stayed(self) -> tuple[dict[str, str], Expected]:
        return self._how_long_stayed_of(WALKERS)

    def _how_long_stayed_of(self, walkers: Sequence[str]) -> tuple[dict[str, str], Expected]:
        while True:
            walker, stay = self._stay(walkers, is_over=True)
            ends = {self._record.stays(walker)[i].place for i in (0, -1)}
            if stay.place not in ends:
                return {"walker": walker, "room": stay.place}, Expected(
                    seconds=self._total(walker, stay.place)
                )

    def _how_long_open(self) -> tuple[dict[str, str], Expected]:
        device = self._pick(OPENABLE, "open")
        return {"device": device}, Expected(seconds=self._total(device, "open"))

    def _entered_often(self) -> tuple[dict[str, str], Expected]:
        while True:
            walker, room = self._rng.choice(WALKERS), self._rng.choice(list(ROOMS))
            stays = self._record.stays(walker)
            if room != stays[0].place:
                count = sum(s.place == room for s in stays)
                return {"walker": walker, "room": room}, Expected(count=count)

    def _moved_often(self) -> tuple[dict[str, str], Expected]:
        thing = self._pick(THINGS, "moved")
        return {"thing": thing}, Expected(count=len(self._record.of(thing, "moved")))

    def _opened_often(self) -> tuple[dict[str, str], Expected]:
        device = self._pick(OPENABLE, "open")
        return {"device": device}, Expected(count=len(self._record.of(device, "open")))

    def _who_moved(self) -> tuple[dict[str, str], Expected]:
        thing = self._pick(THINGS, "moved")
        actor = self._record.of(thing, "moved")[-1].actor
        return {"thing": thing}, Expected(names=frozenset((actor,)), is_exact=True)

    def _who_put(self) -> tuple[dict[str, str], Expected]:
        thing, stay = self._stay(THINGS, is_over=self._rng.random() < 0.7)
        last = [s for s in self._record.stays(thing)[1:] if s.place == stay.place][-1]
        return {"thing": thing, "surface": stay.place}, Expected(
            names=frozenset((last.actor,)), is_exact=True
        )

    def _who_opened(self) -> tuple[dict[str, str], Expected]:
        device = self._pick(OPENABLE, "open")
        actor = self._record.of(device, "open")[-1].actor
        return {"device": device}, Expected(names=frozenset((actor,)), is_exact=True)

    def _changed_room(self) -> tuple[dict[str, str], Expected]:
        while True:
            ns, time = self._quiet()
            room = self._rng.choice(list(ROOMS))
            surfaces = {surface for surface, there in SURFACES.items() if there == room}
            if (expected := self._changed(ns, surfaces, room)) is not None:
                return {"room": room, "time": time}, expected

    def _changed_surface(self) -> tuple[dict[str, str], Expected]:
        while True:
            ns, time = self._quiet()
            surface = self._rng.choice(list(SURFACES))
            if (expected := self._changed(ns, {surface}, "none")) is not None:
                return {"surface": surface, "time": time}, expected

    def _changed(self, ns: int, surfaces: set[str], room: str) -> Expected | None:
        """Return what changed, or None if something came back, perhaps to where it was."""
        names = set()
        for thing in THINGS:
            was, now = self._place_at(thing, ns), self._place_at(thing, self._record.end_ns)
            has_moved = any(h.ns > ns for h in self._record.of(thing, "moved", "removed"))
            if has_moved and was == now and was in surfaces:
                return None
            if has_moved and ({was, now} & surfaces):
                names.add(thing)
        for device, there in DEVICES.items():
            if there == room and self._place_at(device, ns) != self._place_at(device, self._record.end_ns):
                names.add(device)
        return Expected(names=frozenset(names), is_exact=True)

    def _missing(self) -> tuple[dict[str, str], Expected]:
        ns, time = self._quiet()
        surface = self._rng.choice([s for s in SURFACES if any(self._place_at(t, ns) == s for t in THINGS)])
        was = {t for t in THINGS if self._place_at(t, ns) == surface}
        gone = {t for t in was if self._place_at(t, self._record.end_ns) != surface}
        return {"surface": surface, "time": time}, Expected(names=frozenset(gone), is_exact=True)

    def _neighbours(self) -> Iterator[tuple[str, list[Stay], int]]:
        """Yield the things with the last of their stays at a surface, by its number."""
        things = list(THINGS)
        self._rng.shuffle(things)
        for thing in things:
            stays = self._record.stays(thing)
            numbers = [i for i, s in enumerate(stays) if s.place not in [t.place for t in stays[i + 1 :]]]
            self._rng.shuffle(numbers)
            for i in numbers:
                yield thing, stays, i

    def _before(self) -> tuple[dict[str, str], Expected]:
        thing, stays, i = next(one for one in self._neighbours() if one[2] > 0)
        slots = {"thing": thing, "surface": stays[i].place}
        return slots, Expected(names=frozenset((stays[i - 1].place,)))

    def _after(self) -> tuple[dict[str, str], Expected]:
        thing, stays, i = next(one for one in self._neighbours() if one[2] + 1 < len(one[1]))
        slots = {"thing": thing, "surface": stays[i].place}
        return slots, Expected(names=frozenset((stays[i + 1].place,)))

    def _thing_ever(self) -> tuple[dict[str, str], Expected]:
        thing, room = self._rng.choice(THINGS), self._rng.choice(["bathroom1", "bathroom1", *ROOMS])
        was_there = any(SURFACES[s.place] == room for s in self._record.stays(thing))
        return {"thing": thing, "room": room}, Expected(verdict=was_there)

    def _walker_ever(self) -> tuple[dict[str, str], Expected]:
        walker, room = (
            self._rng.choice(["r2", *WALKERS]),
            self._rng.choice(["bathroom1", "bathroom1", *ROOMS]),
        )
        was_there = any(s.place == room for s in self._record.stays(walker))
        return {"walker": walker, "room": room}, Expected(verdict=was_there)


DEVICES: Final[Mapping[str, str]] = {
    "fridge1": "kitchen1", "oven1": "kitchen1", "wardrobe1": "bedroom1", "cabinet1": "livingroom1",
    "light1": "corridor1", "television1": "livingroom1", "lamp1": "studio1",
}  # fmt: skip
"""The rooms of the devices; doors are in none."""
