"""A period of the history as an MCAP file, with the topics of `semmap ros`."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import IO, Any, Final, NamedTuple

from mcap.writer import Writer

from semmap.nodes import bus
from semmap.nodes.bus.rmw import RosTopic
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.ros import messages
from semmap.nodes.extern.ros.bridge import Topics
from semmap.nodes.extern.ros.messages import Moment
from semmap.nodes.extern.ros.planning_scene import follow_scene, planning_scene
from semmap.nodes.extern.ros.shapes import ShapeTable
from semmap.nodes.extern.ros.things import Thing, located_things
from semmap.nodes.extern.ros.types import encode, store
from semmap.nodes.runtime.version import version
from semmap.schemas import errors, keys
from semmap.schemas.bridge import Recall
from semmap.schemas.calls import Call, reply_type
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity

_AT_ONCE: Final = 100
_MOST: Final = 10_000
_REPLY_S: Final = 30.0


_QOS: Final = (
    "- history: keep_last\n  depth: {depth}\n  reliability: reliable\n  durability: {durability}\n"
    "  deadline: {forever}\n  lifespan: {forever}\n"
    "  liveliness: automatic\n  liveliness_lease_duration: {forever}\n"
    "  avoid_ros_namespace_conventions: false"
)
"""The quality of service of a topic as `ros2 bag record` writes it, from which `ros2 bag play` publishes."""
_FOREVER: Final = "{sec: 9223372036, nsec: 854775807}"


class State(NamedTuple):
    """The map after a commit, with the time of the commit."""

    commit: int
    stamp_ns: int
    things: dict[str, Thing]


def states(client: Client, since: str | None, until: str | None) -> Iterator[State]:
    """Yield the map before a period, and after each commit in it, in order.

    Raises BadRequest for a period without commits, or with ten thousand or more.
    """
    rows = client.history(since=since, until=until, limit=_MOST)
    if not rows:
        raise errors.BadRequest("the period has no commits; to list commits: semmap history")
    if len(rows) == _MOST:
        raise errors.BadRequest(f"the period has {_MOST:,} commits or more; choose a shorter one")
    return _states(client, [row.seq for row in rows], rows[0].stamp_ns)


def _states(client: Client, seqs: list[int], began_ns: int) -> Iterator[State]:
    first = seqs[0]
    before = client.list(as_of=str(first - 1)) if first > 1 else ()
    entities = {entity.name: entity for entity in before}
    shapes = ShapeTable()
    yield State(first - 1, began_ns, _locate(client, entities, shapes))
    for commit in _fetch_commits(client, seqs):
        if commit.abridged is not None or commit.tbox:
            entities = {entity.name: entity for entity in client.list(as_of=str(commit.seq))}
        else:
            _follow(entities, commit)
        yield State(commit.seq, commit.stamp_ns, _locate(client, entities, shapes))


def _locate(client: Client, entities: Mapping[str, Entity], shapes: ShapeTable) -> dict[str, Thing]:
    for query in shapes.queries(entities.values()):
        shapes.take(query, _ask(client, query))
    return located_things(entities, {}, {}, shapes.of)


def _follow(entities: dict[str, Entity], commit: Commit) -> None:
    for gone in commit.removed:
        entities.pop(gone.name, None)
    for entity in commit.changed:
        entities[entity.name] = entity


def _fetch_commits(client: Client, seqs: list[int]) -> Iterator[Commit]:
    for start in range(0, len(seqs), _AT_ONCE):
        some = tuple(seqs[start : start + _AT_ONCE])
        commits: tuple[Commit, ...] = _ask(client, Recall(seqs=some))
        yield from commits


def _ask(client: Client, call: Call[Any]) -> Any:
    kind = type(call)
    return bus.ask(client.session, keys.BRIDGE, kind.VERB, call, reply_type(kind), timeout_s=_REPLY_S)


def write(path: Path, found: Iterable[State], of: Topics, *, frame: str = "map") -> int:
    """Write states to a new file, and return the number of messages. Raises BadFile.

    The file is created after it is complete, so an interruption leaves none.
    """
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        if path.exists():
            raise errors.BadFile(f"{path} already exists; choose another name")
        with unfinished.open("xb") as file:
            count = _Recording(file, of, frame).fill(found)
            file.flush()
            os.fsync(file.fileno())
        unfinished.replace(path)
        return count
    except OSError as error:
        raise errors.BadFile(f"{path} cannot be written: {error.strerror}") from None
    finally:
        unfinished.unlink(missing_ok=True)


class _Recording:
    def __init__(self, file: IO[bytes], of: Topics, frame: str) -> None:
        self._writer, self._of, self._frame = Writer(file), of, frame
        self._writer.start(profile="ros2", library=f"semmap {version()}")
        self._channels = {made: self._channel(made) for made in of if made is not of.grid}
        self._count = 0

    def _channel(self, made: RosTopic) -> int:
        text, _ = store().generate_msgdef(made.type, ros_version=2)
        schema = self._writer.register_schema(made.type, "ros2msg", text.encode())
        return self._writer.register_channel(
            made.name, "cdr", schema, {"offered_qos_profiles": _offered_qos(made)}
        )

    def fill(self, found: Iterable[State]) -> int:
        before: dict[str, Thing] = {}
        for state in found:
            at = Moment(self._frame, state.stamp_ns)
            things = state.things.values()
            self._add(self._of.detections, messages.detections(things, at), state)
            self._add(self._of.markers, messages.markers(things, at), state)
            self._add(self._of.transforms, messages.transforms(things, at), state)
            if (scene := planning_scene(state.things, before, {}, at)) is not None:
                self._add(self._of.planning_scene, scene, state)
            before = follow_scene(before, state.things)
        self._writer.finish()  # type: ignore[no-untyped-call]
        return self._count

    def _add(self, made: RosTopic, message: Any, state: State) -> None:
        self._count += 1
        self._writer.add_message(
            self._channels[made], state.stamp_ns, encode(message), state.stamp_ns, state.commit
        )


def _offered_qos(made: RosTopic) -> str:
    durability = "transient_local" if made.latched else "volatile"
    return _QOS.format(depth=made.depth, durability=durability, forever=_FOREVER)
