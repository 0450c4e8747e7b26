"""Pattern queries return the same as filtering all facts."""

from __future__ import annotations

import random
from itertools import product

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.rules.general import GeneralEngine
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import SAME_AS, TYPE, is_literal
from tests.kb_node.reasoner.graphs import triple, triples
from tests.kb_node.reasoner.test_worlds import THEMES, follow
from tests.kb_node.reasoner.worlds import World

TBOX = """
:A a owl:Class . :B a owl:Class ; rdfs:subClassOf :A . :C a owl:Class .
:on a owl:ObjectProperty ; rdfs:subPropertyOf :touches . :bears owl:inverseOf :on .
:touches a owl:ObjectProperty , owl:SymmetricProperty .
:part a owl:ObjectProperty , owl:TransitiveProperty ; owl:inverseOf :has .
:near a owl:ObjectProperty . :mass a owl:DatatypeProperty . :weight owl:equivalentProperty :mass .
"""
FACTS = """
:cup1 a :B ; :on :tray1 ; :mass 1 . :cup2 a :B , :C ; :on :tray1 ; :mass "1.0"^^xsd:decimal .
:tray1 a :A ; :part :shelf1 ; :touches :cup1 . :shelf1 :part :room1 ; :mass 2 . :room1 :part :house1 .
:cup1 :near :cup2 .
"""
SAME = ":mug1 owl:sameAs :cup1 . :mug1 :near :lamp1 . :lamp1 owl:sameAs :light1 . "
COMPUTED = triples(
    ":cup1 :near :shelf1 . :cup2 :near :shelf1 . :tray1 :near :cup1 . :cup1 :on :tray1 . :lamp1 :on :shelf1 ."
)


def matches(pattern, fact):
    return all(part in (None, term) for part, term in zip(pattern, fact, strict=True))


def patterns_of(facts):
    """Return all patterns that match one of the facts, and some that match none."""
    found = {
        tuple(term if kept else None for term, kept in zip(fact, mask, strict=True))
        for fact in facts
        for mask in product((True, False), repeat=3)
    }
    none = "<http://example.org/none>"
    return [
        *found,
        (none, None, None),
        (None, none, None),
        (None, None, none),
        (none, TYPE, none),
        (None, TYPE, none),
    ]


@pytest.fixture(params=["", SAME], ids=["all different", "some the same"])
def reasoner(request):
    reasoner = Reasoner(triples(TBOX))
    reasoner.apply(insert=triples(FACTS + request.param))
    reasoner.update_computed(add=COMPUTED)
    assert reasoner.is_compiled
    return reasoner


@pytest.mark.parametrize("ask", ["asserted", "computed", "inferred"])
def test_a_pattern_returns_all_matching_facts(reasoner, ask):
    ask = getattr(reasoner, ask)
    everything = list(ask())
    assert len(everything) == len(set(everything))
    for pattern in patterns_of(everything):
        found = list(ask(*pattern))
        assert sorted(found) == sorted(fact for fact in everything if matches(pattern, fact)), pattern


def test_asserted_facts_are_also_listed_by_subject(reasoner):
    reasoner.apply(delete=triples(":shelf1 a :Shelf ; :part :room1 ; :mass 2 . :room1 :part :house1 ."))
    data = [fact for fact in reasoner.asserted() if not is_schema(fact)]
    listed = list(reasoner._engine._view.by_subject())
    assert sorted(fact for facts in listed for fact in facts) == sorted(data)
    subjects = [{s for s, _, _ in facts} for facts in listed if facts]
    assert all(len(some) == 1 for some in subjects)
    assert len(subjects) == len({s for s, _, _ in data})


def test_conclusions_equal_those_of_the_rules(reasoner):
    """Compared with the general engine."""
    asserted = list(reasoner.asserted())
    general = GeneralEngine([*asserted, *reasoner.computed()])
    said = set(reasoner.computed())
    assert set(reasoner.inferred()) - said == set(general.inferred(None, None, None)) - said
    for fact in (*asserted, *reasoner.inferred(), *said):
        assert reasoner.holds(fact)
    for individual in {s for s, _, _ in asserted}:
        assert reasoner.types(individual) == general.types(individual)


PLAIN = """
:cup1 a :B ; :on :tray1 . :cup2 a :B , :C ; :on :tray1 . :tray1 a :A ; :touches :cup1 . :lamp1 :bears :cup2 .
"""
WHOLE = ":tray1 :part :shelf1 . :shelf1 :part :room1 . :room1 :has :lamp1 . "


