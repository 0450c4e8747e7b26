"""A day in the flat, shortened to minutes: a robot and two persons move about and change things.

The journal stamps each commit with the clock of the machine, which cannot be injected. Times are therefore
asked with seconds. What happens is recorded by this module alone, with the times before and after each call.
"""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Final

from semmap import Client
from semmap.schemas import errors

SURFACES: Final[Mapping[str, str]] = {
    "table1": "kitchen1",
    "counter1": "kitchen1",
    "desk1": "studio1",
    "coffee_table1": "livingroom1",
    "bedstand1": "bedroom1",
    "washing_machine1": "bathroom1",
    "console1": "corridor1",
}
"""Surfaces and their rooms."""
ROOMS: Final[Mapping[str, tuple[float, float]]] = {
    "kitchen1": (7.0, 2.6),
    "studio1": (7.4, 5.6),
    "livingroom1": (3.0, 2.0),
    "bedroom1": (4.0, 5.6),
    "bathroom1": (1.0, 6.4),
    "corridor1": (5.0, 4.2),
}
"""Rooms, each with a position [m] in no smaller place."""
PERSONS: Final[Mapping[str, str]] = {"anna1": "Anna", "bruno1": "Bruno"}
ROBOT: Final = "r2"
WALKERS: Final = (*PERSONS, ROBOT)
ACTORS: Final[Mapping[str, str]] = {"anna1": "anna", "bruno1": "bruno", "r2": "r2"}
"""The agents of the commits by their entities."""
THINGS: Final = (
    "cup1", "cup2", "plate1", "plate2", "book1", "glass1", "water1", "keys1", "smartphone1",
    "remote_control1",
)  # fmt: skip
ORIGINAL: Final[Mapping[str, str]] = {
    "cup1": "desk1", "plate1": "table1", "plate2": "table1", "book1": "desk1", "glass1": "table1",
    "water1": "table1", "keys1": "console1", "smartphone1": "bedstand1", "remote_control1": "coffee_table1",
}  # fmt: skip
"""Where the map of the flat has these things before the day."""
OPENABLE: Final = ("fridge1", "oven1", "wardrobe1", "cabinet1", "door4")
SWITCHED: Final = ("light1", "television1", "lamp1")
_S: Final = 1_000_000_000
_QUIET_S: Final = 2.2


@dataclass(slots=True)
class Happening:
    """One change: `kind` is moved, opened, closed, on, off, added, removed or entered.

    `place` is the new surface or room and `was` the former one. The change was made between the two times
    [ns].
    """

    kind: str
    subject: str
    actor: str
    begun_ns: int
    done_ns: int
    place: str = ""
    was: str = ""

    @property
    def ns(self) -> int:
        """The middle of the two times."""
        return (self.begun_ns + self.done_ns) // 2


@dataclass(slots=True)
class Stay:
    """A time at a place or in a state; `end_ns` is None if it goes on."""

    place: str
    begun_ns: int
    end_ns: int | None
    actor: str = ""


@dataclass(slots=True)
class Record:
    """The day as it happened. `start` and `end` [ns] are its first and last time, `quiet` the pauses."""

    happenings: list[Happening] = field(default_factory=list)
    at_first: dict[str, str] = field(default_factory=dict)
    """The surface or room of each thing and walker, and the state of each device, at the start."""
    quiet: list[tuple[int, int]] = field(default_factory=list)
    start_ns: int = 0
    end_ns: int = 0

    def of(self, subject: str, *kinds: str) -> list[Happening]:
        """Return what happened to a subject, in order."""
        return [h for h in self.happenings if h.subject == subject and (not kinds or h.kind in kinds)]

    def stays(self, subject: str) -> list[Stay]:
        """Return where a subject was or how it was, in order, with times [ns]; the last one may go on."""
        begun_ns = self.start_ns if subject not in THINGS else 0
        found = [Stay(self.at_first[subject], begun_ns, None)] if subject in self.at_first else []
        for h in self.of(subject, "moved", "entered", "open", "closed", "on", "off", "removed"):
            found[-1].end_ns = h.ns
            if h.kind != "removed":
                found.append(Stay(h.place, h.ns, None, h.actor))
        return found


