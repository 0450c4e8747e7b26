"""RDF documents that describe an ABox: what of them may come into the map."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain
from operator import itemgetter
from typing import NamedTuple

from semmap.nodes.kb_node.by_property import by_property
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import stars
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.explanations import Term, Triple

_VOCABULARIES = (v.RDF, v.RDFS, v.OWL, v.XSD)
_TBOX = f"<{v.TBOX}"
_OF_STARS = (v.COORDINATES, v.THREE_DIM_SIZE, v.PREFERRED_REFERENCE, v.ALTERNATIVE_REFERENCE)
"""The classes of what describes an entity, in which semmap writes whatever the TBox."""
_FEW = 5
_WHOLES = (v.COORDINATE_XYZ, v.ORIENTATION_WXYZ, v.SIZE_XYZ)
_FLOATS = frozenset(chain(*_WHOLES))
_BITS = {p: 1 << i for i, p in enumerate(chain(*_WHOLES))}
_CLASSES = frozenset((v.OWL_CLASS, v.RDFS_CLASS))
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
    triples = list(triples)
    said = by_property(triples)
    if _has_other_numbers(said, classes.number_kinds):
        triples = _with_numbers(triples, classes.number_kinds)
        said = by_property(triples)
    types_said = said.get(v.RDF_TYPE, [])
    used = set(map(itemgetter(2), types_said))
    declared = {s for s, _, o in types_said if o in _CLASSES} if used & _CLASSES else set[Term]()
    known = declared.union(classes.names, _OF_STARS)
    spatial = _with_subclasses(classes.spatial, said.get(v.RDFS_SUB_CLASS_OF, []))
    own = {o for o in used if not is_built_in(o)}
    if declared and spatial.isdisjoint(own):
        raise errors.BadFile("it declares classes but no entities; to load a TBox use --tbox")
    strange = own - known
    unknown = sorted((s, o) for s, _, o in types_said if o in strange) if strange else []
    users: dict[str, list[str]] = {}
    for s, c in unknown:
        name = c if classes.index.namesakes(c) else v.local_name(c)
        users.setdefault(name, []).append(_called(s))
    if unknown and not skip_unknown:
        raise errors.UnknownClass(classes.index.unknown_classes(users))
    words = [f"{name} (unknown class '{c}')" for c, names in users.items() for name in names]
    kept = triples
    if unknown:
        described = own & known
        gone = {s for s, _ in unknown} - {s for s, _, o in types_said if o in described}
        doubtful = {(s, v.RDF_TYPE, o) for s, o in unknown}
        kept = _without(gone, [t for t in triples if t not in doubtful])
        said = by_property(kept)
    notes = (*_unknown_properties(said, classes), *_own_classes(declared, classes), *_halves(said, kept))
    return SortedOut(kept, words, list(notes))


def undeclared_classes(triples: Iterable[Triple], classes: ClassTable) -> set[Term]:
    """The classes with a name that individuals are of, and that neither the TBox nor these triples declare.

    The document that brought the individuals declared them; without that it would have been refused.
    """
    types = [(s, o) for s, p, o in triples if p == v.RDF_TYPE and o.startswith("<")]
    declared = {s for s, o in types if o in _CLASSES}.union(classes.names, _OF_STARS)
    return {o for _, o in types if o not in declared and not is_built_in(o)}


def strangers(
    triples: Sequence[Triple], reasoner: Reasoner, stays: Callable[[Triple], bool] = lambda _: True
) -> dict[Term, Triple]:
    """What something is related to though nobody says what it is, each with the first triple that does so.

    What the reasoner holds counts, too, as far as it `stays`.
    """
    relations = {s for s, _, _ in reasoner.asserted(None, v.RDF_TYPE, v.OWL_OBJECT_PROPERTY)}
    said = by_property(triples)
    related = {o for p in relations & said.keys() for _, _, o in said[p]}
    related.difference_update(map(itemgetter(0), said.get(v.RDF_TYPE, ())))
    strange = {o for o in related if not any(map(stays, reasoner.asserted(o, v.RDF_TYPE, None)))}
    found: dict[Term, Triple] = {}
    for triple in triples if strange else ():
        if triple[2] in strange and triple[1] in relations:
            found.setdefault(triple[2], triple)
    return found


def of_strangers(found: Mapping[Term, Triple]) -> str:
    """One sentence on them."""
    few = ", ".join(f"{_called(term)} ({v.spoken(said)})" for term, said in [*found.items()][:_FEW])
    more = f" and {len(found) - _FEW} more" if len(found) > _FEW else ""
    return f"referenced but not described: {few}{more}"


def _with_subclasses(roots: frozenset[Term], below: list[Triple]) -> set[Term]:
    """Classes, and those which triples of `rdfs:subClassOf` put below them."""
    found, above = set(roots), [(s, o) for s, _, o in below]
    while more := {s for s, o in above if o in found and s not in found}:
        found |= more
    return found


def _has_other_numbers(said: Mapping[Term, list[Triple]], kinds: Mapping[Term, Term]) -> bool:
    """Whether a number is of another kind than its property asks for."""
    return any(
        o.endswith(_NUMBERS)
        for p, kind in kinds.items()
        for _, _, o in said.get(p, ())
        if not o.endswith(kind)
    )


def _with_numbers(triples: list[Triple], kinds: Mapping[Term, Term]) -> list[Triple]:
    """`triples` where each number is of the kind that its property asks for.

    `0` and `0.5` in Turtle are an integer and a decimal, and many a map says double where its ontology wants
    a float; they mean the number all the same.
    """
    return [
        (s, p, v.literal(v.lexical(o), kinds[p])) if p in kinds and o.endswith(_NUMBERS) else (s, p, o)
        for s, p, o in triples
    ]


def _unknown_properties(said: Mapping[Term, list[Triple]], classes: ClassTable) -> list[str]:
    """A word on the properties in the TBox's namespace that it does not have: they may be misspelt."""
    if not any(p.startswith(_TBOX) for p in classes.properties):
        return []  # the TBox is somebody else's, and these are the words of stars
    used = {p for p in said if p.startswith(_TBOX)} - classes.properties
    declared = {s for s, _, o in said.get(v.RDF_TYPE, ()) if o in v.PROPERTY_KINDS} if used else set()
    unknown = used - declared
    if not unknown:
        return []
    users = {v.local_name(p): [v.local_name(s) for s, _, _ in said[p]] for p in said if p in unknown}
    known = declared | classes.properties
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


def _halves(said: Mapping[Term, list[Triple]], triples: list[Triple]) -> list[str]:
    """A word on positions, orientations and sizes that lack a number: they are as good as none."""
    having = {p: set(map(itemgetter(0), said.get(p, ()))) for p in _FLOATS}
    if all(having[p] == having[whole[0]] for whole in _WHOLES for p in whole):
        return []
    numbers: dict[Term, int] = {}
    for s, p, _ in [t for t in triples if t[1] in _FLOATS]:
        numbers[s] = numbers.get(s, 0) | _BITS[p]
    lacking = [
        f"{_called(s)} has no {' and no '.join(v.local_name(p) for p in whole if not _BITS[p] & bits)}"
        for s, bits in numbers.items()
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
