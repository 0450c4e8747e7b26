"""Commands as transactions: which triples must hold, which go, which come."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ontology import stars
from ontology import vocabulary as v
from schemas.commands import Add, Command, Update
from schemas.commits import Placed, Star, Transaction
from schemas.entities import ClassInfo, Entity, Pose
from schemas.explanations import Term, Triple
from schemas.scene_files import Described, pose_of


def transaction(
    command: Command,
    reason: str,
    *,
    placed: Iterable[Placed] = (),
    require: Iterable[Triple] = (),
    vacant: Iterable[Term] = (),
    retract: Iterable[Triple] = (),
    insert: Iterable[Triple] = (),
) -> Transaction:
    """A transaction on behalf of `command`. What the scene says no client asked for, so it has no verb."""
    return Transaction(
        id=command.id,
        source=command.source,
        agent=command.agent,
        verb="" if command.source == "scene" else command.VERB,
        reason=command.reason or reason,
        confidence=getattr(command, "confidence", None),
        placed=tuple(placed),
        require=tuple(require),
        vacant=tuple(vacant),
        retract=tuple(retract),
        insert=tuple(insert),
    )


def add(
    command: Add, name: str, found: ClassInfo, pose: Pose, ref: str | None, suffix: str = ""
) -> Transaction:
    """A new entity. Its name must be free, and so must those of the individuals of its star.

    `suffix` goes to the names of the latter, in case that somebody else's reference is named so already.
    """
    triples = stars.star(
        name,
        v.iri(found.iri),
        pose=pose,
        size_m=command.size,
        preferred=ref,
        alternatives=command.alt,
        suffix=suffix,
    )
    return transaction(command, f"add {found.name} {name}", vacant=_subjects(triples), insert=triples)


def place(command: Update) -> Transaction:
    """An entity is somewhere else, and that is all."""
    return transaction(command, f"update {command.name}", placed=_placed(command))


def update(
    command: Update, entity: Entity, star: Star, found: ClassInfo | None, suffix: str = ""
) -> Transaction:
    """What is named changes; the triples that go are required to be there still. `suffix` as for `add`."""

    def node(what: str) -> Term:
        iri = v.entity_iri(f"{star.name}_{what}{suffix}")
        taken = (star.coordinates, star.size, *star.preferred, *star.alternatives)
        return iri if iri not in taken else v.entity_iri(f"{star.name}_{what}_{star.seq + 1}")

    retract: list[Triple] = []
    insert: list[Triple] = []
    if found is not None and found.name != entity.class_:
        retract += _types(star)
        insert.append((star.iri, v.RDF_TYPE, v.iri(found.iri)))
    if command.size is not None:
        size = star.size or node("size")
        retract += _about(star, size, v.SIZE_XYZ) + _edges(star, v.HAS_SIZE)
        insert += stars.size(star.iri, size, command.size)
    if command.ref is not None and command.ref != entity.preferred_reference:
        retract += _references(star, v.HAS_PREFERRED_REFERENCE, star.preferred)
        insert += stars.preferred_reference(star.iri, node("preferred_reference"), command.ref)
    if command.alt is not None and command.alt != entity.alternative_references:
        retract += _references(star, v.HAS_ALTERNATIVE_REFERENCE, star.alternatives)
        for i, text in enumerate(command.alt, start=1):
            insert += stars.alternative_reference(star.iri, node(f"alternative_reference_{i}"), text)
    if command.conflict is not None and command.conflict != entity.conflict:
        retract += _edges(star, v.CONFLICTING_OBSERVATION)
        if command.conflict:
            insert.append((star.iri, v.CONFLICTING_OBSERVATION, v.literal(command.conflict)))
    known = {star.iri, star.size}
    return transaction(
        command,
        f"update {entity.name}",
        placed=_placed(command),
        require=retract,
        vacant=[s for s in _subjects(insert) if s not in known],
        retract=retract,
        insert=insert,
    )


def remove(command: Command, reason: str, leaving: Sequence[Star]) -> Transaction:
    """Entities go, with all that is only theirs and all that others say of them."""
    triples = dict.fromkeys(t for star in leaving for t in (*star.own, *star.incoming))
    present = [(star.iri, v.RDF_TYPE, o) for star in leaving for _, p, o in star.own if p == v.RDF_TYPE]
    require = [t for t in present if t in triples]
    return transaction(command, reason, require=require, retract=triples)


def describe(name: str, found: ClassInfo, described: Described) -> list[Triple]:
    """The triples of an entity that a file describes. Raises BadRequest for a pose that is none."""
    pose = pose_of(described.at, described.yaw, described.orientation) if described.at is not None else None
    triples = stars.star(
        name,
        v.iri(found.iri),
        pose=pose,
        size_m=described.size,
        preferred=described.ref,
        alternatives=described.alt,
    )
    return triples + [(v.entity_iri(name), v.HAS_AFFORDANCE, v.dm(word)) for word in described.affords]


def _placed(command: Update) -> tuple[Placed, ...]:
    """Where the command puts its entity, if it says anything of it."""
    if command.at is None and command.yaw is None and command.orientation is None:
        return ()
    return (Placed(name=command.name, at=command.at, yaw=command.yaw, orientation=command.orientation),)


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
