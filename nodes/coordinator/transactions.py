"""Commands as transactions: which triples must hold, which go, which come."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ontology import stars
from ontology import vocabulary as v
from schemas.commands import Add, Command, Update
from schemas.commits import Star, Transaction
from schemas.entities import ClassInfo, Entity, Pose, Size
from schemas.explanations import Term, Triple


def transaction(
    command: Command,
    reason: str,
    *,
    require: Iterable[Triple] = (),
    vacant: Iterable[Term] = (),
    retract: Iterable[Triple] = (),
    insert: Iterable[Triple] = (),
) -> Transaction:
    """A transaction on behalf of `command`."""
    return Transaction(
        id=command.id,
        source=command.source,
        agent=command.agent,
        reason=command.reason or reason,
        confidence=getattr(command, "confidence", None),
        require=tuple(require),
        vacant=tuple(vacant),
        retract=tuple(retract),
        insert=tuple(insert),
    )


def add(command: Add, name: str, found: ClassInfo, pose: Pose, ref: str | None) -> Transaction:
    """A new entity. Its name must be free, and so must those of the individuals of its star."""
    triples = stars.star(
        name, v.iri(found.iri), pose=pose, size_m=command.size, preferred=ref, alternatives=command.alt
    )
    return transaction(command, f"add {found.name} {name}", vacant=_subjects(triples), insert=triples)


def update(
    command: Update, entity: Entity, star: Star, found: ClassInfo | None, pose: Pose | None
) -> Transaction:
    """What is named changes; the triples that go are required to be there still."""
    retract: list[Triple] = []
    insert: list[Triple] = []
    if found is not None and found.name != entity.class_:
        retract += _types(star)
        insert.append((star.iri, v.RDF_TYPE, v.iri(found.iri)))
    if pose is not None:
        node = star.coordinates or _free(star, "coordinates")
        retract += _about(star, node, (*v.COORDINATE_XYZ, *v.ORIENTATION_WXYZ)) + _edges(star, v.HAS_POSITION)
        insert += stars.position(star.iri, node, pose)
    if command.size is not None:
        node = star.size or _free(star, "size")
        retract += _about(star, node, v.SIZE_XYZ) + _edges(star, v.HAS_SIZE)
        insert += stars.size(star.iri, node, command.size)
    if command.ref is not None and command.ref != entity.preferred_reference:
        retract += _references(star, v.HAS_PREFERRED_REFERENCE, star.preferred)
        insert += stars.preferred_reference(star.iri, _free(star, "preferred_reference"), command.ref)
    if command.alt is not None and command.alt != entity.alternative_references:
        retract += _references(star, v.HAS_ALTERNATIVE_REFERENCE, star.alternatives)
        for i, text in enumerate(command.alt, start=1):
            insert += stars.alternative_reference(star.iri, _free(star, f"alternative_reference_{i}"), text)
    return transaction(command, f"update {entity.name}", require=retract, retract=retract, insert=insert)


def remove(command: Command, reason: str, leaving: Sequence[Star]) -> Transaction:
    """Entities go, with all that is only theirs and all that others say of them."""
    triples = dict.fromkeys(t for star in leaving for t in (*star.own, *star.incoming))
    present = [(star.iri, v.RDF_TYPE, o) for star in leaving for _, p, o in star.own if p == v.RDF_TYPE]
    require = [t for t in present if t in triples]
    return transaction(command, reason, require=require, retract=triples)


def describe(
    name: str,
    found: ClassInfo,
    *,
    pose: Pose | None,
    size_m: Size | None,
    ref: str | None,
    alt: tuple[str, ...],
    affords: tuple[str, ...],
) -> list[Triple]:
    """The triples of an entity that a file describes."""
    triples = stars.star(name, v.iri(found.iri), pose=pose, size_m=size_m, preferred=ref, alternatives=alt)
    return triples + [(v.entity_iri(name), v.HAS_AFFORDANCE, v.dm(word)) for word in affords]


def _subjects(triples: Iterable[Triple]) -> list[Term]:
    return list(dict.fromkeys(s for s, _, _ in triples))


def _types(star: Star) -> list[Triple]:
    return [t for t in star.own if t[:2] == (star.iri, v.RDF_TYPE) and t[2] != v.OWL_NAMED_INDIVIDUAL]


def _about(star: Star, node: Term, predicates: tuple[Term, ...]) -> list[Triple]:
    return [t for t in star.own if t[0] == node and t[1] in predicates]


def _edges(star: Star, predicate: Term) -> list[Triple]:
    return [t for t in star.own if t[:2] == (star.iri, predicate)]


def _references(star: Star, predicate: Term, nodes: tuple[Term, ...]) -> list[Triple]:
    """The edges to its references, and those references that only it uses."""
    return _edges(star, predicate) + [t for t in star.own if t[0] in nodes]


def _free(star: Star, what: str) -> Term:
    """An IRI for a new individual of the star, unlike those that it or another entity has."""
    iri = v.entity_iri(f"{star.name}_{what}")
    taken = {star.coordinates, star.size, *star.preferred, *star.alternatives}
    return iri if iri not in taken else v.entity_iri(f"{star.name}_{what}_{star.seq}")
