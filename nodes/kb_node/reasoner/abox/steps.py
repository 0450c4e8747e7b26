"""The effect of an edge on its two individuals, computed once for each pair of kinds."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from semmap.nodes.kb_node.reasoner.abox.kinds import Kind, Kinds, mask_of
from semmap.nodes.kb_node.reasoner.rules.swrl import SwrlRule
from semmap.nodes.kb_node.reasoner.tbox.axioms import ANY, DIFFERENT, SAME, Chain, Group, Key, Limit, Role
from semmap.nodes.kb_node.reasoner.tbox.schema import Schema


@dataclass(frozen=True, slots=True)
class EdgeRules:
    """The rules for new edges of a property that do not depend on kinds."""

    irreflexive: Role | None
    limits: tuple[tuple[bool, Limit], ...]
    """Limits for all individuals (prp-fp, prp-ifp), and whether the owner is the subject."""
    exclusive: tuple[tuple[Role, Role], ...]
    """(implied role, role that must not hold at the same time)."""
    exclusive_group: Group
    """The edges of the subject along which the excluded roles lead."""
    heads: tuple[tuple[bool, Chain], ...]
    """Chains that the edge may start, and whether it is read forwards."""
    tails: tuple[tuple[bool, Chain], ...]
    """Chains that the edge may end."""
    beyond: tuple[Group, Group]
    """The edges of the subject, and of the object, along which these chains continue."""
    by_value: bool
    """Whether literals must be compared by value."""
    only_uniqueness: bool
    """Whether the only check is that the subject has no other edge with the predicate."""
    triggers: tuple[tuple[bool, SwrlRule, int], ...] = ()
    """The SWRL rules and their atoms that the edge may match, and whether it is read forwards."""
    meanings: tuple[Role, ...] = ()
    """The implied roles of rdf:type, owl:sameAs and owl:differentFrom."""

    @property
    def implies_more(self) -> bool:
        """Whether edges may imply more than edges along the roles of their property."""
        return bool(self.triggers or self.meanings)


@dataclass(frozen=True, slots=True)
class Step:
    """The resulting kinds of subject and object, and further checks."""

    subject: Kind
    object: Kind
    clash: tuple[Role, int, int] | None
    """A forbidden combination of role, owner and filler (or ANY) (cls-maxc1, cls-maxqc1)."""
    limits: tuple[tuple[bool, Limit], ...]
    """Limits that apply to the edge, and whether their owner is the subject."""
    keys: tuple[tuple[bool, Key], ...]
    """Keys that apply to the subject (or else the object)."""
    special: bool
    """Whether there are further checks."""
    only_uniqueness: bool
    """Whether no check is needed if the subject has no other edge with the predicate."""
    rules: EdgeRules | None
    """The rules for a new edge that do not depend on kinds; None if there are none."""


class Steps:
    """The cache of steps, and the rules of each property."""

    LIMIT = 50_000
    """Maximum number of cached steps, after which the cache is cleared (a home has about 50)."""

    def __init__(self, schema: Schema, kinds: Kinds) -> None:
        self._schema = schema
        self._kinds = kinds
        self.known: dict[tuple[int, Kind, Kind], Step] = {}
        self._concerned: dict[int, tuple[int, int]] = {}
        self._producing_chains: dict[int, tuple[tuple[bool, Chain], ...]] = {}
        self._chain_starts: dict[int, tuple[Group, Group]] = {}
        self._derived: dict[int, bool] = {}
        self._rules: dict[int, EdgeRules | None] = {}

    def step(self, prop: int, subject: Kind, object_: Kind) -> Step:
        """Return the effect of an edge of a property on two kinds."""
        found = self.known.get((prop, subject, object_))
        if found is None:
            if len(self.known) >= self.LIMIT:
                self.known.clear()
            found = self.known[prop, subject, object_] = self._compute(prop, subject, object_)
        return found

    def rules(self, prop: int) -> EdgeRules | None:
        """Return the rules for new edges of a property that do not depend on kinds, or None."""
        if prop not in self._rules:
            self._rules[prop] = self._edge_rules(prop)
        return self._rules[prop]

    def relevant_classes(self, prop: int) -> tuple[int, int]:
        """Return the classes of the subject and of the object that affect the steps of a property."""
        found = self._concerned.get(prop)
        if found is None:
            masks = [0, 0]
            for q, backwards in self._schema.roles(prop):
                axioms = self._schema.axioms[q]
                owners = [r for r, _ in (*axioms.only, *axioms.none)]
                owners += [limit.owner for limit in axioms.limits] + [key.owner for key in axioms.keys]
                fillers = [cls for _, cls in (*axioms.some, *axioms.none)]
                fillers += [limit.filler for limit in axioms.limits]
                for classes, which in ((owners, backwards), (fillers, not backwards)):
                    masks[which] |= mask_of({cls for cls in classes if cls != ANY})
            found = self._concerned[prop] = masks[0], masks[1]
        return found

    def producing_chains(self, prop: int) -> tuple[tuple[bool, Chain], ...]:
        """Return the chains that may imply the same as an edge of a property, and whether backwards."""
        found = self._producing_chains.get(prop)
        if found is None:
            found = self._producing_chains[prop] = tuple(
                (backwards, chain)
                for q, backwards in self._schema.roles(prop)
                for chain in self._schema.chains
                if chain.result == q
            )
        return found

    def may_be_derived(self, prop: int) -> bool:
        """Return whether a chain or a SWRL rule may imply the same as an edge of a property."""
        found = self._derived.get(prop)
        if found is None:
            is_result = self._schema.rules_by_head.keys() & {q for q, _ in self._schema.roles(prop)}
            found = self._derived[prop] = bool(is_result or self.producing_chains(prop))
        return found

    def chain_starts(self, prop: int) -> tuple[Group, Group]:
        """Return where `producing_chains` start: the groups of a subject, and backwards of an object."""
        found = self._chain_starts.get(prop)
        if found is None:
            groups: tuple[list[Group], list[Group]] = [], []
            for backwards, chain in self.producing_chains(prop):
                groups[backwards].append(self.group((chain.first, False)))
            found = self._chain_starts[prop] = _union(groups[False]), _union(groups[True])
        return found

    def group(self, role: Role) -> Group:
        """Return the edges along which a role leads."""
        return self._schema.group(role)

    def _compute(self, prop: int, subject: Kind, object_: Kind) -> Step:
        wider_subject, wider_object = self._widened(prop, subject, object_)
        if wider_subject is not subject or wider_object is not object_:
            return self.step(prop, wider_subject, wider_object)
        clash, keys = None, []
        limits: list[tuple[bool, Limit]] = []
        for role in self._schema.roles(prop):
            q, backwards = role
            owner, filler = (object_, subject) if backwards else (subject, object_)
            axioms = self._schema.axioms[q]
            for restriction, cls in axioms.none:
                if _in(restriction, owner) and _in(cls, filler):
                    clash = (role, restriction, cls)
            limits += [
                (not backwards, limit)
                for limit in axioms.limits
                if limit.owner != ANY
                and Limit(limit.role, ANY, ANY) not in axioms.limits
                and _in(limit.owner, owner)
                and _in(limit.filler, filler)
            ]
            keys += [(not backwards, key) for key in axioms.keys if _in(key.owner, owner)]
        others = bool(clash or keys or object_.clash)
        only_uniqueness = not others and self._only_check_uniqueness(prop, limits)
        rules = self.rules(prop)
        return Step(
            subject,
            object_,
            clash,
            tuple(limits),
            tuple(keys),
            others or bool(limits),
            only_uniqueness,
            rules,
        )

    def _only_check_uniqueness(self, prop: int, limits: list[tuple[bool, Limit]]) -> bool:
        """Return whether limits are met if the subject has no other edge with the predicate."""
        alone = Group((prop,), ())
        return all(at_subject and self.group(limit.role) == alone for at_subject, limit in limits)

    def _widened(self, prop: int, subject: Kind, object_: Kind) -> tuple[Kind, Kind]:
        """Return the kinds after domains, ranges and restrictions are applied once."""
        to_subject = to_object = 0
        for q, backwards in self._schema.roles(prop):
            axioms = self._schema.axioms[q]
            x, y = (object_, subject) if backwards else (subject, object_)
            to_x, to_y = axioms.domain, axioms.range
            for restriction, cls in axioms.some:
                if _in(cls, y):
                    to_x |= 1 << restriction
            for restriction, cls in axioms.only:
                if _in(restriction, x):
                    to_y |= 1 << cls
            if backwards:
                to_subject, to_object = to_subject | to_y, to_object | to_x
            else:
                to_subject, to_object = to_subject | to_x, to_object | to_y
        return self._kinds.widen(subject, to_subject), self._kinds.widen(object_, to_object)

    def _edge_rules(self, prop: int) -> EdgeRules | None:
        schema = self._schema
        roles = schema.roles(prop) if prop != SAME else {}
        irreflexive = next((role for role in roles if schema.axioms[role[0]].irreflexive), None)
        limits: list[tuple[bool, Limit]] = []
        exclusive: list[tuple[Role, Role]] = []
        heads: list[tuple[bool, Chain]] = []
        tails: list[tuple[bool, Chain]] = []
        by_value = False
        for role in roles:
            q, backwards = role
            axioms = schema.axioms[q]
            for limit in axioms.limits:
                if limit.owner == ANY:
                    limits.append((limit.role[1] == backwards, limit))
                    by_value |= limit.role[1]
            exclusive += [(role, (other, backwards != flip)) for other, flip in axioms.exclusive]
            heads += [(not backwards, chain) for chain in schema.chains if chain.first == q]
            tails += [(not backwards, chain) for chain in schema.chains if chain.second == q]
            by_value |= bool(axioms.keys or axioms.exclusive)
        triggers = tuple(
            (not backwards, rule, at)
            for q, backwards in roles
            if q != DIFFERENT  # as one of `meanings`, it is derived as an edge of its own
            for rule, at in schema.rules_by_property.get(q, ())
        )
        meanings = tuple(role for role in roles if schema.axioms[role[0]].has_meaning and role[0] != prop)
        by_value |= bool(heads or tails or triggers or meanings)
        others = by_value or irreflexive or exclusive or heads or tails
        if not (limits or others):
            return None
        beyond: tuple[list[Group], list[Group]] = [], []
        for forwards, chain in heads:
            beyond[forwards].append(self.group((chain.second, False)))
        for forwards, chain in tails:
            beyond[not forwards].append(self.group((chain.first, True)))
        return EdgeRules(
            irreflexive=irreflexive,
            limits=tuple(limits),
            exclusive=tuple(exclusive),
            exclusive_group=_union(self.group(other) for _, other in exclusive),
            heads=tuple(heads),
            tails=tuple(tails),
            beyond=(_union(beyond[False]), _union(beyond[True])),
            by_value=by_value,
            only_uniqueness=not others and self._only_check_uniqueness(prop, limits),
            triggers=triggers,
            meanings=meanings,
        )


def _union(groups: Iterable[Group]) -> Group:
    """Return the union of groups."""
    out, into = dict[int, None](), dict[int, None]()
    for group in groups:
        out.update(dict.fromkeys(group.out))
        into.update(dict.fromkeys(group.into))
    return Group(tuple(out), tuple(into))


def _in(cls: int, kind: Kind) -> bool:
    return cls == ANY or bool(kind.mask >> cls & 1)
