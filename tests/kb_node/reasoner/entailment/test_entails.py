"""Cases of entailment and non-entailment: a name, a premise and a conclusion."""

from functools import reduce
from itertools import combinations, islice
from operator import and_

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.entailment import contradictory, entails
from tests.kb_node.reasoner.entailment.cases import cases, follows, picture, spelled_out
from tests.kb_node.reasoner.entailment.models import MEANINGS, where
from tests.kb_node.reasoner.graphs import triples

FOLLOWS = """
different by a functional property
    :hasFather a owl:FunctionalProperty . :a :hasFather :f . :b :hasFather :g . :f owl:differentFrom :g
    :a owl:differentFrom :b
different by two values of a functional data property
    :age a owl:FunctionalProperty . :a :age 3 . :b :age 4
    :a owl:differentFrom :b
different by an inverse functional property
    :owns a owl:InverseFunctionalProperty . :a :owns :x . :b :owns :y . :a owl:differentFrom :b
    :x owl:differentFrom :y
different by disjoint properties
    :father owl:propertyDisjointWith :mother . :s :father :p . :s :mother :l
    :p owl:differentFrom :l
different by disjoint data properties
    :name owl:propertyDisjointWith :street . :p :name "Elm" . :q :street "Elm"
    :p owl:differentFrom :q
different by disjoint classes, and vice versa
    :Cup owl:disjointWith :Room . :c a :Cup . :r a :Room
    :c owl:differentFrom :r . :r owl:differentFrom :c
difference is symmetric
    :a owl:differentFrom :b
    :b owl:differentFrom :a
different members of a list
    [] a owl:AllDifferent ; owl:distinctMembers (:a :b :c)
    :a owl:differentFrom :c . :c owl:differentFrom :b
different by an irreflexive property
    :near a owl:IrreflexiveProperty . :a :near :b
    :a owl:differentFrom :b
different by a negative assertion
    [] NEVER(:a :p :x) . :b :p :x
    :a owl:differentFrom :b
all different of three
    [] a owl:AllDisjointProperties ; owl:members (:p :q :r) . :s :p :a ; :q :b ; :r :c
    [] a owl:AllDifferent ; owl:members (:a :b :c)
all different by disjoint classes
    :A owl:disjointWith :B . :a a :A . :b a :B
    [] a owl:AllDifferent ; owl:distinctMembers (:a :b)
not of a disjoint class
    :Boy owl:disjointWith :Girl . :stewie a :Boy
    :stewie a [ a owl:Class ; owl:complementOf :Girl ]
not of one of three disjoint classes
    [] a owl:AllDisjointClasses ; owl:members (:Boy :Girl :Dog) . :stewie a :Boy
    :stewie a [ owl:complementOf :Girl ] , [ owl:complementOf :Dog ]
not of a union
    :A owl:disjointWith :B , :C . :x a :A
    :x a [ owl:complementOf [ owl:unionOf (:B :C) ] ]
not of an intersection
    :A owl:disjointWith :B . :x a :A
    :x a [ owl:complementOf [ owl:intersectionOf (:B :C) ] ]
the domain excludes what the subject is not
    :p rdfs:domain :A . :A owl:disjointWith :B . :x a :B
    :x a [ owl:onProperty :p ; owl:maxCardinality NONE ]
a negative assertion by a functional property
    :p a owl:FunctionalProperty . :a :p :x . :x owl:differentFrom :y
    [] NEVER(:a :p :y)
a negative assertion by a functional data property
    :p a owl:FunctionalProperty . :a :p 1
    [] owl:sourceIndividual :a ; owl:assertionProperty :p ; owl:targetValue 2 ;
      a owl:NegativePropertyAssertion
a negative assertion by an asymmetric property
    :p a owl:AsymmetricProperty . :a :p :b
    [] NEVER(:b :p :a)
a negative assertion of a disjoint property
    :p owl:propertyDisjointWith :q . :a :p :b
    [] NEVER(:a :q :b)
a negative assertion as it was stated
    [] NEVER(:a :p :y)
    [] NEVER(:a :p :y)
reflexive
    :knows a owl:ReflexiveProperty . :p a owl:Thing
    :p :knows :p
reflexive by a property below
    :knows a owl:ReflexiveProperty ; rdfs:subPropertyOf :seenBy . :p a :A
    :p :seenBy :p
what is reflexive has a domain
    :knows a owl:ReflexiveProperty ; rdfs:domain :Agent . :p a :A
    :p a :Agent
knowing oneself
    :Narcissist rdfs:subClassOf [ owl:onProperty :likes ; owl:hasSelf true ] . :n a :Narcissist
    :n :likes :n
a class of those who like themselves
    :n :likes :n
    :n a [ a owl:Restriction ; owl:onProperty :likes ; owl:hasSelf true ]
the top property relates all
    :a a :A . :b a :B
    :a owl:topObjectProperty :b
an existential restriction says there is one
    :Person rdfs:subClassOf SOME(:parent :Person) . :fred a :Person
    :fred :parent [ a :Person ; :parent [ a :Person ] ]
two steps of it, the nodes without classes
    :Person rdfs:subClassOf SOME(:parent :Person) . :fred a :Person
    :fred :parent [ :parent [] ]
there is one by cardinality
    :P rdfs:subClassOf [ owl:onProperty :mother ; owl:cardinality ONE ] . :fred a :P
    :fred :mother []
what there is makes an existential restriction
    :fred :parent [ a :Person ]
    :fred a SOME(:parent :Person)
one value is at least one
    :a :p :b
    :a a [ owl:onProperty :p ; owl:minCardinality ONE ]
two different values are at least two
    :a :p :b , :c . :b owl:differentFrom :c
    :a a [ owl:onProperty :p ; owl:minCardinality TWO ]
at most one of a functional property
    :p a owl:FunctionalProperty . :a a :A
    :a a [ owl:onProperty :p ; owl:maxCardinality ONE ]
    :A rdfs:subClassOf [ owl:onProperty :p ; owl:maxCardinality ONE ]
a blank node for an object
    :a :p :b . :b :q :c
    :a :p _:x . _:x :q _:y
functional by a restriction on everything
    owl:Thing rdfs:subClassOf [ owl:onProperty :p ; owl:maxCardinality ONE ]
    :p a owl:FunctionalProperty
functional because its inverse is inverse functional
    :p owl:inverseOf :q . :q a owl:InverseFunctionalProperty
    :p a owl:FunctionalProperty
functional because the one above it is
    :p rdfs:subPropertyOf :q . :q a owl:FunctionalProperty
    :p a owl:FunctionalProperty
symmetric because it is its own inverse
    :p owl:inverseOf :p
    :p a owl:SymmetricProperty
its own inverse because symmetric
    :p a owl:SymmetricProperty , owl:ObjectProperty
    :p owl:inverseOf :p
transitive by a chain of itself
    :p owl:propertyChainAxiom (:p :p)
    :p a owl:TransitiveProperty
a chain because it is transitive
    :p a owl:TransitiveProperty
    :p owl:propertyChainAxiom (:p :p :p)
a chain by the property above
    :p owl:propertyChainAxiom (:q :r) ; rdfs:subPropertyOf :s . :t rdfs:subPropertyOf :q
    :s owl:propertyChainAxiom (:t :r)
irreflexive because asymmetric
    :p a owl:AsymmetricProperty
    :p a owl:IrreflexiveProperty
asymmetric because disjoint with its inverse
    :p owl:inverseOf :q ; owl:propertyDisjointWith :q
    :p a owl:AsymmetricProperty
disjoint properties by disjoint ranges
    :p rdfs:range :A . :q rdfs:range :B . :A owl:disjointWith :B
    :p owl:propertyDisjointWith :q
the inverse of an inverse
    :p owl:inverseOf :q . :r owl:inverseOf :q
    :p owl:equivalentProperty :r
a domain by the inverse's range
    :p owl:inverseOf :q . :q rdfs:range :A . :A rdfs:subClassOf :B
    :p rdfs:domain :B
an inverse in a restriction
    :p owl:inverseOf :q . :x :q :y . :x a :A
    :y a [ owl:onProperty [ owl:inverseOf :q ] ; owl:someValuesFrom :A ]
the range of bytes is one of shorts
    :p rdfs:range xsd:byte
    :p rdfs:range xsd:short
a subclass of an intersection
    :A rdfs:subClassOf :B , :C
    :A rdfs:subClassOf [ owl:intersectionOf (:B :C) ]
a named intersection
    :A rdfs:subClassOf :B , :C . :D owl:intersectionOf (:B :C)
    :A rdfs:subClassOf :D
a union of subclasses
    :A rdfs:subClassOf :C . :B rdfs:subClassOf :C
    [ owl:unionOf (:A :B) ] rdfs:subClassOf :C
a union is commutative
    :U owl:unionOf (:A :B) . :V owl:unionOf (:B :A)
    :U owl:equivalentClass :V
union of enumerations
    :A owl:oneOf (:a) . :B owl:oneOf (:b) . :C owl:oneOf (:a :b) . :D owl:unionOf (:A :B)
    :C owl:equivalentClass :D
a definition by the same restriction
    :A owl:equivalentClass SOME(:p :C) . :B owl:equivalentClass SOME(:p :C)
    :A owl:equivalentClass :B
every value of a narrower class
    :A rdfs:subClassOf ONLY(:p :B) . :B rdfs:subClassOf :C
    :A rdfs:subClassOf ONLY(:p :C)
every value by the range
    :p rdfs:range :C . :a a :A
    :A rdfs:subClassOf ONLY(:p :C)
subclasses of disjoint classes
    :A owl:disjointWith :B . :C rdfs:subClassOf :A . :D rdfs:subClassOf :B
    [] a owl:AllDisjointClasses ; owl:members (:C :D)
disjoint is symmetric
    :A owl:disjointWith :B
    :B owl:disjointWith :A . :A rdfs:subClassOf [ owl:complementOf :B ]
disjoint by a functional value
    :p a owl:FunctionalProperty . :A rdfs:subClassOf HAS(:p 1) . :B rdfs:subClassOf HAS(:p 2)
    :A owl:disjointWith :B
all disjoint from pairs
    :A owl:disjointWith :B , :C . :B owl:disjointWith :C
    [] a owl:AllDisjointClasses ; owl:members (:C :B :A)
in either case
    :A owl:unionOf (:B :C) . :B rdfs:subClassOf :D . :C rdfs:subClassOf :D . :x a :A
    :x a :D
an empty class is a subclass of all
    :A rdfs:subClassOf :B , :C . :B owl:disjointWith :C
    :A rdfs:subClassOf owl:Nothing , :E
by a key
    :Person owl:hasKey (:number) . :a a :Person ; :number 7 . :b a :Person ; :number 7
    :a owl:sameAs :b
a key of a subclass
    :Person owl:hasKey (:number) . :Child rdfs:subClassOf :Person
    :Child owl:hasKey (:number)
in a class above one whose definition is met
    :A owl:equivalentClass [ owl:onProperty :p ; owl:minCardinality TWO ] ; rdfs:subClassOf :B .
      :a :p :b , :c . :b owl:differentFrom :c
    :a a :A , :B
same in all
    :A rdfs:subClassOf HAS(:p :v) . :a a :A
    :a a HAS(:p :v)
from a contradiction
    :A owl:disjointWith :B . [] NEVER(:a :p :y)
    [ owl:intersectionOf (:A :B) ] rdfs:subClassOf :Z
what two ranges have in common
    :p rdfs:range xsd:short , xsd:unsignedInt
    :p rdfs:range xsd:unsignedShort
exactly one is at least one and at most one
    :C rdfs:subClassOf [ owl:onProperty :p ; owl:cardinality ONE ]
    :C rdfs:subClassOf [ owl:onProperty :p ; owl:minCardinality ONE ] , MOST(:p)
at least one and at most one is exactly one
    :C rdfs:subClassOf [ owl:onProperty :p ; owl:minCardinality ONE ] , MOST(:p)
    :C rdfs:subClassOf [ owl:onProperty :p ; owl:cardinality ONE ]
the same property by the same value
    :d owl:equivalentClass HAS(:p :v) , HAS(:q :v) .
      :p rdfs:domain :d . :q rdfs:domain :d . :p a owl:FunctionalProperty . :q a owl:FunctionalProperty
    :p owl:equivalentProperty :q
a functional property has at most one value of any class
    :p a owl:FunctionalProperty
    owl:Thing rdfs:subClassOf MOST(:p)
the only value is the one that must exist
    :A rdfs:subClassOf MOST(:p) , SOME(:p :B)
    :A rdfs:subClassOf ONLY(:p :B)
what is reached is reflexive, too
    :p a owl:ReflexiveProperty ; rdfs:domain :A
    :p rdfs:range :A
something that there is
    :a a :A . :a :p :b
    _:x a owl:Class , :A ; :p [ a owl:Thing ]
a class of either vocabulary
    :A a owl:Class
    :A a rdfs:Class
a transitive property is a property
    :p a owl:TransitiveProperty
    :p a rdf:Property , owl:ObjectProperty
declared as it is used
    :p rdfs:domain :A
    :A a owl:Class
with declarations
    :A rdfs:subClassOf :B . :B rdfs:subClassOf :C
    :A a owl:Class ; rdfs:subClassOf :C . :C a owl:Class . <http://example.org/o> a owl:Ontology
"""

