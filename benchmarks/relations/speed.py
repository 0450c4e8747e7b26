"""Duration of computing relations: from scratch, and after one move."""

from __future__ import annotations

import random
import statistics
import time

from msgspec import structs

from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas.entities import Entity, Pose, Provenance, Size, Vector

_NOBODY = Provenance(commit=1, stamp_ns=0, source="file")
_ROOM = 50
_TABLES = 7


def rooms(entities: int) -> list[Entity]:
    """Rooms of 50: tables with cups on them."""
    dice = random.Random(1)
    made: list[Entity] = []
    for room in range(entities // _ROOM):
        x, y = 7.0 * (room % 100), 7.0 * (room // 100)
        made.append(_entity(f"room{room}", "", (x, y, 0.0), (6.0, 6.0, 2.5)))
        tables = [(x - 2.0 + 2.0 * (k % 3), y - 2.0 + 2.0 * (k // 3)) for k in range(_TABLES)]
        made += [_entity(f"table{room}_{k}", "table", (*at, 0.0)) for k, at in enumerate(tables)]
        for k in range(_ROOM - 1 - _TABLES):
            tx, ty = tables[k % _TABLES]
            at = (tx + dice.uniform(-0.4, 0.4), ty + dice.uniform(-0.3, 0.3), 0.75)
            made.append(_entity(f"cup{room}_{k}", "cup", at))
    return made


def _entity(name: str, model: str, at: Vector, size: Size | None = None) -> Entity:
    return Entity(
        name=name, class_=model, iri=f"urn:{name}", types=(), pose=Pose(position_m=at), place=not model,
        size_m=size or own_size_m(model), model=model, provenance=_NOBODY, pose_provenance=_NOBODY,
        shape_provenance=_NOBODY, reference_provenance=_NOBODY,
    )  # fmt: skip


def move_ms(entities: int, moves: int = 500) -> float:
    """Return the median time to update the relations after a cup is moved to another table [ms]."""
    facts, there = Facts(), rooms(entities)
    facts.update(there)
    dice = random.Random(2)
    cups = [entity for entity in there if entity.model == "cup"]
    times = []
    for _ in range(moves):
        to = dice.choice(cups).pose
        moved = structs.replace(dice.choice(cups), pose=to)
        start = time.perf_counter()
        facts.update([moved])
        times.append(time.perf_counter() - start)
    return 1e3 * statistics.median(times)


def from_nothing_ms(entities: int, times: int = 20) -> float:
    """Return the median time to compute all relations of so many entities [ms]."""
    there = rooms(entities)
    taken = []
    for _ in range(times):
        start = time.perf_counter()
        Facts().update(there)
        taken.append(time.perf_counter() - start)
    return 1e3 * statistics.median(taken)
