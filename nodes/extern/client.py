"""The typed Python client.

    from nodes.extern.client import connect

    with connect() as semmap:
        semmap.add("Beer", "beer1", at=(1.0, 2.0, 0.9), ref="beer")
        for entity in semmap.list("Drinkable"):
            print(entity.name, entity.pose)

Every method sends one command and returns its reply. Positions are metres in the map frame, angles radians,
quaternions `wxyz`. Errors are those of `schemas.errors`: Refused, BadRequest, NoAnswer.
"""

from __future__ import annotations

import contextlib
import functools
import queue
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import zenoh

from nodes import bus
from nodes.extern.connection import endpoint, open_session
from nodes.extern.files import read_file
from nodes.extern.sparql_client import StandingQuery
from schemas import codec, commands, errors, keys, replies
from schemas.commits import Commit
from schemas.entities import ClassInfo, Entity, Quaternion, Size, Source, Vector
from schemas.explanations import Explanation
from schemas.moments import When, with_offset
from schemas.scenes import Picture
from schemas.sparql import SparqlResult

_LONG_S = 700.0


@contextlib.contextmanager
def connect(
    where: str | None = None, *, source: Source = "operator", agent: str = "", namespace: str = ""
) -> Iterator[Client]:
    """A client of the system at `where`. Raises NoAnswer when nothing answers there.

    That is said at once where this machine refuses the connection and no system is starting.
    """
    with open_session(where or endpoint(), namespace) as session:
        yield Client(session, source=source, agent=agent)


