"""RDF documents that describe an ABox: what of them may come into the map."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain
from operator import itemgetter
from typing import NamedTuple

from nodes.kb_node.entities.class_table import ClassTable
from nodes.kb_node.reasoner import Reasoner
from ontology import stars
from ontology import vocabulary as v
from schemas import errors
from schemas.explanations import Term, Triple

_VOCABULARIES = (v.RDF, v.RDFS, v.OWL, v.XSD)
_TBOX = f"<{v.TBOX}"
_OF_STARS = (v.COORDINATES, v.THREE_DIM_SIZE, v.PREFERRED_REFERENCE, v.ALTERNATIVE_REFERENCE)
"""The classes of what describes an entity, in which semmap writes whatever the TBox."""
_FEW = 5
_WHOLES = (v.COORDINATE_XYZ, v.ORIENTATION_WXYZ, v.SIZE_XYZ)
_FLOATS = frozenset(chain(*_WHOLES))
_BITS = {p: 1 << i for i, p in enumerate(chain(*_WHOLES))}
_MASKS = tuple(sum(_BITS[p] for p in whole) for whole in _WHOLES)
_NUMBERS = tuple(f"^^{v.iri(v.XSD + kind)}" for kind in ("integer", "decimal", "double", "float"))


class SortedOut(NamedTuple):
    """The triples that fit the TBox, a word on each individual left out, and on what may be a mistake."""

    triples: list[Triple]
    skipped: list[str]
    notes: list[str]


def sort_out(triples: Iterable[Triple], classes: ClassTable, *, skip_unknown: bool) -> SortedOut:
    """What of a document may come into the map. A number of a star may be written as any kind of number.

    Raises UnknownClass naming all individuals of unknown classes, unless `skip_unknown`; then what is of
    unknown classes only is left out, with the star that only it uses, and of the others the unknown class.
    Raises BadFile for a TBox.
    """
    triples = _with_numbers(list(triples), classes.number_kinds)
    types_said = [t for t in triples if t[1] == v.RDF_TYPE]
    declared = {s for s, _, o in types_said if o in (v.OWL_CLASS, v.RDFS_CLASS)}
    known = declared.union(classes.names, _OF_STARS)
    built_in = {o for o in {o for _, _, o in types_said} if is_built_in(o)}
    types = [(s, o) for s, _, o in types_said if o not in built_in]
    spatial = _with_subclasses(classes.spatial, triples)
    if declared and not any(o in spatial for _, o in types):
        raise errors.BadFile("it declares classes but no entities; to load a TBox use --tbox")
    unknown = sorted((s, o) for s, o in types if o not in known)
    users: dict[str, list[str]] = {}
    namesakes = set(classes.names.values())
    for s, c in unknown:
        name = v.local_name(c)
        users.setdefault(c if name in namesakes else name, []).append(_called(s))
    if unknown and not skip_unknown:
        raise errors.UnknownClass(errors.unknown_classes(users, classes.names.values()))
    words = [f"{name} (unknown class '{c}')" for c, names in users.items() for name in names]
    kept = triples
    if unknown:
        gone = {s for s, _ in unknown} - {s for s, o in types if o in known}
        doubtful = {(s, v.RDF_TYPE, o) for s, o in unknown}
        kept = _without(gone, [t for t in triples if t not in doubtful])
    notes = (*_unknown_properties(kept, classes), *_own_classes(declared, classes), *_halves(kept))
    return SortedOut(kept, words, list(notes))


def undeclared_classes(triples: Iterable[Triple], classes: ClassTable) -> set[Term]:
    """The classes with a name that individuals are of, and that neither the TBox nor these triples declare.

    The document that brought the individuals declared them; without that it would have been refused.
    """
    types = [(s, o) for s, p, o in triples if p == v.RDF_TYPE and o.startswith("<")]
    declared = {s for s, o in types if o in (v.OWL_CLASS, v.RDFS_CLASS)}.union(classes.names, _OF_STARS)
    return {o for _, o in types if o not in declared and not is_built_in(o)}


def strangers(
    triples: Sequence[Triple], reasoner: Reasoner, stays: Callable[[Triple], bool] = lambda _: True
) -> dict[Term, Triple]:
    """What something is related to though nobody says what it is, each with the first triple that does so.

    What the reasoner holds counts, too, as far as it `stays`.
    """
    relations = {s for s, _, _ in reasoner.asserted(None, v.RDF_TYPE, v.OWL_OBJECT_PROPERTY)}
    found: dict[Term, Triple] = {}
    for triple in triples:
        if triple[1] in relations:
            found.setdefault(triple[2], triple)
    for s, p, _ in triples:
        if p == v.RDF_TYPE:
            found.pop(s, None)
    return {
        term: triple
        for term, triple in found.items()
        if not any(map(stays, reasoner.asserted(term, v.RDF_TYPE, None)))
    }


def of_strangers(found: Mapping[Term, Triple]) -> str:
    """One sentence on them."""
    few = ", ".join(f"{_called(term)} ({v.spoken(said)})" for term, said in [*found.items()][:_FEW])
    more = f" and {len(found) - _FEW} more" if len(found) > _FEW else ""
    return f"referenced but not described: {few}{more}"


def _with_subclasses(roots: frozenset[Term], triples: list[Triple]) -> set[Term]:
    """Classes, and those which the triples put below them."""
    found, above = set(roots), [(t[0], t[2]) for t in triples if t[1] == v.RDFS_SUB_CLASS_OF]
    while below := {s for s, o in above if o in found and s not in found}:
        found |= below
    return found


def _with_numbers(triples: list[Triple], kinds: Mapping[Term, Term]) -> list[Triple]:
    """`triples` where each number is of the kind that its property asks for.

    `0` and `0.5` in Turtle are an integer and a decimal, and many a map says double where its ontology wants
    a float; they mean the number all the same.
    """
    if not any(t[2].endswith(_NUMBERS) and not t[2].endswith(kinds[t[1]]) for t in triples if t[1] in kinds):
        return triples
    return [
        (s, p, v.literal(v.lexical(o), kinds[p])) if p in kinds and o.endswith(_NUMBERS) else (s, p, o)
        for s, p, o in triples
    ]


def _unknown_properties(triples: list[Triple], classes: ClassTable) -> list[str]:
    """A word on the properties in the TBox's namespace that it does not have: they may be misspelt."""
    if not any(p.startswith(_TBOX) for p in classes.properties):
        return []  # the TBox is somebody else's, and these are the words of stars
    used = {p for p in set(map(itemgetter(1), triples)) if p.startswith(_TBOX)} - classes.properties
    unknown = used and used - {s for s, p, o in triples if p == v.RDF_TYPE and o in v.PROPERTY_KINDS}
    if not unknown:
        return []
    users: dict[str, list[str]] = {}
    for s, p, _ in triples:
        if p in unknown:
            users.setdefault(v.local_name(p), []).append(v.local_name(s))
    known = {s for s, p, o in triples if p == v.RDF_TYPE and o in v.PROPERTY_KINDS} | classes.properties
    return [errors.unknown_properties(users, map(v.local_name, sorted(known)))]


