"""What a document replaces in the map: values of individuals that are there, for which it states others.

A document is often an edited copy of one that was loaded before. It replaces

- the pose and the size of an entity, in whatever vocabulary the map has them,
- labels (each language by itself) and references,
- values of functional properties, with the joint states that follow from them,
- nameless parts: those of the same structure, if the document has as many of them.

Blank nodes have no identity outside a document. Those that the map describes in the same way are the same.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from typing import NamedTuple

from semmap.nodes.kb_node.documents import blank_nodes
from semmap.nodes.kb_node.documents.blank_nodes import is_blank
from semmap.nodes.kb_node.entities import aligned_values, implied_values
from semmap.nodes.kb_node.entities.aligned_values import AlignedPose, AlignedSize
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

_LABELS = frozenset((v.RDFS_LABEL, v.SKOS_PREF_LABEL, v.LEXICAL_REFERENCE))
_DESCRIPTIONS = frozenset(entity_triples.DESCRIPTION_PROPERTIES)
_NUMBERS = (*entity_triples.COORDINATE_PROPERTIES, *v.SIZE_XYZ)

Objects = Mapping[Term, Sequence[Term]]


class Replacement(NamedTuple):
    """The replaced triples, by the individual that the document describes, and the triples to add."""

    retract: dict[Term, list[Triple]]
    insert: list[Triple]
    known: Set[Term] = frozenset()
    """The individuals that both the map and the document describe or mention."""


def find_replacement(
    triples: list[Triple], reasoner: Reasoner, classes: ClassTable, tbox: frozenset[Triple]
) -> Replacement:
    """Return what a document replaces, and its triples with the map's labels for nameless parts that stay."""
    known = {t for t in reasoner.mentioned({s for s, _, _ in triples}) if not is_blank(t)}
    if not known:
        return Replacement({}, triples)
    if labels := _find_matches(triples, known, reasoner):
        triples = list(blank_nodes.relabel(triples, labels))
    draft = _Draft(triples, known, reasoner, classes, tbox)
    for subject in sorted(known):
        draft.replace(subject)
    return Replacement(draft.retract, [*triples, *draft.implied] if draft.implied else triples, known)


def _find_matches(triples: Iterable[Triple], known: Set[Term], reasoner: Reasoner) -> dict[Term, Term]:
    """Return the document's blank nodes that the map describes in the same way, with their labels there."""
    new = [t for t in triples if is_blank(t[0]) or is_blank(t[2])]
    if not new:
        return {}
    parts = {o for _, _, o in new if is_blank(o)}
    roots: dict[Term, list[Triple]] = {}
    for triple in new:
        if is_blank(triple[0]) and triple[0] not in parts:  # such as an annotated axiom
            roots.setdefault(triple[0], []).append(triple)
    pending = list(known)
    for about in roots.values():
        _, p, o = min(about, key=lambda t: (is_blank(t[2]), t[1] == v.RDF_TYPE, t))
        pending += [] if is_blank(o) else [s for s, _, _ in reasoner.asserted(None, p, o) if is_blank(s)]
    found: list[Triple] = []
    seen = set(pending)
    while pending:
        subject = pending.pop()
        for triple in reasoner.asserted(subject):
            node = triple[2]
            if is_blank(subject) or is_blank(node):
                found.append(triple)
            if is_blank(node) and node not in seen:
                seen.add(node)
                pending.append(node)
    return blank_nodes.find_matches(new, found) if found else {}


