"""Questions in wordings by a person who had not seen the grammar, each with its stated meaning."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Final, NamedTuple

from benchmarks.episodes.day import OPENABLE, PERSONS, ROBOT, ROOMS, SURFACES, THINGS, WALKERS, Stay
from benchmarks.episodes.questions import DEVICES, Asker, Expected

_FILE: Final = Path(__file__).parent / "blind_wordings.toml"
_S: Final = 1_000_000_000
_ROOMS: Final = {
    "en": {"kitchen1": "kitchen", "studio1": "studio", "livingroom1": "living room", "bedroom1": "bedroom",
           "bathroom1": "bathroom", "corridor1": "corridor"},
    "it": {"kitchen1": "cucina", "studio1": "studio", "bathroom1": "bagno"},
}  # fmt: skip
Made = tuple[dict[str, str], Expected]


class Wording(NamedTuple):
    """A wording of the file, and its number among those of its kind and language."""

    kind: str
    language: str
    text: str
    number: int


def load() -> list[Wording]:
    """Return the wordings in order."""
    counts: dict[tuple[str, str], int] = {}
    found = []
    for row in tomllib.loads(_FILE.read_text("utf-8"))["wording"]:
        key = row["kind"], row["language"]
        counts[key] = counts.get(key, 0) + 1
        found.append(Wording(*key, row["text"], counts[key]))
    return found


class BlindAsker(Asker):
    """Makes the questions of these wordings, with the answers by their meanings."""

    def make_blind(self, wording: Wording) -> Made:
        """Return the words for the slots of a wording, and the right answer."""
        self._language = wording.language
        makers: dict[str, list[Callable[[], Made]]] = {
            "where en": [self._at, self._today_at, self._room_at, self._at, self._person_at],
            "when en": [self._moved, self._put, self._opened, self._put_by, self._seen_in],
            "since en": [
                self._since_on,
                self._since_here,
                self._open_since_time,
                self._since_in,
                self._stays_in,
            ],
            "how_long en": [
                self._long_on,
                self._last_open,
                self._long_between,
                self._minutes,
                self._last_stay,
            ],
            "how_often en": [
                self._robot_today,
                self._moved_since,
                self._between,
                self._opened_today,
                self._twice,
            ],
            "who en": [self._who_last, self._who_put_last, self._who_took, self._left_open, self._who_last],
            "changed en": [self._room_since, self._on_since_, self._happened, self._all_moved, self._is_same],
            "missing en": [self._gone, self._gone, self._gone, self._gone_from_room, self._is_all_there],
            "before_after en": [
                self._place_before,
                self._put_after,
                self._place_after,
                self._on_before,
                self._order,
            ],
            "never en": [self._ever, self._nobody, self._never_on, self._was_on, self._unseen_rooms],
            "where it": [self._at, self._room_at, self._today_at],
            "when it": [self._moved, self._put, self._opened_by],
            "since it": [self._since_on, self._open_for, self._in_for],
            "who it": [self._who_last, self._who_put_last, self._who_last],
            "missing it": [self._gone, self._gone, self._is_all_there],
        }
        return makers[f"{wording.kind} {wording.language}"][wording.number - 1]()

    def _named(self, room: str) -> str:
        return _ROOMS[self._language][room]

    def _rooms(self) -> list[str]:
        return list(_ROOMS[self._language])

    def _today_at(self) -> Made:
        slots, expected = self._where_thing()
        at = "today at" if self._language == "en" else "oggi alle"
        return {**slots, "time": f"{at} {slots['time']}"}, expected

    def _at(self) -> Made:
        return self._where_thing()

    def _room_at(self) -> Made:
        slots, expected = self._where_thing()
        rooms = frozenset(SURFACES[surface] for surface in expected.names or ())
        return slots, Expected(names=rooms)

    def _person_at(self) -> Made:
        ns, time = self._quiet()
        return {"person": "Anna", "time": time}, Expected(names=frozenset((self._place_at("anna1", ns),)))

    def _moved(self) -> Made:
        return self._moved_last()

    def _last_put(self, *, is_over: bool | None = None) -> tuple[str, str, Stay]:
        """Return a thing and a surface with its last stay there."""
        thing, stay = self._stay(THINGS, is_over=self._rng.random() < 0.6 if is_over is None else is_over)
        last = [s for s in self._record.stays(thing)[1:] if s.place == stay.place][-1]
        if is_over and last.end_ns is None:
            return self._last_put(is_over=is_over)
        return thing, stay.place, last

    def _put(self) -> Made:
        thing, surface, last = self._last_put()
        return {"thing": thing, "place": surface}, Expected(time_ns=last.begun_ns)

    def _opened(self) -> Made:
        slots, expected = self._opened_last()
        return {"place": slots["device"]}, expected

    def _opened_by(self) -> Made:
        moves = [h for d in OPENABLE for h in self._record.of(d, "open") if f"{h.actor}1" in PERSONS]
        one = self._rng.choice(moves)
        last = [h for h in moves if (h.subject, h.actor) == (one.subject, one.actor)][-1]
        return {"place": one.subject, "person": one.actor.title()}, Expected(time_ns=last.ns)

    def _put_by(self) -> Made:
        moves = [h for t in THINGS for h in self._record.of(t, "moved") if f"{h.actor}1" in PERSONS]
        one = self._rng.choice(moves)
        same = [h for h in moves if (h.subject, h.actor, h.place) == (one.subject, one.actor, one.place)]
        slots = {"thing": one.subject, "place": one.place, "person": one.actor.title()}
        return slots, Expected(time_ns=same[-1].ns)

    def _room_stays(self, thing: str) -> list[Stay]:
        """Return the unbroken stays of a thing in rooms."""
        found: list[Stay] = []
        for stay in self._record.stays(thing):
            room = SURFACES[stay.place]
            if found and found[-1].place == room:
                found[-1].end_ns = stay.end_ns
            else:
                found.append(Stay(room, stay.begun_ns, stay.end_ns))
        return found

    def _seen_in(self) -> Made:
        thing = self._rng.choice(THINGS)
        rooms = self._room_stays(thing)
        past = [
            s for i, s in enumerate(rooms) if s.end_ns and s.place not in [t.place for t in rooms[i + 1 :]]
        ]
        stay = self._rng.choice(past)
        return {"thing": thing, "room": self._named(stay.place)}, Expected(time_ns=stay.end_ns)

    def _since_on(self) -> Made:
        slots, expected = self._on_since()
        return {"thing": slots["thing"], "place": slots["surface"]}, expected

    def _since_here(self) -> Made:
        thing = self._rng.choice([t for t in THINGS if t not in ("plate2", "water1")])
        begun_ns = self._record.stays(thing)[-1].begun_ns
        return {"thing": thing}, Expected(time_ns=begun_ns, may_be_age=True)

    def _open_since_time(self) -> Made:
        ns, time = self._quiet()
        device = self._rng.choice(OPENABLE)
        last = self._record.stays(device)[-1]
        is_so = last.place == "open" and last.begun_ns <= ns
        return {"place": device, "time": time}, Expected(verdict=is_so)

    def _present_in(self) -> tuple[str, Stay]:
        thing = self._rng.choice([t for t in THINGS if t not in ("plate2", "water1")])
        stay = self._room_stays(thing)[-1]
        return (thing, stay) if stay.place in self._rooms() and stay.begun_ns else self._present_in()

    def _since_in(self) -> Made:
        thing, stay = self._present_in()
        return {"thing": thing, "room": self._named(stay.place)}, Expected(time_ns=stay.begun_ns)

    def _in_for(self) -> Made:
        thing, stay = self._present_in()
        expected = Expected(time_ns=stay.begun_ns, may_be_age=True)
        return {"thing": thing, "room": self._named(stay.place)}, expected

    def _stays_in(self) -> Made:
        walker = self._rng.choice(list(PERSONS))
        stay = self._record.stays(walker)[-1]
        expected = Expected(time_ns=stay.begun_ns, may_be_age=True)
        return {"person": PERSONS[walker], "room": self._named(stay.place)}, expected

    def _open_for(self) -> Made:
        slots, expected = self._open_since()
        return {"place": slots["device"]}, Expected(time_ns=expected.time_ns, may_be_age=True)

    def _long_on(self) -> Made:
        slots, expected = self._how_long_on()
        return {"thing": slots["thing"], "place": slots["surface"]}, expected

    def _last_open(self) -> Made:
        device = self._pick(OPENABLE, "open")
        last = [s for s in self._record.stays(device) if s.place == "open"][-1]
        return {"place": device}, Expected(
            seconds=lambda now_ns: ((last.end_ns or now_ns) - last.begun_ns) / _S
        )

    def _times(self) -> tuple[int, int, dict[str, str]]:
        """Return two times [ns], and both as words."""
        (one, first), (two, last) = sorted(self._quiet() for _ in range(2))
        return (one, two, {"time": first, "time2": last}) if one < two else self._times()

    def _long_between(self) -> Made:
        first, last, slots = self._times()
        thing, room = self._rng.choice(THINGS), self._rng.choice(self._rooms())
        parts = [
            min(s.end_ns or last, last) - max(s.begun_ns, first)
            for s in self._room_stays(thing)
            if s.place == room
        ]
        total_s = sum(max(0, part) for part in parts) / _S
        slots |= {"thing": thing, "room": self._named(room)}
        return slots, Expected(seconds=lambda _: total_s)

    def _minutes(self) -> Made:
        slots, expected = self._how_long_stayed_of(list(PERSONS))
        return {
            "person": PERSONS[slots["walker"]],
            "room": self._named(slots["room"]),
            "time": "today",
        }, expected

    def _last_stay(self) -> Made:
        thing, surface, last = self._last_put(is_over=True)
        lasted_s = ((last.end_ns or 0) - last.begun_ns) / _S
        return {"thing": thing, "place": surface}, Expected(seconds=lambda _: lasted_s)

    def _visits(self, walker: str, room: str, first: int = 0, last: int = 1 << 62) -> int:
        return sum(
            s.place == room and s.begun_ns <= last and (s.end_ns or last) > first
            for s in self._record.stays(walker)
        )

    def _robot_today(self) -> Made:
        room = self._rng.choice(self._rooms())
        return {"room": self._named(room), "time": "today"}, Expected(count=self._visits(ROBOT, room))

    def _moved_since(self) -> Made:
        ns, time = self._quiet()
        thing = self._rng.choice(THINGS)
        return {"thing": thing, "time": time}, Expected(
            count=sum(h.ns > ns for h in self._record.of(thing, "moved"))
        )

    def _between(self) -> Made:
        first, last, slots = self._times()
        walker, room = self._rng.choice(list(PERSONS)), self._rng.choice(self._rooms())
        count = sum(h.place == room and first < h.ns <= last for h in self._record.of(walker, "entered"))
        return {**slots, "person": PERSONS[walker], "room": self._named(room)}, Expected(count=count)

    def _opened_today(self) -> Made:
        slots, expected = self._opened_often()
        return {"place": slots["device"], "time": "today"}, expected

    def _twice(self) -> Made:
        ns, time = self._quiet()
        room = self._rng.choice(self._rooms())
        is_so = self._visits(ROBOT, room, ns) > 1
        return {"robot": ROBOT, "room": self._named(room), "time": time}, Expected(verdict=is_so)

    def _who_last(self) -> Made:
        thing = self._pick(THINGS, "moved")
        actor = self._record.of(thing, "moved", "removed")[-1].actor
        slots = {"thing": thing, "person": self._rng.choice(list(PERSONS.values()))}
        return slots, Expected(names=frozenset((actor,)), is_exact=True)

    def _who_put_last(self) -> Made:
        thing, surface, last = self._last_put()
        return {"thing": thing, "place": surface}, Expected(names=frozenset((last.actor,)), is_exact=True)

    def _who_took(self) -> Made:
        thing, surface, last = self._last_put(is_over=True)
        moves = self._record.of(thing, "moved", "removed")
        actor = next(h.actor for h in moves if h.ns == last.end_ns)
        return {"thing": thing, "place": surface}, Expected(names=frozenset((actor,)), is_exact=True)

    def _left_open(self) -> Made:
        device, person = self._rng.choice(OPENABLE), self._rng.choice(list(PERSONS.values()))
        last = self._record.stays(device)[-1]
        is_so = last.place == "open" and last.actor == person.lower()
        return {"place": device, "person": person}, Expected(verdict=is_so)

    def _room_since(self) -> Made:
        slots, expected = self._changed_room()
        return {**slots, "room": self._named(slots["room"])}, expected

    def _on_since_(self) -> Made:
        ns, time = self._quiet()
        surface = self._rng.choice(list(SURFACES))
        end_ns = self._record.end_ns
        names = {
            t for t in THINGS if (self._place_at(t, ns) == surface) != (self._place_at(t, end_ns) == surface)
        }
        return {"place": surface, "time": time}, Expected(names=frozenset(names), is_exact=True)

    def _happened(self) -> Made:
        first, last, slots = self._times()
        room = self._rng.choice(self._rooms())
        names = set()
        for h in self._record.happenings:
            there = {DEVICES.get(h.subject), *(SURFACES.get(place) for place in (h.place, h.was))}
            if first < h.ns <= last and room in there:
                names.add(h.subject)
        slots["room"] = self._named(room)
        return slots, Expected(names=frozenset(names), is_exact=True, ignored=frozenset(WALKERS))

    def _all_moved(self) -> Made:
        ns, time = self._quiet()
        names = frozenset(h.subject for h in self._record.happenings if h.kind == "moved" and h.ns > ns)
        return {"time": time}, Expected(names=names, is_exact=True, ignored=frozenset(WALKERS))

    def _is_same(self) -> Made:
        slots, expected = self._on_since_()
        return slots, Expected(verdict=not expected.names)

    def _gone(self) -> Made:
        slots, expected = self._missing()
        return {"place": slots["surface"], "time": slots["time"]}, expected

    def _gone_from_room(self) -> Made:
        ns, time = self._quiet()
        room = self._rng.choice(self._rooms())
        end_ns = self._record.end_ns
        was = {t for t in THINGS if SURFACES.get(self._place_at(t, ns)) == room}
        gone = {t for t in was if SURFACES.get(self._place_at(t, end_ns)) != room}
        return {"room": self._named(room), "time": time}, Expected(names=frozenset(gone), is_exact=True)

    def _is_all_there(self) -> Made:
        slots, expected = self._gone()
        return slots, Expected(verdict=not expected.names)

    def _place_before(self) -> Made:
        slots, expected = self._before()
        return {"thing": slots["thing"], "place": slots["surface"]}, expected

    def _place_after(self) -> Made:
        slots, expected = self._after()
        return {"thing": slots["thing"], "place": slots["surface"]}, expected

    def _put_after(self) -> Made:
        thing, surface, last = self._last_put(is_over=True)
        names = {
            h.subject
            for h in self._record.happenings
            if h.kind == "moved" and h.place == surface and h.ns > (last.end_ns or 0)
        }
        return {"thing": thing, "place": surface}, Expected(names=frozenset(names), is_exact=True)

    def _on_before(self) -> Made:
        walker, stay = self._stay(list(PERSONS), is_over=True)
        last = [s for s in self._record.stays(walker)[1:] if s.place == stay.place][-1]
        surface = self._rng.choice(list(SURFACES))
        names = {t for t in THINGS if self._place_at(t, last.begun_ns - 1) == surface}
        slots = {"person": PERSONS[walker], "room": self._named(stay.place), "place": surface}
        expected = Expected(names=frozenset(names), is_exact=True, among=frozenset(THINGS))
        return slots, expected

    def _order(self) -> Made:
        walker, stay = self._stay(list(PERSONS), is_over=True)
        left = [s for s in self._record.stays(walker) if s.place == stay.place and s.end_ns][-1].end_ns or 0
        thing = self._pick(THINGS, "moved")
        how = "before" if left < self._record.of(thing, "moved")[-1].ns else "after"
        slots = {"person": PERSONS[walker], "room": self._named(stay.place), "thing": thing}
        return slots, Expected(word=how)

    def _ever(self) -> Made:
        slots, expected = self._thing_ever()
        return {"thing": slots["thing"], "room": self._named(slots["room"])}, expected

    def _nobody(self) -> Made:
        return {"thing": self._pick(THINGS, "moved")}, Expected(verdict=False)

    def _never_on(self) -> Made:
        surface = self._rng.choice(list(SURFACES))
        never = {t for t in THINGS if all(s.place != surface for s in self._record.stays(t))}
        return {"place": surface}, Expected(names=frozenset(never), is_exact=True, among=frozenset(THINGS))

    def _was_on(self) -> Made:
        thing, surface = self._rng.choice(THINGS), self._rng.choice(list(SURFACES))
        is_so = any(s.place == surface for s in self._record.stays(thing))
        return {"thing": thing, "place": surface}, Expected(verdict=is_so, is_said=True)

    def _unseen_rooms(self) -> Made:
        unseen = {room for room in ROOMS if not self._visits(ROBOT, room)}
        return {}, Expected(names=frozenset(unseen), is_exact=True, among=frozenset(ROOMS))
