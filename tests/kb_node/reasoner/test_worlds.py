"""Random worlds with every construct: the incremental engine is compared with the rule table.

After each change the rule table is applied to all asserted facts from scratch.
"""

import random

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.datatypes import canonical
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.rules.general import GeneralEngine
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import SAME_AS, TYPE, iri, is_literal, is_named
from tests.depth import tries
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.worlds import (
    AXIOMS,
    EQUALITIES,
    KEYS,
    NOMINALS,
    RANGES,
    TRANSITIVE,
    TYPES,
    World,
)

STEPS_OF_A_WORLD = 25
THEMES = {
    "everything": AXIOMS,
    "keys": KEYS,
    "nominals": NOMINALS,
    "transitive": TRANSITIVE,
    "ranges": RANGES,
    "equalities": EQUALITIES,
    "types": TYPES,
}
SCHEMA_PREDICATES = [iri("rdfs:subClassOf"), iri("rdfs:domain"), iri("owl:equivalentProperty")]


def promised(closure, asserted):
    """Return the part of the closure that `inferred` must return."""
    said = {(s, p, canonical(o)) for s, p, o in asserted}
    return {
        (s, p, canonical(o))
        for s, p, o in closure.facts
        if not is_literal(s)
        and is_named(p)
        and not is_schema((s, p, o))
        and not (p == TYPE and not is_named(o))
        and not (p == SAME_AS and s == o)
    } - said


def check(reasoner, closure, asserted, random_):
    """Check a reasoner against the rules."""
    assert reasoner.is_compiled
    assert set(reasoner.asserted()) == set(asserted)
    found = list(reasoner.inferred())
    assert len(found) == len(set(found))
    assert set(found) == promised(closure, asserted)
    for fact in (*asserted, *found):
        assert reasoner.holds(fact)
    general = GeneralEngine(asserted)
    assert set(general.inferred(None, None, None)) == set(found)
    individuals = {
        term for s, _, o in asserted for term in (s, o) if term.startswith("<http://example.org/i")
    }
    for individual in individuals:
        assert reasoner.types(individual) == general.types(individual)
        assert set(reasoner.inferred(individual)) == {fact for fact in found if fact[0] == individual}
    for cls in {o for _, p, o in (*asserted, *found) if p == TYPE and is_named(o)}:
        assert set(reasoner.instances(cls)) == set(general.instances(cls))
    predicate = random_.choice(SCHEMA_PREDICATES)
    assert set(reasoner.inferred(None, predicate)) == set(general.inferred(None, predicate, None))


def refused(reasoner, change):
    """Apply a change; return the explanation of a rejection, or None."""
    try:
        reasoner.apply(delete=change.delete, insert=change.insert)
    except Inconsistent as refusal:
        return refusal.explanation
    return None


def follow(seed, steps, theme):
    """Apply `steps` random changes to one world."""
    world, random_ = World(seed, theme), random.Random(seed)
    closure = Closure(world.asserted)
    while closure.clash is not None:
        world = World(random_.random(), theme)
        closure = Closure(world.asserted)
    reasoner = Reasoner(world.asserted)
    check(reasoner, closure, world.asserted, random_)
    for _ in range(steps):
        change = world.change()
        after = world.after(change)
        closure_after = Closure(after)
        refusal = refused(reasoner, change)
        assert (refusal is None) == (closure_after.clash is None), refusal or closure_after.leaves(None)
        if refusal is None:
            world.accept(change)
            closure = closure_after
        elif random_.random() < 0.1:
            proofs.check(refusal, after)
        check(reasoner, closure, world.asserted, random_)
    found = sorted(reasoner.inferred())
    for fact in random_.sample(found, min(2, len(found))):
        proofs.check(reasoner.explain(fact), world.asserted)


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_hundreds_of_changes(theme):
    for seed in range(tries(10)):
        follow(seed, STEPS_OF_A_WORLD, theme)


@pytest.mark.long
@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_many_thousand_changes(theme):
    for _ in range(250):
        seed = random.randrange(10**9)
        print(seed)  # shown if it fails
        follow(seed, STEPS_OF_A_WORLD, theme)
