"""The same answers of the compiled and of the general engine."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.nodes.kb_node.reasoner.terms import SAME_AS, TYPE
from tests.kb_node.reasoner.graphs import triple, triples

TBOX = """
:Cup a owl:Class ; rdfs:subClassOf :Thing , [ owl:onProperty :on ; owl:allValuesFrom :Thing ] .
:inside a owl:ObjectProperty ; rdfs:range :Box .
:Thing a owl:Class . :Mug a owl:Class ; rdfs:subClassOf :Cup . :Box a owl:Class ; owl:disjointWith :Cup .
:on a owl:ObjectProperty ; rdfs:range :Thing ; rdfs:subPropertyOf :near . :near a owl:ObjectProperty .
:mass a owl:DatatypeProperty ; rdfs:subPropertyOf :value . :value a owl:DatatypeProperty .
:key a owl:DatatypeProperty .
"""
MAP = ':mug1 a :Mug ; :on :table1 ; :mass "2.50"^^xsd:float . :mug2 owl:sameAs :mug1 . :cup1 a :Cup .'


@pytest.fixture(params=["compiled", "general"])
def reasoner(request):
    made = Reasoner(triples(TBOX))
    if request.param == "general":
        made = Reasoner(triples(f"{TBOX} :Cup owl:differentFrom :Box ."))
        assert not made.is_compiled
    made.apply(insert=triples(MAP))
    assert made.is_compiled == (request.param == "compiled")
    return made


def names(terms):
    return {term.rpartition("/")[2].rstrip(">") for term in terms if "example.org" in term}


def iri(name):
    return f"<http://example.org/{name}>"


def test_the_classes_of_individuals_and_the_individuals_of_classes(reasoner):
    assert names(reasoner.types(iri("mug1"))) == {"Mug", "Cup", "Thing"}
    assert names(reasoner.types(iri("mug2"))) == {"Mug", "Cup", "Thing"}
    assert names(reasoner.types(iri("table1"))) == {"Thing"}
    assert names(reasoner.instances(iri("Cup"))) == {"mug1", "mug2", "cup1"}
    assert names(reasoner.instances(iri("Box"))) == set()


def test_the_classes_above_and_below_a_class(reasoner):
    assert names(reasoner.subclasses(iri("Cup"))) == {"Cup", "Mug"}
    assert names(reasoner.superclasses(iri("Cup"))) == {"Cup", "Thing"}
    assert names(reasoner.subclasses(iri("Unknown"))) == {"Unknown"}
    assert all(term.startswith("<") for term in reasoner.superclasses(iri("Mug")))


def test_the_names_of_an_individual(reasoner):
    assert names(reasoner.equals(iri("mug1"))) == names(reasoner.equals(iri("mug2"))) == {"mug1", "mug2"}
    assert tuple(reasoner.equals(iri("cup1"))) == ()


@pytest.mark.parametrize(
    ("fact", "holds"),
    [
        (":mug1 a :Cup", True),
        (":mug1 a :Box", False),
        (":mug1 :near :table1", True),
        (":mug2 :on :table1", True),
        (":cup1 :on :table1", False),
        (':mug1 :mass "2.5"^^xsd:float', True),
        (':mug1 :value "2.500"^^xsd:float', True),
        (':mug1 :mass "2.6"^^xsd:float', False),
        (':mug1 :mass "2.5"', False),
        (":mug1 owl:sameAs :mug1", True),
        (":mug1 owl:sameAs :cup1", False),
    ],
)
def test_a_fact_holds_in_each_spelling_of_its_value(reasoner, fact, holds):
    assert reasoner.holds(triple(fact)) == holds
    assert (reasoner.explain(triple(fact)) is not None) == holds


def test_what_follows_is_not_asserted(reasoner):
    assert reasoner.follows(triple(":mug1 a :Cup"))
    assert not reasoner.follows(triple(":mug1 a :Mug"))
    assert not reasoner.follows(triple(":mug1 a :Box"))


def test_inferred_facts_are_those_of_the_pattern_that_are_not_asserted(reasoner):
    about = set(reasoner.inferred(iri("mug1"), None, None))
    assert triple(":mug1 a :Cup") in about
    assert triple(":mug1 :near :table1") in about
    assert triple(":mug1 a :Mug") not in about
    assert triple(":mug1 owl:sameAs :mug1") not in about
    assert not any(o.startswith("_:") for _, p, o in about if p == TYPE)
    assert [o for _, _, o in reasoner.inferred(iri("mug1"), iri("value"), None)] == [
        triple(':mug1 :value "2.5"^^xsd:float')[2]
    ]
    assert list(reasoner.inferred(iri("mug1"), iri("mass"), None)) == []
    near = set(reasoner.inferred(None, iri("near"), iri("table1")))
    assert near == set(triples(":mug1 :near :table1 . :mug2 :near :table1 ."))
    assert names(s for s, _, _ in reasoner.inferred(None, TYPE, iri("Cup"))) >= {"mug1", "mug2"}


def test_asserted_facts_are_as_they_were_given(reasoner):
    assert set(reasoner.asserted(iri("mug1"))) == set(
        triples(':mug1 a :Mug ; :on :table1 ; :mass "2.50"^^xsd:float .')
    )
    assert list(reasoner.asserted(None, SAME_AS)) == triples(":mug2 owl:sameAs :mug1 .")
    assert names(s for s, _, _ in reasoner.asserted(None, None, iri("table1"))) == {"mug1"}
    about = reasoner.about(iri("mug1"))
    assert about == {s[1]: [s[2]] for s in triples(':mug1 a :Mug ; :on :table1 ; :mass "2.50"^^xsd:float .')}
    assert reasoner.about(iri("table1")) == {}
    groups = [group for group in reasoner.by_subject() if group]
    assert {one for group in groups for one in group} >= set(triples(MAP))
    assert reasoner.mentioned({iri("mug1"), iri("table1"), iri("new1")}) >= {iri("mug1"), iri("table1")}


def test_computed_facts_hold_without_being_asserted(reasoner):
    fact = triple(":cup1 :on :table1")
    before = len(reasoner)
    reasoner.update_computed(add=[fact])
    assert len(reasoner) == before
    assert reasoner.is_computed(fact)
    assert list(reasoner.computed(iri("cup1"))) == [fact]
    assert list(reasoner.computed(None, iri("near"))) == []
    assert fact in set(reasoner.given(iri("cup1")))
    assert fact not in set(reasoner.asserted(iri("cup1")))
    assert reasoner.holds(triple(":cup1 :near :table1"))
    reasoner.apply(insert=[fact])
    assert not reasoner.is_computed(fact)
    reasoner.apply(delete=[fact])
    reasoner.update_computed(remove=[fact])
    assert not reasoner.holds(triple(":cup1 :near :table1"))


def test_suppressed_facts_are_asserted_and_do_not_hold(reasoner):
    fact = triple(":mug1 :on :table1")
    before = len(reasoner)
    reasoner.update_computed(suppress=[fact])
    assert (list(reasoner.suppressed()), reasoner.has_suppressed) == ([fact], True)
    assert fact in set(reasoner.asserted(iri("mug1")))
    assert fact[2] in reasoner.about(iri("mug1"))[fact[1]]
    assert reasoner.suppressed_about({iri("table1")}) == {fact}
    assert reasoner.suppressed_about({iri("cup1")}) == set()
    assert reasoner.mentioned({iri("table1")}) == {iri("table1")}
    assert not reasoner.holds(triple(":mug1 :near :table1"))
    assert len(reasoner) == before
    reasoner.apply(insert=[fact])  # it stays suppressed
    assert not reasoner.holds(fact)
    reasoner.update_computed(restore=[fact])
    assert reasoner.holds(triple(":mug2 :near :table1"))
    assert not reasoner.has_suppressed


def test_a_suppressed_fact_can_be_deleted_and_asserted_anew(reasoner):
    fact = triple(":mug1 :on :table1")
    reasoner.update_computed(suppress=[fact])
    change = reasoner.apply(delete=[fact])
    assert fact[0] in change.others
    assert list(reasoner.suppressed()) == []
    assert fact not in set(reasoner.asserted())
    reasoner.update_computed(suppress=[])
    reasoner.apply(insert=[fact])
    assert reasoner.holds(fact)


def test_what_is_suppressed_and_given_again_in_one_change_holds(reasoner):
    fact, other = triple(":mug1 :on :table1"), triple(":cup1 :on :table1")
    reasoner.update_computed(suppress=[fact])
    reasoner.apply(delete=[fact], insert=[fact, other])
    assert reasoner.holds(fact)
    assert reasoner.holds(other)


def test_a_contradiction_changes_nothing(reasoner):
    before = set(reasoner.asserted())
    with pytest.raises(Inconsistent):
        reasoner.apply(delete=triples(":cup1 a :Cup ."), insert=triples(":mug1 a :Box ."))
    with pytest.raises(Inconsistent):
        reasoner.update_computed(add=triples(":cup1 :inside :mug1 ."))
    assert set(reasoner.asserted()) == before
    assert list(reasoner.computed()) == []
    assert names(reasoner.types(iri("cup1"))) == {"Cup", "Thing"}


def test_assumptions_hold_only_for_a_while(reasoner):
    assumed = triples(":cup1 :on :table1 ; a :Cup .")
    with reasoner.assuming(assumed):
        assert reasoner.holds(triple(":cup1 :near :table1"))
    assert not reasoner.holds(triple(":cup1 :near :table1"))
    assert reasoner.holds(triple(":cup1 a :Cup"))
    with pytest.raises(Inconsistent), reasoner.assuming(triples(":cup1 a :Box .")):
        pass
    if reasoner.is_compiled:
        with (
            pytest.raises(NotCompilable),
            reasoner.assuming(triples(":Box rdfs:subClassOf :Thing ."), allow_recompute=False),
        ):
            pass
    else:
        with pytest.raises(NotCompilable), reasoner.assuming(assumed, allow_recompute=False):
            pass
        assert "compared" in reasoner.not_incremental


def test_a_copy_has_the_same_facts_without_the_suppressed_ones(reasoner):
    fact, measured = triple(":mug1 :on :table1"), triple(":cup1 :on :shelf1")
    reasoner.update_computed(suppress=[fact], add=[measured])
    copy = Reasoner.of(reasoner.given_facts())
    assert not copy.holds(fact)
    assert copy.is_computed(measured)
    assert copy.holds(triple(":mug2 a :Cup"))


def test_a_change_of_the_schema_concerns_those_whose_classes_change(reasoner):
    change = reasoner.apply(insert=triples(":Mug rdfs:subClassOf :Ware ."))
    assert names(change.others) >= {"mug1", "mug2"}
    assert "Ware" in names(reasoner.types(iri("mug2")))
    assert "Ware" not in names(reasoner.types(iri("cup1")))
