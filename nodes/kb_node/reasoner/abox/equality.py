"""Equality of nodes: asserted, by value, by a limit on values, or by a key."""

from __future__ import annotations

from collections.abc import Iterator

from semmap.nodes.kb_node.reasoner.abox.abox import ABox, Equals
from semmap.nodes.kb_node.reasoner.explain.reasons import Claim, Clash, Edge, Member, Same, member
from semmap.nodes.kb_node.reasoner.tbox.axioms import ANY, Key, Limit, NotCompilable, Role
from semmap.nodes.kb_node.reasoner.terms import is_literal, is_reserved


class Equality:
    """The rules that equate individuals, or spellings of a value, in an ABox."""

    def __init__(self, abox: ABox) -> None:
        self._abox = abox
        self._store = abox.store
        self._steps = abox.steps

    def merge_spellings(self, literal: int) -> None:
        """Equate a literal with the other spellings of its value (dt-eq)."""
        value = self._abox.value(literal)
        if value is None:
            return
        known = self._abox.spellings.setdefault(value, [])
        if literal not in known:
            known.append(literal)
        if known[0] != literal:
            self.merge(known[0], literal)

    def merge(self, one: int, other: int, *claims: Claim) -> None:
        """Equate two nodes (eq-*): unite members and classes, and process all edges again."""
        first, second = self._abox.equals.get(one), self._abox.equals.get(other)
        if one == other or (first is not None and first is second):
            return
        self._check_joinable(one, other, claims)
        first, second = first or Equals(one), second or Equals(other)
        if len(first.members) < len(second.members):
            first, second = second, first
        added = list(second.members)
        first.members += added
        first.links += second.links
        first.links.append(self._abox.conclude(claims, link=(one, other)))
        for node in first.members:
            self._abox.equals[node] = first
        if not self._abox.is_literal(one):
            self._abox.regrouped.update(first.members)
        if self._abox.is_literal(one) and None in (self._abox.value(one), self._abox.value(other)):
            self._merge_spellings_of(one, other)
        self._abox.widen(one, self._store.kind[one].mask | self._store.kind[other].mask)
        for node in first.members if self._abox.schema.rules else added:  # a rule may name the added nodes
            if self._store.kind[node].mask & self._abox.schema.rule_classes:
                self._abox.dirty[node] = None
            self._abox.fresh += self._store.out.all(node)
            self._abox.fresh += self._store.into.all(node)

    def _merge_spellings_of(self, *literals: int) -> None:
        """Equate a literal without a known value with all spellings of the literal that it equals."""
        self._abox.has_unknown_equals = True
        values = {self._abox.value(literal) for literal in literals} - {None}
        for term, node in list(self._store.numbers.items()) if values else ():
            if is_literal(term) and not self._store.is_bare(node) and self._abox.value(node) in values:
                self.merge_spellings(node)

    def _check_joinable(self, one: int, other: int, claims: tuple[Claim, ...]) -> None:
        terms = self._store.terms
        if self._abox.is_literal(one) and self._abox.is_literal(other):
            both = (*self._abox.members(one), *self._abox.members(other))
            values = {self._abox.value(node) for node in both}
            if len(values - {None}) > 1:
                raise Clash(*claims, *self._different(one, other))
        elif self._abox.is_literal(one) or self._abox.is_literal(other):
            raise NotCompilable(f"an individual is the same as a value: {terms[one]} and {terms[other]}")
        elif any(self._abox.schema.is_used(term) or is_reserved(term) for term in (terms[one], terms[other])):
            raise NotCompilable(
                f"a class or property is the same as another: {terms[one]} and {terms[other]}"
            )

    def _different(self, one: int, other: int) -> Iterator[Claim]:
        """Yield the equality claims of two literals that have different values."""
        for node in (one, other):
            yield from (Same(node, member) for member in self._abox.members(node) if member != node)

    def apply_limit(self, edge: int, owner: int, value: int, limit: Limit) -> None:
        """Equate a value with any other if there may be only one (prp-fp, prp-ifp, cls-maxc2, cls-maxqc*)."""
        group = self._steps.group(limit.role)
        if (
            not group.into
            and len(group.out) == 1
            and owner not in self._abox.equals
            and self._store.out.is_alone(edge)
        ):
            return
        for other, end, found in self._abox.related(owner, group):
            if other == edge or self._abox.is_same(value, found):
                continue
            if limit.filler != ANY and not self._store.kind[found].mask >> limit.filler & 1:
                continue
            claims: list[Claim] = [
                Edge(edge, limit.role),
                Edge(other, limit.role),
                *member(owner, limit.owner),
            ]
            claims += [*member(value, limit.filler), *member(found, limit.filler)]
            if end != owner:
                claims.append(Same(owner, end))
            self.merge(value, found, *claims)
            return

    def apply_key(self, node: int, key: Key) -> None:
        """Equate a node with other members that share a value of every key property (prp-key)."""
        onward = self._steps.group((key.properties[0], False))
        back = self._steps.group((key.properties[0], True))
        for first, end, value in list(self._abox.related(node, onward)):
            for second, there, other in list(self._abox.related(value, back)):
                if self._abox.is_same(other, node) or not self._store.kind[other].mask >> key.owner & 1:
                    continue
                role = (key.properties[0], False)
                claims: list[Claim] = [Edge(first, role), Edge(second, role)]
                claims += [Same(a, b) for a, b in ((node, end), (value, there)) if a != b]
                for p in key.properties[1:]:
                    agreed = self._agreement(node, other, (p, False))
                    if agreed is None:
                        break
                    claims += agreed
                else:
                    self.merge(node, other, *claims, Member(node, key.owner), Member(other, key.owner))

    def _agreement(self, one: int, other: int, role: Role) -> list[Claim] | None:
        """Return the claims that two nodes have a common value of a role, or None."""
        group = self._steps.group(role)
        for first, here, value in self._abox.related(one, group):
            for second, there, found in self._abox.related(other, group):
                if self._abox.is_same(value, found):
                    ends = ((one, here), (other, there), (value, found))
                    return [Edge(first, role), Edge(second, role), *(Same(a, b) for a, b in ends if a != b)]
        return None
