"""The map with its journal, in one process: bulk load, start-up, listing."""

from __future__ import annotations

import os
import random
import tempfile
from pathlib import Path
from typing import NamedTuple

from benchmarks.kb.made import Cost, Figures, cost, each, entities
from semmap.nodes.kb_node.answers import answers
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.seed import seed
from semmap.ontology import HOUSEHOLD_TTL
from semmap.schemas import codec
from semmap.schemas.commits import Transaction


class Disk(NamedTuple):
    """Figures of a map with its journal in one process."""

    entities: int
    bulk_load: Cost
    """One durable commit of all entities into an empty map."""
    start_up: Cost
    """Loading the journal until the map answers queries, for a later start."""
    list_all: Figures
    """Listing all entities, encoded as messages."""
    sync: Figures
    """A durable write to the disk, for comparison."""


def measure(where: Path | None, size: int) -> Disk:
    """Measure with journals in a new folder in `where`, or in the temporary folder."""
    with tempfile.TemporaryDirectory(dir=where) as folder:
        path = Path(folder)
        bulk_load = prepare(path, size)
        journal = Journal(path / FILENAME)
        maps: list[SemanticMap] = []
        start_up = cost(lambda: maps.append(SemanticMap(journal)))
        list_all = each(range(10), lambda _: codec.encode(answers.find_entities(maps[0], None)))
        journal.close()
        return Disk(size, bulk_load, start_up, list_all, _sync(path / "sync"))


def prepare(folder: Path, size: int, tbox: Path = HOUSEHOLD_TTL) -> Cost:
    """Write a journal of `size` entities to `folder` like a stopped node; return the bulk load time."""
    seed(folder, tbox, None)
    journal = Journal(folder / FILENAME)
    semantic_map = SemanticMap(journal)
    random_ = random.Random(size)
    triples = tuple(triple for star in entities(size, random_) for triple in star)
    transaction = Transaction(id="load", source="file", reason="benchmark", insert=triples)
    load = cost(lambda: semantic_map.commit(transaction))
    semantic_map.checkpoint()
    journal.close()
    return load


def _sync(path: Path) -> Figures:
    with path.open("wb", buffering=0) as file:

        def write(_: int) -> None:
            file.write(bytes(8192))
            os.fdatasync(file.fileno())

        return each(range(200), write)
