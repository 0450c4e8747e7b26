"""Individuals that are the same (`owl:sameAs`, asserted or inferred): they are one entity.

One of them gives the entity its name and IRI, and all of them what is asserted about it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

from semmap.nodes.kb_node.entities import aligned_values
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term

Objects = Mapping[Term, Sequence[Term]]
"""The asserted objects of a subject by predicate."""
About = Callable[[Term], Objects]

_OF_THE_MAP = f"<{v.ABOX}"


def choose_primary(members: Iterable[Term], classes: ClassTable, about: About) -> Term:
    """Return the individual that names the entity of equal ones.

    It depends only on the triples: an individual with a pose is preferred, then one with a spatial class,
    then one in the namespace of the map.
    """

    def rank(iri: Term) -> tuple[bool, bool, bool, bool, Term]:
        asserted = about(iri)
        is_spatial = not classes.spatial.isdisjoint(asserted.get(v.RDF_TYPE, ()))
        has_pose = v.HAS_POSITION in asserted or v.HAS_EXTENT in asserted
        if classes.alignments and not has_pose:
            has_pose = any(True for _ in aligned_values.find_poses(classes.alignments, about, iri))
        return iri.startswith("_:"), not has_pose, not is_spatial, not iri.startswith(_OF_THE_MAP), iri

    return min(members, key=rank)


def merge(about: About, members: Collection[Term]) -> About:
    """Return a lookup in which each of the equal individuals has what is asserted of any of them."""
    merged: dict[Term, list[Term]] = {}
    for member in sorted(members):
        for p, objects in about(member).items():
            known = merged.setdefault(p, [])
            known += [o for o in objects if o not in known]
    return lambda subject: merged if subject in members else about(subject)


def about_entity(reasoner: Reasoner, iri: Term, about: About | None = None) -> About:
    """Return a lookup in which an individual has what is asserted of it and of its equals."""
    members = reasoner.equals(iri)
    return merge(about or reasoner.about, members) if members else about or reasoner.about


def find_other_names(members: Iterable[Term], primary: Term) -> tuple[str, ...]:
    """Return the names of the equal individuals other than that of the entity itself."""
    names = {v.entity_name(iri) for iri in members if iri.startswith("<")}
    return tuple(sorted(names - {v.entity_name(primary)}))


def with_equals(reasoner: Reasoner, individuals: Iterable[Term]) -> set[Term]:
    """Return individuals and all that are the same as one of them."""
    return {member for iri in individuals for member in (reasoner.equals(iri) or (iri,))}
