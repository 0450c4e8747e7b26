"""Several robots asked together, each with the commit that its answer is about.

    with robots("arm*") as found:
        for answer in found.list("Cup"):
            print(answer.robot, answer.commit, answer.value)

A robot is a system with a namespace (`semmap up --namespace`). Which there are their liveliness tokens tell,
and each is asked over a session of its own in its namespace, so that a robot is asked like any other system.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from fnmatch import fnmatchcase
from typing import Any, Final, TypeVar

from semmap.nodes import bus
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.connection import endpoint, identity, open_session
from semmap.nodes.identity import Identity
from semmap.nodes.supervisor import registry
from semmap.schemas import errors
from semmap.schemas.commands import Status
from semmap.schemas.entities import Entity
from semmap.schemas.moments import When
from semmap.schemas.relations import Described
from semmap.schemas.replies import SystemStatus
from semmap.schemas.robots import Answer
from semmap.schemas.sparql import SparqlResult

R = TypeVar("R")

ANSWER_S: Final = 10.0
"""Seconds: a robot that takes longer to say how it is does not answer."""
_AT_ONCE: Final = 32
_GLOB: Final = re.compile(r"[*?\[]")


class Robots:
    """The robots that match a pattern, by name; each question goes to all of them at once."""

    def __init__(self, clients: dict[str, Client], missing: Sequence[Answer[Any]]) -> None:
        """`missing` is said of those that cannot be asked."""
        self.clients = clients
        self._missing = tuple(missing)

    @property
    def names(self) -> tuple[str, ...]:
        """Those that are there."""
        return tuple(self.clients)

    def each(self, ask: Callable[[Client], tuple[int | None, R]]) -> tuple[Answer[R], ...]:
        """What `ask(client)` returns of each robot: the commit that it is about, and the reply.

        In the order of their names; with an error of each that does not answer, or refuses.
        """

        def answer(robot: str) -> Answer[R]:
            try:
                commit, reply = ask(self.clients[robot])
            except errors.SemmapError as error:
                return Answer(robot=robot, error=errors.to_message(error))
            return Answer(robot=robot, commit=commit, reply=reply)

        with ThreadPoolExecutor(_AT_ONCE) as threads:
            answers = list(threads.map(answer, self.clients))
        return tuple(sorted([*answers, *self._missing], key=lambda one: one.robot))

    def status(self) -> tuple[Answer[SystemStatus], ...]:
        """How each of them is."""

        def ask(client: Client) -> tuple[int, SystemStatus]:
            status = client.send(Status(), timeout_s=ANSWER_S)
            return status.commit, status

        return self.each(ask)

    def list(
        self, class_: str | None = None, *, as_of: When | None = None, **where: Any
    ) -> tuple[Answer[tuple[Entity, ...]], ...]:
        """The entities of each; see `Client.list`."""
        return self.each(_at_one_commit(lambda client, then: client.list(class_, as_of=then, **where), as_of))

    def get(
        self, name: str, *, where: bool = False, as_of: When | None = None
    ) -> tuple[Answer[Entity | Described], ...]:
        """The entity of that name of each; UnknownName of those that have none."""
        return self.each(
            _at_one_commit(lambda client, then: client.get(name, where=where, as_of=then), as_of)
        )

    def sparql(self, query: str, **options: Any) -> tuple[Answer[SparqlResult], ...]:
        """The rows of each; see `Client.sparql`."""

        def ask(client: Client) -> tuple[int, SparqlResult]:
            _now(client)
            result = client.sparql(query, **options)
            return result.seq, result

        return self.each(ask)


def _now(client: Client) -> int:
    """The number of its last commit. Raises NoAnswer soon."""
    return client.send(Status(), timeout_s=ANSWER_S).commit


def _at_one_commit(
    ask: Callable[[Client, When | None], R], as_of: When | None
) -> Callable[[Client], tuple[int | None, R]]:
    """Of a question whose reply does not say which commit it is about.

    Where one came meanwhile, it is asked again about the map as it was before.
    """

    def answer(client: Client) -> tuple[int | None, R]:
        before = _now(client)
        reply = ask(client, as_of)
        if as_of is not None:
            return (as_of if isinstance(as_of, int) and as_of <= before else None), reply
        return before, reply if _now(client) == before else ask(client, before)

    return answer


@contextlib.contextmanager
def robots(
    pattern: str | Sequence[str] = "*",
    where: str | Sequence[str] | None = None,
    *,
    identity_: str | None = None,
    agent: str = "",
) -> Iterator[Robots]:
    """The robots whose names match `pattern`: names with `*`, `?` and `[...]`, several separated by commas.

    `where` are the endpoints at which they are reached; by default those of `SEMMAP_CONNECT`, or of all
    systems that this user runs on this machine. Names without wildcards that are not there are answered for
    with an error. Raises NoAnswer when there is no robot at all.
    """
    patterns = words(pattern)
    who = identity(identity_)
    missing: list[Answer[Any]] = []
    with contextlib.ExitStack() as stack:
        places: dict[str, str] = {}
        for place in endpoints(where):
            try:
                for name in _there(place, who):
                    places.setdefault(name, place)
            except errors.NoAnswer as error:
                missing.append(Answer(robot=f"at {place}", error=errors.to_message(error)))
        wanted = sorted(name for name in places if any(fnmatchcase(name, one) for one in patterns))
        for name in patterns:
            if not _GLOB.search(name) and name not in places:
                missing.append(_not_there(name, places))
        if not wanted and not missing:
            raise errors.NoAnswer(f"no robot matches {', '.join(patterns)}; {_which(places)}")
        clients = {}
        for name in wanted:
            session = stack.enter_context(open_session(places[name], name, who, mode="client"))
            clients[name] = Client(session, agent=agent, identity=who)
        yield Robots(clients, missing)


def robots_there(where: str | None, identity_: str | None) -> tuple[str, ...]:
    """The names of the robots that are reached at an endpoint, or at all that could be meant.

    Raises NoAnswer, BadFile.
    """
    who = identity(identity_)
    return tuple(dict.fromkeys(name for place in endpoints(where) for name in _there(place, who)))


def _there(place: str, who: Identity | None) -> dict[str, frozenset[str]]:
    """The robots that are reached at an endpoint. Raises NoAnswer."""
    with open_session(place, "", who, mode="client") as session:
        return bus.find_robots(session)


def endpoints(where: str | Sequence[str] | None) -> tuple[str, ...]:
    """Those that are given, or of the system that is meant, or of all that this user runs here."""
    if where:
        return words(where)
    try:
        return words(endpoint())
    except errors.BadRequest:  # it could be any of several: all of them, then
        return tuple(dict.fromkeys(system.reachable for system in registry.systems()))


def words(text: str | Sequence[str]) -> tuple[str, ...]:
    """Several, separated by commas."""
    said = text.split(",") if isinstance(text, str) else text
    return tuple(word.strip() for word in said if word.strip())


def _not_there(name: str, others: Sequence[str] | dict[str, str]) -> Answer[Any]:
    error = errors.NoAnswer(f"no node of {name} is there; {_which(others)}")
    return Answer(robot=name, error=errors.to_message(error))


def _which(names: Sequence[str] | dict[str, str]) -> str:
    named = sorted(name for name in names if name)
    if named:
        return f"there are: {', '.join(named)}"
    return "a system is there, but it has no namespace" if "" in names else "none is there"
