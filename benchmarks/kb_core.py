"""Time and memory of the reasoner alone: `python -m benchmarks.kb_core [--sizes 10,100,...] [--json FILE]`.

Entities have a star of about 20 triples with coordinates of their own, over the household TBox. Times are of
one transaction each, in milliseconds. Memory is what the process grew by, without the caller's own triples.
"""

from __future__ import annotations

import gc
import json
import random
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median, quantiles
from typing import Annotated

import owlrl
import psutil  # type: ignore[import-untyped]
import pyoxigraph
import rdflib
import typer

from nodes.kb_node.reasoner import Inconsistent, Reasoner
from schemas.explanations import Term, Triple

DM = "http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model#"
MAP = "http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_1#"
TBOX = Path(__file__).parents[1] / "ontology" / "household.ttl"
A = "<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>"
FLOAT = "<http://www.w3.org/2001/XMLSchema#float>"
CLASSES = ("Chair", "Table", "Bottle", "Book", "Lamp", "Cup", "Fridge", "Window")
Row = dict[str, float]


def load(path: Path) -> list[Triple]:
    """The triples of a file in any RDF syntax."""
    return [(str(q.subject), str(q.predicate), str(q.object)) for q in pyoxigraph.parse(path=str(path))]


def dm(name: str) -> Term:
    """A class or property of the TBox."""
    return f"<{DM}{name}>"


def individual(name: str) -> Term:
    """An individual of the map."""
    return f"<{MAP}{name}>"


def star(name: str, cls: str, random_: random.Random) -> list[Triple]:
    """The 20 triples of an entity, its references included."""
    entity = individual(name)
    position, size = individual(f"{name}_coordinates"), individual(f"{name}_size")
    preferred, other = (
        individual(f"{name}_preferred_reference"),
        individual(f"{name}_alternative_reference_1"),
    )
    triples = [
        (entity, A, dm(cls)),
        (entity, dm("hasPosition"), position),
        (entity, dm("hasSize"), size),
        (entity, dm("hasPreferredReference"), preferred),
        (entity, dm("hasAlternativeReference"), other),
        (position, A, dm("Coordinates")),
        (size, A, dm("3Three_Dim_Size")),
        (preferred, A, dm("PreferredReference")),
        (preferred, dm("lexicalReference"), f'"{cls.lower()}"'),
        (other, A, dm("AlternativeReference")),
        (other, dm("lexicalReference"), f'"the {cls.lower()}"'),
    ]
    return triples + at(position, "coordinates", random_) + at(size, "size", random_)


def at(node: Term, what: str, random_: random.Random) -> list[Triple]:
    """Three numbers of a position or size."""
    return [
        (node, dm(f"float_{what}_{axis}"), f'"{random_.uniform(-50, 50):.4f}"^^{FLOAT}') for axis in "xyz"
    ]


def entities(count: int, random_: random.Random, prefix: str = "e") -> Iterator[list[Triple]]:
    """So many stars."""
    for i in range(count):
        cls = CLASSES[i % len(CLASSES)]
        yield star(f"{prefix}{cls.lower()}{i}", cls, random_)


def measure(tbox: list[Triple], size: int, repeat: int = 500) -> Row:
    """One row of the table: the map of a size, then single changes to it."""
    random_ = random.Random(size)
    reasoner = Reasoner(tbox)
    gc.collect()
    process = psutil.Process()
    before, started = process.memory_info().rss, time.perf_counter()
    for first in range(0, size, 1000):
        chunk = entities(min(1000, size - first), random_, f"m{first}_")
        reasoner.apply(insert=[triple for star_ in chunk for triple in star_])
    row: Row = {"entities": size, "load_s": time.perf_counter() - started}
    gc.collect()
    row["kb_per_entity"] = (process.memory_info().rss - before) / 1024 / size
    gc.freeze()
    new = list(entities(repeat, random_))
    row |= _timed("add", new, lambda star_: reasoner.apply(insert=star_))
    row |= _timed("move", new, lambda star_: reasoner.apply(**_moved(star_, random_)))
    row |= _timed("refuse", [_kitchen(star_) for star_ in new], lambda star_: _refused(reasoner, star_))
    now = [[*star_[:-6], *_values(reasoner, star_)] for star_ in new]
    row |= _timed("remove", now, lambda star_: reasoner.apply(delete=star_))
    gc.unfreeze()
    return row


