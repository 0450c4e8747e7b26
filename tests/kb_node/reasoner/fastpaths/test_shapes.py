"""Runs of a known shape are stored as the rules would store them."""

import pytest
from hypothesis import given, note
from hypothesis import strategies as st

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.abox.store import Store
from semmap.nodes.kb_node.reasoner.explain.sentences import proof_sentence
from semmap.nodes.kb_node.reasoner.fastpaths import batches
from semmap.nodes.kb_node.reasoner.fastpaths.shapes import Contradiction, KnownShape, Shapes
from tests.depth import tries
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.facts import prefixed
from tests.kb_node.reasoner.graphs import (
    CLASSES,
    DATA_PROPERTIES,
    LITERALS,
    OBJECT_PROPERTIES,
    triple,
    triples,
)
from tests.kb_node.reasoner.test_reasoner import BASE, asserted_in, check_same, closure_of, sequences

KNOWN = '"x"^^:unknown'
OTHERS = [":i0", ":i2", ":old", ":older"]
TYPES = st.tuples(st.integers(0, 2), st.just("a"), st.sampled_from(prefixed("", CLASSES)))
LINKS = st.tuples(
    st.integers(0, 2),
    st.sampled_from(prefixed("", OBJECT_PROPERTIES)),
    st.one_of(st.integers(0, 2), st.sampled_from(OTHERS)),
)
VALUES = st.tuples(st.integers(0, 2), st.sampled_from(prefixed("", DATA_PROPERTIES)), st.just("value"))


def sorted_by_subject(run):
    """Sort a run by individual, as in a usual document."""
    return sorted(run, key=lambda part: part[0])


RUNS = st.lists(st.one_of(TYPES, TYPES, LINKS, VALUES), min_size=1, max_size=6)
"""Runs without names: individuals by number, literals to be inserted."""
BEFORE = [triple(text) for text in (":old a :F", ":older a :F", ":older :free :i2")]


def named(run, name, values):
    """Return a run with individuals named after `name`."""

    def term(part):
        if isinstance(part, int):
            return f":{name}{part}"
        return next(values) if part == "value" else part

    return [triple(" ".join(map(term, part))) for part in run]


@pytest.fixture(params=[False, True], ids=["singly", "in batches"])
def by_columns(request, monkeypatch):
    """Whether small numbers of runs are also processed in batches."""
    if request.param:
        monkeypatch.setattr(batches, "_MANY", 1)
        monkeypatch.setattr(Store, "free_rows", 0)


@pytest.mark.usefixtures("by_columns")
@sequences(tries(100))
@given(
    RUNS, st.lists(st.sampled_from(sorted(set(LITERALS) - {KNOWN})), min_size=24, max_size=24), st.booleans()
)
def test_the_result_does_not_depend_on_whether_the_shape_is_known(run, literals, together):
    values = iter(literals)
    asserted = dict.fromkeys([*asserted_in(BASE), *BEFORE])
    closure = closure_of(asserted, BASE)
    reasoner = Reasoner(asserted)
    transactions = [named(run, name, values) for name in ("a", "b", "c", "d")]
    if together:
        transactions = [transactions[0], [*transactions[1], *transactions[2]], transactions[3]]
    for insert in transactions:
        note(f"insert {insert}")
        after = asserted | dict.fromkeys(insert)
        closure_after = closure_of(after, BASE)
        if closure_after.clash is None:
            change = reasoner.apply(insert=insert)
            asserted, closure = after, closure_after
            assert {s for s, _, _ in insert} <= change.touched
        else:
            with pytest.raises(Inconsistent) as refusal:
                reasoner.apply(insert=insert)
            explanation = refusal.value.explanation
            proofs.check(explanation, after)
            assert explanation.text == proof_sentence(
                None, explanation.support, explanation.steps, reasoner.words
            )
        check_same(reasoner, asserted, BASE, closure)
    for insert in reversed(transactions):
        there = [fact for fact in dict.fromkeys(insert) if fact in asserted]
        reasoner.apply(delete=there)
        asserted = {fact: None for fact in asserted if fact not in there}
        check_same(reasoner, asserted, BASE)


