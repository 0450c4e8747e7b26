"""The commits that last changed an individual that is not in space.

Commits are indexed by entity only, so they are searched for triples about the individual, the newest first.
They are not decoded for that: a triple in MessagePack begins with its subject and its property.
"""

from __future__ import annotations

from typing import Final, NamedTuple, TypeVar

from msgspec import structs

from semmap.nodes.kb_node.entities import aligned_values
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology import vocabulary as v
from semmap.schemas import codec
from semmap.schemas.entities import Entity, Provenance
from semmap.schemas.explanations import Term

_TRIPLE: Final = b"\x93"
"""The MessagePack code of a list of three."""
_LABELS: Final = (*aligned_values.LABELS, v.HAS_PREFERRED_REFERENCE, v.HAS_ALTERNATIVE_REFERENCE)
E = TypeVar("E", bound=Entity)

_MAX_NODES: Final = 1000


class Described(NamedTuple):
    """The individuals whose triples describe one individual."""

    members: frozenset[Term]
    """The individual, and those that are the same."""
    nodes: frozenset[Term] = frozenset()
    """The individuals that hold its labels, and its nameless values."""
    label_nodes: frozenset[Term] = frozenset()


class Dates(NamedTuple):
    """The provenance of an individual: its last change, its classes and its labels."""

    last: Provenance
    classes: Provenance
    labels: Provenance

    def of(self, individual: E) -> E:
        """Return the individual with this provenance."""
        return structs.replace(
            individual,
            provenance=self.last,
            pose_provenance=self.classes,
            shape_provenance=self.classes,
            reference_provenance=self.labels,
        )


def find_described(reasoner: Reasoner, term: Term) -> Described:
    """Return the individuals whose triples describe the individual `term`."""
    members = frozenset(reasoner.equals(term) or (term,))
    objects_of_labels = (o for one in members for p in _LABELS for o in reasoner.about(one).get(p, ()))
    labels = {o for o in objects_of_labels if not o.startswith('"')}
    nodes, waiting = set[Term](), [*members]
    while waiting and len(nodes) < _MAX_NODES:
        for objects in reasoner.about(waiting.pop()).values():
            new = {o for o in objects if o.startswith("_:")} - nodes
            nodes |= new
            waiting += new
    return Described(members, frozenset(nodes | labels), frozenset(labels))


def find_dates(journal: Journal, described: Described, until: int) -> Dates:
    """Return the commits up to `until` that last changed an individual, its classes and its labels.

    Those of an individual without labels are that of its first statement.
    """
    classes = {_pattern(one, v.RDF_TYPE) for one in described.members}
    labels = {_pattern(one, p) for one in described.members for p in _LABELS}
    labels |= {_pattern(node) for node in described.label_nodes}
    every = {_pattern(one) for one in (*described.members, *described.nodes)}
    last = of_classes = of_labels = first = 0
    for seq, found in journal.find_contained(every | classes | labels, until):
        last, first = last or seq, seq
        of_classes = of_classes or (0 if classes.isdisjoint(found) else seq)
        of_labels = of_labels or (0 if labels.isdisjoint(found) else seq)
        if of_classes and of_labels:
            break
    if journal.beginning.seq and not (of_classes and of_labels):
        first = 0  # it may be older than the compacted history
    return Dates(*(_provenance(journal, seq) for seq in (last, of_classes or first, of_labels or first)))


def _pattern(subject: Term, property_: Term | None = None) -> bytes:
    return _TRIPLE + codec.encode(subject) + (b"" if property_ is None else codec.encode(property_))


def _provenance(journal: Journal, seq: int) -> Provenance:
    """Return the provenance of a commit; 0 stands for what was there before the first stored one."""
    if seq:
        return journal.commit_provenance(seq)
    there = journal.beginning
    text = "the history begins here; earlier commits were compacted" if there.seq else "the TBox says so"
    return Provenance(commit=there.seq, stamp_ns=there.stamp_ns, source="file", reason=text)
