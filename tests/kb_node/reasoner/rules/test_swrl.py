"""SWRL rules: the incremental engine is compared with a closure from scratch."""

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.terms import SAME_AS
from tests.depth import tries
from tests.kb_node.reasoner.graphs import triple
from tests.kb_node.reasoner.swrl import graph
from tests.kb_node.reasoner.test_worlds import promised, refused
from tests.kb_node.reasoner.worlds import Change

SWRL = "http://www.w3.org/2003/11/swrl#"
AXIOMS = """
:B rdfs:subClassOf :A . :q rdfs:subPropertyOf :p . :inv owl:inverseOf :p . :p rdfs:domain :D .
:tra a owl:TransitiveProperty . :fun a owl:FunctionalProperty . :dfun a owl:FunctionalProperty .
:Some owl:onProperty :tra ; owl:someValuesFrom :C .
:Has owl:onProperty :p ; owl:hasValue :i1 . :H rdfs:subClassOf :Has .
:p a owl:ObjectProperty . :q a owl:ObjectProperty . :d a owl:DatatypeProperty . :dd a owl:DatatypeProperty .
:i0 a :Z . [] a owl:AllDifferent ; owl:members ( :i2 :i3 ) .
"""
RULES = (
    "A(x), p(x, y) -> C(y)",
    "C(x), C(y), tra(x, y) -> q(y, x)",
    "p(x, y), p(y, z), differentFrom(x, z) -> r(x, z)",
    "r(x, y), inv(x, y) -> sameAs(x, y)",
    "d(x, v), d(y, v), E(x) -> s(x, y)",
    "d(x, v), b.greaterThan(v, 2) -> E(x)",
    "d(x, v), b.multiply(w, v, 2) -> dd(x, w)",
    "dd(x, v), d(y, w), b.equal(v, w) -> s(y, x)",
    "F(x) -> sameAs(x, i1)",
    "H(x), Some(x) -> differentFrom(x, i2)",
    "s(x, x), A(x) -> F(x), q(i2, x)",
    "G(x), s(x, i3) -> ",
    "-> G(i3)",
    "sameAs(x, y), G(x), D(y) -> fun(x, i0)",
    "fun(x, y), d(x, 3) -> p(x, y)",
    "q(x, y), sameAs(x, i2) -> tra(y, y)",
    "d(x, v), dd(x, w), b.multiply(w, v, 1) -> H(x)",
    "tra(x, y), differentFrom(x, i3) -> H(y)",
)
TBOX = graph(*RULES, axioms=AXIOMS)
_NODES = st.sampled_from([f":i{n}" for n in range(4)])
_VALUES = st.sampled_from(("1", "2", "3", "3.0", '"2"^^xsd:float', "4"))
_FACTS = st.one_of(
    st.builds("{} a {}".format, _NODES, st.sampled_from([f":{name}" for name in "ABCDEFGH"])),
    st.builds(
        "{} {} {}".format, _NODES, st.sampled_from([":p", ":q", ":inv", ":tra", ":fun", ":r", ":s"]), _NODES
    ),
    st.builds("{} {} {}".format, _NODES, st.sampled_from((":d", ":d", ":dd")), _VALUES),
    st.builds("{} {} {}".format, _NODES, st.sampled_from(("owl:sameAs", "owl:differentFrom")), _NODES),
).map(triple)
_CHANGES = st.lists(
    st.tuples(st.lists(st.integers(0, 40), max_size=3), st.lists(_FACTS, max_size=4)), min_size=3, max_size=8
)


def random_(count):
    """Return settings without shrinking, which takes minutes."""
    checks = list(HealthCheck)
    return settings(max_examples=count, deadline=None, suppress_health_check=checks, phases=[Phase.generate])


@random_(tries(45))
@given(_CHANGES)
def test_after_each_change_the_rules_hold_as_in_a_closure_from_scratch(changes):
    reasoner, facts = Reasoner(TBOX), list[tuple[str, str, str]]()
    for removed, added in changes:
        delete = list(dict.fromkeys(facts[i % len(facts)] for i in removed if facts))
        after = list(dict.fromkeys([*(fact for fact in facts if fact not in delete), *added]))
        closure = Closure([*TBOX, *after])
        refusal = refused(reasoner, Change(delete, added))
        assert (refusal is None) == (closure.clash is None)
        if refusal is None:
            facts = after
        else:
            assert Closure(refusal.support).clash is not None
            closure = Closure([*TBOX, *facts])
        assert reasoner.is_compiled
        found = list(reasoner.inferred())
        assert len(found) == len(set(found))
        assert set(found) == promised(closure, [*TBOX, *facts])


