"""The class table: what commands need to know of the TBox, worked out once when it is loaded."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import NamedTuple

from msgspec import structs

from nodes.kb_node.entities.property_table import PropertyTable
from nodes.kb_node.reasoner import Reasoner
from ontology import vocabulary as v
from schemas import errors
from schemas.entities import ClassInfo, Entity
from schemas.explanations import Term

_CHUNK = re.compile(r"[^/*$?#\s]+")
_BUILT_IN = frozenset((v.OWL_THING, v.OWL_NOTHING))


class Kind(NamedTuple):
    """What the classes of an entity say of it. Names are local names of the TBox."""

    class_name: str
    """The most special spatial class that is asserted, or else the most special one that follows."""
    types: tuple[str, ...]
    place: bool
    fixed: bool
    model: str


class ClassTable:
    """The named classes of a TBox: which are of things in space, which are places, what they look like."""

    def __init__(self, reasoner: Reasoner) -> None:
        """Raises BadFile when the classes cannot be told apart by their local names, in commands and keys."""
        self._reasoner = reasoner
        self.names: dict[Term, str] = {
            c: v.local_name(c)
            for c, _, _ in sorted(reasoner.asserted(None, v.RDF_TYPE, v.OWL_CLASS))
            if c.startswith("<") and c not in _BUILT_IN
        }
        self.spatial: frozenset[Term] = frozenset().union(*map(self._named_below, self._spatial_roots()))
        self.places: frozenset[Term] = self._named_below(v.LOCATION)
        self.properties = frozenset(
            s for kind in v.PROPERTY_KINDS for s, _, _ in reasoner.asserted(None, v.RDF_TYPE, kind)
        )
        self.iris = _by_name(self.names)
        self.stated = PropertyTable(reasoner)
        self._depth = {c: len(reasoner.superclasses(c)) for c in self.names}
        self._parents = {c: tuple(self._named_parents(c)) for c in self.names}
        self.models: dict[Term, str] = {c: self._nearest(c, v.MODEL) for c in self.names}
        self.fixed: frozenset[Term] = frozenset(c for c in self.names if self._nearest(c, v.FIXED) == "true")
        self._kinds: dict[tuple[frozenset[Term], frozenset[Term]], Kind | None] = {}

    def special_first(self, types: Iterable[Term]) -> list[Term]:
        """Those of `types` that are named classes of the TBox, the most special one first."""
        return sorted((t for t in types if t in self.names), key=lambda c: (-self._depth[c], c))

    def kind(self, types: frozenset[Term], asserted: frozenset[Term]) -> Kind | None:
        """What an individual is that has these classes, some of them asserted; None if it is no entity.

        A map has few combinations of classes, so each is worked out once.
        """
        try:
            return self._kinds[types, asserted]
        except KeyError:
            found = self._kinds[types, asserted] = self._kind(types, asserted)
            return found

    def _kind(self, types: frozenset[Term], asserted: frozenset[Term]) -> Kind | None:
        named = self.special_first(types)
        spatial = [t for t in named if t in self.spatial]
        if not spatial:
            return None
        said = [t for t in spatial if t in asserted] or spatial
        return Kind(
            class_name=self.names[said[0]],
            types=tuple(self.names[t] for t in named),
            place=any(t in self.places for t in named),
            fixed=any(t in self.fixed for t in said),
            model=self.models[said[0]],
        )

    @cached_property
    def rows(self) -> list[ClassInfo]:
        """One row a class, by name, without counts."""
        return sorted(map(self._row, self.names), key=lambda row: row.name)

    def counted(self, entities: Iterable[Entity]) -> Iterator[ClassInfo]:
        """The rows with the number of entities of each class, asserted and inferred."""
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

    def _row(self, c: Term) -> ClassInfo:
        labels = {
            v.language_of(o) or "": v.lexical(o)
            for _, _, o in sorted(self._reasoner.asserted(c, v.RDFS_LABEL, None))
        }
        comments = sorted(o for _, _, o in self._reasoner.asserted(c, v.RDFS_COMMENT, None))
        return ClassInfo(
            name=self.names[c],
            iri=v.bare(c),
            parents=tuple(self.names[p] for p in self._parents[c]),
            ancestors=tuple(self.names[a] for a in self.special_first(self._reasoner.superclasses(c) - {c})),
            labels=labels,
            comment=v.lexical(comments[0]) if comments else "",
            spatial=c in self.spatial,
            place=c in self.places,
            fixed=c in self.fixed,
            model=self.models[c],
        )

    def _spatial_roots(self) -> list[Term]:
        """The domain of hasPosition; if there is none, Physical_Thing, or else whatever is no Property."""
        said = [
            o for _, _, o in self._reasoner.asserted(v.HAS_POSITION, v.RDFS_DOMAIN, None) if o in self.names
        ]
        if said:
            return said
        if v.PHYSICAL_THING in self.names:
            return [v.PHYSICAL_THING]
        properties = self._named_below(v.PROPERTY)
        return [c for c in self.names if c not in properties]

    def _named_below(self, root: Term) -> frozenset[Term]:
        return frozenset(c for c in self._reasoner.subclasses(root) if c in self.names)

    def _named_parents(self, c: Term) -> list[Term]:
        return sorted(
            o for _, _, o in self._reasoner.asserted(c, v.RDFS_SUB_CLASS_OF, None) if o in self.names
        )

    def _nearest(self, c: Term, annotation: Term) -> str:
        """The value of `annotation` at `c` or its nearest ancestor, breadth first; "" when there is none."""
        seen, level = set[Term](), [c]
        while level:
            for ancestor in level:
                if values := [value for _, _, value in self._reasoner.asserted(ancestor, annotation, None)]:
                    return v.lexical(min(values))  # of several always the same one, after a restart too
            seen.update(level)
            level = [p for a in level for p in self._parents.get(a, ()) if p not in seen]
        return ""


def _by_name(names: dict[Term, str]) -> dict[str, Term]:
    iris: dict[str, Term] = {}
    for c, name in names.items():
        if not _CHUNK.fullmatch(name):
            raise errors.BadFile(f"the class {c} of the TBox needs an IRI that ends in a name")
        if iris.setdefault(name, c) != c:
            raise errors.BadFile(f"the TBox has two classes named {name}, {iris[name]} and {c}: rename one")
    return iris
