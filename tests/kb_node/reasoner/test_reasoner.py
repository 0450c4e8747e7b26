from functools import cache
from itertools import islice, permutations

import pytest
from hypothesis import HealthCheck, given, note, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner, compiled, datatypes
from semmap.nodes.kb_node.reasoner.compiled import CompiledEngine
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import TYPE, is_literal
from tests.depth import tries
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.facts import ANY_FACT, INDIVIDUALS, facts, prefixed
from tests.kb_node.reasoner.graphs import EVERYTHING, household, triple, triples

BASE = Closure(triples(EVERYTHING))
HOME = cache(lambda: Closure(household()))


@pytest.fixture(autouse=True)
def _closed_once(monkeypatch):
    """Close the schema once, because it is the same in all examples."""
    close = cache(lambda facts: Closure(facts))
    monkeypatch.setattr(compiled, "Closure", lambda facts: close(tuple(facts)))


def asserted_in(base):
    return [fact for fact, reason in base.facts.items() if reason is None]


def closure_of(asserted, base):
    return Closure((fact for fact in asserted if fact not in base.facts), base=base)


def _changes(facts):
    return st.lists(
        st.tuples(st.lists(st.integers(0, 200), max_size=3), st.lists(facts, max_size=4)),
        min_size=10,
        max_size=10,
    )


def _at_home(names):
    return prefixed("dm", names.split())


CHANGES = _changes(ANY_FACT)
AT_HOME = _changes(
    facts(
        [*INDIVIDUALS, "dm:color_red", "dm:grasping"],
        _at_home("Kitchen Chair Can Drug Tap Sink Person Coordinates Container Wall Food Fridge"),
        _at_home(
            "isOn isInside holds isLocatedIn isSubLocationOf isPartOf isDirectPartOf hasHandle isConnectedBy "
            "connects controls isOwnedBy hasMainColor hasPosition hasAffordance"
        ),
        _at_home("mass isOpen lexicalReference float_coordinates_x"),
        ['"1.0"^^xsd:float', '"1.00"^^xsd:float', '"-0.0"^^xsd:float', "true", '"a"', "2"],
    )
)


def expected(closure, base, asserted):
    """Return what `inferred` must return for a closure that started from `base`, whose facts come first."""
    inferable = [*_inferable_of_base(base), *_inferable(islice(closure.facts, len(base.facts), None))]
    return {fact for fact in inferable if fact not in asserted}


@cache
def _inferable_of_base(base):
    return _inferable(base.facts)


def _inferable(facts):
    return [
        (s, p, o)
        for s, p, o in facts
        if not is_literal(s) and not is_schema((s, p, o)) and not (p == TYPE and o[0] != "<")
    ]


def _canonical(fact):
    """Return a triple with its literal, if any, in the canonical spelling."""
    s, p, o = fact
    return (s, p, datatypes.canonical(o))


def check_same(reasoner, asserted, base, closure=None):
    """Check a reasoner against a fresh closure of the asserted facts (`closure`, if it exists already)."""
    closure = closure or closure_of(asserted, base)
    assert closure.clash is None
    assert set(reasoner.asserted()) == set(asserted)
    assert len(reasoner) == len(asserted)
    individuals = {t for fact in reasoner._engine._abox.store.numbers for t in (fact,) if not is_literal(t)}
    wanted = {f for f in expected(closure, base, asserted) if f[0] in individuals}
    found = list(reasoner.inferred())
    assert len(found) == len(set(found))
    known = {_canonical(fact) for fact in asserted}
    assert set(found) == {_canonical(fact) for fact in wanted} - known
    for fact in wanted:
        assert reasoner.holds(fact), fact
    for individual in individuals:
        types = {
            o
            for _, _, o in closure.match(individual, TYPE)
            if o[0] == "<" and not is_schema((individual, TYPE, o))
        }
        assert reasoner.types(individual) == types
    for cls in {o for _, p, o in wanted if p == TYPE}:
        assert set(reasoner.instances(cls)) == {
            s for s, _, _ in closure.match(None, TYPE, cls) if not is_literal(s)
        }


def check_sequence(changes, base):
    """Compare ten random transactions with a fresh closure of the asserted facts."""
    asserted = dict.fromkeys(asserted_in(base))
    reasoner = Reasoner(asserted)
    closure = base
    for picks, insert in changes:
        abox = [fact for fact in asserted if fact not in base.facts]
        delete = [abox[pick % len(abox)] for pick in picks if abox]
        note(f"delete {delete}\ninsert {insert}")
        after = {fact: None for fact in asserted if fact not in delete} | dict.fromkeys(insert)
        closure_after = closure_of(after, base)
        if closure_after.clash is None:
            reasoner.apply(delete=delete, insert=insert)
            asserted, closure = after, closure_after
        else:
            with pytest.raises(Inconsistent) as refusal:
                reasoner.apply(delete=delete, insert=insert)
            proofs.check(refusal.value.explanation, after)
        assert isinstance(reasoner._engine, CompiledEngine)
        check_same(reasoner, asserted, base, closure)
    for fact in list(reasoner.inferred())[:3]:
        proofs.check(reasoner.explain(fact), asserted)