class _Draft:
    """The replaced triples in preparation."""

    def __init__(
        self,
        triples: Iterable[Triple],
        known: Set[Term],
        reasoner: Reasoner,
        classes: ClassTable,
        tbox: frozenset[Triple],
    ) -> None:
        self.retract: dict[Term, list[Triple]] = {}
        self.implied: list[Triple] = []
        """Values that follow from new ones, such as `isOpen` from `openness`."""
        self._reasoner, self._classes, self._tbox = reasoner, classes, tbox
        self._removed: set[Triple] = set()
        self._stated: dict[Term, dict[Term, list[Term]]] = {}
        for s, p, o in triples:
            if s in known or is_blank(s) or classes.alignments:
                self._stated.setdefault(s, {}).setdefault(p, []).append(o)
        poses = [words for known in classes.alignments for words in known.pose]
        sizes = [words for known in classes.alignments for words in known.size]
        self._names = frozenset(p for known in classes.alignments for p in known.names)
        self._orientations: dict[Term, Sequence[Term]] = dict.fromkeys(v.COORDINATE_XYZ, v.ORIENTATION_WXYZ)
        """By property of a position: those of its orientation. A document omits them for the identity."""
        self._orientations.update((w.position, (w.orientation,)) for w in poses if w.orientation)
        numbers = [p for w in poses for p in (w.position, w.orientation or w.position)]
        numbers += [p for w in sizes for p in (w.x, w.y, w.z)]
        self._single = dict.fromkeys((*_DESCRIPTIONS, *_NUMBERS, *numbers, v.ENTITY_NAME), True)
        """Whether a property has one value, as far as it is known."""

    def replace(self, subject: Term) -> None:
        """Find what the document replaces of an individual that both describe."""
        stated, asserted = self._stated[subject], self._reasoner.about(subject)
        self._replace_of_equals(subject, stated)
        is_copy = all(o in stated.get(p, ()) for p, objects in asserted.items() for o in objects)
        if is_copy and not self._classes.alignments:
            return  # the usual case of a file that is loaded again
        for p, new in stated.items():
            old = [o for o in asserted.get(p, ()) if o not in new]
            if not old or p == v.RDF_TYPE:
                continue
            if p in _LABELS or p in self._names:
                languages = {v.language_of(o) for o in new if o.startswith('"')}
                old = [o for o in old if not o.startswith('"') or v.language_of(o) in languages]
            elif not self._is_single(p):
                old = self._find_same_structure([o for o in new if o not in asserted[p]], old)
            self._remove(subject, ((subject, p, o) for o in old))
        outdated = {q for p in stated for q in self._orientations.get(p, ())} - stated.keys()
        self._remove(subject, ((subject, p, o) for p in outdated for o in asserted.get(p, ())))
        if self._classes.alignments:
            self._replace_aligned(subject, stated, asserted)
        self._imply(subject, stated, asserted)

    def _replace_of_equals(self, subject: Term, stated: Objects) -> None:
        """Remove the pose, the size and other single values that the map has by another name of `subject`.

        What the document states by the other name stays, so that two different values are rejected.
        """
        for other in self._reasoner.equals(subject):
            if other == subject:
                continue
            asserted, of_other = self._reasoner.about(other), self._about(other)
            for p, new in stated.items():
                if p in asserted and p not in of_other and self._is_single(p) and p != v.ENTITY_NAME:
                    old = [o for o in asserted[p] if o not in new]
                    self._remove(subject, ((other, p, o) for o in old))
            if self._classes.alignments and not is_blank(other):
                self._replace_aligned(other, {p: o for p, o in stated.items() if p not in of_other}, asserted)

    def _replace_aligned(self, subject: Term, stated: Objects, asserted: Objects) -> None:
        """Remove the pose, the size and the name that the map has in another vocabulary, or elsewhere."""
        known, about = self._classes.alignments, self._reasoner.about
        for edge, find in (
            (v.HAS_POSITION, aligned_values.find_poses),
            (v.HAS_SIZE, aligned_values.find_sizes),
        ):
            new = [found.nodes for found in find(known, self._about, subject)]
            if new:
                self._remove(subject, ((subject, edge, o) for o in asserted.get(edge, ())))
            if new or edge in stated:
                for found in find(known, about, subject):
                    if found.nodes not in new:
                        self._detach(subject, found)
        if not self._names.union((v.RDFS_LABEL,)).isdisjoint(stated):
            edge = v.HAS_PREFERRED_REFERENCE
            self._remove(subject, ((subject, edge, o) for o in asserted.get(edge, ()) if edge not in stated))

    def _detach(self, subject: Term, found: AlignedPose | AlignedSize) -> None:
        """Remove a pose or size, and the nameless parts on the path to it that have no other content."""
        nodes, path = found.nodes, found.words.path
        for user, edge, node in zip(nodes, path, nodes[1:], strict=False):
            if any(t[0] not in nodes for t in self._staying(node)):  # it describes another individual, too
                self._remove(subject, [(user, edge, node)])
                return
        self._remove(subject, aligned_values.value_triples(found, self._reasoner.about))
        for place in range(len(path), 0, -1):
            node = nodes[place]
            content = (t for t in self._reasoner.asserted(node) if t[1] != v.RDF_TYPE)
            if not is_blank(node) or any(t not in self._removed for t in content):
                return
            self._remove(subject, [(nodes[place - 1], path[place - 1], node)])

    def _imply(self, subject: Term, stated: Objects, asserted: Objects) -> None:
        """Clear or update the joint states and the grasp pose that follow from the document's values."""
        implied = implied_values.imply_joint_values(stated, asserted)
        implied.update(implied_values.imply_attachment_values(stated, asserted))
        for p, new in implied.items():
            self._remove(subject, ((subject, p, o) for o in asserted.get(p, ()) if o not in new))
            self.implied += [(subject, p, o) for o in new]

    def _about(self, subject: Term) -> Objects:
        """Return what the document states about an individual."""
        return self._stated.get(subject, {})

    def _is_single(self, p: Term) -> bool:
        if p not in self._single:
            self._single[p] = self._classes.property_table.is_functional(p)
        return self._single[p]

    def _find_same_structure(self, new: Iterable[Term], old: Iterable[Term]) -> list[Term]:
        """Return the nameless parts of `old` with as many counterparts of the same structure in `new`."""
        counterparts = Counter(_structure(o, self._about) for o in new if is_blank(o))
        alike: dict[object, list[Term]] = defaultdict(list)
        for o in filter(is_blank, old if counterparts else ()):
            alike[_structure(o, self._reasoner.about)].append(o)
        return [
            o for structure, parts in alike.items() if counterparts[structure] == len(parts) for o in parts
        ]

    def _remove(self, owner: Term, triples: Iterable[Triple]) -> None:
        """Remove triples of `owner`, and the parts that nothing else uses then."""
        pending = list(triples)
        while pending:
            triple = pending.pop()
            if triple in self._removed or triple in self._tbox:
                continue
            self._removed.add(triple)
            self.retract.setdefault(owner, []).append(triple)
            _, p, node = triple
            if self._is_part(p, node) and not any(self._staying(node)):
                pending += self._reasoner.asserted(node)

    def _is_part(self, p: Term, node: Term) -> bool:
        """Return whether a value is an individual that only describes another, and not by the document."""
        if node.startswith('"') or node in self._stated:
            return False
        return is_blank(node) or (
            p in self._classes.edges and self._reasoner.types(node).isdisjoint(self._classes.spatial)
        )

    def _staying(self, node: Term) -> Iterator[Triple]:
        return (t for t in self._reasoner.asserted(None, None, node) if t not in self._removed)


def _structure(node: Term, about: Callable[[Term], Objects], depth: int = 8) -> object:
    """Return the classes and properties of a nameless part, and those of its parts."""
    stated = about(node) if depth else {}
    return tuple(
        (p, tuple(sorted(map(str, (_part(p, o, about, depth) for o in objects)))))
        for p, objects in sorted(stated.items())
    )


def _part(p: Term, o: Term, about: Callable[[Term], Objects], depth: int) -> object:
    if is_blank(o):
        return _structure(o, about, depth - 1)
    return o if p == v.RDF_TYPE else ""
