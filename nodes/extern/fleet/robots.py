"""Joint queries to several robots. Each reply includes the commit that it refers to.

    with robots("arm*") as found:
        for answer in found.list("Cup"):
            print(answer.robot, answer.commit, answer.value)

A robot is a system with a namespace (`semmap up --namespace`). Robots are discovered by their liveliness
tokens. Each one is queried over a separate session in its namespace, like any other system.
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
from semmap.schemas.endpoints import parse_endpoint
from semmap.schemas.entities import Entity
from semmap.schemas.moments import When
from semmap.schemas.relations import Described
from semmap.schemas.replies import SystemStatus
from semmap.schemas.robots import Answer
from semmap.schemas.sparql import SparqlResult

R = TypeVar("R")

ANSWER_S: Final = 10.0
"""The timeout of a status request to a robot [s]."""
_AT_ONCE: Final = 32
_GLOB: Final = re.compile(r"[*?\[]")


class Robots:
    """The robots that match a pattern, by name. Each request is sent to all of them at the same time."""

    def __init__(self, clients: dict[str, Client], missing: Sequence[Answer[Any]]) -> None:
        """Store the clients, and the errors of robots that are `missing`."""
        self.clients = clients
        self._missing = tuple(missing)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the available robots."""
        return tuple(self.clients)

    def each(self, ask: Callable[[Client], tuple[int | None, R]]) -> tuple[Answer[R], ...]:
        """Call `ask(client)` for each robot; it returns a commit and a reply.

        Returns the replies in the order of the names, with the error of each robot that does not respond or
        rejects the request.
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
        """Return the status of each robot."""

        def ask(client: Client) -> tuple[int, SystemStatus]:
            status = client.send(Status(), timeout_s=ANSWER_S)
            return status.commit, status

        return self.each(ask)

    def list(
        self, class_: str | None = None, *, as_of: When | None = None, **where: Any
    ) -> tuple[Answer[tuple[Entity, ...]], ...]:
        """Return the entities of each robot; see `Client.list`."""
        return self.each(
            _read_at_one_commit(lambda client, then: client.list(class_, as_of=then, **where), as_of)
        )

    def get(
        self, name: str, *, where: bool = False, as_of: When | None = None
    ) -> tuple[Answer[Entity | Described], ...]:
        """Return the entity with this name of each robot, or the error UnknownName."""
        return self.each(
            _read_at_one_commit(lambda client, then: client.get(name, where=where, as_of=then), as_of)
        )

    def sparql(self, query: str, **options: Any) -> tuple[Answer[SparqlResult], ...]:
        """Return the rows of each robot; see `Client.sparql`."""

        def ask(client: Client) -> tuple[int, SparqlResult]:
            _current_commit(client)
            result = client.sparql(query, **options)
            return result.seq, result

        return self.each(ask)


def _current_commit(client: Client) -> int:
    """Return the number of the last commit. Raises NoAnswer."""
    return client.send(Status(), timeout_s=ANSWER_S).commit


def _read_at_one_commit(
    ask: Callable[[Client, When | None], R], as_of: When | None
) -> Callable[[Client], tuple[int | None, R]]:
    """Add the commit to a query whose reply does not include it.

    If there was a commit during the query, the query is repeated for the commit before.
    """

    def answer(client: Client) -> tuple[int | None, R]:
        before = _current_commit(client)
        reply = ask(client, as_of)
        if as_of is not None:
            return (as_of if isinstance(as_of, int) and as_of <= before else None), reply
        return before, reply if _current_commit(client) == before else ask(client, before)

    return answer


@contextlib.contextmanager
def robots(
    pattern: str | Sequence[str] = "*",
    where: str | Sequence[str] | None = None,
    *,
    identity_: str | None = None,
    agent: str = "",
) -> Iterator[Robots]:
    """Connect to the robots whose names match `pattern`, which may contain `*`, `?`, `[...]` and commas.

    `where` are their endpoints: by default those in `SEMMAP_CONNECT`, or all systems that this user runs on
    this machine. A name without wildcards that is not found has an error in each reply. Raises NoAnswer if no
    robot is found.
    """
    patterns = split_names(pattern)
    who = identity(identity_)
    missing: list[Answer[Any]] = []
    with contextlib.ExitStack() as stack:
        places: dict[str, str] = {}
        for place in endpoints(where):
            try:
                for name in _discover_robots(place, who):
                    places.setdefault(name, place)
            except errors.NoAnswer as error:
                missing.append(Answer(robot=f"at {place}", error=errors.to_message(error)))
        wanted = sorted(name for name in places if any(fnmatchcase(name, one) for one in patterns))
        for name in patterns:
            if not _GLOB.search(name) and name not in places:
                missing.append(_missing_robot(name, places))
        if not wanted and not missing:
            raise errors.NoAnswer(f"no robot matches {', '.join(patterns)}; {_available(places)}")
        clients = {}
        for name in wanted:
            session = stack.enter_context(open_session(places[name], name, who, mode="client"))
            clients[name] = Client(session, agent=agent, identity=who)
        yield Robots(clients, missing)


def robot_names(where: str | None, identity_: str | None) -> tuple[str, ...]:
    """Return the names of the robots at an endpoint or the default endpoints. Raises NoAnswer, BadFile."""
    who = identity(identity_)
    return tuple(dict.fromkeys(name for place in endpoints(where) for name in _discover_robots(place, who)))


def _discover_robots(place: str, who: Identity | None) -> dict[str, frozenset[str]]:
    """Return the robots at an endpoint. Raises NoAnswer."""
    with open_session(place, "", who, mode="client") as session:
        return bus.find_robots(session)


def endpoints(where: str | Sequence[str] | None) -> tuple[str, ...]:
    """Return the endpoints in `where`, or the default endpoint, or those of all local systems."""
    if where:
        return tuple(map(parse_endpoint, split_names(where)))
    try:
        return (endpoint(),)
    except errors.BadRequest:  # there are several systems: use all of them
        return tuple(dict.fromkeys(system.reachable for system in registry.systems()))


def split_names(text: str | Sequence[str]) -> tuple[str, ...]:
    """Split a comma-separated list of names."""
    names = text.split(",") if isinstance(text, str) else text
    return tuple(name.strip() for name in names if name.strip())


def _missing_robot(name: str, others: Sequence[str] | dict[str, str]) -> Answer[Any]:
    error = errors.NoAnswer(f"robot {name} not found; {_available(others)}")
    return Answer(robot=name, error=errors.to_message(error))


def _available(names: Sequence[str] | dict[str, str]) -> str:
    named = sorted(name for name in names if name)
    if named:
        return f"available robots: {', '.join(named)}"
    return "the system found has no namespace" if "" in names else "no robots found"
