"""Adds poses and sizes from a URDF file to the individuals of a document that have the names of its links.

The name is that of a property such as `urdf:hasURDFName`, or by the last part of its IRI. What a
document states itself counts more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from semmap.nodes.kb_node.documents.urdf import Link
from semmap.nodes.kb_node.entities import aligned_values
from semmap.nodes.kb_node.entities.alignments import Alignment
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import entities, errors, wording
from semmap.schemas.entities import Pose
from semmap.schemas.explanations import Term, Triple

_FEW: Final = 5
_NAME_PROPERTIES: Final = frozenset(("hasURDFName", "hasUrdfName", "urdfName"))
"""Local names of properties with the name of a link."""


def add_poses(
    triples: list[Triple], links: Mapping[str, Link], alignments: Sequence[Alignment], name: str
) -> tuple[list[Triple], list[str]]:
    """Return the triples with poses and sizes from the links of the URDF file `name`, and notes.

    The frame of the root link is the map frame. A link without a box, such as one with meshes only, gives the
    origin of its frame. Raises Refused if no individual has the name of a link.
    """
    about: dict[Term, dict[Term, list[Term]]] = {}
    for s, p, o in triples:
        about.setdefault(s, {}).setdefault(p, []).append(o)
    known = {s: called for s, values in about.items() if (called := _find_link(s, values, links)) is not None}
    if not known:
        count, example = wording.counted(len(links), "link"), next(iter(links), "none")
        raise errors.Refused(
            f"{name}: no individual of the file has the name of one of its {count}, such as {example};"
            " state it with urdf:hasURDFName"
        )

    def look_up(term: Term) -> Mapping[Term, Sequence[Term]]:
        return about.get(term, {})

    added: list[Triple] = []
    posed: list[str] = []
    for subject, link_name in sorted(known.items()):
        link, values = links[link_name], about[subject]
        has_size = v.HAS_SIZE in values or aligned_values.find_size(alignments, look_up, subject) is not None
        if link.box is not None and not has_size:
            added += entity_triples.size(subject, _part(subject, "size"), link.box[1])
        stated = next(aligned_values.find_stated_poses(alignments, look_up, subject), None)
        if v.HAS_POSITION not in values and stated is None:
            posed.append(v.entity_name(subject))
            added += entity_triples.position(subject, _part(subject, "coordinates"), _bottom(link))
    of_meshes = sum(1 for link_name in known.values() if links[link_name].box is None)
    notes = (
        [f"{wording.counted(len(posed), 'pose')} from {name}: {wording.few(posed, _FEW)}"] if posed else []
    )
    if of_meshes:
        notes.append(f"{wording.counted(of_meshes, 'link')} of {name} without a size: of meshes or no shapes")
    return [*triples, *added], notes


def _find_link(subject: Term, values: Mapping[Term, Sequence[Term]], links: Mapping[str, Link]) -> str | None:
    """Return the link that has the name of an individual, or None."""
    if subject.startswith("_:"):
        return None
    names = (o for p in values if v.local_name(p) in _NAME_PROPERTIES for o in values[p])
    words = (*(v.lexical(o) for o in names if o[0] == '"'), v.local_name(subject))
    return next((word for text in words for word in (text, text.rpartition("/")[2]) if word in links), None)


def _bottom(link: Link) -> Pose:
    """Return the pose of the bottom centre of a link in the map frame."""
    if link.box is None:
        return entities.rounded(link.frame)
    middle, (_, _, height_m) = link.box
    return entities.rounded(entities.compose(middle, Pose(position_m=(0.0, 0.0, -height_m / 2.0))))


def _part(subject: Term, suffix: str) -> Term:
    """Return an individual that describes another."""
    return f"{subject[:-1]}_{suffix}>"