@pytest.mark.parametrize(
    "facts", [PLAIN, PLAIN + WHOLE, PLAIN + ":cup2 :weight 3 . "], ids=["things", "parts", "a value"]
)
def test_conclusions_without_literals_equal_those_of_the_rules(facts):
    """Without equal nodes and spellings a faster algorithm is used."""
    reasoner = Reasoner(triples(TBOX))
    reasoner.apply(insert=triples(facts))
    general = GeneralEngine(list(reasoner.asserted()))
    wanted = set(general.inferred(None, None, None))
    for _ in range(2):
        found = list(reasoner.inferred())
        assert len(found) == len(set(found))
        assert set(found) == wanted
    for pattern in patterns_of(wanted):
        assert set(reasoner.inferred(*pattern)) == {fact for fact in wanted if matches(pattern, fact)}
    reasoner.update_computed(add=triples(":cup1 :on :lamp1 ."))
    assert triple(":lamp1 :bears :cup1") in set(reasoner.inferred())
    assert triple(":lamp1 :touches :cup1") in set(reasoner.inferred())


@pytest.mark.parametrize(
    ("fact", "holds"),
    [
        (":cup1 a :A", True),
        (":cup1 a :C", False),
        (":cup1 a :Unknown", False),
        (":unknown a :A", False),
        (":unknown owl:sameAs :unknown", True),
        (":cup1 owl:sameAs :cup1", True),
        (":cup1 owl:sameAs :cup2", False),
        (":cup1 :touches :tray1", True),
        (":tray1 :bears :cup1", True),
        (":cup1 :bears :tray1", False),
        (":cup1 :unknown :tray1", False),
        (":tray1 :part :house1", True),
        (":house1 :has :tray1", True),
        (":house1 :part :tray1", False),
        (":tray1 :part :unknown", False),
        (":cup1 :weight 1", True),
        (':cup2 :mass "1"^^xsd:integer', True),
        (":cup1 :mass 2", False),
        (":shelf1 :weight 2", True),
    ],
)
def test_holds(reasoner, fact, holds):
    assert reasoner.holds(triple(fact)) is holds


def test_asserted_facts_are_returned_by_subject(reasoner):
    asserted = list(reasoner.asserted())
    by_subject = list(reasoner.by_subject())
    assert sorted(fact for facts in by_subject for fact in facts) == sorted(asserted)
    named = {s for s, _, _ in triples(FACTS)}
    parts = [{s for s, _, _ in facts} for facts in by_subject if any(s in named for s, _, _ in facts)]
    assert len(parts) == len(named)
    assert all(len(part) == 1 for part in parts)
    for subject in {s for s, _, _ in asserted}:
        said = {(subject, p, o) for p, objects in reasoner.about(subject).items() for o in objects}
        assert said == {fact for fact in asserted if fact[0] == subject}
    assert reasoner.about("<http://example.org/none>") == {}


def test_computed_and_asserted_facts_are_distinguished(reasoner):
    asserted = set(reasoner.asserted())
    for fact in COMPUTED:
        assert reasoner.is_computed(fact) is (fact not in asserted)
    for fact in asserted:
        assert not reasoner.is_computed(fact)
    for nothing in (
        ":none :near :cup1",
        ":cup1 :near :none",
        ":cup1 :none :shelf1",
        ":cup1 :touches :shelf1",
    ):
        assert not reasoner.is_computed(triple(nothing))


def test_the_individuals_of_a_class(reasoner):
    def named(cls):
        return {
            term
            for term in reasoner.instances(f"<http://example.org/{cls}>")
            if "cup" in term or "tray" in term
        }

    cup1, cup2, tray1 = (f"<http://example.org/{name}>" for name in ("cup1", "cup2", "tray1"))
    assert (named("A"), named("B"), named("C")) == ({cup1, cup2, tray1}, {cup1, cup2}, {cup2})
    assert named("Unknown") == set()
    assert reasoner.types("<http://example.org/none>") == frozenset()


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_a_pattern_returns_all_matching_facts_in_random_worlds(theme):
    for seed in range(4):
        world, random_ = World(seed, theme), random.Random(seed)
        try:
            reasoner = Reasoner(world.asserted)
        except Inconsistent:
            continue
        inferred, asserted = list(reasoner.inferred()), list(reasoner.asserted())
        for everything, ask in (inferred, reasoner.inferred), (asserted, reasoner.asserted):
            facts = random_.sample(everything, min(15, len(everything)))
            for pattern in patterns_of(fact for fact in facts if not is_literal(fact[2])):
                if ask == reasoner.inferred and pattern[1] == SAME_AS and pattern[0] == pattern[2]:
                    continue  # everything is the same as itself
                assert sorted(ask(*pattern)) == sorted(f for f in everything if matches(pattern, f)), pattern


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_patterns_after_changes(theme):
    follow(3, 6, theme)
