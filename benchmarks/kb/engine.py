"""The reasoner alone: single changes at several sizes, memory, a crowded room; compared with owlrl."""

from __future__ import annotations

import gc
import random
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import count
from pathlib import Path
from typing import NamedTuple

import owlrl
import psutil
import rdflib

from benchmarks.kb.made import Figures, each, entities, pose, tbox, timed
from semmap.nodes.kb_node.documents import ontology_files
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

_CHUNK = 1000
_PARTS = 10_000
_TOP: Triple = (v.iri(f"{v.OWL}topObjectProperty"), v.RDF_TYPE, v.OWL_OBJECT_PROPERTY)
_ARTEFACT = "<http://www.ontologydesignpatterns.org/ont/dul/DUL.owl#DesignedArtifact>"
_OF_CLASSES = 16


class Engine(NamedTuple):
    """Figures of one size. Memory is resident memory per entity: of the map, and of the whole process."""

    entities: int
    load_s: float
    add: Figures
    move: Figures
    refuse: Figures
    remove: Figures
    kb_per_entity: float
    process_kb_per_entity: float


def measure(size: int, repeat: int) -> Engine:
    """Measure `repeat` changes of each sort on a map of `size` entities. Run it in a separate process."""
    random_ = random.Random(size)
    reasoner = Reasoner(tbox())
    gc.collect()
    before, load_s = _resident_kb(), 0.0
    for first in range(0, size, _CHUNK):
        chunk = entities(min(_CHUNK, size - first), random_, f"m{first}_")
        triples = [triple for star in chunk for triple in star]
        load_s += timed(lambda triples=triples: reasoner.apply(insert=triples))  # type: ignore[misc]
    del triples
    gc.collect()
    after = _resident_kb()
    gc.freeze()
    new = list(entities(repeat, random_))
    add = each(new, lambda star: reasoner.apply(insert=star))
    moves = [_position(star, random_) for star in new]
    move = each(moves, lambda change: reasoner.apply(delete=change[0], insert=change[1]))
    refuse = each(
        [_kitchen(star) for star in entities(repeat, random_, "r")], lambda s: _refused(reasoner, s)
    )
    gone = [[t for t in star if t not in old] + now for star, (old, now) in zip(new, moves, strict=True)]
    remove = each(gone, lambda star: reasoner.apply(delete=star))
    return Engine(size, load_s, add, move, refuse, remove, (after - before) / size, after / size)


def adds(size: int, repeat: int, *, top: bool = False, ontology: Path | None = None) -> Figures:
    """Measure single adds to a map of `size` entities. Run it in a separate process.

    The entities are household objects, optionally with a `top` property in the TBox, or artefacts of an
    `ontology` based on DUL.
    """
    random_, prefixes = random.Random(size), count()
    if ontology is None:
        reasoner = Reasoner([*tbox(), *([_TOP] if top else [])])
        make = partial(entities, random_=random_)
    else:
        reasoner = Reasoner(ontology_files.gather([ontology], {}).triples)
        classes = random_.sample(sorted(reasoner.subclasses(_ARTEFACT)), _OF_CLASSES)
        make = partial(_artefacts, random_=random_, classes=classes)
    for first in range(0, size, _CHUNK):
        chunk = make(min(_CHUNK, size - first), prefix=f"m{next(prefixes)}_")
        reasoner.apply(insert=[triple for star in chunk for triple in star])
    gc.collect()
    gc.freeze()
    each(list(make(_CHUNK, prefix="w")), lambda star: reasoner.apply(insert=star))
    return each(list(make(repeat, prefix="n")), lambda star: reasoner.apply(insert=star))


def _artefacts(
    wanted: int, random_: random.Random, classes: Sequence[Term], prefix: str
) -> Iterator[list[Triple]]:
    for i in range(wanted):
        yield entity_triples.describe(
            f"{prefix}{i}",
            classes[i % len(classes)],
            pose=pose(random_),
            size_m=(0.5, 0.5, 0.5),
            preferred="thing",
            alternatives=("a thing",),
        )


def room(repeat: int) -> tuple[Figures, Figures]:
    """Measure adding and removing one of 10 000 parts of a kitchen."""
    reasoner = Reasoner(tbox())
    kitchen = v.entity_iri("kitchen")
    reasoner.apply(insert=[(kitchen, v.RDF_TYPE, v.dm("Kitchen"))])
    part_of = [(v.entity_iri(f"part{i}"), v.dm("isDirectPartOf"), kitchen) for i in range(_PARTS + repeat)]
    reasoner.apply(insert=part_of[:_PARTS])
    gc.freeze()
    new = [[triple] for triple in part_of[_PARTS:]]
    return (
        each(new, lambda part: reasoner.apply(insert=part)),
        each(new, lambda part: reasoner.apply(delete=part)),
    )


def against_owlrl(size: int, repeat: int) -> Figures:
    """Measure owlrl's closure of a map of `size` entities and one more, and its list of contradictions."""
    random_ = random.Random(size)
    stars_ = list(entities(size + repeat, random_))
    known = [*tbox(), *(t for star in stars_[:size] for t in star)]
    graphs = [_graph([*known, *star]) for star in stars_[size:]]
    return each(graphs, lambda graph: owlrl.DeductiveClosure(owlrl.OWLRL_Semantics).expand(graph))


def _graph(triples: list[Triple]) -> rdflib.Graph:
    lines = "".join(f"{s} {p} {o} .\n" for s, p, o in triples)
    return rdflib.Graph().parse(data=lines, format="nt")


def _position(star: list[Triple], random_: random.Random) -> tuple[list[Triple], list[Triple]]:
    """Return the triples to retract and to insert when an entity moves."""
    coordinates = next(o for _, p, o in star if p == v.HAS_POSITION)
    old = [t for t in star if t[0] == coordinates and t[1] in v.COORDINATE_XYZ]
    new = entity_triples.position(star[0][0], coordinates, pose(random_))
    return old, [t for t in new if t[1] in v.COORDINATE_XYZ]


def _kitchen(star: list[Triple]) -> list[Triple]:
    """Return an entity that is also a kitchen."""
    return [*star, (star[0][0], v.RDF_TYPE, v.dm("Kitchen"))]


def _refused(reasoner: Reasoner, star: list[Triple]) -> None:
    try:
        reasoner.apply(insert=star)
    except Inconsistent:
        return
    raise AssertionError("an entity and a kitchen in one was accepted")


def _resident_kb() -> float:
    return float(psutil.Process().memory_info().rss) / 1024