def sequences(examples):
    return settings(
        max_examples=examples,
        deadline=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
    )


def test_one_spelling_is_deleted_while_another_is_inserted():
    """The node of the deleted spelling must not be merged with that of the new one."""
    reasoner = Reasoner(asserted_in(BASE))
    old, new = (triple(f':i0 :ifd "{text}"^^xsd:float') for text in ("1.0", "1.00"))
    reasoner.apply(insert=[old])
    reasoner.apply(delete=[old], insert=[new])
    check_same(reasoner, [*asserted_in(BASE), new], BASE)


@pytest.mark.parametrize("odd", ["", ":A owl:differentFrom :B . "], ids=["compiled", "general"])
def test_a_suppressed_fact_is_asserted_and_does_not_hold_until_it_is_restored(odd):
    facts = triples(
        odd + ":A rdfs:subClassOf :B . :on a owl:ObjectProperty . :cup a :A ; :on :tray , :shelf ."
    )
    reasoner = Reasoner(facts)
    assert reasoner.is_compiled is (not odd)
    on_tray, on_shelf, a_b = triple(":cup :on :tray"), triple(":cup :on :shelf"), triple(":cup a :B")
    reasoner.update_computed(suppress=[on_tray])
    assert reasoner.has_suppressed
    assert list(reasoner.suppressed()) == [on_tray]
    assert reasoner.suppressed_about([on_tray[2]]) == {on_tray}
    assert reasoner.suppressed_about([on_shelf[2]]) == set()
    assert len(reasoner) == len(facts)
    assert set(reasoner.asserted()) == set(facts)
    assert set(reasoner.asserted(None, on_tray[1])) == {on_tray, on_shelf}
    assert set(reasoner.given(None, on_tray[1])) == {on_shelf}
    assert {fact for group in reasoner.by_subject() for fact in group} == set(facts)
    assert set(reasoner.about(on_tray[0])[on_tray[1]]) == {on_tray[2], on_shelf[2]}
    assert set(reasoner.about(on_tray[0])) == {TYPE, on_tray[1]}
    assert reasoner.mentioned({on_tray[2], "<http://example.org/none>"}) == {on_tray[2]}
    assert (reasoner.holds(on_tray), reasoner.holds(on_shelf), reasoner.holds(a_b)) == (False, True, True)
    again = Reasoner.of(reasoner.given_facts())
    assert set(again.given(None, on_tray[1])) == {on_shelf}
    reasoner.update_computed(restore=[on_tray, on_shelf])
    assert not reasoner.has_suppressed
    assert reasoner.holds(on_tray)
    assert set(reasoner.about(on_tray[0])[on_tray[1]]) == {on_tray[2], on_shelf[2]}
    assert set(reasoner.asserted()) == set(facts)


def test_the_spelling_of_an_inferred_value_does_not_depend_on_the_order_of_facts():
    """Early spellings are already merged; the others are inserted with their edges."""
    facts = [
        triple(text)
        for text in (
            ':i0 :data "1.00"^^xsd:float',
            ':i0 :ifd "1.0"^^xsd:float',
            ':i1 :ifd "1.00"^^xsd:float',
            ":i1 a :HasData",
        )
    ]
    value = triple(':i1 :data "1.0"^^xsd:float')
    for order in permutations(facts):
        reasoner = Reasoner(asserted_in(BASE))
        for fact in order:
            reasoner.apply(insert=[fact])
        assert list(reasoner.inferred(value[0], value[1])) == [value]
        assert list(reasoner.inferred(None, value[1], value[2])) == [value]
        assert not list(reasoner.inferred(facts[0][0], value[1]))
        assert reasoner.holds(facts[0])
        check_same(reasoner, [*asserted_in(BASE), *facts], BASE)


CHARGING = """
:OurDock rdfs:subClassOf :Device, [ owl:onProperty :hasAffordance ; owl:hasValue :charging ] ;
    owl:equivalentClass [ owl:oneOf ( :dock1 ) ] .
"""


