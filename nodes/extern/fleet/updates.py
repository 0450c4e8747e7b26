"""What commits mean to a SPARQL 1.1 server: operations that take effect once, whatever becomes of a request.

Each operation names in its WHERE clause the fact that it rests on (the digest of the commit before it, or who
is copying); the one that completes a step replaces that fact as it writes. Sent twice, late, or beside
another mirror's, it does nothing. So it also is where a server carries out the operations of a request one by
one and is killed between two of them: what was done is done again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final
from urllib.parse import quote

from msgspec import structs

from semmap.nodes.extern.fleet import facts as f
from semmap.nodes.extern.fleet.facts import FACTS, Facts
from semmap.nodes.extern.fleet.frames import Frame
from semmap.ontology import vocabulary as v
from semmap.schemas.bridge import MapCopy
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Term, Triple

CHUNK: Final = 10_000
"""Triples in one operation of a copy."""


class Change:
    """The sum of commits that follow one another: what is gone in the end, and what has come."""

    def __init__(self, robot: str, frame: Frame | None) -> None:
        self._robot, self._frame = robot, frame
        self._deleted: dict[Triple, None] = {}
        self._inserted: dict[Triple, None] = {}
        self._poses: dict[str, tuple[Triple, ...]] = {}

    def take(self, commit: Commit) -> None:
        """Add the next commit."""
        for triple in skolemize(self._robot, commit.retracted):
            self._inserted.pop(triple, None)
            self._deleted[triple] = None
        for triple in skolemize(self._robot, commit.inserted):
            self._deleted.pop(triple, None)
            self._inserted[triple] = None
        if self._frame is not None:
            for departed in commit.removed:
                self._poses[departed.name] = ()
            for entity in commit.changed:
                self._poses[entity.name] = pose_triples(entity, self._frame)

    def __len__(self) -> int:
        """About how many triples it is."""
        return (
            len(self._deleted) + len(self._inserted) + sum(1 + len(placed) for placed in self._poses.values())
        )

    def operations(self, before: Facts, after: Facts) -> Iterator[str]:
        """From the facts as they are in the server to what they are to be with this change."""
        poses = f.poses_graph(self._robot)
        if self._poses:
            names = " ".join(map(f.text, self._poses))
            where = f"GRAPH {poses} {{ ?s {f.term('entity')} ?n ; ?p ?o . VALUES ?n {{ {names} }} }}"
            yield (
                f"DELETE {{ GRAPH {poses} {{ ?s ?p ?o }} }}"
                f" WHERE {{ GRAPH {FACTS} {{ {_pattern(before.guard)} }} {where} }}"
            )
        placed = [triple for triples in self._poses.values() for triple in triples]
        yield _guarded_update(
            before,
            deleted={f.graph(self._robot): self._deleted, FACTS: before.commit_triples},
            inserted={f.graph(self._robot): self._inserted, poses: placed, FACTS: after.commit_triples},
        )


def copy_operations(before: Facts | None, copied: Facts, whole: MapCopy) -> Iterator[str]:
    """The operations by which a robot's graph becomes `whole`, whatever it has been.

    `before` are the facts as they are in the server. `copied` are those to be in the end; meanwhile they say
    that it is being copied.
    """
    robot, name = f.graph(copied.robot), copied.robot
    begun = structs.replace(copied, commit=None)
    if before is None:
        yield (
            f"INSERT {{ {_graph_block(FACTS, begun.triples)} }}"
            f" WHERE {{ FILTER NOT EXISTS {{ GRAPH {FACTS} {{ {robot} ?p ?o }} }} }}"
        )
    else:
        kept = before.tombstone if before.epoch != copied.epoch else ()
        yield (
            f"DELETE {{ GRAPH {FACTS} {{ {robot} ?p ?o }} }}"
            f" INSERT {{ {_graph_block(FACTS, [*begun.triples, *kept])} }}"
            f" WHERE {{ GRAPH {FACTS} {{ {_pattern(before.guard)} {robot} ?p ?o }} }}"
        )
    guard = f"GRAPH {FACTS} {{ {_pattern(begun.guard)} }}"
    for graph in (robot, f.poses_graph(name)):
        yield (f"DELETE {{ GRAPH {graph} {{ ?s ?p ?o }} }} WHERE {{ {guard} GRAPH {graph} {{ ?s ?p ?o }} }}")
    for chunk in _chunks(list(skolemize(name, whole.triples))):
        yield f"INSERT {{ {_graph_block(robot, chunk)} }} WHERE {{ {guard} }}"
    if copied.frame is not None:
        placed = [t for entity in whole.entities for t in pose_triples(entity, copied.frame)]
        for chunk in _chunks(placed):
            yield f"INSERT {{ {_graph_block(f.poses_graph(name), chunk)} }} WHERE {{ {guard} }}"
    yield _guarded_update(
        begun, deleted={FACTS: begun.commit_triples}, inserted={FACTS: copied.commit_triples}
    )


def skolemize(robot: str, triples: Iterable[Triple]) -> Iterator[Triple]:
    """The triples with an IRI for each blank node: one that the same node of the same robot always has."""
    for s, p, o in triples:
        yield (
            _skolem(robot, s) if s.startswith("_:") else s,
            p,
            _skolem(robot, o) if o.startswith("_:") else o,
        )


def pose_triples(entity: Entity, frame: Frame) -> tuple[Triple, ...]:
    """Where an entity is in the fleet's frame; nothing of one that is nowhere."""
    if entity.pose is None:
        return ()
    pose, iri = frame.pose(entity.pose), v.iri(entity.iri)
    x, y, z = pose.position_m
    said: list[Triple] = [(iri, f.term("entity"), f.text(entity.name))]
    for word, value in (("x", x), ("y", y), ("z", z), ("yaw", pose.yaw_rad)):
        said.append((iri, f.term(word), f.double(value)))
    return tuple(said)


def _skolem(robot: str, label: Term) -> Term:
    return f"<urn:semmap:robot:{robot}:node:{quote(label[2:], safe='')}>"


def _guarded_update(
    before: Facts, *, deleted: dict[Term, Iterable[Triple]], inserted: dict[Term, Iterable[Triple]]
) -> str:
    """One operation, which does nothing unless the server is as it was `before`."""
    delete = " ".join(_graph_block(graph, triples) for graph, triples in deleted.items() if triples)
    insert = " ".join(_graph_block(graph, triples) for graph, triples in inserted.items() if triples)
    guard = f"GRAPH {FACTS} {{ {_pattern(before.guard)} }}"
    return f"DELETE {{ {delete} }} INSERT {{ {insert} }} WHERE {{ {guard} }}"


def _graph_block(graph: Term, triples: Iterable[Triple]) -> str:
    return f"GRAPH {graph} {{ {' '.join(map(_pattern, triples))} }}"


def _pattern(triple: Triple) -> str:
    return f"{triple[0]} {triple[1]} {triple[2]} ."


def _chunks(triples: Sequence[Triple]) -> Iterator[Sequence[Triple]]:
    for start in range(0, len(triples), CHUNK):
        yield triples[start : start + CHUNK]
