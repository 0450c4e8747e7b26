"""Fast paths beside SWRL rules give the same result as the rules, and are used where no rule can match."""

import random

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.abox.saturation import Saturation
from semmap.nodes.kb_node.reasoner.fastpaths import batches, paths
from tests.depth import tries
from tests.kb_node.reasoner.graphs import triple, triples
from tests.kb_node.reasoner.rules.test_swrl import AXIOMS, RULES
from tests.kb_node.reasoner.swrl import graph

MORE_RULES = (
    "C(x), p(x, y) -> near(y, x)",
    "A(x) -> near(i4, x)",
    "near(x, y) -> I(x)",
    "I(x) -> dn(x, 1)",
    "n(x, y), dn(x, 2) -> J(y)",
    "K(i5), L(i5) -> ",
    "K(x), L(x), near(x, y) -> ",
    "M(x), differentFrom(x, i2) -> I(x)",
    "n(i5, x) -> A(x)",
)
MORE_AXIOMS = """
:J rdfs:subClassOf :A . :n rdfs:range :N . :Full owl:onProperty :near ; owl:someValuesFrom :I .
:Full rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :at ; owl:hasValue :here ] .
:near a owl:ObjectProperty . :n a owl:ObjectProperty ; owl:propertyChainAxiom ( :n :at ) .
:dn a owl:DatatypeProperty . :K owl:disjointWith :B .
"""
CLASSES = [*(f":{name}" for name in "ABCDEFGHIJKLMN"), ":Plain", ":Other"]
PROPERTIES = [":p", ":q", ":inv", ":tra", ":fun", ":r", ":s", ":near", ":n", ":at", ":free"]
VALUES = ("1", "2", "3.0", '"2"^^xsd:float', '"1.5"^^xsd:float', '"x"')
NAMES = [f":i{n}" for n in range(8)]


