"""The relations that semmap computes for a drawn world, compared with the truth."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from itertools import chain, permutations
from typing import NamedTuple

import mujoco
import numpy as np

from benchmarks.relations.foreign.drawing import ForeignWorld
from benchmarks.relations.foreign.settling import AtRest, settle
from benchmarks.relations.foreign.truth import Pair, Verdicts, find_truth
from semmap.nodes.kb_node.documents.ontology_files import gather
from semmap.nodes.kb_node.documents.tbox.tbox_validation import compile_tbox
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.relations.facts.pair_facts import measure_pair
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.sim_node.body_classes import BodyClasses
from semmap.nodes.sim_node.world import World
from semmap.nodes.sim_node.world_shapes import world_shapes
from semmap.ontology import HOUSEHOLD_TTL
from semmap.ontology.model_shapes import (
    WorldShapes,
    exchange_world,
    model_in_world,
    own_size_m,
    shape_named,
    world,
)
from semmap.schemas.entities import ClassInfo
from semmap.schemas.scenes import Body

RELATIONS = ("isOn", "isInside", "isUnder")


class Error(NamedTuple):
    """A wrong relation of a world."""

    world: str
    relation: str
    pair: Pair
    is_missing: bool

    def __str__(self) -> str:
        one, other = self.pair
        return f"{self.world}: {'missing' if self.is_missing else 'wrong'}: {one} {self.relation} {other}"


class Compared(NamedTuple):
    """The comparison of some worlds, by relation."""

    right: dict[str, int]
    errors: list[Error]
    restless: list[str]
    """Worlds whose bodies do not come to rest, so that the truth may be wrong."""

    def f1(self, relation: str) -> float:
        """Return the harmonic mean of precision and recall."""
        right, wrong = self.right[relation], sum(error.relation == relation for error in self.errors)
        return 2 * right / max(1, 2 * right + wrong)

    @classmethod
    def together(cls, some: Iterable[Compared]) -> Compared:
        """Return the sums."""
        right, errors, restless = zip(*some, strict=True)
        sums = {relation: sum(counts[relation] for counts in right) for relation in RELATIONS}
        return cls(sums, list(chain(*errors)), list(chain(*restless)))


def compare(worlds: Iterable[ForeignWorld]) -> Compared:
    """Compare worlds."""
    compared = Compared(dict.fromkeys(RELATIONS, 0), [], [])
    for drawn in worlds:
        rest = settle(drawn)
        if not rest.is_calm:
            compared.restless.append(drawn.name)
        for relation, verdicts, found in zip(RELATIONS, find_truth(rest), find_relations(rest), strict=True):
            compared.right[relation] += sum(verdicts.get(pair) is True for pair in found)
            compared.errors.extend(_list_errors(drawn.name, relation, verdicts, found))
    return compared


def _list_errors(name: str, relation: str, verdicts: Verdicts, found: set[Pair]) -> Iterator[Error]:
    for pair in sorted(found):
        if verdicts.get(pair, False) is False:
            yield Error(name, relation, pair, False)
    for pair, verdict in verdicts.items():
        if verdict and pair not in found:
            yield Error(name, relation, pair, True)


def find_relations(rest: AtRest) -> tuple[set[Pair], ...]:
    """Return the pairs of bodies with each of `RELATIONS`, with names of bodies as in the world's file."""
    there = World(mujoco.MjSpec.from_string(rest.world.text()), classes=BodyClasses(household_classes()))
    _take_state(there, rest)
    shapes, before = world_shapes(there), world()
    exchange_world(WorldShapes.of(shapes))
    try:
        bodies = [body for body in there.scene().bodies if not body.robot]
        facts, names = Facts(), {body.name: body.body or body.name for body in bodies}
        facts.update(map(_entity, bodies))
        solids = [facts.space.solids[name] for name in names]
        stored = {
            relation: {(names[one], names[other]) for one, its, other in facts if its == relation}
            for relation in RELATIONS[:2]
        }
        under = {
            (names[one.name], names[other.name])
            for one, other in permutations(solids, 2)
            if any(made.holds for _, made in measure_pair(facts.space, one, other, {"isUnder"}))
        }
    finally:
        exchange_world(before)
    return stored["isOn"], stored["isInside"], under


def _take_state(there: World, rest: AtRest) -> None:
    """Set the bodies and joints of the simulator's world to those of a world at rest."""
    model, data = there.model, there.data
    for joint in range(rest.model.njnt):
        body = int(rest.model.jnt_bodyid[joint])
        name = rest.model.joint(joint).name
        number = (
            model.joint(name).id if name else model.body_jntadr[model.body(rest.model.body(body).name).id]
        )
        count = 7 if rest.model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE else 1
        at, its = int(model.jnt_qposadr[number]), int(rest.model.jnt_qposadr[joint])
        data.qpos[at : at + count] = rest.data.qpos[its : its + count]
    mujoco.mj_forward(model, data)


def _entity(body: Body) -> PlacedEntity:
    """Return a body as the map has it."""
    shape = shape_named(model_in_world(body.name, body.model, body.size_m))
    at = {joint.name: joint.position for joint in body.joints}
    joints = tuple(at.get(leaf.name, 0.0) for leaf in shape.leaves) if shape is not None else ()
    return PlacedEntity(
        name=body.name,
        iri=f"urn:{body.name}",
        pose=body.pose,
        size_m=body.size_m or own_size_m(body.model),
        place=False,
        model=model_in_world(body.name, body.model, body.size_m),
        joints=joints if any(np.abs(joints) > 0.002) else (),
        fixed=body.class_ in _fixed_classes(),
    )


@cache
def _fixed_classes() -> frozenset[str]:
    return frozenset(known.name for known in household_classes() if known.fixed)


@cache
def household_classes() -> tuple[ClassInfo, ...]:
    """Return the classes of the household TBox."""
    return tuple(ClassTable(compile_tbox(gather([HOUSEHOLD_TTL], {}).triples)).rows)
