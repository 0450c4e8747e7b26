"""RDF documents that describe an ABox, and which of their triples the map accepts."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain, count
from operator import itemgetter
from types import MappingProxyType
from typing import NamedTuple

from semmap.nodes.kb_node.documents import blank_nodes, distinct_names
from semmap.nodes.kb_node.documents.blank_nodes import is_blank
from semmap.nodes.kb_node.documents.inert_statements import SWRL, count_inert, inert_note
from semmap.nodes.kb_node.documents.map_frame import FindFrame, express_in_map_frame
from semmap.nodes.kb_node.documents.rule_terms import undeclared_note, undeclared_terms
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.entities.property_values import retype
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.shacl.shape_triples import SHACL
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.ontology.prefixes import Prefixes
from semmap.schemas import errors, wording
from semmap.schemas.entities import Entity, name_stem
from semmap.schemas.explanations import Term, Triple

_VOCABULARIES = (v.RDF, v.RDFS, v.OWL, v.XSD, SWRL, SHACL)
_INERT = (f"<{SWRL}", f"<{SHACL}")
_TBOX = f"<{v.TBOX}"
_OF_STARS = (v.COORDINATES, v.THREE_DIM_SIZE, v.PREFERRED_REFERENCE, v.ALTERNATIVE_REFERENCE)
"""Classes of the individuals that describe an entity. semmap writes them with any TBox."""
_FEW = 5
_DESCRIBING = (v.RDF_TYPE, v.OWL_SAME_AS, v.RDFS_LABEL, v.SKOS_PREF_LABEL)
"""Properties of an individual that is not merely a misspelt name."""
_NAMELESS = "a nameless individual"
_LABEL = re.compile(r"_:\S+")
_DEPTH = 8
"""Depth to which the parts of a blank node are compared."""
_WHOLES = (v.COORDINATE_XYZ, v.ORIENTATION_WXYZ, v.SIZE_XYZ)
_FLOATS = frozenset(chain(*_WHOLES))
_BITS = {p: 1 << i for i, p in enumerate(chain(*_WHOLES))}
_CLASSES = frozenset((v.OWL_CLASS, v.RDFS_CLASS))
_OF_INDIVIDUALS = frozenset((v.OWL_NAMED_INDIVIDUAL, v.OWL_THING))
"""Classes that do not tell what an individual is."""
_NUMBERS = tuple(f"^^{v.iri(v.XSD + kind)}" for kind in ("integer", "decimal", "double", "float"))


def find_none(_: str) -> Entity | None:
    """Return None, as in a map without entities."""
    return None


class DocumentOrigin(NamedTuple):
    """What distinguishes the names in a document: its file, its prefixes, and the names of the map."""

    filename: str = ""
    prefixes: Prefixes = MappingProxyType({})
    find: Callable[[str], Entity | None] = find_none
    """Returns the entity of the map with a name, or None."""


_UNKNOWN_ORIGIN = DocumentOrigin()
_BLANK = "a blank node"


class FilteredDocument(NamedTuple):
    """The accepted triples, a note on each individual that is left out, and notes on possible mistakes."""

    triples: list[Triple]
    skipped: list[str]
    notes: list[str]


def filter_document(
    triples: Iterable[Triple],
    classes: ClassTable,
    *,
    skip_unknown: bool,
    of_file: DocumentOrigin = _UNKNOWN_ORIGIN,
    find_frame: FindFrame = lambda _: None,
) -> FilteredDocument:
    """Return the triples of a document that the map accepts. Numbers may be of any numeric datatype.

    A literal outside the range of its property gets a datatype of the range if its text is a value of that.
    Blank nodes of spatial classes get IRIs. Entities that would have the name of another one get a name with
    a prefix. Poses of alignments are in the map frame; `find_frame` returns those of the map.

    Raises UnknownClass with all individuals of unknown classes, unless `skip_unknown`. In that case
    individuals that have only unknown classes are left out, with the triples that describe only them, and the
    others, such as properties, lose the unknown classes. Raises BadFile for a TBox and for poses in a cycle.
    """
    stated = list(triples)
    triples, of_frames = express_in_map_frame(stated, classes.alignments, find_frame)
    by_property = entity_triples.group_by_property(triples)
    if _has_other_numbers(by_property, classes.number_datatypes):
        triples = _with_numbers(triples, classes.number_datatypes)
        by_property = entity_triples.group_by_property(triples)
    triples, by_property, retyped = _with_datatypes(triples, by_property, classes)
    types_said = by_property.get(v.RDF_TYPE, [])
    used = set(map(itemgetter(2), types_said))
    declared = {s for s, _, o in types_said if o in _CLASSES} if used & _CLASSES else set[Term]()
    helpers = (c for known in classes.alignments for c in known.helpers)
    known = declared.union(classes.names, _OF_STARS, helpers)
    spatial = _with_subclasses(classes.spatial, by_property.get(v.RDFS_SUB_CLASS_OF, []))
    own = {o for o in used if not is_built_in(o)}
    if declared and spatial.isdisjoint(own):
        name = of_file.filename or "the file"
        raise errors.BadFile(f"{name}: declares classes but no entities; to load a TBox use --tbox")
    strange = own - known
    unknown = sorted((s, o) for s, _, o in types_said if o in strange) if strange else []
    users: dict[str, list[str]] = {}
    for s, c in unknown:
        name = c if classes.index.namesakes(c) else v.local_name(c)
        users.setdefault(name, []).append(_display_name(s))
    if unknown and not skip_unknown:
        text = classes.index.unknown_classes({c: _with_blank_nodes_counted(n) for c, n in users.items()})
        raise errors.UnknownClass(f"{of_file.filename}: {text}" if of_file.filename else text)
    named: list[str] = []
    if nameless := dict(sorted((s, o) for s, _, o in types_said if is_blank(s) and o in spatial)):
        of_content = stated if classes.alignments else triples  # poses in the map frame change with the map
        labels = _make_iris(of_content, nameless, of_file.filename)
        triples = list(blank_nodes.relabel(triples, labels))
        by_property = entity_triples.group_by_property(triples)
        types_said = by_property[v.RDF_TYPE]
        unknown = [(labels.get(s, s), o) for s, o in unknown]
        new = sorted(name for name in map(v.entity_name, labels.values()) if of_file.find(name) is None)
        if new:  # the others had their names at an earlier load
            nodes = wording.counted(len(new), "blank node")
            named.append(f"{nodes} stored with names: {wording.few(new, _FEW)}")
    words = [f"{name} (unknown class '{c}')" for c, names in users.items() for name in names]
    kept = triples
    if unknown:
        described = (own & known).union(c for c in used - _OF_INDIVIDUALS if is_built_in(c))
        removed = {s for s, _ in unknown} - {s for s, _, o in types_said if o in described}
        doubtful = {(s, v.RDF_TYPE, o) for s, o in unknown}
        kept = _without(removed, [t for t in triples if t not in doubtful])
        by_property = entity_triples.group_by_property(kept)
    if names := distinct_names.make_distinct_names(kept, spatial, of_file.find, of_file.prefixes):
        kept = [*kept, *distinct_names.name_triples(names)]
        named.append(distinct_names.describe(names))
    inert = of_rules = ""
    if any(c.startswith(_INERT) for c in used):
        inert = inert_note(count_inert(kept))
        of_rules = undeclared_note(undeclared_terms(kept, known | classes.properties))
    notes = (
        *of_frames,
        *retyped,
        *named,
        *filter(None, (inert, of_rules)),
        *_unknown_properties(by_property, classes),
        *_own_classes(declared, classes),
        *_incomplete_values(by_property, kept),
    )
    return FilteredDocument(kept, words, list(notes))


def _make_iris(triples: Iterable[Triple], nodes: Mapping[Term, Term], filename: str) -> dict[Term, Term]:
    """Return IRIs for blank nodes with these classes.

    They depend on what the document states about the nodes and on its file, so a file that is loaded again
    gives the same, and another file does not. They differ from the IRIs that the document describes.
    """
    about: dict[Term, list[Triple]] = {}
    used: set[Term] = set()
    for triple in triples:
        if is_blank(triple[0]):
            about.setdefault(triple[0], []).append(triple)
        else:
            used.add(triple[0])
    digests: dict[tuple[Term, int], str] = {}

    def digest(node: Term, depth: int) -> str:
        if (node, depth) not in digests:
            content = (
                f"{p} {(digest(o, depth - 1) if depth else '') if is_blank(o) else o}"
                for _, p, o in about.get(node, ())
            )
            text = "\n".join((filename, *sorted(content))).encode()
            digests[node, depth] = hashlib.blake2b(text, digest_size=4).hexdigest()
        return digests[node, depth]

    iris: dict[Term, Term] = {}
    numbers: dict[str, Iterator[int]] = {}
    for node in (s for s in about if s in nodes):
        name = f"{name_stem(v.local_name(nodes[node]))}_{digest(node, _DEPTH)}"
        further = numbers.setdefault(name, count(1))  # thousands may be alike
        alike = (v.entity_iri(name if number == 1 else f"{name}_{number}") for number in further)
        iris[node] = next(free for free in alike if free not in used)
        used.add(iris[node])
    return iris


def undeclared_classes(triples: Iterable[Triple], classes: ClassTable) -> set[Term]:
    """Return the named classes of individuals that neither the TBox nor these triples declare.

    The document that added the individuals declared them, otherwise it would have been rejected.
    """
    types = [(s, o) for s, p, o in triples if p == v.RDF_TYPE and o.startswith("<")]
    declared = {s for s, o in types if o in _CLASSES}.union(classes.names, _OF_STARS)
    return {o for _, o in types if o not in declared and not is_built_in(o)}


def find_undescribed(
    triples: Sequence[Triple], reasoner: Reasoner, stays: Callable[[Triple], bool] = lambda _: True
) -> dict[Term, Triple]:
    """Return named individuals that are referenced but not described, each with the first such triple.

    What the reasoner holds counts as a description, if `stays` is True for it.
    """
    relations = {s for s, _, _ in reasoner.asserted(None, v.RDF_TYPE, v.OWL_OBJECT_PROPERTY)}
    by_property = entity_triples.group_by_property(triples)
    related = {o for p in relations & by_property.keys() for _, _, o in by_property[p]}
    for p in _DESCRIBING:
        related.difference_update(map(itemgetter(0), by_property.get(p, ())))
    related.difference_update(map(itemgetter(2), by_property.get(v.OWL_SAME_AS, ())))
    named = (o for o in related if o.startswith("<"))
    strange = {
        o for o in named if not any(stays(t) for p in _DESCRIBING for t in reasoner.asserted(o, p, None))
    }
    found: dict[Term, Triple] = {}
    for triple in triples if strange else ():
        if triple[2] in strange and triple[1] in relations:
            found.setdefault(triple[2], triple)
    return found


def undescribed_note(found: Mapping[Term, Triple]) -> str:
    """Return one sentence on the undescribed individuals."""
    few = ", ".join(
        f"{_display_name(term)} ({_LABEL.sub(_NAMELESS, v.to_words(triple))})"
        for term, triple in [*found.items()][:_FEW]
    )
    more = f" and {len(found) - _FEW} more" if len(found) > _FEW else ""
    return f"referenced but not described: {few}{more}"


def name_notes(entities: Iterable[Entity]) -> list[str]:
    """Return a note on the entities whose names differ from the last parts of their IRIs."""
    made = {
        entity.name: entity.iri
        for entity in entities
        if not entity.iri.endswith(entity.name) and entity.name == v.own_name(v.iri(entity.iri))
    }
    if not made:
        return []
    few = wording.few([f"{name} (<{iri}>)" for name, iri in sorted(made.items())], _FEW)
    return [f"{wording.counted(len(made), 'name')} made from IRIs, which stay as they are: {few}"]


def _with_subclasses(roots: frozenset[Term], below: list[Triple]) -> set[Term]:
    """Return the classes and their subclasses by `rdfs:subClassOf` triples."""
    found, above = set(roots), [(s, o) for s, _, o in below]
    while more := {s for s, o in above if o in found and s not in found}:
        found |= more
    return found


def _has_other_numbers(by_property: Mapping[Term, list[Triple]], kinds: Mapping[Term, Term]) -> bool:
    """Return whether a number has another datatype than its property requires."""
    return any(
        o.endswith(_NUMBERS)
        for p, kind in kinds.items()
        for _, _, o in by_property.get(p, ())
        if not o.endswith(kind)
    )


def _with_numbers(triples: list[Triple], kinds: Mapping[Term, Term]) -> list[Triple]:
    """Return the triples with the datatypes that the properties of numbers require.

    `0` and `0.5` in Turtle are an integer and a decimal, and many maps use double where the ontology requires
    float.
    """
    return [
        (s, p, v.literal(v.lexical(o), kinds[p])) if p in kinds and o.endswith(_NUMBERS) else (s, p, o)
        for s, p, o in triples
    ]


def _with_datatypes(
    triples: list[Triple], by_property: dict[Term, list[Triple]], classes: ClassTable
) -> tuple[list[Triple], dict[Term, list[Triple]], list[str]]:
    """Return the triples with literals in the ranges of their properties as far as possible, and a note."""
    changed: dict[Triple, Triple] = {}
    counts: dict[str, int] = {}
    for prop in classes.property_table.by_iri.values():
        if prop.data_range is None:
            continue
        usual = tuple(f"^^{datatype}" for datatype in prop.data_range.datatypes)
        for triple in by_property.get(prop.iri, ()):
            s, p, o = triple
            if not o.endswith(usual) and o.startswith('"') and (term := retype(prop.data_range, o)) != o:
                changed[triple] = (s, p, term)
                word = f"{prop.name} ({v.local_name(v.datatype_of(term))})"
                counts[word] = counts.get(word, 0) + 1
    if not changed:
        return triples, by_property, []
    few = ", ".join(list(counts)[:_FEW]) + (" and others" if len(counts) > _FEW else "")
    note = f"{wording.counted(sum(counts.values()), 'value')} stored with the datatype of the property: {few}"
    triples = [changed.get(triple, triple) for triple in triples]
    return triples, entity_triples.group_by_property(triples), [note]


def _unknown_properties(by_property: Mapping[Term, list[Triple]], classes: ClassTable) -> list[str]:
    """Return a note on unknown properties in the TBox's namespace, because they may be misspelt."""
    if not any(p.startswith(_TBOX) for p in classes.properties):
        return []  # the TBox is from elsewhere, and these properties describe entities
    used = {p for p in by_property if p.startswith(_TBOX)} - classes.properties
    declared = {s for s, _, o in by_property.get(v.RDF_TYPE, ()) if o in v.PROPERTY_KINDS} if used else set()
    unknown = used - declared
    if not unknown:
        return []
    nameless = {
        s: f"{_NAMELESS} of class {v.local_name(o)}"
        for s, _, o in by_property.get(v.RDF_TYPE, ())
        if is_blank(s) and not is_blank(o)
    }

    def name(s: Term) -> str:
        return nameless.get(s, _NAMELESS) if is_blank(s) else v.local_name(s)

    users = {
        v.local_name(p): [*dict.fromkeys(name(s) for s, _, _ in by_property[p])]
        for p in by_property
        if p in unknown
    }
    known = declared | classes.properties
    return [errors.unknown_properties(users, map(v.local_name, sorted(known)))]


