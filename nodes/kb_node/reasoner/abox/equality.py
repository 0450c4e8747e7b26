"""When two nodes are the same: asserted, by value, by a limit on values, by a key."""

from __future__ import annotations

from collections.abc import Iterator

from nodes.kb_node.reasoner.abox.individuals import Equals, Individuals
from nodes.kb_node.reasoner.explain.reasons import Claim, Clash, Edge, Member, Reason, Same, member
from nodes.kb_node.reasoner.tbox.axioms import ANY, Key, Limit, NotCompilable, Role
from nodes.kb_node.reasoner.terms import is_literal


class Equality(Individuals):
    """Individuals with the rules that make them the same."""

    def _meet(self, literal: int) -> None:
        """Spellings of one value are the same node where that matters (dt-eq)."""
        value = self.value(literal)
        if value is None:
            return
        known = self.spellings.setdefault(value, [])
        if literal not in known:
            known.append(literal)
        if known[0] != literal:
            self._join(known[0], literal)

    def _join(self, one: int, other: int, *claims: Claim) -> None:
        """Two nodes are the same (eq-*): one set of members, one mask, and all edges looked at anew."""
        mine, theirs = self.equals.get(one), self.equals.get(other)
        if one == other or (mine is not None and mine is theirs):
            return
        self._check_joinable(one, other, claims)
        mine, theirs = mine or Equals(one), theirs or Equals(other)
        if len(mine.members) < len(theirs.members):
            mine, theirs = theirs, mine
        newcomers = list(theirs.members)
        mine.members += newcomers
        mine.links += theirs.links
        mine.links.append(self._remember(Reason(next(self._order), claims, link=(one, other))))
        for node in mine.members:
            self.equals[node] = mine
        if self.is_literal(one) and None in (self.value(one), self.value(other)):
            self._mix(one, other)
        self._widen(one, self.store.kind[one].mask | self.store.kind[other].mask)
        for node in newcomers:
            self.fresh += self.store.out.all(node)
            self.fresh += self.store.into.all(node)

    def _mix(self, *literals: int) -> None:
        """A literal without a known value is the same as another: so it is as all spellings of that one."""
        self.is_mixed = True
        values = {self.value(literal) for literal in literals} - {None}
        for term, node in list(self.store.numbers.items()) if values else ():
            if is_literal(term) and not self.store.is_bare(node) and self.value(node) in values:
                self._meet(node)

    def _check_joinable(self, one: int, other: int, claims: tuple[Claim, ...]) -> None:
        terms = self.store.terms
        if self.is_literal(one) and self.is_literal(other):
            values = {self.value(node) for node in (*self.members(one), *self.members(other))}
            if len(values - {None}) > 1:
                raise Clash(*claims, *self._different(one, other))
        elif self.is_literal(one) or self.is_literal(other):
            raise NotCompilable(f"an individual is the same as a value: {terms[one]} and {terms[other]}")
        elif self.schema.speaks_of(terms[one]) or self.schema.speaks_of(terms[other]):
            raise NotCompilable(
                f"a class or property is the same as another: {terms[one]} and {terms[other]}"
            )

    def _different(self, one: int, other: int) -> Iterator[Claim]:
        """The literals known to be the same as two, among which are two values."""
        for node in (one, other):
            yield from (Same(node, member) for member in self.members(node) if member != node)

    def _limit(self, edge: int, owner: int, value: int, limit: Limit) -> None:
        """At most one value: this one and any other are the same (prp-fp, prp-ifp, cls-maxc2, cls-maxqc*)."""
        group = self.steps.group(limit.role)
        if (
            not group.into
            and len(group.out) == 1
            and owner not in self.equals
            and self.store.out.is_alone(edge)
        ):
            return
        for other, end, found in self.related(owner, group):
            if other == edge or self.is_same(value, found):
                continue
            if limit.filler != ANY and not self.store.kind[found].mask >> limit.filler & 1:
                continue
            claims: list[Claim] = [
                Edge(edge, limit.role),
                Edge(other, limit.role),
                *member(owner, limit.owner),
            ]
            claims += [*member(value, limit.filler), *member(found, limit.filler)]
            if end != owner:
                claims.append(Same(owner, end))
            self._join(value, found, *claims)
            return

    def _identify(self, node: int, key: Key) -> None:
        """Somebody else of the class who has a value in common for every property of the key (prp-key)."""
        onward = self.steps.group((key.properties[0], False))
        back = self.steps.group((key.properties[0], True))
        for first, end, value in list(self.related(node, onward)):
            for second, there, other in list(self.related(value, back)):
                if self.is_same(other, node) or not self.store.kind[other].mask >> key.owner & 1:
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
                    self._join(node, other, *claims, Member(node, key.owner), Member(other, key.owner))

    def _agreement(self, one: int, other: int, role: Role) -> list[Claim] | None:
        """Two edges that lead from two nodes to the same value, or None."""
        group = self.steps.group(role)
        for first, here, value in self.related(one, group):
            for second, there, found in self.related(other, group):
                if self.is_same(value, found):
                    ends = ((one, here), (other, there), (value, found))
                    return [Edge(first, role), Edge(second, role), *(Same(a, b) for a, b in ends if a != b)]
        return None