@pytest.mark.usefixtures("by_columns")
@sequences(30)
@given(st.lists(RUNS, min_size=1, max_size=5), st.permutations(range(24)), st.data())
def test_one_transaction_equals_single_transactions(runs, order, data):
    values = iter(data.draw(st.lists(st.sampled_from(LITERALS[:4]), min_size=40, max_size=40)))
    facts = [fact for i, run in enumerate(runs) for fact in named(run, f"n{i % 3}_", values)]
    facts = [facts[i] for i in order if i < len(facts)]
    one_by_one, at_once = Reasoner(asserted_in(BASE), fast=False), Reasoner(asserted_in(BASE))
    try:
        touched = frozenset().union(*(one_by_one.apply(insert=[fact]).touched for fact in facts))
    except Inconsistent:
        with pytest.raises(Inconsistent):
            at_once.apply(insert=facts)
        return
    assert at_once.apply(insert=facts).touched == touched
    assert set(at_once.asserted()) == set(one_by_one.asserted())
    assert set(at_once.inferred()) == set(one_by_one.inferred())


HOME = """
:C rdfs:subClassOf :B . :p rdfs:range :D . :n a owl:FunctionalProperty . :C owl:disjointWith :D .
:K rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :q ; owl:hasValue :here ] . :q rdfs:range :Place .
"""


def known(reasoner):
    return list(reasoner._engine._paths.shapes.known.values())


def test_the_rules_are_applied_once_for_each_shape():
    reasoner = Reasoner(triples(HOME))
    for name in ("a", "b", "c"):
        reasoner.apply(insert=triples(f":{name} a :C , :K ; :p :{name}1 ; :n 1 . :{name}1 :n 2.5 ."))
    assert [type(shape) for shape in known(reasoner)] == [KnownShape]
    assert reasoner.holds(triple(":c a :B"))
    assert reasoner.holds(triple(":c1 a :D"))
    assert reasoner.holds(triple(":c :q :here"))


def test_a_contradictory_shape_is_cached():
    reasoner = Reasoner(triples(HOME))
    for name in ("a", "b"):
        with pytest.raises(Inconsistent, match=f"{name} cannot be both a C and a D"):
            reasoner.apply(insert=triples(f":{name} a :C , :D ; :n 1 ."))
    assert [type(shape) for shape in known(reasoner)] == [Contradiction]
    assert len(reasoner) == len(triples(HOME))


def test_a_contradiction_with_the_map_is_not_cached():
    """Another run of the same shape may be consistent with the map."""
    reasoner = Reasoner([*triples(HOME), *triples(":d a :C . :e a :B .")])
    with pytest.raises(Inconsistent):
        reasoner.apply(insert=triples(":x :p :d ."))
    reasoner.apply(insert=triples(":x :p :e ."))
    reasoner.apply(delete=triples(":d a :C ."))
    reasoner.apply(insert=triples(":d a :B . :y :p :d ."))


def test_a_repeated_object_is_one_triple():
    """The first run has two objects of a kind, the second has the same object twice."""
    reasoner = Reasoner([*triples(HOME), *triples(":d a :B . :e a :B .")])
    reasoner.apply(insert=triples(":x :r :d , :e ."))
    reasoner.apply(insert=[triple(":y :r :d")] * 2)
    reasoner.apply(delete=[triple(":y :r :d")])
    assert not list(reasoner.asserted(triple(":y :r :d")[0]))


def test_a_constant_that_changed():
    """The value implied by a class lost a class that another individual implied."""
    reasoner = Reasoner([*triples(HOME), *triples(":s rdfs:range :Far .")])
    reasoner.apply(insert=triples(":z :s :here ."))
    reasoner.apply(insert=triples(":a a :K ."))
    reasoner.apply(delete=triples(":z :s :here ."))
    reasoner.apply(insert=triples(":b a :K ."))
    assert reasoner.holds(triple(":b :q :here"))
    assert not reasoner.holds(triple(":here a :Far"))
    reasoner.apply(delete=triples(":a a :K ."))
    assert reasoner.holds(triple(":here a :Place"))
    reasoner.apply(delete=triples(":b a :K ."))
    assert not reasoner.holds(triple(":here a :Place"))


