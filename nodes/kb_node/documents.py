"""RDF documents that describe an ABox: what of them may come into the map."""

from __future__ import annotations

from collections.abc import Iterable

from nodes.kb_node.classes import ClassTable
from ontology import vocabulary as v
from schemas import errors
from schemas.explanations import Term, Triple

_VOCABULARIES = (v.RDF, v.RDFS, v.OWL, v.XSD)


def sort_out(
    triples: Iterable[Triple], classes: ClassTable, *, skip_unknown: bool
) -> tuple[list[Triple], list[str]]:
    """The triples that fit the TBox, and a sentence on each individual of an unknown class.

    Raises UnknownClass naming all of them, unless `skip_unknown`; then their triples are left out, with the
    individuals that only they use.
    """
    triples = list(triples)
    declared = {s for s, p, o in triples if p == v.RDF_TYPE and o in (v.OWL_CLASS, v.RDFS_CLASS)}
    known = declared.union(classes.names)
    unknown = {s: o for s, p, o in triples if p == v.RDF_TYPE and o not in known and not _is_built_in(o)}
    users: dict[str, list[str]] = {}
    for s, c in sorted(unknown.items()):
        users.setdefault(v.local_name(c), []).append(v.local_name(s))
    if unknown and not skip_unknown:
        raise errors.UnknownClass(errors.unknown_classes(users, classes.names.values()))
    sentences = [f"{name} (unknown class '{c}')" for c, names in users.items() for name in names]
    return _without(set(unknown), triples), sentences


def _is_built_in(iri: Term) -> bool:
    return iri.startswith("_:") or v.bare(iri).startswith(_VOCABULARIES)


def _without(gone: set[Term], triples: list[Triple]) -> list[Triple]:
    """`triples` without those about `gone`, and about what nothing else points to any more."""
    pointers: dict[Term, int] = {}
    targets: dict[Term, list[Term]] = {}
    for s, p, o in triples:
        if p != v.RDF_TYPE and not o.startswith('"'):
            pointers[o] = pointers.get(o, 0) + 1
            targets.setdefault(s, []).append(o)
    agenda = list(gone)
    while agenda:
        for o in targets.get(agenda.pop(), ()):
            pointers[o] -= 1
            if pointers[o] == 0 and o not in gone:
                gone.add(o)
                agenda.append(o)
    return [(s, p, o) for s, p, o in triples if s not in gone and o not in gone]