class Changes:
    """Random changes of a map: new individuals of few shapes, removals, replaced numbers, computed facts."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        choose = self.random.choices
        self.rules = self.random.sample((*RULES, *MORE_RULES), self.random.choice((1, 2, 4, 20)))
        few = self.random.choice((3, 6, 16))
        self._classes, self._properties = choose(CLASSES, k=few), choose(PROPERTIES, k=few)
        self._data = [":d", ":dd", ":dn", ":free"][: self.random.choice((0, 1, 4))]
        self.shapes = [[self._part() for _ in range(self.random.randint(1, 4))] for _ in range(3)]
        self.tbox = graph(*self.rules, axioms=AXIOMS + MORE_AXIOMS)

    def _part(self):
        choose = self.random.choice
        if self._data and self.random.random() < 0.3:
            return choose(self._data), None
        if self.random.random() < 0.5:
            return "a", choose(self._classes)
        return choose(self._properties), choose((True, False))

    def new(self):
        """Return the facts of a new individual, perhaps with a part."""
        choose = self.random.choice
        name, texts = choose([*NAMES, *(f":n{n}" for n in range(20))]), []
        for predicate, to in choose(self.shapes):
            other = choose(VALUES) if to is None else f"{name}x" if to is True else to or choose(NAMES)
            texts.append(f"{name} {predicate} {other}")
        return [triple(text) for text in texts]

    def change(self, asserted):
        """Return what is deleted and inserted."""
        pick, facts = self.random.random(), list(asserted)
        if pick < 0.55 or not facts:
            return [], [fact for _ in range(self.random.choice((1, 1, 2, 6))) for fact in self.new()]
        if pick < 0.75:
            some = self.random.choice(facts)[0]
            return [t for t in facts if t[0] == some or t[0] == f"{some[:-1]}x>"], []
        if pick < 0.9 and (numbers := [t for t in facts if t[2][0] == '"']):
            s, p, o = self.random.choice(numbers)
            return [(s, p, o)], [(s, p, triple(f":i0 :d {self.random.choice(VALUES)}")[2])]
        return self.random.sample(facts, min(len(facts), 2)), self.new()

    def computed(self, present):
        """Return the computed facts that are removed and added."""
        gone = self.random.sample(present, min(len(present), self.random.choice((0, 1, 4))))
        pairs = (self.random.sample(NAMES, 2) for _ in range(self.random.choice((0, 1, 8))))
        added = [triple(f"{s} {self.random.choice(self._properties)} {o}") for s, o in pairs]
        return gone, added


def state(reasoner):
    individuals = {t for s, p, o in reasoner.given() if p.startswith("<http://example") for t in (s, o)}
    return (
        set(reasoner.asserted()),
        set(reasoner.computed()),
        set(reasoner.inferred()),
        {individual: reasoner.types(individual) for individual in individuals if individual[0] == "<"},
        len(reasoner),
    )


def outcome(reasoner, *, change=None, computed=None):
    """Apply a change; return what it touched or the rejection."""
    try:
        if change is not None:
            return reasoner.apply(delete=change[0], insert=change[1]).touched
        reasoner.update_computed(remove=computed[0], add=computed[1])
    except Inconsistent:
        return "rejected"
    return None


def follow(seed, steps):
    """Apply the same changes with and without fast paths; return the number of accepted ones."""
    changes = Changes(seed)
    try:
        fast, slow = Reasoner(changes.tbox), Reasoner(changes.tbox, fast=False)
    except Inconsistent:
        return 0
    asserted, present, accepted = {}, [], 0
    for _ in range(steps):
        if changes.random.random() < 0.2:
            computed = changes.computed(present)
            found = outcome(fast, computed=computed)
            assert found == outcome(slow, computed=computed)
            if found is None:
                accepted += 1
        else:
            change = changes.change(asserted)
            found = outcome(fast, change=change)
            assert (found == "rejected") == (outcome(slow, change=change) == "rejected"), change
            if found != "rejected":
                accepted += 1
                asserted = {t: None for t in asserted if t not in change[0]} | dict.fromkeys(change[1])
        if gone := sorted({*slow.computed()} - {*fast.computed()}):  # fast removal includes computed facts
            outcome(slow, computed=(gone, []))
        present = sorted(slow.computed())
        assert state(fast) == state(slow), (seed, changes.rules)
    return accepted


@pytest.fixture
def _always(monkeypatch):
    """Also use the fast paths for many facts if there are few."""
    monkeypatch.setattr(paths, "MANY", 1)
    monkeypatch.setattr(paths, "MANY_DELETED", 1)
    monkeypatch.setattr(batches, "_MANY", 1)


@pytest.mark.usefixtures("_always")
def test_the_result_beside_rules_does_not_depend_on_the_fast_paths():
    assert sum(follow(seed, 15) for seed in range(tries(24))) > 40


HOME = ":A a owl:Class . :n a owl:DatatypeProperty . :near a owl:ObjectProperty . :old a :A ."
RULE = "Cup(x), near(x, y) -> Full(y)"


@pytest.fixture
def by_rules(monkeypatch):
    """The edges to which the rules are applied singly."""
    edges = []
    process = Saturation._process_edge

    def processed(self, edge):
        edges.append(edge)
        process(self, edge)

    monkeypatch.setattr(Saturation, "_process_edge", processed)
    return edges


@pytest.mark.parametrize("new", [":{0} a :A ; :n 1 ; :free :old .", ":{0} a :Cup ; :n 1 ."])
def test_a_change_that_no_rule_can_match_uses_the_fast_paths(new, by_rules):
    """The second one has a class of the rule, but not the property that the rule needs, too."""
    reasoner = Reasoner(graph(RULE, axioms=HOME))
    reasoner.apply(insert=triples(new.format("a")))
    by_rules.clear()
    reasoner.apply(insert=triples(new.format("b")))
    reasoner.apply(delete=triples(":b :n 1 ."), insert=triples(":b :n 2 ."))
    reasoner.apply(delete=triples(new.format("b").replace(":n 1", ":n 2")))
    assert not by_rules


@pytest.mark.parametrize(
    ("rule", "new", "concluded"),
    [
        (RULE, ":{0} a :Cup ; :near :old .", ":old a :Full"),
        ("Cup(x) -> near(x, old)", ":{0} a :Cup ; :n 1 .", ":{0} :near :old"),
        ("n(x, 1) -> Full(x)", ":{0} :n 1 .", ":{0} a :Full"),
        ("Cup(b) -> Full(old)", ":{0} a :Cup .", ":old a :Full"),
    ],
)
def test_a_rule_holds_for_each_new_individual_of_a_shape(rule, new, concluded):
    reasoner = Reasoner(graph(rule, axioms=HOME))
    for name in ("a", "b"):
        reasoner.apply(insert=triples(new.format(name)))
    assert reasoner.holds(triple(concluded.format("b")))
    for name in ("a", "b"):
        reasoner.apply(delete=triples(new.format(name)))
    assert not reasoner.holds(triple(concluded.format("b")))


def test_the_conclusion_of_a_rule_outlives_its_assertion_by_a_removed_individual():
    reasoner = Reasoner(graph("Cup(x) -> near(i, x)", axioms=HOME))
    reasoner.apply(insert=triples(":i :near :cup . :cup a :A ."))
    reasoner.apply(insert=triples(":cup a :Cup ."))
    reasoner.apply(delete=triples(":i :near :cup ."))
    assert reasoner.holds(triple(":i :near :cup"))


def test_a_replaced_number_leaves_what_a_rule_concludes():
    reasoner = Reasoner(graph("Cup(x) -> n(x, 1)", axioms=HOME))
    reasoner.apply(insert=triples(":cup :n 1 ."))
    reasoner.apply(insert=triples(":cup a :Cup ."))
    reasoner.apply(delete=triples(":cup :n 1 ."), insert=triples(":cup :n 2 ."))
    assert reasoner.holds(triple(":cup :n 1"))


def test_a_rejection_by_a_rule_about_one_individual_does_not_concern_others():
    reasoner = Reasoner(graph("Cup(a), Full(a) -> ", axioms=HOME))
    with pytest.raises(Inconsistent):
        reasoner.apply(insert=triples(":a a :Cup , :Full ."))
    reasoner.apply(insert=triples(":b a :Cup , :Full ."))


def test_what_computed_facts_imply_is_reported_unless_they_match_a_rule():
    reasoner = Reasoner(graph(RULE, axioms=HOME + ":on rdfs:subPropertyOf :above ."))
    reasoner.apply(insert=triples(":b a :Cup ."))
    on = triple(":b :on :old")
    change = reasoner.update_computed(add=[on], report_implied=True)
    assert change.implied == {on, triple(":b :above :old")}
    assert reasoner.update_computed(add=[triple(":b :near :old")], report_implied=True).implied is None
