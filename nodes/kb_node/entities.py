"""Entities and their stars, read from the triples."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping

from nodes.kb_node.classes import ClassTable
from nodes.kb_node.journal import Marks
from nodes.kb_node.reasoner import Reasoner
from ontology import stars
from ontology import vocabulary as v
from schemas import errors
from schemas.commits import Star
from schemas.entities import NAME_PATTERN, REACH_M, Entity, Pose, Provenance
from schemas.explanations import Term

_NAME = re.compile(NAME_PATTERN)


def read_entity(
    reasoner: Reasoner, classes: ClassTable, iri: Term, marks: Marks, commits: Mapping[int, Provenance]
) -> Entity:
    """The Entity that the triples about `iri` describe.

    Raises BadRequest when a number in its star is none, or is not finite, or is out of all bounds.
    """
    name = v.local_name(iri)
    types = classes.special_first(reasoner.types(iri))
    asserted = {o for _, _, o in reasoner.asserted(iri, v.RDF_TYPE, None)}
    spatial = [t for t in types if t in classes.spatial]
    said = [t for t in spatial if t in asserted] or spatial
    preferred = sorted(_references(reasoner, iri, v.HAS_PREFERRED_REFERENCE))
    return Entity(
        name=name,
        class_=classes.names[said[0]],
        iri=v.bare(iri),
        types=tuple(classes.names[t] for t in types),
        pose=_pose(reasoner, iri),
        size_m=_size(reasoner, iri),
        preferred_reference=preferred[0] if preferred else None,
        alternative_references=tuple(_references(reasoner, iri, v.HAS_ALTERNATIVE_REFERENCE)),
        place=any(t in classes.places for t in types),
        fixed=any(t in classes.fixed for t in said),
        model=classes.models[said[0]],
        provenance=commits[marks.any],
        pose_provenance=commits[marks.pose],
        shape_provenance=commits[marks.shape],
    )


def is_valid_name(iri: Term) -> bool:
    """Can `iri` be an entity's? It must be an IRI whose local part is a valid name."""
    return iri.startswith("<") and _NAME.match(v.local_name(iri)) is not None


def owners(reasoner: Reasoner, subject: Term) -> Iterator[Term]:
    """The individuals to whose star a triple about `subject` may belong: itself, and who points to it."""
    yield subject
    for predicate in stars.STAR_PROPERTIES:
        for s, _, _ in reasoner.asserted(None, predicate, subject):
            yield s


def read_star(reasoner: Reasoner, iri: Term, seq: int, leaving: frozenset[Term]) -> Star:
    """The triples about an entity: its own, and what others say of it.

    What is used only by entities of `leaving` (among them this one) counts as its own.
    """
    own = list(reasoner.asserted(iri, None, None))
    edges = {p: [o for _, q, o in own if q == p] for p in stars.STAR_PROPERTIES}
    for predicate, node in [(p, o) for p, nodes in edges.items() for o in nodes]:
        users = {s for p in stars.STAR_PROPERTIES for s, _, _ in reasoner.asserted(None, p, node)}
        if users <= leaving:
            own += reasoner.asserted(node, None, None)
        elif predicate in (v.HAS_POSITION, v.HAS_SIZE):
            edges[predicate] = []  # somebody else's too: a change makes a new one
    coordinates, size = edges[v.HAS_POSITION], edges[v.HAS_SIZE]
    return Star(
        seq=seq,
        name=v.local_name(iri),
        iri=iri,
        own=tuple(own),
        incoming=tuple(t for t in reasoner.asserted(None, None, iri) if t[0] != iri),
        coordinates=coordinates[0] if coordinates else None,
        size=size[0] if size else None,
        preferred=tuple(edges[v.HAS_PREFERRED_REFERENCE]),
        alternatives=tuple(edges[v.HAS_ALTERNATIVE_REFERENCE]),
    )


def _pose(reasoner: Reasoner, iri: Term) -> Pose | None:
    node = _object(reasoner, iri, v.HAS_POSITION)
    if node is None:
        return None
    position = [_number(reasoner, iri, node, p) for p in v.COORDINATE_XYZ]
    if None in position:
        return None
    orientation = [_number(reasoner, iri, node, p) for p in v.ORIENTATION_WXYZ]
    if None in orientation:
        return Pose(position_m=tuple(position))  # type: ignore[arg-type]
    try:
        return Pose(position_m=tuple(position), orientation_wxyz=tuple(orientation))  # type: ignore[arg-type]
    except ValueError as error:
        raise errors.BadRequest(f"{v.local_name(iri)}: {error}") from None


def _size(reasoner: Reasoner, iri: Term) -> tuple[float, float, float] | None:
    node = _object(reasoner, iri, v.HAS_SIZE)
    if node is None:
        return None
    size = [_number(reasoner, iri, node, p) for p in v.SIZE_XYZ]
    if None in size:
        return None
    if any(extent <= 0 for extent in size):  # type: ignore[operator]
        raise errors.BadRequest(f"{v.local_name(iri)}: the size {tuple(size)} must be positive")
    return tuple(size)  # type: ignore[return-value]


def _object(reasoner: Reasoner, subject: Term, predicate: Term) -> Term | None:
    return min((o for _, _, o in reasoner.asserted(subject, predicate, None)), default=None)


def _number(reasoner: Reasoner, iri: Term, node: Term, predicate: Term) -> float | None:
    term = _object(reasoner, node, predicate)
    if term is None:
        return None
    text = v.lexical(term)
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= REACH_M:
        raise errors.BadRequest(
            f"{v.local_name(iri)}: {v.local_name(predicate)} is {text}; it must be a number"
            f" between -{REACH_M:g} and {REACH_M:g}"
        )
    return value


def _references(reasoner: Reasoner, iri: Term, predicate: Term) -> list[str]:
    nodes = sorted(o for _, _, o in reasoner.asserted(iri, predicate, None))
    return [v.lexical(text) for node in nodes for text in sorted(_texts(reasoner, node))]


def _texts(reasoner: Reasoner, node: Term) -> Iterator[Term]:
    return (o for _, _, o in reasoner.asserted(node, v.LEXICAL_REFERENCE, None))
