"""`python -m benchmarks.kb [--sizes 10,100,...] [--quick] [--parts core,disk,...] [--json FILE]`."""

from __future__ import annotations

import argparse
import json
import os
import platform
import signal
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TypeVar

from benchmarks.kb import disk, engine, in_turn, scale, table, university, wire
from benchmarks.relations import fact_costs
from benchmarks.table import Row, lines
from semmap.nodes.kb_node.documents import rdf

PARTS = ("core", "owlrl", "disk", "wire", "sim")
UNIVERSITY = "university"
"""Data of another shape, in the engine alone; measured only on request."""
UNIVERSITY_TRIPLES = (120_000, 1_200_000)
VARIANTS = "variants"
"""The engine with other TBoxes: with a top property, and with `--ontology`."""
IN_TURN = "turns"
"""The version in `--before` and this one, measured in turn."""
LARGE = "scale"
"""A part that is measured only on request: it takes minutes and gigabytes."""
FURTHER = (UNIVERSITY, VARIANTS, IN_TURN, LARGE)
CORE_SIZES, LARGE_SIZES = "10,100,1000,10000,100000", "10000,100000"
T = TypeVar("T")


def arguments() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.kb", description="Speed and memory.")
    parser.add_argument(
        "--sizes",
        nargs="+",
        help=f"entities in the engine alone ({CORE_SIZES}), or in {LARGE} ({LARGE_SIZES})",
    )
    parser.add_argument(
        "--entities", type=int, default=10_000, help="entities in the node, on disk and over Zenoh"
    )
    parser.add_argument("--sim-entities", type=int, default=300, help="entities with bodies in the simulator")
    parser.add_argument("--repeat", type=int, default=1000, help="single changes of each sort")
    parser.add_argument(
        "--parts", default=",".join(PARTS), help=f"parts to measure: {','.join((*PARTS, *FURTHER))}"
    )
    parser.add_argument("--before", type=Path, metavar="DIR", help=f"another version's root, for {IN_TURN}")
    parser.add_argument(
        "--no-relations",
        action="store_true",
        help=f"for {IN_TURN} over Zenoh: with a TBox that does not declare spatial relations",
    )
    parser.add_argument(
        "--ontology", type=Path, help=f"an ontology based on DUL, such as SOMA-HOME.owl, for {VARIANTS}"
    )
    parser.add_argument("--folder", type=Path, help="folder of the journals; default: the temporary folder")
    parser.add_argument("--quick", action="store_true", help="small and rough, not for publication")
    parser.add_argument("--patience", type=int, default=1800, help=f"timeout for each size in {LARGE} [s]")
    parser.add_argument("--json", type=Path, metavar="FILE", dest="json_file")
    words = parser.parse_args()
    words.sizes = ",".join(words.sizes) if words.sizes else None
    if IN_TURN in words.parts.split(",") and words.before is None:
        parser.error(f"{IN_TURN} takes --before DIR: a checkout of another version")
    if words.quick:
        words.sizes, words.entities, words.sim_entities, words.repeat = "10,100,1000", 1000, 30, 100
    return words


def main() -> None:
    """Measure, print the growing table, and write JSON."""
    words = arguments()
    parts = set(words.parts.split(","))
    report: dict[str, Any] = {"machine": platform.platform(), "load_average": os.getloadavg()}
    rows: list[Row] = []
    if parts & {"core", "owlrl"}:
        rows += _core(words, report, with_owlrl="owlrl" in parts)
    if "disk" in parts:
        found = _alone(disk.measure, words.folder, words.entities)
        rows += table.of_disk(found)
        report["disk"] = found._asdict()
    for part, size in (("wire", words.entities), ("sim", words.sim_entities)):
        if part in parts:
            with tempfile.TemporaryDirectory(dir=words.folder) as folder:
                _alone(disk.prepare, Path(folder), size)
                seen = wire.measure(Path(folder), size, sim=part == "sim", repeat=words.repeat)
            rows += table.of_wire(seen)
            report[part] = seen._asdict()
    if UNIVERSITY in parts:
        sizes = UNIVERSITY_TRIPLES[:1] if words.quick else UNIVERSITY_TRIPLES
        universities = [_alone(university.measure, size) for size in sizes]
        rows += table.of_university(universities)
        if (reasonable_s := _alone(university.against_reasonable, sizes[0])) is not None:
            rows.append(table.of_reasonable(universities[0], reasonable_s))
        report[UNIVERSITY] = [found._asdict() for found in universities]
    if VARIANTS in parts:
        rows += _variants(words, report)
    if IN_TURN in parts:
        rows += _in_turn(words, report)
    if LARGE in parts:
        rows += _large(words, report)
    report["rows"] = [{**row._asdict(), "now": row.value, "met": row.met} for row in rows]
    print(lines(rows))
    print("load average: {:.1f} before, {:.1f} now".format(report["load_average"][0], os.getloadavg()[0]))
    if words.json_file:
        words.json_file.write_text(json.dumps(report, indent=1) + "\n")


