"""Accuracy of relations compared with contact forces, sampled points and manual annotations."""

from __future__ import annotations

import random
from collections.abc import Iterable
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.relations.settled import settled_scene
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.entities import entity_reading
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.relations.facts.contradictions import PROPERTIES, fact_of
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.geometry.solids import Solid, solid_of
from semmap.nodes.kb_node.relations.measuring import containment, proximity
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.ontology.model_shapes import Interior, shapes
from semmap.schemas.entities import Entity, Pose, Provenance

_NOBODY = Provenance(commit=1, stamp_ns=0, source="file")
_SAMPLES = 4000
FLAT_BY_HAND = Path(__file__).with_name("flat_by_hand.ttl")
"""The manually annotated relations of the flat."""
_ROOM = Entity(
    name="room", class_="", iri="urn:room", types=(), pose=Pose(position_m=(2.0, 0.0, 0.0)), place=True,
    size_m=(20.0, 20.0, 3.0), provenance=_NOBODY, pose_provenance=_NOBODY, shape_provenance=_NOBODY,
    reference_provenance=_NOBODY,
)  # fmt: skip


class Counts(NamedTuple):
    """Counts of true positives, false positives and false negatives."""

    right: int
    extra: int
    missing: int

    @property
    def f1(self) -> float:
        """The harmonic mean of precision and recall."""
        return 2 * self.right / max(1, 2 * self.right + self.extra + self.missing)

    @classmethod
    def of(cls, found: set[tuple[str, str]], true: set[tuple[str, str]]) -> Counts:
        """Compare two sets of pairs."""
        return cls(len(found & true), len(found - true), len(true - found))

    @classmethod
    def together(cls, counts: Iterable[Counts]) -> Counts:
        """The sums."""
        return cls(*map(sum, zip(*counts, strict=True)))


class Contacts(NamedTuple):
    """Recall of the pairs in contact."""

    on: Counts
    touches: Counts
    steep: Counts
    """Recall for things without a resting contact; false positives are counted with `on`."""


def against_contacts(scenes: int) -> Contacts:
    """Compare `isOn` with resting contacts in random settled scenes, and `touches` with all contacts.

    Things that only steeper contacts support are counted separately.
    """
    found = [_in_scene(seed) for seed in range(scenes)]
    return Contacts(*(Counts.together(counts) for counts in zip(*found, strict=True)))


def _in_scene(seed: int) -> Contacts:
    """A thing on the bottom of its container is inside it, not on it, which counts as correct."""
    scene = settled_scene(seed)
    facts = Facts()
    facts.update([_ROOM, *scene.entities])
    on = {(upper, lower) for upper, relation, lower in facts if relation == "isOn"}
    on |= {(inner, outer) for inner, relation, outer in facts if relation == "isInside"} & scene.on
    names = [entity.name for entity in scene.entities]
    solids, limits = facts.space.solids, facts.space.limits
    touching = {
        (one, other)
        for one, other in combinations(sorted(names), 2)
        if proximity.touches(solids[one], solids[other], limits) is not None
    }
    true = {tuple(sorted(pair)) for pair in scene.touching}
    steep = Counts.of(on & scene.steeply, scene.steeply)
    return Contacts(Counts.of(on - scene.steeply, scene.on), Counts.of(touching, true), steep)  # type: ignore[arg-type]