def test_an_individual_that_a_class_lists_has_the_values_of_the_class():
    tbox, fact = triples(CHARGING), triple(":dock1 a :Device")
    reasoner = Reasoner(tbox)
    has_it = triple(":dock1 :hasAffordance :charging")
    assert has_it in set(reasoner.inferred())
    reasoner.apply(insert=[fact])
    assert has_it in set(reasoner.inferred(has_it[0]))
    reasoner.apply(delete=[fact])
    assert has_it in set(reasoner.inferred(None, has_it[1]))
    proofs.check(reasoner.explain(has_it), tbox)


def test_a_contradiction_with_such_a_value_is_rejected():
    tbox = triples(
        CHARGING + ":hasAffordance rdfs:range :Affordance . :Affordance owl:disjointWith :Device ."
    )
    reasoner = Reasoner(tbox)
    with pytest.raises(Inconsistent):
        reasoner.apply(insert=triples(":charging a :Device ."))
    assert set(reasoner.types("<http://example.org/charging>")) == {"<http://example.org/Affordance>"}


SPELLINGS = [
    ('"1"^^xsd:integer', '"01"^^xsd:integer'),
    ('"1"^^xsd:integer', '"1.0"^^xsd:decimal'),
    ('"1"^^xsd:byte', '"+1"^^xsd:integer'),
    ('"1.5"^^xsd:float', '"1.50"^^xsd:float'),
    ('"a"', '"a"^^xsd:token'),
]


@pytest.mark.parametrize("keys", [":d", ":d :e", ":e :d"])
@pytest.mark.parametrize("spellings", SPELLINGS)
def test_a_key_is_the_same_in_another_spelling(spellings, keys):
    one, other = spellings
    key = triples(f":C owl:hasKey ( {keys} ) .")
    facts = triples(f":a a :C ; :d {one} ; :e {other} . :b a :C ; :d {other} ; :e {one} .")
    same = triple(":a owl:sameAs :b")
    for order in (facts, facts[::-1]):
        reasoner = Reasoner(key)
        for fact in order:
            reasoner.apply(insert=[fact])
        assert reasoner.holds(same)
        proofs.check(reasoner.explain(same), [*key, *facts])
        with pytest.raises(Inconsistent):
            reasoner.apply(insert=[triple(":a owl:differentFrom :b")])
        reasoner.apply(delete=[facts[1]])
        assert reasoner.holds(same) == (":d" not in keys)
    together = Reasoner(key)
    together.apply(insert=facts)
    assert together.holds(same)


def test_a_key_needs_every_value_of_both():
    reasoner = Reasoner(triples(":C owl:hasKey ( :d :e ) . :a a :C ; :d 1 ; :e 1 . :b a :C ; :d 1 ."))
    assert not reasoner.holds(triple(":a owl:sameAs :b"))


def test_a_literal_of_an_unknown_datatype_that_is_a_number():
    """It equals all spellings of that number, in any order of insertion."""
    facts = [
        triple(text)
        for text in (
            ':i0 :data "1.0"^^xsd:float',
            ':i3 :fundata "x"^^:unknown',
            ':i3 :fundata "1.00"^^xsd:float',
            ':i1 :data "1"^^xsd:float',
        )
    ]
    for order in permutations(facts):
        reasoner, asserted = Reasoner(asserted_in(BASE)), dict.fromkeys(asserted_in(BASE))
        for fact in order:
            reasoner.apply(insert=[fact])
            asserted[fact] = None
            check_same(reasoner, asserted, BASE)
        for fact in order:
            reasoner.apply(delete=[fact])
            del asserted[fact]
            check_same(reasoner, asserted, BASE)


def test_a_literal_that_equals_a_number_equals_every_spelling_of_it():
    asserted = dict.fromkeys(asserted_in(BASE))
    reasoner = Reasoner(asserted)
    for text in (':i0 :key2 "x"^^:unknown', ':i0 :fundata "1.00"^^xsd:float', ':i0 :fundata "x"^^:unknown'):
        reasoner.apply(insert=[triple(text)])
        asserted[triple(text)] = None
    check_same(reasoner, asserted, BASE)
    for spelling in ("1.00", "1.0", "1"):
        proofs.check(reasoner.explain(triple(f':i0 :key2 "{spelling}"^^xsd:float')), asserted)


@sequences(tries(120))
@given(CHANGES)
def test_any_sequence_of_changes_equals_a_fresh_closure(changes):
    check_sequence(changes, BASE)


@sequences(tries(6))
@given(AT_HOME)
def test_the_same_at_home(changes):
    check_sequence(changes, HOME())


@pytest.mark.long
@sequences(100)
@given(AT_HOME)
def test_many_at_home(changes):
    check_sequence(changes, HOME())


@pytest.mark.long
@sequences(5000)
@given(CHANGES)
def test_any_of_many_sequences_equals_a_fresh_closure(changes):
    check_sequence(changes, BASE)
