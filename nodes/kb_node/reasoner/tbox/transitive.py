"""Transitive properties whose closure need not be stored.

The number of pairs `x p z` implied by `x p y p z` grows quadratically, and most rules do not need them.
Domain and range follow from the single steps, and membership in a restriction can be passed on along the
steps. The pairs are stored only if a rule needs them (functional, disjoint, irreflexive, chains with others,
keys, SWRL rules, types).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from semmap.nodes.kb_node.reasoner.tbox.axioms import ANY, DIFFERENT

if TYPE_CHECKING:
    from semmap.nodes.kb_node.reasoner.tbox.schema import Schema


def compile_transitive(schema: Schema) -> Iterator[int]:
    """Remove the chains that need not be stored from a schema, and pass restrictions on instead."""
    own = {chain.first: chain for chain in schema.chains if chain.first == chain.second == chain.result}
    paired = {q for chain in schema.chains if chain not in own.values() for q in (chain.first, chain.second)}
    paired |= schema.rules_by_property.keys()
    found = [
        p
        for p in own
        if p > DIFFERENT and not any(_needs_pairs(schema, q, paired) for q in _wider(schema, p))
    ]
    passed = [(p, *_restrictions(schema, p)) for p in found]
    for p, some, only in passed:
        del schema.chains[own[p]]
        schema.axioms[p].some += some
        schema.axioms[p].only += only
    yield from found


def _wider(schema: Schema, p: int) -> set[int]:
    return {q for q, _ in schema.roles(p)}


def _needs_pairs(schema: Schema, q: int, paired: set[int]) -> bool:
    axioms = schema.axioms[q]
    special = axioms.limits or axioms.exclusive or axioms.none or axioms.keys or axioms.irreflexive
    return bool(special) or q in paired or axioms.has_meaning


def _restrictions(schema: Schema, p: int) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Return the restrictions to apply to the subject and to the object of each step.

    The restriction itself is not passed on, because its members may have it without such a value. An
    auxiliary subclass of it is used instead (for allValuesFrom, a subclass of its filler).
    """
    some: dict[tuple[int, int], None] = {}
    only: dict[tuple[int, int], None] = {}
    for q, backwards in schema.roles(p):
        axioms = schema.axioms[q]
        here, there = (only, some) if backwards else (some, only)
        for restriction, filler in axioms.some:
            if filler != ANY:
                passed = _passed(schema, p, restriction, restriction, filler)
                here[(filler, passed) if backwards else (passed, filler)] = None
                here[passed, passed] = None
        for restriction, filler in axioms.only:
            passed = _passed(schema, p, restriction, filler, restriction)
            there[(passed, restriction) if backwards else (restriction, passed)] = None
            there[passed, passed] = None
    return list(some), list(only)


def _passed(schema: Schema, p: int, restriction: int, gained: int, needed: int) -> int:
    names = [schema.axioms[p].term, *(schema.classes[cls] for cls in (restriction, gained, needed))]
    passed = schema.cls(f"{{{' '.join(names)}}}")
    schema.supers[passed] |= schema.supers[gained]
    schema.passed_on[passed] = (restriction, gained)
    return passed