@random_(tries(9))
@given(st.lists(_FACTS, max_size=12))
def test_what_a_rule_implies_is_explained_by_facts_that_entail_it(facts):
    try:
        reasoner = Reasoner([*TBOX, *facts])
    except Inconsistent:
        return
    for conclusion in list(reasoner.inferred()):
        support = reasoner.explain(conclusion).support
        assert set(support) <= {*TBOX, *facts}
        assert conclusion[1] == SAME_AS or Reasoner(support).holds(conclusion)


def inferred(reasoner):
    return {fact for fact in reasoner.inferred() if "Thing" not in fact[2]}


def test_a_rule_is_explained_as_a_sentence_and_its_conclusion_goes_with_a_premise():
    reasoner = Reasoner(graph("Cup(x), on(x, y) -> Cluttered(y)"))
    reasoner.apply(insert=[triple(":cup1 a :Cup"), triple(":cup1 :on :table1")])
    conclusion = triple(":table1 a :Cluttered")
    assert reasoner.explain(conclusion).text == (
        "table1 is a Cluttered, because cup1 is a Cup (asserted), it is on table1 (asserted), "
        "and because of the rule “if x is a Cup and x is on y, then y is a Cluttered”."
    )
    assert reasoner.rules()[0].holds == 1
    reasoner.apply(delete=[triple(":cup1 :on :table1")])
    assert not reasoner.holds(conclusion)
    assert reasoner.rules()[0].holds == 0


def test_a_rule_without_a_head_rejects_a_change_with_the_rule_as_a_reason():
    reasoner = Reasoner(graph("Knife(x), on(x, y), Floor(y) -> "))
    reasoner.apply(insert=[triple(":k a :Knife"), triple(":f a :Floor")])
    with pytest.raises(Inconsistent, match="because of the rule “it is never true that x is a Knife"):
        reasoner.apply(insert=[triple(":k :on :f")])
    assert list(reasoner.asserted(None, triple(":k :on :f")[1])) == []


def test_equality_as_a_conclusion_of_a_rule_goes_with_its_premise():
    reasoner = Reasoner(graph("dcode(x, v), dcode(y, v) -> sameAs(x, y)"))
    codes = [triple(":a :dcode 7"), triple(":b :dcode 7"), triple(":a a :A")]
    reasoner.apply(insert=codes)
    assert reasoner.holds(triple(":b a :A"))
    assert "because of the rule" in reasoner.explain(triple(":b a :A")).text
    reasoner.apply(delete=codes[:1])
    assert not inferred(reasoner)


@pytest.mark.parametrize(
    ("rule", "reason"),
    [
        ("A(x), b.stringConcat(y, x, x) -> B(x)", "unsupported built-in stringConcat"),
        ("A(x), b.add(y, z, 1) -> d(x, y)", "unbound variable"),
        ("A(x) -> p(x, y)", "unbound variable"),
        ("A(x) -> b.equal(x, 1)", "built-in in the head"),
        ("d(x, v), b.add(w, v, 1) -> d(x, w)", "recursion through arithmetic"),
        (" -> ", "empty"),
    ],
)
def test_a_rule_that_is_not_supported_has_no_effect_and_a_reason(rule, reason):
    reasoner = Reasoner(graph(rule))
    reasoner.apply(insert=[triple(":i a :A"), triple(":i :d 1")])
    assert not inferred(reasoner)
    assert [use.unsupported for use in reasoner.rules()] == [reason]
    assert reasoner.is_compiled


CLASS_ATOM = "[ a swrl:ClassAtom ; swrl:classPredicate :A ; swrl:argument1 :x ]"
BODY, HEAD = f"swrl:body ( {CLASS_ATOM} )", f"swrl:head ( {CLASS_ATOM.replace(':A', ':B')} )"


