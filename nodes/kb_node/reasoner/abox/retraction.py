"""Deletion: exactly what would be there had the deleted triples never been.

What was concluded from a deleted edge is dropped, whatever else it may rest on. A node whose kind is not
borne out by what was asserted of it and of its neighbours is reset to what it was given, and its neighbours
are asked in turn. Then everything that was reset runs forward again, as if it were new.
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
    """One batch of deletions; `run` of the saturation draws the conclusions anew."""

    def __init__(self, abox: ABox, saturation: Saturation) -> None:
        self._abox = abox
        self._saturation = saturation
        self._store = abox.store
        self._suspects: dict[int, None] = {}
        self._reset: set[int] = set()
        self._separated: set[int] = set()
        self._dropped: list[tuple[int, int, int]] = []
        self.touched: set[int] = set()
        """Nodes that lost something: an asserted class, an edge."""

    def delete(
        self, triples: Sequence[Triple], computed: Sequence[Triple] = ()
    ) -> tuple[list[Triple], list[Triple]]:
        """Take triples back, and what rests on them; those that were there, asserted and computed."""
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
        return types + edges, others

    def release(self) -> None:
        """Forget the nodes that nothing is said of any more."""
        for node in self.touched:
            self._store.release(node)

    def _forget_spellings(self) -> None:
        for node in list(self.touched):
            if self._abox.is_literal(node) and self._store.is_bare(node):
                self._abox.forget_spelling(node)
                if equals := self._abox.equals.get(node):
                    self._dissolve(equals)

    # What goes

    def _remove_type(self, s: Term, _: Term, o: Term) -> bool:
        store = self._store
        subject, cls = store.find(s), self._abox.schema.find_class(o)
        if subject is None or cls is None or cls not in store.kind[subject].given:
            return False
        self._abox.set(subject, self._abox.kinds.without(store.kind[subject], cls))
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
        """Remove an edge and what rests on it."""
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
        """The ends of an edge that may have classes because of it, beyond those that they were given.

        So a room that loses a cup need not be asked about all else that is in it. Of ends that were reset
        nobody knows any more what they had said of each other.
        """
        s, p, o = edge
        subject, object_ = self._store.kind[s], self._store.kind[o]
        if p <= DIFFERENT or s in self._reset or o in self._reset:
            yield from (s, o)
            return
        step, store = self._abox.steps.step, self._store
        said = step(p, subject.base, object_).subject
        if said is not subject.base and not self._says(store.out.first(s, p), said, at_subject=True):
            yield s
        said = step(p, subject, object_.base).object
        if said is not object_.base and not self._says(store.into.first(o, p), said, at_subject=False):
            yield o

    def _says(self, edge: int, kind: Kind, *, at_subject: bool) -> bool:
        """Whether an edge, if there is one, makes its end of a kind by what was given to both ends alone.

        Then that need not be asked about another edge that said the same: nothing goes in a circle.
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
        """Members are individuals of their own again, until the links that are left say otherwise."""
        for link in equals.links:
            link.alive = False
        for member in equals.members:
            del self._abox.equals[member]
        for member in equals.members:
            self._separated.add(member)
            self._reset_one(member)

    # What stays

    def _is_supported(self, node: int) -> bool:
        """Whether assertions about a node and its neighbours make all of its kind.

        Nodes that are the same do not count: what made them the same may rest on this node's kind.
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
        """What an edge alone says of a node, if the edge is given or comes with an asserted class."""
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
        """Back to the given classes: what rests on the others goes, and the neighbours become suspects."""
        if node in self._reset:
            return
        self._reset.add(node)
        abox, store = self._abox, self._store
        abox.set(node, store.kind[node].base)
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

    # What comes back

    def _rederive(self, subject: int, predicate: int, object_: int) -> None:
        """What a dropped edge implied may follow from others: by a chain, or with a class."""
        abox = self._abox
        for node, other in ((subject, object_), (object_, subject)):
            if self._may_have_been_a_value(node, other):
                self._saturation.add_values(node)
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

    def _may_have_been_a_value(self, node: int, other: int) -> bool:
        """Whether a node's classes come with values of which another, which it lost, may have been one."""
        values = self._store.kind[node].value_terms
        if not values:
            return False
        is_one = self._store.terms[other] in values
        # or it stood for one that is the same
        return is_one or bool(self._abox.equals or self._separated) or self._abox.is_literal(other)

    def _look_for_middle(self, x: int, z: int, chain: Chain) -> None:
        """An individual between two that a chain goes through, sought from the end with fewer edges."""
        abox = self._abox
        onward: Role = (chain.second, False)
        back: Role = (chain.first, True)
        forwards = abox.related(x, abox.steps.group((chain.first, False)))
        backwards = abox.related(z, abox.steps.group((chain.second, True)))
        for (one, _, after), (other, _, before) in zip(forwards, backwards, strict=False):
            second, first = abox.find(after, onward, z), abox.find(before, back, x)
            for pair in ((one, second), (first, other)):
                if NONE not in pair:
                    self._saturation.make_chain(chain, x, z, *pair, *abox.bridges(pair, x, z))
                    return
