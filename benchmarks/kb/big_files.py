"""Files with very many entities of 14 triples each: Turtle, and the same as a JSON scene."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Pose, Size
from semmap.schemas.explanations import Term

CLASSES = ("Chair", "Bottle", "Book", "Lamp", "Cup")
"""Each class has about a fifth of the things."""
RARE_CLASS = "Fridge"
RARE_EVERY = 100
"""One thing in this many has the rare class instead."""
_PREFIXES = {"": v.ABOX, "dm": v.TBOX, "xsd": v.XSD}


class Thing(NamedTuple):
    """A thing of a generated building; its size [m] is along its own axes."""

    name: str
    class_name: str
    pose: Pose
    size_m: Size
    ref: str


def things(count: int) -> Iterator[Thing]:
    """Yield things on a grid of 1 m that is 1000 wide."""
    random_ = random.Random(count)

    def number(low: float, high: float) -> float:
        return round(random_.uniform(low, high), 3)

    for i in range(count):
        class_name = _class(i)
        at = (i % 1000 + number(0, 1), i // 1000 + number(0, 1), number(0, 2))
        size_m = (number(0.1, 1), number(0.1, 1), number(0.1, 1))
        yield Thing(f"thing{i}", class_name, Pose(position_m=at), size_m, class_name.lower())


def count_of(class_name: str, count: int) -> int:
    """Return how many of `count` things are of a class."""
    return sum(_class(i) == class_name for i in range(count))


def _class(i: int) -> str:
    return RARE_CLASS if i % RARE_EVERY == 0 else CLASSES[i % len(CLASSES)]


def write_turtle(path: Path, count: int) -> None:
    """Write `count` things, one triple per line."""
    with path.open("w") as file:
        file.writelines(f"@prefix {prefix}: <{iri}> .\n" for prefix, iri in _PREFIXES.items())
        for name, class_name, pose, size_m, ref in things(count):
            star = entity_triples.describe(name, v.dm(class_name), pose=pose, size_m=size_m, preferred=ref)
            file.writelines(f"{_short(s)} {_short(p)} {_short(o)} .\n" for s, p, o in star)


def write_json(path: Path, count: int) -> None:
    """Write `count` things as a scene."""
    entities = [
        {"name": name, "class": class_name, "at": pose.position_m, "size": size_m, "ref": ref}
        for name, class_name, pose, size_m, ref in things(count)
    ]
    path.write_text(json.dumps({"entities": entities}))


def _short(term: Term) -> str:
    """Return a term in Turtle with prefixes."""
    if term.startswith('"'):
        text, caret, datatype = term.partition("^^")
        return f"{text}{caret}{_short(datatype)}" if caret else term
    if term == v.RDF_TYPE:
        return "a"
    for prefix, iri in _PREFIXES.items():
        if term.startswith(f"<{iri}"):
            return f"{prefix}:{term[len(iri) + 1 : -1]}"
    return term