def _rule_of_one_atom(atom):
    return f"swrl:body ( {CLASS_ATOM} [ {atom} ] ) ; {HEAD}"


@pytest.mark.parametrize(
    ("rule", "reason"),
    [
        (f"{BODY} ; {HEAD}", ""),
        (f"{BODY} ; {HEAD} ; swrla:isRuleEnabled true", ""),
        (f"{BODY} ; {HEAD} ; swrla:isRuleEnabled false", "disabled"),
        (HEAD, "incomplete body"),
        (BODY, "incomplete head"),
        (f"{BODY} ; swrl:body () ; {HEAD}", "incomplete body"),
        (f"swrl:body [ rdf:first :atom ] ; {HEAD}", "incomplete body"),
        (_rule_of_one_atom("a swrl:OtherAtom"), "unknown atom"),
        (_rule_of_one_atom("a swrl:ClassAtom ; swrl:argument1 :x"), "incomplete atom"),
        (_rule_of_one_atom("a swrl:ClassAtom ; swrl:classPredicate :A"), "incomplete atom"),
        (
            _rule_of_one_atom(
                "a swrl:IndividualPropertyAtom ; swrl:propertyPredicate :p ; swrl:argument1 :x"
            ),
            "incomplete atom",
        ),
        (_rule_of_one_atom("a swrl:BuiltinAtom ; swrl:builtin swrlb:equal"), "incomplete atom"),
        (
            _rule_of_one_atom("a swrl:BuiltinAtom ; swrl:builtin swrlb:equal ; swrl:arguments ( :x )"),
            "unsupported built-in equal",
        ),
        (
            _rule_of_one_atom("a swrl:BuiltinAtom ; swrl:builtin :equal ; swrl:arguments ( :x :x )"),
            "unsupported built-in http://example.org/equal",
        ),
        (
            _rule_of_one_atom(
                "a swrl:IndividualPropertyAtom ; swrl:propertyPredicate rdf:type ; swrl:argument1 :x ; "
                "swrl:argument2 :A"
            ),
            "unsupported property rdf:type",
        ),
        (
            _rule_of_one_atom(
                "a swrl:IndividualPropertyAtom ; swrl:propertyPredicate owl:sameAs ; swrl:argument1 :x ; "
                "swrl:argument2 :i"
            ),
            "",
        ),
    ],
)
def test_a_rule_is_read_or_the_reason_is_given(rule, reason):
    prefixes = "@prefix swrla: <http://swrl.stanford.edu/ontologies/3.3/swrla.owl#> . "
    reasoner = Reasoner(graph(axioms=f"{prefixes} [] a swrl:Imp ; {rule} ."))
    reasoner.apply(insert=[triple(":i a :A")])
    assert [use.unsupported for use in reasoner.rules()] == [reason]
    assert reasoner.holds(triple(":i a :B")) is (not reason)


def test_a_data_range_is_an_atom_of_a_rule():
    atom = "[ a swrl:DataRangeAtom ; swrl:dataRange xsd:byte ; swrl:argument1 :v ]"
    given = (
        "[ a swrl:DatavaluedPropertyAtom ; swrl:propertyPredicate :d ; swrl:argument1 :x ; "
        "swrl:argument2 :v ]"
    )
    reasoner = Reasoner(graph(axioms=f"[] a swrl:Imp ; swrl:body ( {given} {atom} ) ; {HEAD} ."))
    reasoner.apply(insert=[triple(":i :d 5"), triple(":j :d 500")])
    assert reasoner.holds(triple(":i a :B"))
    assert not reasoner.holds(triple(":j a :B"))