def _core(words: argparse.Namespace, report: dict[str, Any], *, with_owlrl: bool) -> list[Row]:
    """Measure the engine at each size, a crowded room, and optionally owlrl on a map of 100."""
    engines = [
        _alone(engine.measure, int(size), words.repeat) for size in (words.sizes or CORE_SIZES).split(",")
    ]
    add, remove = _alone(engine.room, words.repeat)
    rows = table.of_engine(engines) + table.of_room(add, remove)
    report["core"] = [e._asdict() for e in engines]
    report["core_add_check"] = [{"entities": e.entities, **e.add} for e in engines]
    report["kb_per_entity"] = engines[-1].kb_per_entity
    report["process_kb_per_entity"] = engines[-1].process_kb_per_entity
    report["room"] = {"add": add, "remove": remove}
    if with_owlrl:
        size = 10 if words.quick else 100
        alike = next((e for e in engines if e.entities == size), None)
        alike = alike or _alone(engine.measure, size, words.repeat)
        figures = _alone(engine.against_owlrl, size, 1)
        rows += table.of_owlrl(figures, alike)
        report["owlrl_add_check"] = [{"entities": size, **figures}]
    return rows


def _variants(words: argparse.Namespace, report: dict[str, Any]) -> list[Row]:
    """The engine with other TBoxes."""
    plain = _alone(engine.adds, words.entities, words.repeat)
    top = _alone(partial(engine.adds, top=True), words.entities, words.repeat)
    foreign = None
    if words.ontology is not None:
        foreign = _alone(partial(engine.adds, ontology=words.ontology), words.entities, words.repeat)
    report[VARIANTS] = {"plain": plain, "top": top, "ontology": foreign}
    return table.of_variants(plain, top, foreign, words.entities)


def _in_turn(words: argparse.Namespace, report: dict[str, Any]) -> list[Row]:
    """Compare with another version."""
    size, count = words.entities, words.repeat
    core = in_turn.core(words.before, size, count)
    with tempfile.TemporaryDirectory(dir=words.folder) as folder:
        tbox = None
        if words.no_relations:
            tbox = Path(folder, "no_relations.nt")
            triples = frozenset(fact_costs.without_relations(fact_costs.household()))
            tbox.write_bytes(rdf.serialise(triples, "ntriples"))
        wired = in_turn.wire(words.before, Path(folder), size, count, tbox)
    rows = table.of_core_in_turn(core, size) + table.of_wire_in_turn(wired, size)
    sizes = UNIVERSITY_TRIPLES[:1] if words.quick else UNIVERSITY_TRIPLES
    universities = {
        triples: in_turn.of_university(words.before, triples, 3 if i == 0 else 1)
        for i, triples in enumerate(sizes)
    }
    rows += [table.of_university_in_turn(pair, triples) for triples, pair in universities.items()]
    report[IN_TURN] = {
        "core": {what: pair._asdict() for what, pair in core.items()},
        "wire": {what: pair._asdict() for what, pair in wired.took.items()},
        "wire_floor": {what: least._asdict() for what, least in wired.floor.items()},
        "wire_cpu": {what: pair._asdict() for what, pair in wired.cpu.items()},
        "university": {triples: pair._asdict() for triples, pair in universities.items()},
    }
    return rows


def _large(words: argparse.Namespace, report: dict[str, Any]) -> list[Row]:
    """Measure whole systems of increasing size."""
    found = []
    for size in map(int, (words.sizes or LARGE_SIZES).split(",")):
        try:
            with tempfile.TemporaryDirectory(dir=words.folder) as folder, _within(words.patience):
                found.append(scale.measure(Path(folder), size))
        except TimeoutError:
            print(f"{size:,} entities were given up after {words.patience} s", flush=True)
    report[LARGE] = [one._asdict() for one in found]
    return table.of_scale(found) if found else []


@contextmanager
def _within(seconds: int) -> Iterator[None]:
    """Raise TimeoutError in this thread after the timeout."""

    def give_up(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def _alone(function: Callable[..., T], *values: Any) -> T:
    """Call `function(*values)` in a new process, for independent memory figures."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return pool.submit(function, *values).result()


if __name__ == "__main__":
    main()