def _own_classes(declared: set[Term], classes: ClassTable) -> list[str]:
    """A word on classes that the TBox does not have: nobody can ask the map for things of them."""
    names = sorted(v.local_name(c) for c in declared.difference(classes.names))
    if not names:
        return []
    few = ", ".join(names[:_FEW]) + (" and others" if len(names) > _FEW else "")
    return [
        f"only the map declares {few}: nothing can be added or listed by such classes; to load classes use"
        " --tbox"
    ]


def _halves(triples: list[Triple]) -> list[str]:
    """A word on positions, orientations and sizes that lack a number: they are as good as none."""
    said: dict[Term, int] = {}
    for s, p, _ in [t for t in triples if t[1] in _FLOATS]:
        said[s] = said.get(s, 0) | _BITS[p]
    halves = {bits for bits in set(said.values()) if any(0 < bits & whole < whole for whole in _MASKS)}
    lacking = [
        f"{_called(s)} has no {' and no '.join(v.local_name(p) for p in whole if not _BITS[p] & bits)}"
        for s, bits in said.items()
        if bits in halves
        for whole in _WHOLES
        if 0 < sum(_BITS[p] & bits for p in whole) < sum(_BITS[p] for p in whole)
    ]
    if not lacking:
        return []
    few = ", ".join(lacking[:_FEW]) + (f" and {len(lacking) - _FEW} more" if lacking[_FEW:] else "")
    return [f"incomplete position, orientation or size ignored: {few}"]


def _called(individual: Term) -> str:
    return "a blank node" if individual.startswith("_:") else v.local_name(individual)


def is_built_in(term: Term) -> bool:
    """Is it a term of OWL's own vocabularies, or an anonymous class?"""
    return term.startswith("_:") or (term.startswith("<") and v.bare(term).startswith(_VOCABULARIES))


def _without(gone: set[Term], triples: list[Triple]) -> list[Triple]:
    """`triples` without those about `gone`, and about what is in no other star."""
    edges = [(s, o) for s, p, o in triples if p in stars.STAR_PROPERTIES]
    gone = gone.union({o for s, o in edges if s in gone} - {o for s, o in edges if s not in gone})
    return [(s, p, o) for s, p, o in triples if s not in gone and o not in gone]
