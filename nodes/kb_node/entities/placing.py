"""Where an entity is, as a change of triples."""

from __future__ import annotations

from nodes.kb_node.entities.entity_reading import owners
from nodes.kb_node.reasoner import Reasoner
from ontology import stars
from ontology import vocabulary as v
from schemas import errors
from schemas.commits import Placed
from schemas.entities import Entity, Pose
from schemas.explanations import Term, Triple
from schemas.scene_files import pose_of


def place(
    reasoner: Reasoner, tbox: frozenset[Triple], entity: Entity, placed: Placed
) -> tuple[list[Triple], list[Triple]]:
    """The triples that go and those that come when `entity` is placed anew.

    Its coordinates are changed where they are, unless somebody else uses them, too: then it gets its own.
    Raises BadRequest for a pose that is none, Refused for an entity that the TBox itself has.
    """
    iri = v.iri(entity.iri)
    said = reasoner.about(iri)
    if any((iri, p, o) in tbox for p, objects in said.items() for o in objects):
        raise errors.Refused(f"{entity.name} is part of the TBox, which no command changes")
    pose = _pose(entity, placed)
    nodes = said.get(v.HAS_POSITION, [])
    if len(nodes) == 1 and owners(reasoner, node := nodes[0]) == {iri, node}:
        values = reasoner.about(node)
        before = [(node, p, o) for p in stars.COORDINATE_PROPERTIES for o in values.get(p, ())]
        return before, stars.coordinates(node, pose)
    before = [(iri, v.HAS_POSITION, node) for node in nodes]
    return before, stars.position(iri, _free_node(reasoner, entity.name), pose)


def _pose(entity: Entity, placed: Placed) -> Pose:
    before = entity.pose
    at = placed.at or (before.position_m if before is not None else None)
    if at is None:
        raise errors.BadRequest(f"{entity.name} has no position yet; give one with --at")
    return pose_of(at, placed.yaw, placed.orientation, before)


def _free_node(reasoner: Reasoner, name: str) -> Term:
    """The usual name of its coordinates, or the next that nobody has."""
    node, number = v.entity_iri(f"{name}_coordinates"), 1
    while any(True for _ in reasoner.asserted(node)):
        number += 1
        node = v.entity_iri(f"{name}_coordinates_{number}")
    return node