class Client:
    """Commands over a session of yours; `source` and `agent` sign what it changes."""

    def __init__(self, session: zenoh.Session, *, source: Source = "operator", agent: str = "") -> None:
        self.session = session
        self._ask = functools.partial(bus.ask, session, keys.CMD, lifelines=bus.Lifelines(session))
        self._signed: dict[str, Any] = {"source": source, "agent": agent}

    def send(self, command: commands.Command, *, kind: Any = None, timeout_s: float = _LONG_S) -> Any:
        """Send any command and return its reply, of the usual type for it or of `kind`."""
        verb = str(command.__struct_config__.tag)
        kind = kind or commands.REPLIES[type(command)]
        return self._ask(verb, command, kind, timeout_s=timeout_s, first_hand=verb in keys.OF_THE_MAP)

    # To change

    def add(
        self,
        class_: str,
        name: str | None = None,
        *,
        at: Vector | None = None,
        yaw: float | None = None,
        orientation: Quaternion | None = None,
        size: Size | None = None,
        ref: str | None = None,
        alt: tuple[str, ...] = (),
        confidence: float | None = None,
        default: bool = False,
        wait: bool = False,
        id: str = "",
    ) -> replies.Changed:
        """Put an entity into the map; see `schemas.commands.Add`."""
        return self._change(
            commands.Add,
            class_=class_,
            name=name,
            at=at,
            yaw=yaw,
            orientation=orientation,
            size=size,
            ref=ref,
            alt=alt,
            confidence=confidence,
            default=default,
            wait=wait,
            id=id,
        )

    def update(
        self,
        name: str,
        *,
        class_: str | None = None,
        at: Vector | None = None,
        yaw: float | None = None,
        orientation: Quaternion | None = None,
        size: Size | None = None,
        ref: str | None = None,
        alt: tuple[str, ...] | None = None,
        conflict: str | None = None,
        confidence: float | None = None,
        wait: bool = False,
        id: str = "",
    ) -> replies.Changed:
        """Change what is given; what is not given stays."""
        return self._change(
            commands.Update,
            name=name,
            class_=class_,
            at=at,
            yaw=yaw,
            orientation=orientation,
            size=size,
            ref=ref,
            alt=alt,
            conflict=conflict,
            confidence=confidence,
            wait=wait,
            id=id,
        )

    def remove(self, *names: str, id: str = "") -> replies.Changed:
        """Take entities out of map and scene: all of them, or, if one is unknown, none."""
        return self._change(commands.Remove, names=names, id=id)

    def clear(self) -> replies.Changed:
        """Take every entity out."""
        return self._change(commands.Clear)

    def load(
        self,
        path: str | Path,
        *,
        replace: bool = False,
        skip_unknown: bool = False,
        tbox: bool = False,
    ) -> replies.Changed:
        """Add what a file describes: an ABox, a JSON scene or a HuRIC map. Raises BadFile.

        With `tbox` it is a TBox that takes the place of the present one.
        """
        content = read_file(Path(path))
        return self._change(
            commands.Load,
            content=content,
            filename=Path(path).name,
            replace=replace,
            skip_unknown=skip_unknown,
            tbox=tbox,
        )

    def undo(self, commit: int | None = None, *, id: str = "") -> replies.Changed:
        """Take back a commit; without one, the newest that a client asked for, with its settling."""
        return self._change(commands.Undo, commit=commit, id=id)

    # To ask

    def list(self, class_: str | None = None, *, as_of: When | None = None) -> tuple[Entity, ...]:
        """The entities of a class, over inferred types; all of them without one.

        `as_of` a commit's number, or a time: seconds since 1970, ISO 8601 or a reply's `stamp_ns`. Those
        after it; a time is as long as it is written (see `schemas.moments.When`).
        """
        command = commands.List(class_=class_, as_of=with_offset(as_of))
        entities: tuple[Entity, ...] = self.send(command, kind=tuple[Entity, ...])
        return entities

    def list_as(
        self, format: Literal["lu4r", "legacy"], class_: str | None = None, *, as_of: When | None = None
    ) -> dict[str, Any]:
        """The entity list in the format of another system."""
        document: dict[str, Any] = self.send(
            commands.List(class_=class_, format=format, as_of=with_offset(as_of))
        )
        return document

    def get(self, name: str, *, as_of: When | None = None) -> Entity:
        """One entity, or as it was then. Raises UnknownName."""
        entity: Entity = self.send(commands.Get(name=name, as_of=with_offset(as_of)))
        return entity

    def check(self, engine: Literal["semmap", "owlrl"] = "semmap") -> replies.Checked:
        """Is the map consistent, and if not, why?"""
        checked: replies.Checked = self.send(commands.Check(engine=engine))
        return checked

    def infer(self, name: str | None = None) -> replies.Inferred:
        """What follows that was not said."""
        inferred: replies.Inferred = self.send(commands.Infer(name=name))
        return inferred

    def explain(self, name: str, predicate: str, value: str) -> Explanation:
        """Why a triple holds. Raises Refused when it does not."""
        question = commands.Explain(name=name, predicate=predicate, value=value)
        explanation: Explanation = self.send(question)
        return explanation

    def export(self, format: commands.RdfFormat = "rdfxml", *, inferred: bool = False) -> replies.Document:
        """The map as a document, checked first."""
        document: replies.Document = self.send(commands.Export(format=format, inferred=inferred))
        return document

    def classes(self) -> tuple[ClassInfo, ...]:
        """The classes of the TBox, with the number of entities of each."""
        classes: tuple[ClassInfo, ...] = self.send(commands.Classes())
        return classes

    def status(self, *, timeout_s: float = _LONG_S) -> replies.SystemStatus:
        """The nodes and the map. Raises NoAnswer when the coordinator has no time for it that long."""
        status: replies.SystemStatus = self.send(commands.Status(), timeout_s=timeout_s)
        return status

    def history(
        self,
        name: str | None = None,
        *,
        since: When | None = None,
        until: When | None = None,
        limit: int = 100,
    ) -> tuple[replies.LoggedCommit, ...]:
        """The newest commits in a span of time, or those that touched an entity; newest last."""
        span = {"since": with_offset(since), "until": with_offset(until)}
        query = codec.convert({"name": name, **span, "limit": limit}, commands.History)
        commits: tuple[replies.LoggedCommit, ...] = self.send(query)
        return commits

    def last_seen(self, name: str) -> replies.Sighting:
        """When, where and by whom an entity was last seen or put, even if it is no more."""
        sighting: replies.Sighting = self.send(commands.LastSeen(name=name))
        return sighting

    # To query

    def sparql(
        self, query: str, *, inferred: bool = False, timeout: float = 5.0, limit: int = 10_000
    ) -> SparqlResult:
        """A SPARQL 1.1 query that reads; `inferred`: over what follows, too. Raises BadRequest, Refused."""
        fields = {"query": query, "inferred": inferred, "timeout": timeout, "limit": limit}
        result: SparqlResult = self.send(codec.convert(fields, commands.Sparql))
        return result

    @contextlib.contextmanager
    def watch(self, query: str, *, inferred: bool = False) -> Iterator[StandingQuery]:
        """`with client.watch(select) as standing: ...`: its rows, and in `standing.changes()` the news."""
        standing = StandingQuery(self.session, self._ask, query, inferred)
        try:
            yield standing
        finally:
            standing.close()

    # To run

    def move(self, name: str, at: Vector, yaw: float | None = None) -> replies.Moved:
        """Take the body and put it elsewhere, as a hand would; the map follows when it rests."""
        command = codec.convert(
            {"name": name, "at": _plain(at), "yaw": _plain(yaw), **self._signed}, commands.Move
        )
        moved: replies.Moved = self.send(command)
        return moved

    def pause(self, *, off: bool = False) -> replies.Done:
        """Stop simulated time, or with `off` let it run again."""
        done: replies.Done = self.send(commands.Pause(off=off))
        return done

    def step(self, seconds: float = 0.1) -> replies.Done:
        """Let paused time go on for so long, 60 s at most. Raises Refused while it runs by itself."""
        done: replies.Done = self.send(codec.convert({"seconds": _plain(seconds)}, commands.StepOnce))
        return done

    def reset(self) -> replies.Done:
        """Put every body back where the map says it stands."""
        done: replies.Done = self.send(commands.Reset())
        return done

    def picture(self, camera: str | None = None, *, width: int = 960, height: int = 720) -> bytes:
        """A picture of the scene as PNG, from one of the world's cameras or from above."""
        command = commands.TakePicture(camera=camera, width=width, height=height)
        picture: Picture = self.send(command)
        return picture.png

    # To watch

    @contextlib.contextmanager
    def commits(self, *, timeout: float | None = None) -> Iterator[Iterator[Commit]]:
        """`with client.commits() as commits: for commit in commits: ...`: every commit from now on.

        The next one is waited for without end, or for `timeout` seconds, which then raises NoAnswer.

        A late subscriber is sent some of the past, too (that is how nothing is lost); it is passed over.
        """
        events: queue.SimpleQueue[Commit] = queue.SimpleQueue()
        subscriber = bus.follow(self.session, keys.COMMIT, lambda _, commit: events.put(commit))
        try:
            now = self.status().commit
            yield (commit for commit in _each(events, timeout) if commit.seq > now)
        finally:
            subscriber.undeclare()

    def _change(self, kind: type[commands.Command], **fields: Any) -> replies.Changed:
        command = codec.convert({**_given(kind, fields), **self._signed}, kind)
        changed: replies.Changed = self.send(command)
        return changed


def _each(events: queue.SimpleQueue[Commit], timeout_s: float | None) -> Iterator[Commit]:
    while True:
        try:
            yield events.get(timeout=timeout_s)
        except queue.Empty:
            raise errors.NoAnswer(f"no commit came within {timeout_s:g} s") from None


def _given(kind: type[commands.Command], fields: dict[str, Any]) -> dict[str, Any]:
    """The fields that were given, by their names on the wire, where `convert` checks them."""
    given = {name: _plain(value) for name, value in fields.items() if value is not None}
    if "class_" in given:
        given["class"] = given.pop("class_")
    return given


def _plain(value: Any) -> Any:
    """Numbers and arrays of NumPy as Python's own."""
    if isinstance(value, (tuple, list)):
        return tuple(map(_plain, value))
    return value.tolist() if hasattr(value, "tolist") else value