DOES_NOT = """
no unique names
    :a a :A . :b a :B
    :a owl:differentFrom :b
not different by a property that is not functional
    :p a owl:ObjectProperty . :a :p :x . :b :p :y . :x owl:differentFrom :y
    :a owl:differentFrom :b
not different by one functional value only
    :p a owl:FunctionalProperty . :a :p :x . :b :p :y
    :a owl:differentFrom :b
not the same for want of a difference
    :a a :A . :b a :A
    :a owl:sameAs :b
the same does not follow from not differing in one value
    :p a owl:FunctionalProperty . :a :p :x . :b :p :x
    :a owl:sameAs :b
an open world knows no absence
    :a a :A
    :a a [ owl:complementOf :B ]
no negative assertion for want of a fact
    :a :p :x
    [] NEVER(:a :p :y)
not all different when two may be the same
    :a owl:differentFrom :b , :c
    [] a owl:AllDifferent ; owl:distinctMembers (:a :b :c)
a union is not one of its parts
    :A owl:unionOf (:B :C) . :x a :A
    :x a :B
one value is not two
    :a :p :b , :c
    :a a [ owl:onProperty :p ; owl:minCardinality TWO ]
one known value is not one at most
    :a :p :b
    :a a [ owl:onProperty :p ; owl:maxCardinality ONE ]
all known values are not all
    :a :p :b . :b a :B
    :a a ONLY(:p :B)
not a subclass by being a superclass
    :A rdfs:subClassOf :B
    :B rdfs:subClassOf :A
not equivalent by one direction
    :A rdfs:subClassOf SOME(:p :C) . :B owl:equivalentClass SOME(:p :C)
    :A owl:equivalentClass :B
not disjoint for want of members in common
    :a a :A . :b a :B . :a owl:differentFrom :b
    :A owl:disjointWith :B
not symmetric by an example
    :a :p :b . :b :p :a
    :p a owl:SymmetricProperty
not functional by an example
    :a :p :b
    :p a owl:FunctionalProperty
not functional because the one below is
    :p rdfs:subPropertyOf :q . :p a owl:FunctionalProperty
    :q a owl:FunctionalProperty
not irreflexive by an example
    :a :p :b . :a owl:differentFrom :b
    :p a owl:IrreflexiveProperty
not reflexive by an example
    :a :p :a
    :p a owl:ReflexiveProperty
not reflexive because symmetric and transitive
    :p a owl:SymmetricProperty , owl:TransitiveProperty . :a a :A
    :a :p :a
not transitive by a chain of another
    :p owl:propertyChainAxiom (:p :q)
    :p a owl:TransitiveProperty
shorts are not bytes, nor is what two ranges have in common
    :p rdfs:range xsd:short , xsd:unsignedInt
    :p rdfs:range xsd:unsignedByte
shorts are not bytes
    :p rdfs:range xsd:short
    :p rdfs:range xsd:byte
no value without an existential restriction
    :A rdfs:subClassOf ONLY(:p :B) . :a a :A
    :a :p []
a witness is of no other class
    :A rdfs:subClassOf SOME(:p :B) . :a a :A . :c a :C
    :a :p [ a :C ]
two witnesses may be one
    :A rdfs:subClassOf SOME(:p :B) , SOME(:p :C) . :a a :A
    :a a [ owl:onProperty :p ; owl:minCardinality TWO ]
one blank node is one individual
    :a :p :b . :a :q :c
    :a :p _:x ; :q _:x
a blank node of the conclusion differs from those of the premise
    :A rdfs:subClassOf _:x . _:x owl:onProperty :p ; owl:someValuesFrom :B
    :A rdfs:subClassOf _:x . _:x owl:onProperty :p ; owl:allValuesFrom :B
no key without a value
    :Person owl:hasKey (:number :name) . :a a :Person ; :number 7 . :b a :Person ; :number 7
    :a owl:sameAs :b
a key of a class is none of a wider one
    :Child owl:hasKey (:number) . :Child rdfs:subClassOf :Person
    :Person owl:hasKey (:number)
not every domain
    :p rdfs:domain :A
    :p rdfs:range :A
no inverse from one direction
    :a :p :b . :b :q :a
    :p owl:inverseOf :q
a subproperty's domain is none of the property above
    :p rdfs:subPropertyOf :q ; rdfs:domain :A
    :q rdfs:domain :A
an axiom without members
    :z owl:members (:A :B) . :A owl:disjointWith :B
    :z a owl:AllDisjointClasses
an axiom with an unknown name
    :A owl:disjointWith :B
    :z a owl:AllDisjointClasses ; owl:members (:A :B)
a list without members
    :A owl:disjointWith :B
    [] a owl:AllDifferent
a negative assertion without a target
    :A owl:disjointWith :B
    [] a owl:NegativePropertyAssertion ; owl:sourceIndividual :a
a class without axioms
    :a a :A
    [] owl:complementOf :A
a class that is declared, without axioms
    :a a :A
    [] a owl:Class ; owl:complementOf :A
a restriction with a name
    :r rdfs:subClassOf SOME(:p :A) . SOME(:p :A) rdfs:subClassOf :r
    :r owl:onProperty :p ; owl:someValuesFrom :A
a restriction without a property
    :r rdfs:subClassOf :A
    :r owl:someValuesFrom :A
a number that is none
    :a :p :b
    :a a [ owl:onProperty :p ; owl:minCardinality :many ]
an annotation that is not asserted
    :a a :A
    :a rdfs:label "a"
a declaration of something else
    :p rdfs:domain :A
    :B a owl:Class
bottom is empty but nothing is in it
    :a a :A
    :a owl:bottomObjectProperty :a
the enumeration has two members
    :A owl:oneOf (:a :b) . :x a :A
    :x owl:sameAs :a
a member of all but one
    :I owl:intersectionOf (:A :B :C) . :x a :A , :B
    :x a :I
"""


