"""What the SPARQL server says of each robot: which map its graph is a copy of, and as of which commit.

These facts are written in the same operation as the data that they are about, in a graph of their own,
`FACTS`. A robot's IRI is also the name of the graph with its map.
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
"""The vocabulary of these facts, and of poses in the fleet's frame."""
FACTS: Final = "<urn:semmap:fleet>"
TYPE: Final = "<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>"
_XSD: Final = "http://www.w3.org/2001/XMLSchema#"

_ESCAPED: Final = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n", "\r": r"\r"})

Row = Sequence[Term | None]


class Facts(Struct, frozen=True, kw_only=True):
    """Of one robot. While `copying`, its graph is being filled and is no map yet: `commit` is None."""

    robot: str
    map_id: str
    begun: str
    """When the map was begun, ISO 8601."""
    epoch: int
    """1, and one more whenever the robot's history was found to be another than the one that was copied."""
    frame: Frame | None = None
    commit: int | None = None
    digest: str = ""
    stamp: str = ""
    """When the commit was made, ISO 8601."""
    copying: str = ""
    """Who is copying: whatever else they are told, only their writes count."""

    @property
    def triples(self) -> tuple[Triple, ...]:
        """As they are in `FACTS`."""
        return (*self.map_triples, *self.commit_triples)

    @property
    def map_triples(self) -> tuple[Triple, ...]:
        """What a commit does not change."""
        robot = graph(self.robot)
        said = [
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
            said += [(robot, term(f"frame_{name}"), double(value)) for name, value in values.items()]
            said.append((robot, term("poses"), poses_graph(self.robot)))
        return tuple(said)

    @property
    def commit_triples(self) -> tuple[Triple, ...]:
        """What each commit changes."""
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
        """What is there as long as nobody has written since."""
        return next(t for t in self.commit_triples if t[1] in (term("digest"), term("copying")))

    @property
    def tombstone(self) -> tuple[Triple, ...]:
        """What remains of an epoch that has ended."""
        epoch = f"<urn:semmap:robot:{self.robot}:epoch:{self.epoch}>"
        said = [
            (epoch, TYPE, term("Epoch")),
            (epoch, term("of"), graph(self.robot)),
            (epoch, term("number"), integer(self.epoch)),
            (epoch, term("map"), text(self.map_id)),
        ]
        if self.commit is not None:
            said += [
                (epoch, term("commit"), integer(self.commit)),
                (epoch, term("digest"), text(self.digest)),
            ]
        return tuple(said)


def term(word: str) -> Term:
    """A word of the vocabulary."""
    return f"<{FLEET}{word}>"


def graph(robot: str) -> Term:
    """The robot, and the graph with its map."""
    return f"<urn:semmap:robot:{robot}>"


def poses_graph(robot: str) -> Term:
    """The graph with where its entities are in the fleet's frame."""
    return f"<urn:semmap:robot:{robot}:poses>"


def text(value: str) -> Term:
    """As a plain literal."""
    return f'"{value.translate(_ESCAPED)}"'


def integer(value: int) -> Term:
    """As `xsd:integer`."""
    return f'"{value}"^^<{_XSD}integer>'


def double(value: float) -> Term:
    """As `xsd:double`."""
    return f'"{value!r}"^^<{_XSD}double>'


def moment(iso: str) -> Term:
    """As `xsd:dateTime`."""
    return f'"{iso}"^^<{_XSD}dateTime>'


def iso(stamp_ns: int) -> str:
    """A time in nanoseconds since 1970, to the microsecond, UTC."""
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    fraction = f".{nanoseconds // 1000:06d}".rstrip("0").rstrip(".")
    return f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%dT%H:%M:%S}{fraction}Z"


QUERY: Final = f"SELECT ?robot ?p ?o {{ GRAPH {FACTS} {{ ?robot a {term('Robot')} ; ?p ?o }} }}"
"""All facts about robots."""


def read(rows: Iterable[Row]) -> dict[str, Facts]:
    """The answer to `QUERY`, by robot; what is not complete enough to be ours is left out."""
    said: dict[str, dict[str, str]] = {}
    for subject, predicate, value in rows:
        if subject and predicate and value and predicate.startswith(f"<{FLEET}"):
            said.setdefault(subject, {})[predicate[len(FLEET) + 1 : -1]] = _value(value)
    found = {}
    for values in said.values():
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
