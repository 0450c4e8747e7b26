"""The map with its journal, in one process: bulk load, start-up, listing."""

from __future__ import annotations

import random
import tempfile
from pathlib import Path

from benchmarks.kb.made import Figures, each, entities, timed
from nodes.kb_node import answers
from nodes.kb_node.journal import FILENAME, Journal
from nodes.kb_node.seed import seed
from nodes.kb_node.semantic_map import SemanticMap
from ontology import HOUSEHOLD_TTL
from schemas import codec
from schemas.commits import Transaction


def bulk_load(size: int) -> float:
    """One durable commit of `size` entities into an empty map [s]."""
    with tempfile.TemporaryDirectory() as folder:
        seed(Path(folder), HOUSEHOLD_TTL, None)
        journal = Journal(Path(folder) / FILENAME)
        semantic_map = _opened(journal)
        transaction = _load(size)
        took_s = timed(lambda: semantic_map.commit(transaction))
        journal.close()
        return took_s


def start_up(folder: Path) -> tuple[float, Figures]:
    """From the journal's file to a map that answers [s]; then listing all of it, encoded, in a warm node."""
    journal = Journal(folder / FILENAME)
    maps: list[SemanticMap] = []
    took_s = timed(lambda: maps.append(_opened(journal)))
    listing = each(range(10), lambda _: codec.encode(answers.entities_of(maps[0], None)))
    journal.close()
    return took_s, listing


def prepare(folder: Path, size: int, *, checkpoint: bool = True) -> None:
    """A journal of `size` entities in `folder`, as a node leaves it that was stopped (or, without, killed)."""
    seed(folder, HOUSEHOLD_TTL, None)
    journal = Journal(folder / FILENAME)
    semantic_map = _opened(journal)
    semantic_map.commit(_load(size))
    if checkpoint:
        semantic_map.checkpoint()
    journal.close()


def _opened(journal: Journal) -> SemanticMap:
    return SemanticMap(journal)


def _load(size: int) -> Transaction:
    random_ = random.Random(size)
    triples = tuple(triple for star in entities(size, random_) for triple in star)
    return Transaction(id="load", source="file", reason="benchmark", insert=triples)
