"""The class table: the information on TBox classes that commands need, computed once per TBox."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import NamedTuple

from msgspec import structs

from semmap.nodes.kb_node.entities import alignments
from semmap.nodes.kb_node.entities.alignments import Alignment
from semmap.nodes.kb_node.entities.property_names import PropertyNames
from semmap.nodes.kb_node.entities.property_table import PropertyTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.relations.measuring import thresholds
from semmap.ontology import entity_triples, prefixes
from semmap.ontology import vocabulary as v
from semmap.ontology.name_index import Named, NameIndex
from semmap.schemas.entities import ClassInfo, Entity
from semmap.schemas.explanations import Term

_BUILT_IN = frozenset((v.OWL_THING, v.OWL_NOTHING))
_CLASSES = (v.OWL_CLASS, v.RDFS_CLASS)
_TRUE = frozenset(v.literal(text, v.XSD_BOOLEAN) for text in ("true", "1"))
_NUMBERS = (v.XSD_FLOAT, v.iri(v.XSD + "double"))
_LABELS = (v.RDFS_LABEL, v.SKOS_PREF_LABEL, v.SKOS_ALT_LABEL)


class Kind(NamedTuple):
    """What the classes of an entity imply. Names are those of the class table."""

    class_name: str
    """The most specific asserted spatial class, or else the most specific inferred one."""
    types: tuple[str, ...]
    place: bool
    fixed: bool
    model: str


class ClassTable:
    """The named classes of a TBox: which are spatial, which are places, and their models."""

    def __init__(self, reasoner: Reasoner) -> None:
        self._reasoner = reasoner
        declared = {s for kind in _CLASSES for s, _, _ in reasoner.asserted(None, v.RDF_TYPE, kind)}
        classes = sorted(c for c in declared if c.startswith("<") and c not in _BUILT_IN)
        self.properties = frozenset(
            s for kind in v.PROPERTY_KINDS for s, _, _ in reasoner.asserted(None, v.RDF_TYPE, kind)
        )
        self.prefixes = prefixes.prefixes_of(
            (prefixes.split(term)[0] for term in (*classes, *self.properties) if term.startswith("<")),
            prefixes.declared_in(reasoner.asserted(None, prefixes.PREFERRED_PREFIX, None)),
        )
        """The prefixes of the namespaces in which the TBox has classes and properties."""
        self.names: dict[Term, str] = prefixes.names(classes, self.prefixes)
        """Class to name: its local name, with a prefix if several classes share it."""
        self.iris = {name: c for c, name in self.names.items()}
        self.prefixed: dict[Term, str] = {c: prefixes.prefixed(c, self.prefixes) for c in self.names}
        """Class to name with its prefix, which is always unambiguous."""
        reasoner.words.disambiguate(self.prefixed)
        reasoner.words.name_individual = v.entity_name
        self.alignments: tuple[Alignment, ...] = alignments.find_for_namespaces(self.prefixes.values())
        """The alignments that apply to the TBox."""
        self.edges = frozenset(entity_triples.DESCRIPTION_PROPERTIES).union(
            *(known.edges for known in self.alignments)
        )
        """The properties that lead from an entity to the individuals that describe it."""
        self.entry_properties = frozenset[Term]().union(
            *(known.entry_properties for known in self.alignments)
        )
        """The properties of alignments by which an entity begins to describe itself."""
        self.declared_roots = tuple(
            sorted(s for s, _, o in reasoner.asserted(None, v.SPATIAL, None) if o in _TRUE)
        )
        """The roots that the TBox or the option `--spatial-root` declares."""
        self.spatial_roots: tuple[Term, ...] = tuple(self._spatial_roots())
        """The roots of the spatial classes."""
        self.spatial: frozenset[Term] = self._named_below(*self.spatial_roots)
        self._solid = self._named_below(*(c for known in self.alignments for c in known.solid))
        places = self._named_below(v.LOCATION, *(c for known in self.alignments for c in known.places))
        self.places: frozenset[Term] = places - self._solid
        self.property_names = PropertyNames(reasoner, self.properties, self.prefixes)
        self.property_table = PropertyTable(
            reasoner, self.property_names, self.names, self.prefixes, self.edges | self.entry_properties
        )
        self._depth = {c: len(reasoner.superclasses(c)) for c in self.names}
        self._parents = {c: tuple(self._named_parents(c)) for c in self.names}
        named = {**self.names, **self.property_names.names}
        self.qualified_names: dict[Term, str] = {
            t: name for t, name in named.items() if name != v.local_name(t)
        }
        """The classes and properties whose names have a prefix because they are ambiguous."""
        self.models: dict[Term, str] = {c: self._nearest(c, v.MODEL) for c in self.names}
        built_in = self._named_below(*(c for known in self.alignments for c in known.fixed))
        self.fixed: frozenset[Term] = frozenset(
            c for c in self.names if (self._nearest(c, v.FIXED) or str(c in built_in).lower()) == "true"
        )
        self.limits = thresholds.read_thresholds(
            lambda p, a: (o for _, _, o in reasoner.asserted(p, a, None))
        )
        """The thresholds of the spatial relations."""
        self._spoken: dict[frozenset[Term], tuple[str, ...]] = {}
        self._kinds: dict[tuple[frozenset[Term], frozenset[Term]], Kind | None] = {}

    @cached_property
    def number_datatypes(self) -> dict[Term, Term]:
        """The numeric datatypes of properties: those of semmap, and with alignments all of the TBox."""
        known = dict.fromkeys((*v.COORDINATE_XYZ, *v.ORIENTATION_WXYZ, *v.SIZE_XYZ), v.XSD_FLOAT)
        if self.alignments:
            for p in self.properties:
                if (kind := self._number_kind(p, frozenset())) is not None:
                    known.setdefault(p, kind)
        return known

    def _number_kind(self, p: Term, seen: frozenset[Term]) -> Term | None:
        """Return the numeric datatype in the range of a property or of its superproperties."""
        kinds = {o for _, _, o in self._reasoner.asserted(p, v.RDFS_RANGE, None)}.intersection(_NUMBERS)
        if kinds:
            return min(kinds)
        above = {o for _, _, o in self._reasoner.asserted(p, v.RDFS_SUB_PROPERTY_OF, None)} - seen - {p}
        found = (self._number_kind(q, seen | {p}) for q in sorted(above))
        return next(filter(None, found), None)

    @property
    def ambiguous(self) -> dict[str, tuple[str, ...]]:
        """The local names that several classes share, with the unambiguous names."""
        shared = prefixes.told_apart(self.names.keys(), self.prefixes)
        return {local: tuple(names) for local, names in shared.items()}

    def most_specific_first(self, types: Iterable[Term]) -> list[Term]:
        """Return those of `types` that are named classes of the TBox, the most specific first."""
        return sorted((t for t in types if t in self.names), key=lambda c: (-self._depth[c], c))

    def kind(self, types: frozenset[Term], asserted: frozenset[Term]) -> Kind | None:
        """Return what these classes imply for an individual, or None if it is not an entity.

        A map has few combinations of classes, so each is computed once.
        """
        try:
            return self._kinds[types, asserted]
        except KeyError:
            found = self._kinds[types, asserted] = self._kind(types, asserted)
            return found

    def type_names(self, types: frozenset[Term]) -> tuple[str, ...]:
        """Return the names of an individual's classes, the most specific first."""
        known = self._spoken.get(types)
        if known is None:
            known = self._spoken[types] = tuple(self.names[t] for t in self.most_specific_first(types))
        return known

    def _kind(self, types: frozenset[Term], asserted: frozenset[Term]) -> Kind | None:
        named = self.most_specific_first(types)
        spatial = [t for t in named if t in self.spatial]
        if not spatial:
            return None
        declared = [t for t in spatial if t in asserted] or spatial
        return Kind(
            class_name=self.names[declared[0]],
            types=tuple(self.names[t] for t in named),
            place=any(t in self.places for t in named) and self._solid.isdisjoint(named),
            fixed=any(t in self.fixed for t in declared),
            model=self.models[declared[0]],
        )

    @cached_property
    def rows(self) -> list[ClassInfo]:
        """One row per class, by name, without counts."""
        return sorted(map(self._row, self.names), key=lambda row: row.name)

    def with_counts(self, entities: Iterable[Entity]) -> Iterator[ClassInfo]:
        """Return the rows with the number of asserted and inferred entities of each class."""
        asserted: dict[str, int] = {}
        inferred: dict[str, int] = {}
        for entity in entities:
            asserted[entity.class_] = asserted.get(entity.class_, 0) + 1
            for name in entity.types:
                inferred[name] = inferred.get(name, 0) + 1
        return (
            structs.replace(row, asserted=asserted.get(row.name, 0), inferred=inferred.get(row.name, 0))
            for row in self.rows
        )

    @cached_property
    def index(self) -> NameIndex:
        """An index of classes by names and labels."""
        return NameIndex(
            Named(row.name, row.iri, row.prefixed, (*row.labels.values(), *row.also)) for row in self.rows
        )

    def _row(self, c: Term) -> ClassInfo:
        labels: dict[str, str] = {}
        also: dict[str, None] = {}
        for label in _LABELS:
            for _, _, o in sorted(self._reasoner.asserted(c, label, None)):
                text = v.lexical(o) if o.startswith('"') else ""
                if text and labels.setdefault(v.language_of(o) or "", text) != text:
                    also[text] = None
        comments = sorted(o for _, _, o in self._reasoner.asserted(c, v.RDFS_COMMENT, None) if o[0] == '"')
        return ClassInfo(
            name=self.names[c],
            iri=v.bare(c),
            prefixed=self.prefixed[c],
            parents=tuple(self.names[p] for p in self._parents[c]),
            ancestors=tuple(
                self.names[a] for a in self.most_specific_first(self._reasoner.superclasses(c) - {c})
            ),
            labels=labels,
            also=tuple(also),
            comment=v.lexical(comments[0]) if comments else "",
            spatial=c in self.spatial,
            place=c in self.places,
            fixed=c in self.fixed,
            model=self.models[c],
        )

    def _spatial_roots(self) -> list[Term]:
        """Return the declared spatial roots, or else those of the alignments.

        A root is declared by `dm:spatial`, the domain of hasPosition, or Physical_Thing. In a household TBox
        without any of these, all classes except properties are spatial. In any other TBox, none is.
        """
        asserted = self._reasoner.asserted
        declared = set(self.declared_roots) or {
            o for _, _, o in asserted(v.HAS_POSITION, v.RDFS_DOMAIN, None)
        }
        declared = {c for c in declared if c in self.names} or {v.PHYSICAL_THING}.intersection(self.names)
        declared = declared or {c for known in self.alignments for c in known.things if self._named_below(c)}
        if not declared and v.TBOX in self.prefixes.values():
            declared = set(self.names) - self._named_below(v.PROPERTY)
        return sorted(declared)

    def _named_below(self, *roots: Term) -> frozenset[Term]:
        return frozenset(c for root in roots for c in self._reasoner.subclasses(root) if c in self.names)

    def _named_parents(self, c: Term) -> list[Term]:
        return sorted(
            o for _, _, o in self._reasoner.asserted(c, v.RDFS_SUB_CLASS_OF, None) if o in self.names
        )

    def _nearest(self, c: Term, annotation: Term) -> str:
        """Return the value of `annotation` at `c` or its nearest ancestor, breadth first, or ""."""
        seen, level = set[Term](), [c]
        while level:
            for ancestor in level:
                if values := [value for _, _, value in self._reasoner.asserted(ancestor, annotation, None)]:
                    return v.lexical(min(values))  # the smallest, so that it is the same after a restart
            seen.update(level)
            level = [p for a in level for p in self._parents.get(a, ()) if p not in seen]
        return ""
