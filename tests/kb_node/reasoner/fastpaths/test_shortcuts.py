import random

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.fastpaths import paths
from semmap.nodes.kb_node.reasoner.fastpaths.shortcuts import (
    remove_independent,
    remove_individuals,
    replace_literals,
)
from semmap.nodes.kb_node.reasoner.terms import TYPE
from tests.kb_node.reasoner.fastpaths.test_many_edges import THEMES
from tests.kb_node.reasoner.graphs import EVERYTHING, triple, triples
from tests.kb_node.reasoner.test_reasoner import BASE, asserted_in, check_same
from tests.kb_node.reasoner.worlds import World

STAR = ':a a :C ; :free :a1 ; :free :old . :a1 :fundata "1.5"^^xsd:float ; :key2 "a" .'
REST = ':old a :B ; :fundata "2.5"^^xsd:float .'


@pytest.fixture
def reasoner():
    return Reasoner([*asserted_in(BASE), *triples(STAR + REST)])


def same_as_fresh(reasoner, turtle):
    check_same(reasoner, dict.fromkeys([*asserted_in(BASE), *triples(turtle)]), BASE)


def test_an_object_is_removed_with_all_its_facts(reasoner):
    assert remove_individuals(reasoner._engine._abox, triples(STAR)) == {
        triple(":a a :C")[0],
        triple(":a1 a :C")[0],
    }
    assert not reasoner.mentioned({triple(":a1 a :C")[0]})
    assert not list(reasoner.inferred(triple(":a a :C")[0]))


@pytest.mark.parametrize(
    ("more", "gone"),
    [
        ("", STAR + " :a :free :i6 ."),
        ("", STAR.replace(" a :C ;", "")),
        (" :old :free :a .", STAR),
        (" :a owl:sameAs :old .", STAR),
        (" :a :p :old .", STAR + " :a :p :old ."),
        (" :a :tra :i6 . :i6 :tra :i5 .", STAR + " :a :tra :i6 ."),
        (' :i6 :key2 "a"^^xsd:token .', STAR),
    ],
)
def test_there_is_no_shortcut_if_other_individuals_are_affected(reasoner, more, gone):
    """More or fewer triples are deleted than exist, or others refer to the object or depend on it."""
    reasoner.apply(insert=triples(more))
    assert remove_individuals(reasoner._engine._abox, triples(gone)) is None
    reasoner.apply(delete=triples(gone))
    left = [fact for fact in triples(STAR + REST + more) if fact not in triples(gone)]
    check_same(reasoner, dict.fromkeys([*asserted_in(BASE), *left]), BASE)


def values(*texts):
    return [triple(f':a1 :fundata "{text}"^^xsd:float') for text in texts]


def test_a_number_is_replaced(reasoner):
    assert replace_literals(reasoner._engine._abox, values("1.5"), values("2.5")) == {triple(":a1 a :C")[0]}
    same_as_fresh(reasoner, STAR.replace("1.5", "2.5") + REST)


@pytest.mark.parametrize(
    ("delete", "insert"),
    [
        (values("9.5"), values("2.5")),
        (values("1.5"), [triple(':a1 :key2 "b"')]),
        (values("1.5"), [triple(':old :fundata "3.5"^^xsd:float')]),
        (values("1.5"), [triple(":a1 :fundata 2")]),
        (values("1.5", "1.5"), values("2.5", "3.5")),
        ([triple(":a :free :old")], [triple(":a :free :i6")]),
    ],
)
def test_there_is_no_shortcut_for_other_replacements(reasoner, delete, insert):
    """An absent value; another property, subject or kind; one value for two; not a literal."""
    before = set(reasoner.asserted())
    assert replace_literals(reasoner._engine._abox, delete, insert) is None
    try:
        reasoner.apply(delete=delete, insert=insert)
        before = (before - set(delete)) | set(insert)
    except Inconsistent:
        pass
    check_same(reasoner, dict.fromkeys(before), BASE)


def test_an_ill_typed_replacement_is_rejected(reasoner):
    with pytest.raises(Inconsistent, match='"abc" is not a value of float'):
        reasoner.apply(delete=values("1.5"), insert=values("abc"))
    same_as_fresh(reasoner, STAR + REST)


@pytest.mark.parametrize("text", ["abc", "٣", "1_0"])
def test_an_invalid_number_is_rejected_together_with_a_valid_one(text):
    """Two values of a functional property, one of them invalid, are undone in both orders."""
    reasoner = Reasoner(triples(EVERYTHING))
    facts = [triple(f':x :fundata "{number}"^^xsd:float') for number in (text, "1.0")]
    for insert in (facts, facts[::-1]):
        with pytest.raises(Inconsistent):
            reasoner.apply(insert=insert)
        assert not reasoner.mentioned({facts[0][0]})
    reasoner.apply(insert=facts[1:])


def state(reasoner):
    asserted = list(reasoner.asserted())
    individuals = {term for s, p, o in asserted for term in (s, o) if p != TYPE and term[0] == "<"}
    types = {individual: reasoner.types(individual) for individual in individuals}
    return set(asserted), set(reasoner.inferred()), types, len(reasoner)


def follow(monkeypatch, seed, theme):
    """Remove individuals by the shortcut and by the rules; return the number of removed triples."""
    world, random_ = World(seed, theme), random.Random(seed)
    try:
        pair = Reasoner(world.asserted), Reasoner(world.asserted)
    except Inconsistent:
        return 0
    removed = []

    def remove_and_record(*of):
        gone = remove_independent(*of)
        removed.extend(gone)
        return gone

    monkeypatch.setattr(paths, "remove_individuals", lambda *_: None)
    monkeypatch.setattr(paths, "remove_independent", remove_and_record)
    for _ in range(10):
        insert = [world._fact() for _ in range(random_.randint(1, 12))]
        if is_refused(pair[0], insert) or is_refused(pair[1], insert):
            continue
        asserted = sorted(set(pair[0].asserted()).difference(world.asserted))
        subjects = sorted({t[0] for t in asserted})
        going = set(random_.sample(subjects, random_.randint(0, len(subjects))))
        delete = [t for t in asserted if t[0] in going or random_.random() < 0.1]
        for reasoner, many in zip(pair, (1, 10**9), strict=True):
            monkeypatch.setattr(paths, "MANY_DELETED", many)
            reasoner.apply(delete=delete)
        assert state(pair[0]) == state(pair[1]), delete
    return len(removed)


def is_refused(reasoner, insert):
    try:
        reasoner.apply(insert=insert)
    except Inconsistent:
        return True
    return False


@pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))
def test_bulk_removal_equals_removal_by_the_rules(monkeypatch, theme):
    assert sum(follow(monkeypatch, seed, theme) for seed in range(20)) > 10


def test_only_independent_individuals_are_removed_in_bulk(reasoner):
    others = triples(":x a :C . :y a :C ; :free :x . :z a :C . :i6 :free :z . :w a :C ; :p :i6 .")
    reasoner.apply(insert=others)
    gone = [t for t in [*triples(STAR), *others] if t[0] != triple(":i6 a :C")[0]]
    removed = remove_independent(reasoner._engine._abox, gone)
    assert set(removed) == {*triples(STAR), *triples(":x a :C . :y a :C ; :free :x .")}
    left = [*asserted_in(BASE), *triples(REST), *(t for t in others if t not in removed)]
    assert state(reasoner)[:3] == state(Reasoner(left))[:3]