@pytest.mark.parametrize(("premise", "conclusion"), cases(FOLLOWS))
def test_follows(premise, conclusion):
    assert follows(premise, conclusion)


@pytest.mark.parametrize(("premise", "conclusion"), cases(DOES_NOT))
def test_does_not_follow(premise, conclusion):
    assert not follows(premise, conclusion)


@settings(max_examples=6, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.sampled_from(list(MEANINGS)), min_size=1, max_size=4, unique=True))
def test_no_conclusion_is_false_in_a_small_interpretation(premise):
    check_soundness(premise)


@pytest.mark.long
@settings(max_examples=2000, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.sampled_from(list(MEANINGS)), min_size=1, max_size=5, unique=True))
def test_no_conclusion_is_false_in_many_interpretations(premise):
    check_soundness(premise)


def check_soundness(premise):
    true = reduce(and_, map(where, premise))
    text = spelled_out(" . ".join(premise) + " .")
    try:
        reasoner = Reasoner(triples(text))
    except Inconsistent:
        assert not true
        return
    before = picture(reasoner)
    assert not (contradictory(reasoner) and true)
    for conclusion in MEANINGS:
        if entails(reasoner, triples(spelled_out(conclusion + " ."))):
            assert not true & ~where(conclusion), f"{premise} does not say that {conclusion}"
    assert picture(reasoner) == before


SMALL_ONLY = ("Irreflexive", "Asymmetric", "Reflexive")
"""Axioms of which many conclusions are valid only because the interpretations are small."""


def _valid_conclusions():
    """Yield some premises of two axioms, and what is true in all of their small interpretations."""
    axioms = [axiom for axiom in MEANINGS if not any(word in axiom for word in SMALL_ONLY)]
    for premise in islice(combinations(axioms, 2), 3, None, 17):
        true = reduce(and_, map(where, premise))
        conclusions = [axiom for axiom in MEANINGS if not true & ~where(axiom) and axiom not in premise]
        if true and conclusions:
            yield premise, conclusions


def test_conclusions_of_two_axioms_are_proved():
    """All but 17, most of which are valid only because the interpretations are small."""
    missed = 0
    for premise, conclusions in _valid_conclusions():
        reasoner = Reasoner(triples(spelled_out(" . ".join(premise) + " .")))
        for axiom in conclusions:
            is_proved = entails(reasoner, triples(spelled_out(axiom + " .")))
            missed += not is_proved
    assert missed <= 17