def load(names, value=lambda i: f"{i}.5"):
    turtle = "".join(
        f":{name} a :C , :K ; :p :{name}1 ; :n {value(i)} . :{name}1 :n 2 ." for i, name in enumerate(names)
    )
    return triples(turtle)


def names(count, stem="a"):
    return [f"{stem}{i}_" for i in range(count)]


@pytest.fixture
def batched(monkeypatch):
    """The number of runs in each batch."""
    sizes = []
    write_all = Shapes.write_all

    def counted(self, triples, start):
        alike, end = write_all(self, triples, start)
        sizes.append(sum(len(list(runs.rows())) for runs in alike))
        return alike, end

    monkeypatch.setattr(Shapes, "write_all", counted)
    return sizes


def test_a_load_is_stored_by_columns(batched):
    home = triples(HOME)
    reasoner = Reasoner(home)
    reasoner.apply(insert=load(names(300)))
    assert max(batched) > 200
    assert reasoner.holds(triple(":a299_ :q :here"))
    assert reasoner.holds(triple(":a299_1 a :D"))
    for name in names(300):
        reasoner.apply(delete=load([name], lambda _, name=name: f"{int(name[1:-1])}.5"))
    assert set(reasoner.asserted()) == set(home)


def test_free_rows_are_used_before_a_load_allocates_new_ones(batched):
    reasoner = Reasoner(triples(HOME))
    reasoner.apply(insert=load(names(300)))
    reasoner.apply(delete=load(names(300)))
    room = len(reasoner._engine._abox.store.subject)
    reasoner.apply(insert=load(names(300, "b")))
    assert len(reasoner._engine._abox.store.subject) == room


def test_a_load_with_more_facts_about_an_individual_equals_single_insertion(batched):
    reasoner = Reasoner(triples(HOME))
    reasoner.apply(insert=[*load(names(300)), *load(["a7_"], lambda _: "7.5")])
    assert len(list(reasoner.asserted(triple(":a7_ :p :a7_1")[0]))) == 4


def test_a_load_with_a_contradiction_in_it_is_undone(batched):
    home = triples(HOME)
    reasoner = Reasoner(home)
    with pytest.raises(Inconsistent, match="a7_"):  # :n is functional
        reasoner.apply(insert=[*load(names(300)), *load(["a7_"], lambda _: "8")])
    assert set(reasoner.asserted()) == set(home)


PLAIN = st.lists(
    st.one_of(
        st.tuples(st.integers(0, 2), st.just("a"), st.sampled_from([":B", ":C", ":K"])),
        st.tuples(st.integers(0, 2), st.sampled_from([":r", ":t"]), st.sampled_from([0, 1, 2, ":d", ":e"])),
        st.tuples(st.integers(0, 2), st.sampled_from([":v", ":w"]), st.just("value")),
    ),
    min_size=2,
    max_size=12,
    unique=True,
).map(sorted_by_subject)


@sequences(60)
@given(
    PLAIN, st.lists(st.sampled_from(['"1.5"^^xsd:float', '"2"^^xsd:float', '"x"']), min_size=80, max_size=80)
)
def test_storing_by_columns_equals_storing_singly(run, literals):
    home = [*triples(HOME), *triples(":d a :B . :e a :B .")]
    values = iter(literals)
    loads = [[fact for name in group for fact in named(run, name, values)] for group in ("a", "bcd", "efg")]
    singly, by_columns = Reasoner(home), Reasoner(home)
    for insert in loads:
        singly.apply(insert=insert)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(batches, "_MANY", 1)
        patch.setattr(Store, "free_rows", 0)
        for insert in loads:
            by_columns.apply(insert=insert)
    gone = loads[1][::2]
    for delete in ([], gone, loads[2]):
        for reasoner in (singly, by_columns):
            reasoner.apply(delete=delete)
        assert set(singly.asserted()) == set(by_columns.asserted())
        assert set(singly.inferred()) == set(by_columns.inferred())
        for cls in (":B", ":C", ":D", ":K", ":Place"):
            term = triple(f":x a {cls}")[2]
            assert set(singly.instances(term)) == set(by_columns.instances(term))
        for s, p, o in singly.asserted():
            assert list(by_columns.asserted(s, p, o)) == [(s, p, o)]
            assert set(by_columns.asserted(None, p, o)) == set(singly.asserted(None, p, o))
