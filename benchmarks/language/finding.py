"""Accuracy and speed of `find` for 150 descriptions of things in a flat and 20 rooms."""

from __future__ import annotations

import functools
import json
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any, Final, NamedTuple

from benchmarks.table import Row
from semmap.nodes.kb_node.answers.entity_search import EntitySearch
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL, entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Find
from semmap.schemas.commits import Transaction
from semmap.schemas.entities import Pose, Size, orientation_from_yaw
from semmap.schemas.explanations import Triple
from semmap.schemas.language import Found

DESCRIPTIONS: Final = Path(__file__).parent / "descriptions.json"
_ENTITIES: Final = 1000


class Tried(NamedTuple):
    """A description, its result, and whether it is correct."""

    number: int
    asked: Mapping[str, Any]
    found: Found | str
    is_right: bool

    @property
    def was_looked_at(self) -> bool:
        """Whether it was inspected during development, as every third was; of the rest only the score was."""
        return self.number % 3 == 0


def tried() -> list[Tried]:
    """Evaluate all descriptions, each in its map."""
    written = json.loads(DESCRIPTIONS.read_text("utf-8"))
    found: list[Tried] = []
    for name, room in written["maps"].items():
        asked = [(i, d) for i, d in enumerate(written["descriptions"]) if d["map"] == name]
        with _map(_flat() if isinstance(room, str) else _room(room)) as there:
            finding = EntitySearch(there)
            found += [_try(finding, index, description) for index, description in asked]
    return sorted(found, key=lambda one: one.number)


def _try(finding: EntitySearch, index: int, asked: Mapping[str, Any]) -> Tried:
    viewer = asked["viewer"]
    query = Find(
        text=asked["text"],
        viewer=viewer if isinstance(viewer, str) else None,
        viewpoint=None if viewer is None or isinstance(viewer, str) else tuple(map(float, viewer)),  # type: ignore[arg-type]
        asker=asked["for"],
    )
    try:
        found = finding.find(query).found
    except errors.SemmapError as error:
        return Tried(index, asked, str(error), False)
    names = {candidate.entity for candidate in found.candidates}
    kind = asked["kind"]
    if kind in ("one", "several"):
        is_right = found.outcome in ("one", "several") and names == set(asked["answers"])
    else:
        is_right = found.outcome == kind and (kind == "none" or names == set(asked["candidates"]))
    return Tried(index, asked, found, is_right)


def rows() -> list[Row]:
    """Return the figures: in total, for seen and unseen ones, by kind, by language; and the duration."""
    all_ = tried()
    found = [_row("find: right of 150", all_, 0.92, 0.98)]
    found.append(
        _row("find: right of those scored before they were read", (t for t in all_ if not t.was_looked_at))
    )
    found.append(_row("find: right of those read while it was written", (t for t in all_ if t.was_looked_at)))
    for kind in ("one", "several", "ambiguous", "none"):
        found.append(_row(f"find: right, {kind}", (t for t in all_ if t.asked["kind"] == kind)))
    for tag, language in (("en", "English"), ("it", "Italian")):
        found.append(_row(f"find: right, {language}", (t for t in all_ if t.asked["language"] == tag)))
    return [*found, Row(f"find: at {_ENTITIES} entities, p50, CPU", milliseconds(), "ms", 5, 2)]


def _row(what: str, some: Iterable[Tried], reach: float | None = None, aim: float | None = None) -> Row:
    right = [one.is_right for one in some]
    return Row(what, sum(right) / len(right), "", reach, aim, more=True)


def milliseconds(entities: int = _ENTITIES) -> float:
    """Return the median duration of all descriptions in one map of so many things [ms]."""
    written = json.loads(DESCRIPTIONS.read_text("utf-8"))
    rooms = [room for room in written["maps"].values() if not isinstance(room, str)]
    asked = [d for d in written["descriptions"] if d["map"] != "flat" and not isinstance(d["viewer"], str)]
    times = []
    with _map(_floors(rooms, entities)) as there:
        finding = EntitySearch(there)
        finding.find(Find(text="the cup"))
        for description in asked:
            viewer = description["viewer"] and tuple(map(float, description["viewer"]))
            query = Find(text=description["text"], viewpoint=viewer)
            begun = time.process_time()
            finding.find(query)
            times.append(1e3 * (time.process_time() - begun))
    return median(times)


def _floors(rooms: list[list[Mapping[str, Any]]], entities: int) -> Iterator[Triple]:
    """Return the rooms side by side, 14 m apart, repeated until there are enough entities."""
    many = ((number, room) for number, room in enumerate(rooms * entities))
    everything = ((number, entity) for number, room in many for entity in room)
    for number, entity in islice(everything, entities):
        yield from _star(entity, f"_{number}", (14.0 * (number % 10), 14.0 * (number // 10)))


def _flat() -> Iterable[Triple]:
    return rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f")


def _room(room: list[Mapping[str, Any]]) -> list[Triple]:
    return [triple for entity in room for triple in _star(entity)]


def _size(said: Sequence[float]) -> Size:
    width, depth, height = map(float, said)
    return width, depth, height


def _star(
    entity: Mapping[str, Any], suffix: str = "", by: tuple[float, float] = (0.0, 0.0)
) -> Iterator[Triple]:
    """Yield the triples of an entity of a room; `suffix` of its name, `by` is the room's offset [m]."""
    x, y, z = entity["at"]
    name = entity["name"] + suffix
    yield from entity_triples.describe(
        name, v.dm(entity["class"]),
        pose=Pose(
            position_m=(float(x) + by[0], float(y) + by[1], float(z)),
            orientation_wxyz=orientation_from_yaw(entity["yaw"]),
        ),
        size_m=_size(entity["size"]),
        preferred=entity["ref"], alternatives=tuple(entity["alt"]),
    )  # fmt: skip
    subject = v.entity_iri(name)
    for property_name, value in entity["properties"].items():
        if isinstance(value, bool):
            yield subject, v.dm(property_name), v.literal(str(value).lower(), v.XSD_BOOLEAN)
        elif value.startswith("dm:"):
            yield subject, v.dm(property_name), v.dm(value.removeprefix("dm:"))
        else:
            yield subject, v.dm(property_name), v.entity_iri(value + suffix)


@functools.cache
def _closure() -> tuple[str, bytes]:
    """Return name and content of the file with the TBox's inferences."""
    with TemporaryDirectory() as folder:
        path = Path(folder)
        journal = Journal.create(path / FILENAME, HOUSEHOLD_TTL.read_bytes())
        SemanticMap(journal)
        journal.close()
        kept = next(path.glob("*.closure"))
        return kept.name, kept.read_bytes()


@contextmanager
def _map(triples: Iterable[Triple]) -> Iterator[SemanticMap]:
    name, closure = _closure()
    with TemporaryDirectory() as folder:
        (Path(folder) / name).write_bytes(closure)
        journal = Journal.create(Path(folder) / FILENAME, HOUSEHOLD_TTL.read_bytes())
        try:
            made = SemanticMap(journal)
            made.commit(Transaction(id="all", source="file", insert=tuple(triples)))
            yield made
        finally:
            journal.close()