@pytest.mark.parametrize("axioms", ["", "owl:sameAs rdfs:subPropertyOf :same ."], ids=["compiled", "general"])
@pytest.mark.parametrize(
    ("rule", "facts", "holds"),
    [
        ("d(x, v), b.multiply(w, v, 2) -> dd(x, w)", [":i :d 2", ":j :d 3", ":j :d 4"], 3),
        ("d(x, v), b.greaterThan(v, 2) -> E(x)", [":i :d 2", ":j :d 3"], 1),
        ("A(x), p(x, y) -> C(y)", [":i a :A", ":i :p :j", ":i :p :k", ":j :p :k"], 2),
        ("p(x, x) -> C(x)", [":i :p :i", ":i :p :j"], 1),
        ("p(x, i) -> C(x)", [":i :p :j", ":j :p :i"], 1),
        ("p(x, y), p(y, x) -> C(x)", [":i :p :j", ":j :p :i", ":j :p :k"], 2),
        ("A(x), differentFrom(x, i) -> C(x)", [":i a :A", ":j a :A", ":j owl:differentFrom :i"], 1),
        ("A(x), B(y), p(x, y) -> C(x)", [":i a :A", ":j a :B", ":k a :B", ":i :p :j"], 1),
    ],
)
def test_the_number_of_matches_of_a_rule(axioms, rule, facts, holds):
    reasoner = Reasoner(graph(rule, axioms=axioms))
    reasoner.apply(insert=[triple(fact) for fact in facts])
    assert [use.holds for use in reasoner.rules()] == [holds]


def test_matches_with_equal_individuals_are_counted_once():
    reasoner = Reasoner(graph("A(x), d(x, v), b.add(w, v, 1) -> dd(x, w)"))
    facts = [":i a :A", ":i :d 1", ":j owl:sameAs :i", ":j owl:sameAs :k", ":l a :A", ":l :d 1"]
    reasoner.apply(insert=[triple(fact) for fact in facts])
    assert [use.holds for use in reasoner.rules()] == [2]
    assert reasoner.holds(triple(":k :dd 2"))


@pytest.mark.parametrize(
    ("rules", "axioms", "is_recursive"),
    [
        ("d(x, v), b.add(w, v, 1) -> dd(x, w)", "", False),
        ("d(x, v), b.add(w, v, 1) -> dd(x, w)", ":dd rdfs:subPropertyOf :d .", True),
        ("d(x, v), b.add(w, v, 1) -> dd(x, w)", ":d rdfs:subPropertyOf :dd .", False),
        ("d(x, v), b.add(w, v, 1) -> dd(x, w)", ":d owl:equivalentProperty :dd .", True),
        ("d(x, v), b.add(w, v, 1) -> dd(x, w)", ":d owl:propertyChainAxiom ( :p :dd ) .", True),
        ("d(x, v), b.add(w, v, 1) -> dd(x, w)", ":dd owl:propertyChainAxiom ( :p :d ) .", False),
        ("d(x, v), b.greaterThan(v, 1) -> d(x, v)", "", False),
        ("d(x, v), b.add(w, v, 1), b.add(z, w, 1) -> d(x, z)", "", True),
        ("d(x, v), de(x, w), b.add(z, w, 1), b.add(y, v, z) -> de(x, y)", "", True),
        ("d(x, v), de(x, w), b.add(z, w, 1) -> de(x, v)", "", False),
    ],
)
def test_only_rules_that_calculate_from_their_own_results_are_recursive(rules, axioms, is_recursive):
    (use,) = Reasoner(graph(rules, axioms=axioms)).rules()
    assert use.unsupported == ("recursion through arithmetic" if is_recursive else "")


def test_recursion_through_arithmetic_is_found_over_other_rules_and_properties():
    rules = ("d(x, v), b.add(w, v, 1) -> dd(x, w)", "de(x, v) -> d(x, v)")
    assert not any(use.unsupported for use in Reasoner(graph(*rules)).rules())
    looped = Reasoner(graph(*rules, axioms=":dd rdfs:subPropertyOf :de ."))
    assert [use.unsupported for use in looped.rules()] == ["", "recursion through arithmetic"]


def test_rules_of_the_general_engine_are_applied_too():
    reasoner = Reasoner(graph("A(x) -> B(x)", axioms=":A owl:sameAs :A ."))
    assert not reasoner.is_compiled
    reasoner.apply(insert=[triple(":i a :A")])
    assert reasoner.holds(triple(":i a :B"))
    assert reasoner.rules()[0].holds == 1