def inside_against_samples(pairs: int) -> Counts:
    """Compare `isInside` with random points of a thing, of which half must be in an interior.

    For a thing that sticks out of the top of an interior, half of the points of its base suffice, if these
    are in the lower half. A sealed interior must contain all points.
    """
    rng = random.Random(3)
    points = np.random.default_rng(3)
    hollow = sorted(
        name for name, shape in shapes().items() if not all(hollow.shallow for hollow in shape.interiors)
    )
    found, true = set(), set()
    for number in range(pairs):
        outer = _solid(f"outer{number}", rng.choice(hollow), (0.0, 0.0, 0.0))
        x, y, z = outer.size
        at = (rng.uniform(-x, x) / 2, rng.uniform(-y, y) / 2, rng.uniform(0.0, z))
        inner = _solid(f"inner{number}", None, at, tuple(rng.uniform(0.1, 0.6) * s for s in outer.size))
        pair = (inner.name, outer.name)
        made = containment.inside(inner, outer, Thresholds())
        if made is not None and made.holds:
            found.add(pair)
        own = points.uniform((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0), (_SAMPLES, 3)) * inner.size + at
        share = max(
            (_are_within_walls(own, h) & (own[:, 2] >= h.low[2]) & (own[:, 2] <= h.high[2])).mean()
            for h in outer.hollows
        )
        base = max(
            _are_within_walls(own, h).mean()
            if h.low[2] - 0.05 < at[2] <= (h.low[2] + h.high[2]) / 2 and at[2] + inner.size[2] > h.high[2]
            else 0.0
            for h in outer.hollows
        )
        if any(h.is_sealed for h in outer.hollows):
            if share == 1.0:
                true.add(pair)
        elif share >= 0.5 or (base > 0.5 and any(map(containment.is_holder, outer.hollows))):
            true.add(pair)
    return Counts.of(found, true)


def _are_within_walls(points: NDArray[np.float64], hollow: Interior) -> NDArray[np.bool_]:
    """Return (N,) whether (N, 3) points are in the rectangle or ellipse of a hollow, seen from above."""
    middle, half = np.add(hollow.low, hollow.high) / 2, np.subtract(hollow.high, hollow.low) / 2
    ends = np.abs(((points - middle) / half)[:, :2])
    found: NDArray[np.bool_] = (np.hypot(*ends.T) if hollow.round else ends.max(axis=1)) <= 1.0
    return found


def _solid(name: str, model: str | None, at: tuple[float, float, float], size: object = None) -> Solid:
    entity = Entity(
        name=name, class_="", iri=f"urn:{name}", types=(), pose=Pose(position_m=at), size_m=size,  # type: ignore[arg-type]
        model=model or "", provenance=_NOBODY, pose_provenance=_NOBODY, shape_provenance=_NOBODY,
        reference_provenance=_NOBODY,
    )  # fmt: skip
    solid = solid_of(entity)
    assert solid is not None
    return solid


class Flat(NamedTuple):
    """Compare with the annotations of the flat: number, missing and additional relations."""

    said: int
    missing: list[tuple[str, str, str]]
    extra: list[tuple[str, str, str]]


def flat() -> Flat:
    """Return missing and additional relations; the latter do not follow from the annotations either.

    The flat's file contains only relations that are not computed.
    """
    files = (HOUSEHOLD_TTL, FLAT_TTL, FLAT_BY_HAND)
    triples = [t for f in files for t in rdf.parse(f.read_bytes(), f.name, label_prefix=f.stem)]
    reasoner = Reasoner(triples)
    classes = ClassTable(reasoner)
    individuals = {
        s for s, p, _ in triples if p == v.RDF_TYPE and not reasoner.types(s).isdisjoint(classes.spatial)
    }
    entities = [entity_reading.read_entity(reasoner, classes, s, _NOBODY) for s in individuals]
    facts = Facts()
    facts.update(filter(None, entities))
    computed = set(facts)
    said = {
        fact
        for t in triples
        if t[1] in PROPERTIES and (fact := fact_of(t)) is not None and t[0].startswith("<")
    }
    known = {entity.name: v.iri(entity.iri) for entity in entities if entity is not None}
    said = {fact for fact in said if fact[0] in known and fact[2] in known}
    extra = [f for f in computed - said if not reasoner.holds((known[f[0]], v.dm(f[1]), known[f[2]]))]
    return Flat(len(said), sorted(said - computed), sorted(extra))
