"""Deletion. The result is exactly the state without the deleted triples.

Conclusions from a deleted edge are dropped, even if they have other reasons. A node is reset to its given
classes if the assertions about it and its neighbours do not support its kind. Then its neighbours are
checked. Finally the rules run forward for everything that was reset.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from semmap.nodes.kb_node.reasoner.abox.abox import ABox, Equals
from semmap.nodes.kb_node.reasoner.abox.adjacency import NONE
from semmap.nodes.kb_node.reasoner.abox.kinds import Kind
from semmap.nodes.kb_node.reasoner.abox.saturation import Saturation
from semmap.nodes.kb_node.reasoner.abox.store import ASSERTED, COMPUTED, GIVEN, VALUE
from semmap.nodes.kb_node.reasoner.explain.reasons import Reason
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.tbox.axioms import DIFFERENT, Chain, Role
from semmap.nodes.kb_node.reasoner.terms import TYPE


class Retraction:
    """One batch of deletions. Afterwards `Saturation.run` draws the conclusions again."""

    def __init__(self, abox: ABox, saturation: Saturation) -> None:
        self._abox = abox
        self._saturation = saturation
        self._store = abox.store
        self._suspects: dict[int, None] = {}
        self._reset: set[int] = set()
        self._separated: set[int] = set()
        self._dropped: list[tuple[int, int, int]] = []
        self.touched: set[int] = set()
        """The nodes that lost an asserted class or an edge."""

    def delete(
        self, triples: Sequence[Triple], computed: Sequence[Triple] = ()
    ) -> tuple[list[Triple], list[Triple]]:
        """Delete asserted and computed triples with their conclusions; return those that were present."""
        types = [triple for triple in triples if triple[1] == TYPE and self._remove_type(*triple)]
        edges = [triple for triple in triples if triple[1] != TYPE and self._remove_edge(*triple, ASSERTED)]
        others = [triple for triple in computed if self._remove_edge(*triple, COMPUTED)]
        while self._suspects:
            node, _ = self._suspects.popitem()
            kind = self._store.kind[node]
            if kind.base is not kind and node not in self._reset and not self._is_supported(node):
                self._reset_all(node)
        if self._abox.spellings:
            self._forget_spellings()
        for node in self._separated:
            self._abox.fresh += self._store.out.all(node)
            self._abox.fresh += self._store.into.all(node)
        for edge in self._dropped:
            self._rederive(*edge)
        if self._separated and self._abox.schema.rules:
            self._saturation.apply_rules()
        return types + edges, others

    def release(self) -> None:
        """Remove the nodes without facts."""
        for node in self.touched:
            if node not in self._abox.equals:
                self._store.release(node)

    def _forget_spellings(self) -> None:
        for node in list(self.touched):
            if self._abox.is_literal(node) and self._store.is_bare(node):
                self._abox.forget_spelling(node)
                if equals := self._abox.equals.get(node):
                    self._dissolve(equals)

    # Removal

    def _remove_type(self, s: Term, _: Term, o: Term) -> bool:
        store = self._store
        subject, cls = store.find(s), self._abox.schema.find_class(o)
        if subject is None or cls is None or cls not in store.kind[subject].given:
            return False
        self._abox.set_kind(subject, self._abox.kinds.without(store.kind[subject], cls))
        self.touched.add(subject)
        self._suspects[subject] = None
        return True

    def _remove_edge(self, s: Term, p: Term, o: Term, source: int) -> bool:
        store, numbers = self._store, self._store.numbers
        subject, object_, predicate = numbers.get(s), numbers.get(o), self._abox.schema.find_property(p)
        if subject is None or object_ is None or predicate is None:
            return False
        edge = store.edge(subject, predicate, object_)
        if edge == NONE or store.source[edge] != source:
            return False
        self._drop(edge)
        return True

    def _drop(self, edge: int) -> None:
        """Remove an edge and the conclusions that depend on it."""
        store = self._store
        edge_was = store.subject[edge], store.predicate[edge], store.object[edge]
        ends = edge_was[0], edge_was[2]
        self._dropped.append(edge_was)
        store.remove(edge)
        self.touched.update(ends)
        self._suspects.update(dict.fromkeys(self._affected_ends(edge_was)))
        if reason := self._abox.reasons.pop(edge, None):
            reason.alive = False
        for reason in self._abox.reasons_by_edge.pop(edge, ()):
            self._cancel(reason)

    def _affected_ends(self, edge: tuple[int, int, int]) -> Iterator[int]:
        """Yield the ends of a removed edge that may have inferred classes because of it.

        This avoids visiting all other edges, for example of a room that loses a cup. If an end was reset, its
        earlier kind is unknown, and both ends are returned.
        """
        s, p, o = edge
        subject, object_ = self._store.kind[s], self._store.kind[o]
        if p <= DIFFERENT or s in self._reset or o in self._reset:
            yield from (s, o)
            return
        step, store = self._abox.steps.step, self._store
        implied = step(p, subject.base, object_).subject
        if implied is not subject.base and not self._implies(store.out.first(s, p), implied, at_subject=True):
            yield s
        implied = step(p, subject, object_.base).object
        if implied is not object_.base and not self._implies(
            store.into.first(o, p), implied, at_subject=False
        ):
            yield o

    def _implies(self, edge: int, kind: Kind, *, at_subject: bool) -> bool:
        """Return whether an edge, if there is one, implies a kind by the given classes of both ends alone.

        Then the kind of the end is supported without circular reasoning.
        """
        store = self._store
        if edge == NONE or store.source[edge] not in GIVEN:
            return False
        subject, object_ = store.kind[store.subject[edge]], store.kind[store.object[edge]]
        step = self._abox.steps.step(store.predicate[edge], subject.base, object_.base)
        return (step.subject if at_subject else step.object) is kind

    def _cancel(self, reason: Reason) -> None:
        if not reason.alive:
            return
        reason.alive = False
        if reason.edge is not None:
            self._drop(reason.edge)
        elif reason.link is not None and (equals := self._abox.equals.get(reason.link[0])):
            self._dissolve(equals)

    def _dissolve(self, equals: Equals) -> None:
        """Separate equal nodes. The remaining links may equate them again."""
        for link in equals.links:
            link.alive = False
        for member in equals.members:
            del self._abox.equals[member]
            self.touched.add(member)
            if not self._abox.is_literal(member):
                self._abox.regrouped.add(member)
        for member in equals.members:
            self._separated.add(member)
            self._reset_one(member)

    # Support

    def _is_supported(self, node: int) -> bool:
        """Return whether the assertions about a node and its neighbours imply all of its kind.

        Equal nodes are not considered, because their equality may depend on this node's kind.
        """
        close, store = self._abox.kinds.close, self._store
        wanted = store.kind[node].mask
        found = store.kind[node].base.mask
        if found == wanted:
            return True
        for side in (store.out, store.into):
            for edge in side.all(node):
                found |= self._classes_from(edge, node)
                if found == wanted:
                    return True
        return close(found) == wanted

    def _classes_from(self, edge: int, node: int) -> int:
        """Return the classes that an edge alone implies, if it is given or implied by an asserted class."""
        store = self._store
        s, p, o = store.subject[edge], store.predicate[edge], store.object[edge]
        subject, object_ = store.kind[s].base, store.kind[o].base
        source = store.source[edge]
        if source not in GIVEN and not (source == VALUE and self._is_value_of_class(edge)):
            return 0
        step = self._abox.steps.step(p, subject, object_)
        return step.subject.mask if node == s else step.object.mask

    def _is_value_of_class(self, edge: int) -> bool:
        store = self._store
        value = (store.predicate[edge], store.terms[store.object[edge]])
        return value in store.kind[store.subject[edge]].base.values

    def _reset_all(self, node: int) -> None:
        equals = self._abox.equals.get(node)
        if equals is not None:
            self._dissolve(equals)
        else:
            self._reset_one(node)

    def _reset_one(self, node: int) -> None:
        """Reset a node to its given classes, drop what depends on the others, and suspect its neighbours."""
        if node in self._reset:
            return
        self._reset.add(node)
        abox, store = self._abox, self._store
        abox.set_kind(node, store.kind[node].base)
        abox.dirty[node] = None
        for reason in abox.reasons_by_node.pop(node, ()):
            self._cancel(reason)
        for edge in list(store.out.all(node)):
            if store.source[edge] == VALUE:
                self._drop(edge)
        for edge in store.out.all(node):
            self._suspects[store.object[edge]] = None
        for edge in store.into.all(node):
            self._suspects[store.subject[edge]] = None

    # Derivation

    def _rederive(self, subject: int, predicate: int, object_: int) -> None:
        """Derive what a dropped edge implied from other facts: by a chain, or by a class."""
        abox = self._abox
        for node, other in ((subject, object_), (object_, subject)):
            if self._may_have_been_a_value(node, other):
                self._saturation.add_values(node)
        if abox.schema.rules:
            for q, backwards in abox.schema.roles(predicate):
                ends = (object_, subject) if backwards else (subject, object_)
                self._saturation.apply_rules_for(ends[0], q, ends[1])
        if predicate == DIFFERENT or predicate in abox.schema.memberships:
            self._process_meanings(subject, predicate)
        steps = abox.steps
        if not (producing_chains := steps.producing_chains(predicate)):
            return
        begins = [
            abox.has_any(node, group)
            for node, group in zip((subject, object_), steps.chain_starts(predicate), strict=True)
        ]
        for backwards, chain in producing_chains:
            if begins[backwards]:
                self._look_for_middle(*((object_, subject) if backwards else (subject, object_)), chain)

    def _process_meanings(self, subject: int, predicate: int) -> None:
        """Process the edges again that may have implied an edge by a subproperty of the vocabulary."""
        abox = self._abox
        prop = DIFFERENT if predicate == DIFFERENT else abox.schema.find_property(TYPE)
        if prop is not None:
            abox.fresh += [edge for edge, _, _ in abox.related(subject, abox.steps.group((prop, False)))]

    def _may_have_been_a_value(self, node: int, other: int) -> bool:
        """Return whether a lost neighbour may have been a value implied by the node's classes."""
        values = self._store.kind[node].value_terms
        if not values:
            return False
        is_one = self._store.terms[other] in values
        # or it was equal to such a value
        return is_one or bool(self._abox.equals or self._separated) or self._abox.is_literal(other)

    def _look_for_middle(self, x: int, z: int, chain: Chain) -> None:
        """Find an individual in the middle of a chain, searching from the end with fewer edges."""
        abox = self._abox
        onward: Role = (chain.second, False)
        back: Role = (chain.first, True)
        forwards = abox.related(x, abox.steps.group((chain.first, False)))
        backwards = abox.related(z, abox.steps.group((chain.second, True)))
        for (one, _, after), (other, _, before) in zip(forwards, backwards, strict=False):
            second, first = abox.find(after, onward, z), abox.find(before, back, x)
            for pair in ((one, second), (first, other)):
                if NONE not in pair:
                    self._saturation.make_chain(chain, x, z, *pair, *abox.equality_claims(pair, x, z))
                    return
