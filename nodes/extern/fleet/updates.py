"""SPARQL 1.1 updates for commits. Their operations are idempotent, so requests can be repeated.

The WHERE clause of each operation tests a triple, the guard: the digest of the previous commit, or the id of
the current copy. The last operation of a step replaces the guard. So an operation that is sent twice, too
late, or at the same time as that of another mirror has no effect. This also holds for a server that executes
the operations of a request one by one and is killed in between: the step is repeated.
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
"""The number of triples in one operation of a copy."""


class Change:
    """The combined change of consecutive commits: the deleted and the inserted triples."""

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
        """Return the approximate number of triples."""
        return (
            len(self._deleted) + len(self._inserted) + sum(1 + len(placed) for placed in self._poses.values())
        )

    def operations(self, before: Facts, after: Facts) -> Iterator[str]:
        """Yield the operations of this change, with the metadata `before` and `after` it."""
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
    """Yield the operations that replace the graph of a robot by `whole`.

    `before` is the metadata in the server, `copied` the metadata after the copy. During the copy, the
    metadata has the id of the copy instead of a commit.
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
    """Replace blank nodes by IRIs. A blank node of a robot always has the same IRI."""
    for s, p, o in triples:
        yield (
            _skolem(robot, s) if s.startswith("_:") else s,
            p,
            _skolem(robot, o) if o.startswith("_:") else o,
        )


def pose_triples(entity: Entity, frame: Frame) -> tuple[Triple, ...]:
    """Return the triples with the pose of an entity in the fleet frame, if it has a pose."""
    if entity.pose is None:
        return ()
    pose, iri = frame.pose(entity.pose), v.iri(entity.iri)
    x, y, z = pose.position_m
    triples: list[Triple] = [(iri, f.term("entity"), f.text(entity.name))]
    for name, value in (("x", x), ("y", y), ("z", z), ("yaw", pose.yaw_rad)):
        triples.append((iri, f.term(name), f.double(value)))
    return tuple(triples)


def _skolem(robot: str, label: Term) -> Term:
    return f"<urn:semmap:robot:{robot}:node:{quote(label[2:], safe='')}>"


def _guarded_update(
    before: Facts, *, deleted: dict[Term, Iterable[Triple]], inserted: dict[Term, Iterable[Triple]]
) -> str:
    """Return an operation that has no effect unless the server has the metadata `before`."""
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
