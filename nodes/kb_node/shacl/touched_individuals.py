"""Finds the individuals that a commit may make valid or invalid."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from itertools import chain
from math import inf
from typing import Final, NamedTuple

from semmap.nodes.kb_node.derived_facts import DerivedChanges
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.shacl.property_paths import PropertyPaths, find_property_paths
from semmap.nodes.kb_node.shacl.shape_triples import SHACL, read_list
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Commit
from semmap.schemas.explanations import Term, Triple

_CHAIN: Final = v.iri(f"{v.OWL}propertyChainAxiom")
_TRANSITIVE: Final = v.iri(f"{v.OWL}TransitiveProperty")
_SYMMETRIC: Final = v.iri(f"{v.OWL}SymmetricProperty")
_INVERSE: Final = v.iri(f"{v.OWL}inverseOf")
_TARGET_OBJECTS_OF: Final = v.iri(f"{SHACL}targetObjectsOf")
_SWRL: Final = "http://www.w3.org/2003/11/swrl#"
_HEAD: Final = v.iri(f"{_SWRL}head")
_PREDICATE: Final = v.iri(f"{_SWRL}propertyPredicate")


class Reach(NamedTuple):
    """How far a change may be from the individuals that become valid or invalid by it."""

    paths: PropertyPaths
    """The property paths of the shapes."""
    chained: frozenset[Term]
    """Transitive properties, and the members of property chains."""
    concluded: frozenset[Term]
    """The properties in the heads of SWRL rules. What a rule compares may be anywhere in the map."""
    reads_values: bool
    """Whether a shape is about the values of a property, or follows one from its values."""

    @classmethod
    def of(cls, tbox: Collection[Triple]) -> Reach:
        """Return the reach of the shapes and axioms of a TBox."""
        values = {(s, p): o for s, p, o in tbox if p in (v.RDF_FIRST, v.RDF_REST, _PREDICATE)}
        chains = (read_list(o, values) for _, p, o in tbox if p == _CHAIN)
        transitive = (s for s, p, o in tbox if p == v.RDF_TYPE and o == _TRANSITIVE)
        chained = frozenset(chain(chain.from_iterable(chains), transitive))
        turned = {one for s, p, o in tbox if p == _INVERSE for one in (s, o)}
        turned.update(s for s, p, o in tbox if p == v.RDF_TYPE and o == _SYMMETRIC)
        concluded_by_chains = chained.union(s for s, p, _ in tbox if p == _CHAIN)
        paths = find_property_paths(tbox)
        atoms = chain.from_iterable(read_list(o, values) for _, p, o in tbox if p == _HEAD)
        return cls(
            paths=paths,
            chained=chained,
            concluded=frozenset(values[atom, _PREDICATE] for atom in atoms if (atom, _PREDICATE) in values),
            reads_values=bool(paths.inverse)
            or not turned.isdisjoint(paths.forward - concluded_by_chains)
            or any(p == _TARGET_OBJECTS_OF for _, p, _ in tbox),
        )


class TouchedIndividuals:
    """Finds the individuals that a commit touches. It is created before the reasoner has the change.

    They are those whose facts or classes change, their values, what refers to them, and the individuals from
    which the paths of the shapes lead to them. A fact may also follow from a change elsewhere: the facts
    about both ends of each changed triple and the conclusions of SWRL rules are compared, and the members of
    property chains are followed.
    """

    def __init__(self, commit: Commit, reasoner: Reasoner, reach: Reach) -> None:
        """Read the facts about the individuals of the commit."""
        self._reasoner = reasoner
        self._reach = reach
        subjects, values = _ends(chain(commit.inserted, commit.retracted))
        self._ends = subjects | _individuals(values)
        self._by_value: dict[Term, list[Triple]] = {}
        """The facts by value that have been looked up, since several steps need the same."""
        self._before = self._read_facts()
        self._reclassified = set[Term]()

    def add_reclassified(self, terms: Iterable[Term]) -> None:
        """Add individuals whose classes or equal individuals have changed."""
        self._reclassified.update(terms)

    def find(self, commit: Commit, derived: DerivedChanges) -> set[Term]:
        """Return the individuals and values. The reasoner has the change, and the commit its entities."""
        self._by_value.clear()
        after = self._read_facts()
        subjects, values = _ends(chain(commit.inserted, commit.retracted, *derived))
        core = subjects | self._reclassified | {v.iri(entity.iri) for entity in commit.changed}
        referring = {s for s, _, o in self._before | after if o in core}
        referring.update(s for s, _, _ in self._facts_about(core - self._ends))
        followed = self._before ^ after
        changed = [*commit.inserted, *commit.retracted, *chain(*derived), *followed]
        core.update(s for s, _, _ in followed)
        core |= self._find_chained_subjects(changed)
        if self._reach.reads_values:
            values |= self._find_chained_values(changed)
        starts = core | values if self._reach.paths.inverse else core
        reached = self._reach.paths.find_starts(_individuals(starts), self._holding)
        return core | values | referring | reached

    def _find_chained_subjects(self, changed: Iterable[Triple]) -> set[Term]:
        """Return the subjects of the changed triples, and of what may follow from them by property chains."""
        subjects = {s for s, p, o in changed if p != v.RDF_TYPE and not o.startswith('"')}
        back = PropertyPaths(forward=self._reach.chained, length=inf)
        return back.find_starts(subjects | self._reclassified, self._holding)

    def _find_chained_values(self, changed: Iterable[Triple]) -> set[Term]:
        """Return the values of the changed triples, and of what may follow from them by property chains."""
        values = {o for _, p, o in changed if p != v.RDF_TYPE}
        ahead = PropertyPaths(inverse=self._reach.chained, length=inf)
        return values | ahead.find_starts(_individuals(values) | self._reclassified, self._holding)

    def _read_facts(self) -> set[Triple]:
        """Return the facts about the ends of the changed triples, and those that SWRL rules may conclude."""
        reasoner = self._reasoner
        facts = self._facts_about(self._ends)
        for term in self._ends:
            facts.update(self._holding(term, None, None))
        for p in self._reach.concluded:
            facts.update(reasoner.inferred(None, p, None))
        return facts

    def _facts_about(self, terms: Iterable[Term]) -> set[Triple]:
        """Return the facts whose value is one of `terms`."""
        return {fact for term in terms for fact in self._holding(None, None, term)}

    def _holding(self, s: Term | None, p: Term | None, o: Term | None) -> Iterable[Triple]:
        given, inferred = self._reasoner.given, self._reasoner.inferred
        if s is not None or p is not None or o is None:
            return chain(given(s, p, o), inferred(s, p, o))
        if (known := self._by_value.get(o)) is None:
            known = self._by_value[o] = [*given(None, None, o), *inferred(None, None, o)]
        return known


def _ends(triples: Iterable[Triple]) -> tuple[set[Term], set[Term]]:
    """Return the subjects of triples, and their values, which include literals but not classes."""
    subjects, values = set[Term](), set[Term]()
    for s, p, o in triples:
        subjects.add(s)
        if p != v.RDF_TYPE:
            values.add(o)
    return subjects, values


def _individuals(values: Iterable[Term]) -> set[Term]:
    return {term for term in values if not term.startswith('"')}