class Day:
    """Lets a day happen, with one client for each actor."""

    def __init__(self, clients: Mapping[str, Client], rng: random.Random) -> None:
        self._clients, self._rng = clients, rng
        self._now: dict[str, str] = {}
        self.record = Record()

    def prepare(self) -> None:
        """Add the persons, the robot and the second cup, and put all things on surfaces."""
        client = self._clients["r2"]
        for name, label in PERSONS.items():
            client.add("Person", name, at=(*ROOMS["livingroom1"], 0.0), ref=label, track="stream")
        client.remove("person1")
        client.add("Robot", ROBOT, at=(*ROOMS["corridor1"], 0.0), track="stream")
        begun_ns = time.time_ns()
        client.add("Cup", "cup2", on="counter1", ref="red cup")
        self._note("added", "cup2", ROBOT, begun_ns, "counter1", "")
        self._now.update(ORIGINAL, cup2="counter1")
        self.record.at_first = dict(self._now)
        for name in THINGS:
            self._move(name, ROBOT)
        for name in OPENABLE:
            client.set(name, "isOpen", "false")
            self._now[name] = "closed"
        for name in SWITCHED:
            client.set(name, "isSwitchedOn", "false")
            self._now[name] = "off"
        for name, room in zip(WALKERS, ("livingroom1", "bedroom1", "corridor1"), strict=True):
            self._publish(name, room)
            self._now[name] = room
        self.rest()
        self.record.at_first |= {name: self._now[name] for name in (*OPENABLE, *SWITCHED, *WALKERS)}
        self.record.start_ns = time.time_ns()

    def run(self, changes: int, most_s: float = 600.0) -> Record:
        """Make a number of changes, with pauses."""
        ends = time.monotonic() + most_s
        while len(self.record.happenings) < changes and time.monotonic() < ends:
            before = len(self.record.happenings)
            self._step()
            if before // 15 < len(self.record.happenings) // 15:
                self.rest()
            time.sleep(0.12)
        self.rest()
        self.record.end_ns = time.time_ns()
        return self.record

    def rest(self) -> None:
        """Let nothing happen for a while; live poses go on."""
        begun_ns = time.time_ns()
        ends = time.monotonic() + _QUIET_S
        while time.monotonic() < ends:
            for name in WALKERS:
                if name in self._now:
                    self._publish(name, self._now[name])
            time.sleep(0.2)
        self.record.quiet.append((begun_ns, time.time_ns()))

    @contextmanager
    def going_on(self) -> Iterator[None]:
        """Publish the live poses as they are, in a thread."""
        is_over = threading.Event()

        def publish() -> None:
            while not is_over.wait(0.3):
                for name in WALKERS:
                    self._publish(name, self._now[name])

        thread = threading.Thread(target=publish)
        thread.start()
        try:
            yield
        finally:
            is_over.set()
            thread.join()

    def _publish(self, name: str, room: str) -> None:
        x, y = ROOMS[room]
        shift = WALKERS.index(name) * 0.4
        self._clients["r2"].publish_pose(name, at=(x + shift, y, 0.0))

    def _step(self) -> None:
        kind = self._rng.choices(("move", "walk", "open", "switch", "remove"), (44, 26, 16, 10, 2))[0]
        actor = self._rng.choice(WALKERS)
        for name in WALKERS:
            self._publish(name, self._now[name])
        match kind:
            case "move":
                self._move(self._rng.choice(THINGS), actor)
            case "walk":
                self._walk(actor)
            case "open":
                self._switch(self._rng.choice(OPENABLE), actor, "isOpen", ("open", "closed"))
            case "switch":
                self._switch(self._rng.choice(SWITCHED), actor, "isSwitchedOn", ("on", "off"))
            case _:
                self._remove(actor)

    def _move(self, name: str, actor: str) -> None:
        was = self._now.get(name)
        if was is None:
            return
        place = self._rng.choice([p for p in SURFACES if p != was])
        if place == "washing_machine1" and THINGS.index(name) % 2:
            return  # half of the things are never in the bathroom
        begun_ns = time.time_ns()
        try:
            self._clients[actor].update(name, on=place)
        except errors.Refused:
            return  # no room there
        self._now[name] = place
        self._note("moved", name, actor, begun_ns, place, was)

    def _walk(self, name: str) -> None:
        was = self._now[name]
        rooms = [r for r in ROOMS if r != was and (r != "bathroom1" or name != ROBOT)]
        room = self._rng.choice(rooms)
        begun_ns = time.time_ns()
        self._now[name] = room
        for _ in range(4):
            self._publish(name, room)
            time.sleep(0.06)
        self._note("entered", name, name, begun_ns, room, was)

    def _switch(self, name: str, actor: str, prop: str, states: tuple[str, str]) -> None:
        is_on = self._now[name] == states[0]
        begun_ns = time.time_ns()
        self._clients[actor].set(name, prop, "false" if is_on else "true")
        was, self._now[name] = self._now[name], states[is_on]
        self._note(self._now[name], name, actor, begun_ns, self._now[name], was)

    def _remove(self, actor: str) -> None:
        there = [name for name in ("plate2", "water1") if name in self._now]
        if not there or len(self.record.happenings) < 60:
            return
        name = self._rng.choice(there)
        begun_ns = time.time_ns()
        self._clients[actor].remove(name)
        self._note("removed", name, actor, begun_ns, "", self._now.pop(name))

    def _note(self, kind: str, subject: str, actor: str, begun_ns: int, place: str, was: str) -> None:
        self.record.happenings.append(
            Happening(kind, subject, ACTORS[actor], begun_ns, time.time_ns(), place, was)
        )
