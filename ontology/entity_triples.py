"""The triples that describe an entity.

    :chair1  a dm:Chair ; dm:hasPosition :chair1_coordinates ; dm:hasSize :chair1_size ;
             dm:hasPreferredReference :chair1_preferred_reference ; ...

New individuals are named after the entity, not after their text, which can be arbitrary.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from functools import lru_cache

from semmap.ontology import vocabulary as v
from semmap.schemas.commands import Rename, Undo
from semmap.schemas.commits import Commit
from semmap.schemas.entities import IDENTITY, Pose, Size
from semmap.schemas.explanations import Term, Triple

DESCRIPTION_PROPERTIES = (v.HAS_POSITION, v.HAS_SIZE, v.HAS_PREFERRED_REFERENCE, v.HAS_ALTERNATIVE_REFERENCE)
"""The properties from an entity to the individuals that describe it."""
COORDINATE_PROPERTIES = (*v.COORDINATE_XYZ, *v.ORIENTATION_WXYZ)
"""The numbers of a pose."""
_FLOAT = f'"^^{v.XSD_FLOAT}'


def describe(
    name: str,
    class_iri: Term,
    *,
    pose: Pose | None = None,
    size_m: Size | None = None,
    preferred: str | None = None,
    alternatives: tuple[str, ...] = (),
    suffix: str = "",
) -> list[Triple]:
    """Return all triples of a new entity; `suffix` is appended to the names of the describing individuals."""
    entity = v.entity_iri(name)
    triples: list[Triple] = [(entity, v.RDF_TYPE, class_iri)]
    if pose is not None:
        triples += position(entity, v.entity_iri(f"{name}_coordinates{suffix}"), pose)
    if size_m is not None:
        triples += size(entity, v.entity_iri(f"{name}_size{suffix}"), size_m)
    if preferred is not None:
        triples += preferred_reference(entity, v.entity_iri(f"{name}_preferred_reference{suffix}"), preferred)
    for i, text in enumerate(alternatives, start=1):
        triples += alternative_reference(
            entity, v.entity_iri(f"{name}_alternative_reference_{i}{suffix}"), text
        )
    return triples


def position(entity: Term, node: Term, pose: Pose) -> list[Triple]:
    """Return the triples of an entity's pose, with the individual `node`."""
    return [(entity, v.HAS_POSITION, node), (node, v.RDF_TYPE, v.COORDINATES), *coordinates(node, pose)]


def coordinates(node: Term, pose: Pose) -> list[Triple]:
    """Return the numbers of a pose: position and, unless it is the identity, orientation."""
    numbers = _numbers(node, v.COORDINATE_XYZ, pose.position_m)
    if pose.orientation_wxyz != IDENTITY:
        numbers += _numbers(node, v.ORIENTATION_WXYZ, pose.orientation_wxyz)
    return numbers


def size(entity: Term, node: Term, size_m: Size) -> list[Triple]:
    """Return the triples of an entity's size along its own axes."""
    return [(entity, v.HAS_SIZE, node), (node, v.RDF_TYPE, v.THREE_DIM_SIZE), *extent(node, size_m)]


def extent(node: Term, size_m: Size) -> list[Triple]:
    """Return the numbers of a size."""
    return _numbers(node, v.SIZE_XYZ, size_m)


def preferred_reference(entity: Term, node: Term, text: str) -> list[Triple]:
    """Return the triples of an entity's label."""
    return [
        (entity, v.HAS_PREFERRED_REFERENCE, node),
        (node, v.RDF_TYPE, v.PREFERRED_REFERENCE),
        (node, v.LEXICAL_REFERENCE, _word(text)),
    ]


def alternative_reference(entity: Term, node: Term, text: str) -> list[Triple]:
    """Return the triples of an alias."""
    return [
        (entity, v.HAS_ALTERNATIVE_REFERENCE, node),
        (node, v.RDF_TYPE, v.ALTERNATIVE_REFERENCE),
        (node, v.LEXICAL_REFERENCE, _word(text)),
    ]


@lru_cache(maxsize=1024)
def _word(text: str) -> Term:
    """Return a literal; cached, so that frequent labels share one object."""
    return v.literal(text)


def _numbers(node: Term, properties: tuple[Term, ...], values: tuple[float, ...]) -> list[Triple]:
    return [
        (node, predicate, f'"{float(value)!r}{_FLOAT}')  # a number needs no escaping
        for predicate, value in zip(properties, values, strict=True)
    ]


def group_by_property(triples: Iterable[Triple]) -> dict[Term, list[Triple]]:
    """Return the triples of each property, in their order."""
    found = defaultdict[Term, list[Triple]](list)
    for triple in triples:
        found[triple[1]].append(triple)
    return dict(found)


def find_renamed(commit: Commit) -> dict[Term, Term]:
    """Return the earlier IRIs of the entities that a commit renamed, by their present IRIs.

    A renamed entity keeps all individuals that describe it. An entity without any is only recognised in the
    commit of a `rename`, and in its undo, if the same triples are about it before and afterwards.
    """
    gone = {departed.name for departed in commit.removed}
    if not gone:
        return {}
    before = _by_subject(t for t in commit.retracted if v.entity_name(t[0]) in gone)
    after = _by_subject(commit.inserted)
    is_rename = commit.verb in (Rename.VERB, Undo.VERB)
    owners = {o: s for s, about in after.items() for p, o in about if p in DESCRIPTION_PROPERTIES}
    same = {frozenset(about): s for s, about in after.items()} if is_rename and len(before) == 1 else {}
    found: dict[Term, Term] = {}
    for earlier, about in before.items():
        described = {(p, o) for p, o in about if p in DESCRIPTION_PROPERTIES}
        owner = next((owners[o] for _, o in described if o in owners), None) or same.get(frozenset(about))
        if owner is not None and described <= after[owner]:
            found[owner] = earlier
    return found


def _by_subject(triples: Iterable[Triple]) -> dict[Term, set[tuple[Term, Term]]]:
    found = defaultdict[Term, set[tuple[Term, Term]]](set)
    for s, p, o in triples:
        found[s].add((p, o))
    return found


def find_earlier_names(commit: Commit) -> dict[str, str]:
    """Return the earlier names of the entities that a commit renamed, by their present names."""
    return {v.entity_name(now): v.entity_name(was) for now, was in find_renamed(commit).items()}
