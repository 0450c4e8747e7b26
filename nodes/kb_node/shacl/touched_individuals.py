"""Finds the individuals that a commit may make valid or invalid."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from itertools import chain
from math import inf
from typing import Final, NamedTuple

from semmap.nodes.kb_node.derived_facts import DerivedChanges
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.shacl.property_paths import PropertyPaths, find_property_paths
from semmap.nodes.kb_node.shacl.relations import Relations
from semmap.nodes.kb_node.shacl.shape_triples import CLOSED, COMPARISONS, TARGETED_VALUES, read_list
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Commit
from semmap.schemas.explanations import Term, Triple

_CHAIN: Final = v.iri(f"{v.OWL}propertyChainAxiom")
_TRANSITIVE: Final = v.iri(f"{v.OWL}TransitiveProperty")
_INVERSE: Final = v.iri(f"{v.OWL}inverseOf")
_SWRL: Final = "http://www.w3.org/2003/11/swrl#"
_HEAD: Final = v.iri(f"{_SWRL}head")
_PREDICATE: Final = v.iri(f"{_SWRL}propertyPredicate")


class Reach(NamedTuple):
    """How far a change may be from the individuals that become valid or invalid by it."""

    paths: PropertyPaths
    """The property paths of the shapes."""
    forward: Relations
    """The properties that the paths follow from subjects to values."""
    inverse: Relations
    """The properties that the paths follow from values to subjects."""
    compared: Relations
    """The properties that the values of a path are compared with."""
    closes_values: bool
    """Whether the values of a path may have facts of some properties only."""
    targeted: Relations
    """The properties whose values are targets of shapes."""
    chained: Relations
    """Transitive properties, and the members of property chains."""
    follows_values: bool
    """Whether paths may begin at the values of what follows by property chains."""
    concluded: frozenset[Term]
    """The properties in the heads of SWRL rules. What a rule compares may be anywhere in the map."""

    @classmethod
    def of(cls, tbox: Collection[Triple]) -> Reach:
        """Return the reach of the shapes and axioms of a TBox."""
        values = {(s, p): o for s, p, o in tbox if p in (v.RDF_FIRST, v.RDF_REST, _PREDICATE)}
        chains = (read_list(o, values) for _, p, o in tbox if p == _CHAIN)
        transitive = {s for s, p, o in tbox if p == v.RDF_TYPE and o == _TRANSITIVE}
        inverses = [(s, o) for s, p, o in tbox if p == _INVERSE]
        # What follows from one of two inverse transitive properties also follows from the other.
        mirrored = {end for ends in inverses if transitive.issuperset(ends) for end in ends}
        linked = (transitive - mirrored).union(s for s, p, _ in tbox if p == _CHAIN)
        atoms = chain.from_iterable(read_list(o, values) for _, p, o in tbox if p == _HEAD)
        paths = find_property_paths(tbox)
        forward, inverse = (Relations.of(each, tbox) for each in (paths.forward, paths.inverse))
        return cls(
            paths=paths,
            forward=forward,
            inverse=inverse,
            compared=Relations.of((o for _, p, o in tbox if p in COMPARISONS), tbox),
            closes_values=any(p == CLOSED for _, p, _ in tbox) and paths.length > 0,
            targeted=Relations.of((o for _, p, o in tbox if p == TARGETED_VALUES), tbox),
            chained=Relations.of(chain(chain.from_iterable(chains), transitive), tbox),
            follows_values=bool(paths.inverse) or not forward.reverse.isdisjoint(linked),
            concluded=frozenset(values[atom, _PREDICATE] for atom in atoms if (atom, _PREDICATE) in values),
        )


class TouchedIndividuals:
    """Finds the individuals that a commit touches. It is created before the reasoner has the change.

    They are those whose facts or classes change, their values, what refers to them, and the individuals from
    which the paths of the shapes lead to a changed fact or class. A fact may also follow from a change
    elsewhere: the facts about the subject of each changed triple and the conclusions of SWRL rules are
    compared, and the members of property chains are followed.

    Paths are followed back only from facts that they read. What is put into a room changes facts about the
    room, too, but not what is read about the other contents.
    """

    def __init__(self, commit: Commit, reasoner: Reasoner, reach: Reach) -> None:
        """Read the facts about the individuals of the commit."""
        self._reasoner = reasoner
        self._reach = reach
        self._subjects = {s for s, _, _ in chain(commit.inserted, commit.retracted)}
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
        referring.update(s for s, _, _ in self._facts_about(core - self._subjects))
        changed = {*commit.inserted, *commit.retracted, *chain(*derived), *(self._before ^ after)}
        facts = [triple for triple in changed if triple[1] != v.RDF_TYPE]
        reclassified = self._reclassified.union(s for s, p, _ in changed if p == v.RDF_TYPE)
        subjects, chained_values = self._follow_chains(facts, reclassified)
        reached = self._find_reading(facts, reclassified, subjects, chained_values)
        targets = self._find_targets(facts, reclassified) | chained_values
        return core | values | referring | subjects | reached | targets | {s for s, _, _ in changed}

    def _follow_chains(self, facts: list[Triple], reclassified: set[Term]) -> tuple[set[Term], set[Term]]:
        """Return the subjects of what may follow by property chains, and the values if shapes depend on them.

        The chain may begin with one of the changed `facts`, or with one that follows from a class.
        """
        chained, reach = self._reach.chained, self._reach
        relations = [(s, o) for s, o in chained.select(facts) if not o.startswith('"')]
        back = PropertyPaths(forward=chained.properties, length=inf)
        subjects = back.find_starts(reclassified.union(s for s, _ in relations), self._holding)
        if not (reach.follows_values or reach.targeted.properties):
            return subjects, set()
        on = PropertyPaths(inverse=chained.properties, length=inf)
        return subjects, on.find_starts(reclassified.union(o for _, o in relations), self._holding)

    def _find_reading(
        self, facts: list[Triple], reclassified: set[Term], subjects: set[Term], values: set[Term]
    ) -> set[Term]:
        """Return the individuals whose paths read changed facts or classes.

        `subjects` and `values` are those of facts that may follow by property chains.
        """
        reach = self._reach
        ends = reclassified.union(s for s, _ in reach.compared.select(facts))
        if reach.closes_values:
            ends.update(s for s, _, _ in facts)
        steps = subjects.union(s for s, _ in reach.forward.select(facts))
        steps.update(o for _, o in reach.inverse.select(facts))
        if reach.follows_values:
            steps |= values
        before_a_step = reach.paths._replace(length=reach.paths.length - 1)  # the changed fact is one step
        return reach.paths.find_starts(_individuals(ends), self._holding) | before_a_step.find_starts(
            _individuals(steps), self._holding
        )

    def _find_targets(self, facts: list[Triple], reclassified: set[Term]) -> set[Term]:
        """Return the values that may have become targets of shapes."""
        targeted = self._reach.targeted
        found = {o for _, o in targeted.select(facts)}
        for p in targeted.properties:  # a class may imply a value
            found.update(o for term in reclassified for _, _, o in self._holding(term, p, None))
        return found

    def _read_facts(self) -> set[Triple]:
        """Return the facts about the subjects of the commit, and those that SWRL rules may conclude.

        All facts about the values would be too many: a room is the value of each of its contents.
        """
        reasoner = self._reasoner
        facts = self._facts_about(self._subjects)
        for term in self._subjects:
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