def _own_classes(declared: set[Term], classes: ClassTable) -> list[str]:
    """Return a note on classes that only the map declares, because clients cannot query them."""
    names = sorted(v.local_name(c) for c in declared.difference(classes.names))
    if not names:
        return []
    few = ", ".join(names[:_FEW]) + (" and others" if len(names) > _FEW else "")
    return [
        f"only the map declares {few}: nothing can be added by such classes; to add them to the TBox, load"
        " the map with --tbox-from-abox"
    ]


def _incomplete_values(by_property: Mapping[Term, list[Triple]], triples: list[Triple]) -> list[str]:
    """Return a note on incomplete positions, orientations and sizes, which are ignored."""
    having = {p: set(map(itemgetter(0), by_property.get(p, ()))) for p in _FLOATS}
    if all(having[p] == having[whole[0]] for whole in _WHOLES for p in whole):
        return []
    numbers: dict[Term, int] = {}
    for s, p, _ in [t for t in triples if t[1] in _FLOATS]:
        numbers[s] = numbers.get(s, 0) | _BITS[p]
    owners = {o: s for s, p, o in triples if p in entity_triples.DESCRIPTION_PROPERTIES and is_blank(o)}
    lacking = [
        f"{_display_name(owners.get(s, s))} has no "
        + " and no ".join(v.local_name(p) for p in whole if not _BITS[p] & bits)
        for s, bits in numbers.items()
        for whole in _WHOLES
        if 0 < sum(_BITS[p] & bits for p in whole) < sum(_BITS[p] for p in whole)
    ]
    if not lacking:
        return []
    few = ", ".join(lacking[:_FEW]) + (f" and {len(lacking) - _FEW} more" if lacking[_FEW:] else "")
    return [f"incomplete position, orientation or size ignored: {few}"]


def _with_blank_nodes_counted(names: Sequence[str]) -> list[str]:
    """Return display names with the number of blank nodes at the end."""
    named = [name for name in names if name != _BLANK]
    count = len(names) - len(named)
    return [*named, wording.counted(count, "blank node")] if count else named


def _display_name(individual: Term) -> str:
    return _BLANK if individual.startswith("_:") else v.entity_name(individual)


def is_built_in(term: Term) -> bool:
    """Return whether a term is part of the vocabularies of OWL, SWRL or SHACL, or an anonymous class."""
    return term.startswith("_:") or (term.startswith("<") and v.bare(term).startswith(_VOCABULARIES))


def _without(removed: set[Term], triples: list[Triple]) -> list[Triple]:
    """Return the triples without those about `removed` and about nodes that describe nothing else."""
    edges = [(s, o) for s, p, o in triples if p in entity_triples.DESCRIPTION_PROPERTIES]
    removed = removed.union({o for s, o in edges if s in removed} - {o for s, o in edges if s not in removed})
    return [(s, p, o) for s, p, o in triples if s not in removed and o not in removed]
