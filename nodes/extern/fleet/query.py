"""Queries to the SPARQL server that robots are mirrored to. The result includes the commit of each robot."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import Final

from msgspec import Struct

from semmap.nodes.extern.fleet import facts as f
from semmap.nodes.extern.fleet.facts import FLEET, Facts
from semmap.nodes.extern.fleet.robots import robots as reach
from semmap.nodes.extern.fleet.robots import split_names
from semmap.nodes.extern.fleet.server import SparqlServer
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.sparql import SparqlResult

_TIMES: Final = 3
_PREFIXES: Final = {
    **v.PREFIXES,
    "rdf": "http://www.w3.org/1999/02/22-rdf-syntax-ns#",
    "rdfs": "http://www.w3.org/2000/01/rdf-schema#",
    "fleet": FLEET,
}
_BASE: Final = re.compile(r"^\s*base\s", re.IGNORECASE)


class CopiedRobot(Struct, frozen=True, kw_only=True):
    """A robot in the SPARQL server, as it was when the query was answered."""

    robot: str
    commit: int | None
    """The commit of its graph; None while the graph is being copied."""
    until: int | None = None
    """A later commit, if the graph was updated while the query was answered."""
    digest: str
    map_id: str
    begun: str
    """The time when the map was created."""
    epoch: int
    behind: int | None = None
    """How many commits the robot is ahead; None if it cannot be reached or has another map now."""
    note: str = ""


class FleetAnswer(Struct, frozen=True, kw_only=True):
    """The result of a query across robots, with the maps and commits that it refers to."""

    result: SparqlResult
    robots: tuple[CopiedRobot, ...]


def sparql(
    query: str,
    query_url: str,
    robots: str | Sequence[str] = "*",
    *,
    where: str | Sequence[str] | None = None,
    identity: str | None = None,
    reachable: bool = True,
) -> FleetAnswer:
    """Run a SELECT or ASK query at the server `query_url` across the robots whose names match.

    The default graph of the query is the union of the graphs of these robots; `GRAPH ?robot { ... }` is the
    graph of one robot. The poses of a robot in the fleet frame are in the graph that `fleet:poses` names.
    With `reachable`, the robots at the endpoints `where` are asked for their current commits.

    Raises Refused, BadRequest, and NoAnswer if the server does not respond.
    """
    server, patterns = SparqlServer(query_url), split_names(robots)
    try:
        for _ in range(_TIMES):
            before = _read_matching(server, patterns)
            graphs = [f.graph(name)[1:-1] for name in before]
            poses = [f.poses_graph(name)[1:-1] for name, one in before.items() if one.frame is not None]
            facts = [f.FACTS[1:-1]]
            result = server.query(
                _with_prefixes(query), default=[*graphs, *facts], named=[*graphs, *poses, *facts]
            )
            after = _read_matching(server, patterns)
            if before == after:
                break
    finally:
        server.close()
    if not before:
        raise errors.NoAnswer(
            f"no mirrored robot at {server.url} matches {', '.join(patterns)}; to mirror robots: semmap fleet"
            " mirror"
        )
    ahead = _commits(list(before), where, identity) if reachable else {}
    copied = [
        _robot_state(one, after.get(name, one), ahead.get(name)) for name, one in sorted(before.items())
    ]
    return FleetAnswer(result=result, robots=tuple(copied))


def _read_matching(server: SparqlServer, patterns: Sequence[str]) -> dict[str, Facts]:
    known = f.read(server.query(f.QUERY).rows)
    return {name: one for name, one in known.items() if any(fnmatchcase(name, p) for p in patterns)}


def _robot_state(before: Facts, after: Facts, ahead: int | str | None) -> CopiedRobot:
    note, behind = "", None
    until = after.commit if after.commit != before.commit else None
    if before.commit is None:
        note = "is being copied: its graph is incomplete"
    elif before.epoch != after.epoch:
        note = "started a new map during the query"
    elif isinstance(ahead, int):
        behind = ahead - before.commit
        if behind < 0:
            behind, note = None, "is at an earlier commit than its copy; it may have another map"
    elif ahead is not None:
        note = ahead
    return CopiedRobot(
        robot=before.robot,
        commit=before.commit,
        until=until,
        digest=before.digest,
        map_id=before.map_id,
        begun=before.begun,
        epoch=before.epoch,
        behind=behind,
        note=note,
    )


def _commits(
    names: list[str], where: str | Sequence[str] | None, identity: str | None
) -> dict[str, int | str]:
    """Return the last commit of each robot, or a text if it cannot be reached."""
    found: dict[str, int | str] = dict.fromkeys(names, "cannot be reached")
    with contextlib.suppress(errors.SemmapError), reach(names, where, identity_=identity) as there:
        for answer in there.status():
            if answer.commit is not None:
                found[answer.robot] = answer.commit
    return found


def _with_prefixes(query: str) -> str:
    """Return the query with declarations of the predefined prefixes."""
    if _BASE.match(query):
        return query
    lines = [
        f"PREFIX {prefix}: <{namespace}>"
        for prefix, namespace in _PREFIXES.items()
        if not re.search(rf"\bprefix\s+{re.escape(prefix)}:", query, re.IGNORECASE)
    ]
    return "\n".join([*lines, query])