def _moved(star_: list[Triple], random_: random.Random) -> dict[str, list[Triple]]:
    position = star_[1][2]
    delete = star_[-6:-3]
    star_[-6:-3] = at(position, "coordinates", random_)
    return {"delete": delete, "insert": star_[-6:-3]}


def _values(reasoner: Reasoner, star_: list[Triple]) -> list[Triple]:
    return [triple for node in (star_[1][2], star_[2][2]) for triple in reasoner.asserted(node)]


def _kitchen(star_: list[Triple]) -> list[Triple]:
    """A new entity that is a kitchen besides."""
    renamed = [(s.replace("#e", "#refused_"), p, o.replace("#e", "#refused_")) for s, p, o in star_]
    return [*renamed, (renamed[0][0], A, dm("Kitchen"))]


def _refused(reasoner: Reasoner, star_: list[Triple]) -> None:
    try:
        reasoner.apply(insert=star_)
    except Inconsistent:
        return
    raise AssertionError("an entity and a kitchen in one was accepted")


def _timed(name: str, items: list[list[Triple]], change: Callable[[list[Triple]], object]) -> Row:
    times = []
    for item in items:
        started = time.perf_counter()
        change(item)
        times.append((time.perf_counter() - started) * 1e3)
    return {f"{name}_p50_ms": median(times), f"{name}_p99_ms": quantiles(times, n=100)[98]}


def room(tbox: list[Triple], parts: int = 10_000, repeat: int = 200) -> Row:
    """A room with many parts: add one, remove it."""
    reasoner = Reasoner(tbox)
    kitchen = individual("kitchen")
    reasoner.apply(insert=[(kitchen, A, dm("Kitchen"))])
    part_of = [(individual(f"part{i}"), dm("isDirectPartOf"), kitchen) for i in range(parts + repeat)]
    reasoner.apply(insert=part_of[:parts])
    new = [[triple] for triple in part_of[parts:]]
    row: Row = {"parts": parts}
    row |= _timed("add", new, lambda item: reasoner.apply(insert=item))
    return row | _timed("remove", new, lambda item: reasoner.apply(delete=item))


def by_owlrl(tbox: list[Triple], size: int = 100) -> Row:
    """What owlrl needs to check one more entity: it closes the whole map."""
    random_ = random.Random(size)
    triples = [*tbox, *(triple for star_ in entities(size + 1, random_) for triple in star_)]
    graph = rdflib.Graph().parse(data="".join(f"{s} {p} {o} .\n" for s, p, o in triples), format="nt")
    started = time.perf_counter()
    owlrl.DeductiveClosure(owlrl.OWLRL_Semantics).expand(graph)
    return {"entities": size, "p50_ms": (time.perf_counter() - started) * 1e3}


def main(
    sizes: str = "10,100,1000,10000,100000",
    tbox: Path = TBOX,
    owlrl_too: Annotated[bool, typer.Option("--owlrl")] = False,
    json_file: Annotated[Path | None, typer.Option("--json")] = None,
) -> None:
    """Print the table."""
    schema = load(tbox)
    rows = []
    for size in map(int, sizes.split(",")):
        rows.append(measure(schema, size))
        print("  ".join(f"{name} {value:.4g}" for name, value in rows[-1].items()), flush=True)
    crowded = room(schema)
    print("a room:  " + "  ".join(f"{name} {value:.4g}" for name, value in crowded.items()))
    report: dict[str, object] = {"core": rows, "room": crowded}
    if owlrl_too:
        report["owlrl_add_check"] = [by_owlrl(schema)]
        print(f"owlrl: {report['owlrl_add_check']}")
    if json_file:
        json_file.write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    typer.run(main)