def test_rules_of_functional_syntax_and_owl_xml_are_applied():
    functional = (
        "Prefix(:=<http://example.org/>) Ontology(Declaration(Class(:A)) "
        "DLSafeRule(Body(ClassAtom(:A Variable(<urn:x>))) Head(ClassAtom(:B Variable(<urn:x>)))))"
    )
    atom = '<ClassAtom><Class IRI="http://example.org/{}"/><Variable IRI="urn:x"/></ClassAtom>'
    xml = (
        '<Ontology xmlns="http://www.w3.org/2002/07/owl#" ontologyIRI="http://example.org/o">'
        f"<DLSafeRule><Body>{atom.format('A')}</Body><Head>{atom.format('B')}</Head></DLSafeRule></Ontology>"
    )
    for text, name in ((functional, "a.ofn"), (xml, "a.owx")):
        reasoner = Reasoner(rdf.parse(text.encode(), name))
        reasoner.apply(insert=[triple(":i a :A")])
        assert reasoner.holds(triple(":i a :B")), name


def test_rules_of_rdf_xml_and_manchester_syntax_are_applied():
    def atom(kind, predicate, name, *variables):
        arguments = "".join(
            f'<swrl:argument{i} rdf:resource="urn:{variable}"/>' for i, variable in enumerate(variables, 1)
        )
        return (
            f'<rdf:Description><rdf:type rdf:resource="{SWRL}{kind}"/>'
            f'<swrl:{predicate} rdf:resource="http://example.org/{name}"/>{arguments}</rdf:Description>'
        )

    def atoms(part, *found):
        return f'<swrl:{part} rdf:parseType="Collection">{"".join(found)}</swrl:{part}>'

    body = atoms(
        "body",
        atom("ClassAtom", "classPredicate", "A", "x"),
        atom("IndividualPropertyAtom", "propertyPredicate", "p", "x", "y"),
    )
    head = atoms("head", atom("ClassAtom", "classPredicate", "B", "y"))
    rdf_xml = (
        '<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:swrl="'
        f'{SWRL}"><swrl:Variable rdf:about="urn:x"/><swrl:Variable rdf:about="urn:y"/>'
        f"<swrl:Imp>{body}{head}</swrl:Imp></rdf:RDF>"
    )
    manchester = (
        "Prefix: : <http://example.org/>\nOntology: <http://example.org/o>\nClass: :A\nClass: :B\n"
        "ObjectProperty: :p\nRule:\n    :A(?x), :p(?x, ?y) -> :B(?y)\n"
    )
    for text, name in ((rdf_xml, "a.owl"), (manchester, "a.omn")):
        reasoner = Reasoner(rdf.parse(text.encode(), name))
        reasoner.apply(insert=[triple(":i a :A"), triple(":i :p :j")])
        assert reasoner.holds(triple(":j a :B")), name


@pytest.mark.parametrize("axioms", ["", "owl:sameAs rdfs:subPropertyOf :same ."], ids=["compiled", "general"])
def test_counting_the_matches_of_rules_stops_at_the_time_limit(axioms):
    reasoner = Reasoner(graph("A(x), A(y) -> B(x)", "A(x) -> B(x)", axioms=axioms))
    reasoner.apply(insert=[triple(f":i{i} a :A") for i in range(10)])
    uses = sorted(reasoner.rules(), key=lambda use: use.holds)
    assert [(use.holds, use.is_cut) for use in uses] == [(10, False), (100, False)]
    assert all(use.is_cut and not use.holds for use in reasoner.rules(patience_s=0))


@random_(tries(15))
@given(_CHANGES)
def test_the_rules_use_computed_facts_and_release_them(changes):
    reasoner, computed = Reasoner(TBOX), list[tuple[str, str, str]]()
    for removed, added in changes:
        remove = list(dict.fromkeys(computed[i % len(computed)] for i in removed if computed))
        add = [fact for fact in added if fact[1].startswith("<http://example.org/")]
        after = list(dict.fromkeys([*(fact for fact in computed if fact not in remove), *add]))
        clash = Closure([*TBOX, *after]).clash
        try:
            reasoner.update_computed(remove=remove, add=add)
        except Inconsistent:
            rejected = True
        else:
            rejected, computed = False, after
        assert rejected == (clash is not None)
        closure = Closure([*TBOX, *computed])
        assert set(reasoner.inferred()) == promised(closure, TBOX)
        assert reasoner.is_compiled
