"""Metadata of the mirrored robots in the SPARQL server: the map and the commit of each graph.

The metadata is written in the same operation as the data that it describes, to the graph `FACTS`. The IRI of
a robot is also the name of the graph with its map.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import Final

from msgspec import Struct

from semmap.nodes.extern.fleet.frames import Frame
from semmap.schemas.explanations import Term, Triple

FLEET: Final = "http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_fleet#"
"""The vocabulary of the metadata, and of poses in the fleet frame."""
FACTS: Final = "<urn:semmap:fleet>"
TYPE: Final = "<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>"
_XSD: Final = "http://www.w3.org/2001/XMLSchema#"

_ESCAPED: Final = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n", "\r": r"\r"})

Row = Sequence[Term | None]


class Facts(Struct, frozen=True, kw_only=True):
    """The metadata of one robot. While its graph is being filled, `commit` is None and `copying` is set."""

    robot: str
    map_id: str
    begun: str
    """The time when the map was created, ISO 8601."""
    epoch: int
    """1, incremented whenever the history of the robot is not the one that was copied."""
    frame: Frame | None = None
    commit: int | None = None
    digest: str = ""
    stamp: str = ""
    """The time of the commit, ISO 8601."""
    copying: str = ""
    """The id of the current copy; operations of other copies have no effect."""

    @property
    def triples(self) -> tuple[Triple, ...]:
        """The triples in `FACTS`."""
        return (*self.map_triples, *self.commit_triples)

    @property
    def map_triples(self) -> tuple[Triple, ...]:
        """The triples that a commit does not change."""
        robot = graph(self.robot)
        triples = [
            (robot, TYPE, term("Robot")),
            (robot, term("name"), text(self.robot)),
            (robot, term("graph"), robot),
            (robot, term("map"), text(self.map_id)),
            (robot, term("begun"), moment(self.begun)),
            (robot, term("epoch"), integer(self.epoch)),
        ]
        if (frame := self.frame) is not None:
            values = {"x": frame.x, "y": frame.y, "z": frame.z, "yaw": frame.yaw}
            values |= {"cos": math.cos(frame.yaw), "sin": math.sin(frame.yaw)}  # SPARQL 1.1 has neither
            triples += [(robot, term(f"frame_{name}"), double(value)) for name, value in values.items()]
            triples.append((robot, term("poses"), poses_graph(self.robot)))
        return tuple(triples)

    @property
    def commit_triples(self) -> tuple[Triple, ...]:
        """The triples that each commit changes."""
        robot = graph(self.robot)
        if self.commit is None:
            return ((robot, term("copying"), text(self.copying)),)
        return (
            (robot, term("commit"), integer(self.commit)),
            (robot, term("digest"), text(self.digest)),
            (robot, term("stamp"), moment(self.stamp)),
        )

    @property
    def guard(self) -> Triple:
        """The triple that is present unless another operation has written since."""
        return next(t for t in self.commit_triples if t[1] in (term("digest"), term("copying")))

    @property
    def tombstone(self) -> tuple[Triple, ...]:
        """The triples that remain of an epoch that has ended."""
        epoch = f"<urn:semmap:robot:{self.robot}:epoch:{self.epoch}>"
        triples = [
            (epoch, TYPE, term("Epoch")),
            (epoch, term("of"), graph(self.robot)),
            (epoch, term("number"), integer(self.epoch)),
            (epoch, term("map"), text(self.map_id)),
        ]
        if self.commit is not None:
            triples += [
                (epoch, term("commit"), integer(self.commit)),
                (epoch, term("digest"), text(self.digest)),
            ]
        return tuple(triples)


def term(word: str) -> Term:
    """Return a term of the vocabulary."""
    return f"<{FLEET}{word}>"


def graph(robot: str) -> Term:
    """Return the IRI of a robot, which is also the graph with its map."""
    return f"<urn:semmap:robot:{robot}>"


def poses_graph(robot: str) -> Term:
    """Return the graph with the poses of its entities in the fleet frame."""
    return f"<urn:semmap:robot:{robot}:poses>"


def text(value: str) -> Term:
    """Return a plain literal."""
    return f'"{value.translate(_ESCAPED)}"'


def integer(value: int) -> Term:
    """Return an `xsd:integer` literal."""
    return f'"{value}"^^<{_XSD}integer>'


def double(value: float) -> Term:
    """Return an `xsd:double` literal."""
    return f'"{value!r}"^^<{_XSD}double>'


def moment(iso: str) -> Term:
    """Return an `xsd:dateTime` literal."""
    return f'"{iso}"^^<{_XSD}dateTime>'


def iso(stamp_ns: int) -> str:
    """Convert nanoseconds since 1970 to ISO 8601 with microseconds, UTC."""
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    fraction = f".{nanoseconds // 1000:06d}".rstrip("0").rstrip(".")
    return f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%dT%H:%M:%S}{fraction}Z"


QUERY: Final = f"SELECT ?robot ?p ?o {{ GRAPH {FACTS} {{ ?robot a {term('Robot')} ; ?p ?o }} }}"
"""The query for the metadata of all robots."""


def read(rows: Iterable[Row]) -> dict[str, Facts]:
    """Return the result of `QUERY` by robot, without incomplete metadata."""
    by_subject: dict[str, dict[str, str]] = {}
    for subject, predicate, value in rows:
        if subject and predicate and value and predicate.startswith(f"<{FLEET}"):
            by_subject.setdefault(subject, {})[predicate[len(FLEET) + 1 : -1]] = _value(value)
    found = {}
    for values in by_subject.values():
        try:
            facts = _facts(values)
        except (KeyError, ValueError):
            continue
        found[facts.robot] = facts
    return found


def _facts(values: dict[str, str]) -> Facts:
    frame = None
    if "frame_yaw" in values:
        frame = Frame(*(float(values[f"frame_{name}"]) for name in ("x", "y", "z", "yaw")))
    return Facts(
        robot=values["name"],
        map_id=values["map"],
        begun=values["begun"],
        epoch=int(values["epoch"]),
        frame=frame,
        commit=int(values["commit"]) if "commit" in values else None,
        digest=values.get("digest", ""),
        stamp=values.get("stamp", ""),
        copying=values.get("copying", ""),
    )


def _value(literal: Term) -> str:
    return literal.rpartition('"')[0][1:] if literal.startswith('"') else literal
