"""The cost of spatial relations as facts: the same map with and without them in the TBox."""

from __future__ import annotations

import gc
import random
import statistics
import tempfile
import time
import tracemalloc
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from benchmarks.kb.made import Cost, cost
from benchmarks.kb.wire import running
from benchmarks.relations.speed import rooms
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.relations.facts.rules import COMPUTED
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.runtime import memory
from semmap.ontology import HOUSEHOLD_TTL, entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Transaction
from semmap.schemas.entities import Vector
from semmap.schemas.explanations import Triple

_CLASSES = {"": "Kitchen", "table": "Table", "cup": "Cup"}


class Kept(NamedTuple):
    """Measure with and without them, on the same rooms."""

    load: Cost
    load_without: Cost
    kb_per_entity: float
    move_ms: float
    move_without_ms: float


def measure(size: int, moves: int) -> Kept:
    """Load entities, restart, and move cups from table to table over Zenoh, in turn."""
    with tempfile.TemporaryDirectory() as folder:
        kept, without = Path(folder, "with"), Path(folder, "without")
        load, load_without = (
            _load(kept, size, household()),
            _load(without, size, without_relations(household())),
        )
        memory = _memory_kb(kept) / size
        with running(kept, "--no-sim") as (one, _), running(without, "--no-sim") as (other, _):
            times: tuple[list[float], list[float]] = [], []
            for name, at in _moves(size, moves):
                for client, taken in zip((one, other), times, strict=True):
                    start = time.perf_counter()
                    client.update(name, at=at)
                    taken.append(1e3 * (time.perf_counter() - start))
    return Kept(load, load_without, memory, *map(statistics.median, times))


def household() -> list[Triple]:
    """The household TBox."""
    return rdf.parse(HOUSEHOLD_TTL.read_bytes(), HOUSEHOLD_TTL.name, label_prefix="t")


def without_relations(tbox: list[Triple]) -> list[Triple]:
    """Return a TBox that does not declare the properties, so that they are not computed."""
    return [triple for triple in tbox if triple[0] not in COMPUTED or triple[1] != v.RDF_TYPE]


def _load(folder: Path, size: int, tbox: list[Triple]) -> Cost:
    folder.mkdir()
    triples = [
        triple
        for e in rooms(size)
        for triple in entity_triples.describe(
            e.name, v.dm(_CLASSES[e.model]), pose=e.pose, size_m=e.size_m, preferred=e.name
        )
    ]
    journal = Journal.create(folder / FILENAME, rdf.serialise(frozenset(tbox), "ntriples"))
    with _open(journal) as semantic_map, memory.uncollected(freeze=True):
        transaction = Transaction(id="rooms", source="file", insert=tuple(triples))
        taken = cost(lambda: semantic_map.commit(transaction))
        semantic_map.checkpoint()
    return taken


def _memory_kb(folder: Path) -> float:
    """Return the memory of solids and facts by Python's count, without the reasoner's edges."""
    with _open(Journal(folder / FILENAME)) as semantic_map:
        gc.collect()
        tracemalloc.start()
        semantic_map.derive_all()
        gc.collect()
        taken, _ = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    return taken / 1024


@contextmanager
def _open(journal: Journal) -> Iterator[SemanticMap]:
    try:
        yield SemanticMap(journal)
    finally:
        journal.close()


def _moves(size: int, count: int) -> Iterator[tuple[str, Vector]]:
    dice = random.Random(4)
    cups = [entity for entity in rooms(size) if entity.model == "cup"]
    for _ in range(count):
        to = dice.choice(cups).pose
        assert to is not None
        yield dice.choice(cups).name, to.position_m
