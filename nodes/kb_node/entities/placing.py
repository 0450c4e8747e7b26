"""Where an entity is, as a change of triples.

What is said in the words of an alignment is said anew in these words, where it stands, so that others read an
export as before. What nobody has said yet is said in semmap's own words.
"""

from __future__ import annotations

from nodes.kb_node.entities import aligned
from nodes.kb_node.entities.class_table import ClassTable
from nodes.kb_node.entities.entity_reading import owners
from nodes.kb_node.reasoner import Reasoner
from ontology import stars
from ontology import vocabulary as v
from schemas import errors
from schemas.commits import Placed
from schemas.entities import Entity, Pose
from schemas.explanations import Term, Triple
from schemas.scene_files import pose_of

Changes = tuple[list[Triple], list[Triple]]
"""The triples that go, and those that come."""


def place(
    reasoner: Reasoner, classes: ClassTable, tbox: frozenset[Triple], entity: Entity, placed: Placed
) -> Changes:
    """The triples that go and those that come when `entity` is placed anew.

    They are changed where they are, unless somebody else uses them, too: then the entity gets its own.
    Raises BadRequest for a pose that is none, Refused for an entity that the TBox itself has.
    """
    iri = v.iri(entity.iri)
    said = reasoner.about(iri)
    if any((iri, p, o) in tbox for p, objects in said.items() for o in objects):
        raise errors.Refused(f"{entity.name} is part of the TBox, which no command changes")
    return _moved(reasoner, classes, entity, _pose(entity, placed), said.get(v.HAS_POSITION, []))


def _moved(
    reasoner: Reasoner,
    classes: ClassTable,
    entity: Entity,
    pose: Pose,
    nodes: list[Term],
) -> Changes:
    iri = v.iri(entity.iri)
    if len(nodes) == 1 and owners(reasoner, classes, node := nodes[0]) == {iri, node}:
        values = reasoner.about(node)
        before = [(node, p, o) for p in stars.COORDINATE_PROPERTIES for o in values.get(p, ())]
        return before, stars.coordinates(node, pose)
    before = [(iri, v.HAS_POSITION, node) for node in nodes]
    if classes.alignments and not nodes:
        there = aligned.said_pose(classes.alignments, reasoner.about, iri)
        if there is not None and _is_own(reasoner, there.nodes):
            return aligned.pose_triples(there, pose, entity.size_m, reasoner.about)
        before = [(iri, there.words.path[0], there.nodes[1])] if there is not None else []
    return before, stars.position(iri, _free_node(reasoner, f"{entity.name}_coordinates"), pose)


def _is_own(reasoner: Reasoner, nodes: tuple[Term, ...]) -> bool:
    """Whether the individuals on a way are nobody else's."""
    return all(s in nodes for node in nodes[1:] for s, _, _ in reasoner.asserted(None, None, node))


def _pose(entity: Entity, placed: Placed) -> Pose:
    before = entity.pose
    at = placed.at or (before.position_m if before is not None else None)
    if at is None:
        raise errors.BadRequest(f"{entity.name} has no position yet; give one with --at")
    return pose_of(at, placed.yaw, placed.orientation, before)


def _free_node(reasoner: Reasoner, name: str) -> Term:
    """An individual of that name, or with the next number that nobody has."""
    node, number = v.entity_iri(name), 1
    while any(True for _ in reasoner.asserted(node)):
        number += 1
        node = v.entity_iri(f"{name}_{number}")
    return node
