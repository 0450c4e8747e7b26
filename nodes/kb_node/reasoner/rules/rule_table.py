"""The OWL 2 RL/RDF rules as a table: name | schema | data | conclusion.

The rows are tables 4 to 9 of the recommendation (OWL 2 Profiles, section 4.3) with their original names. If
the schema atoms and the data atoms of a row hold, its conclusion holds. `false` means that the graph is
inconsistent. The engine first specialises a row by its schema atoms: `?x ?p ?y` becomes `?x :partOf ?y`
before individuals are matched.

There are five list atoms:

- `?x a all(?l)`: x is in every member;
- `?m in ?l`: m is some member;
- `?x path(?l) ?y`: the properties lead from x to y, one after the other;
- `?x agree(?l) ?y`: x and y have a common value of every property;
- `?m,?n of ?l`: m and n are members at different positions.

Not in the table: eq-ref (every term is the same as itself, which is not stored), the axiomatic triples
(AXIOMS), and table 8 about values (datatypes.py). Rows named ext-* go beyond the recommendation.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import iri, iris

TABLE: Final = """
eq-sym       |                                                    | ?x owl:sameAs ?y                           | ?y owl:sameAs ?x
eq-trans     |                                                    | ?x owl:sameAs ?y, ?y owl:sameAs ?z         | ?x owl:sameAs ?z
eq-rep-s     | ?s owl:sameAs ?t                                   | ?s ?p ?o                                   | ?t ?p ?o
eq-rep-p     | ?p owl:sameAs ?q                                   | ?s ?p ?o                                   | ?s ?q ?o
eq-rep-o     | ?o owl:sameAs ?t                                   | ?s ?p ?o                                   | ?s ?p ?t
eq-diff1     |                                                    | ?x owl:sameAs ?y, ?x owl:differentFrom ?y  | false
eq-diff1     |                                                    | ?x owl:differentFrom ?x                    | false
eq-diff2     | ?x a owl:AllDifferent, ?x owl:members ?l, ?m,?n of ?l         | ?m owl:sameAs ?n                | false
eq-diff3     | ?x a owl:AllDifferent, ?x owl:distinctMembers ?l, ?m,?n of ?l | ?m owl:sameAs ?n                | false

prp-dom      | ?p rdfs:domain ?c                                  | ?x ?p ?y                                   | ?x a ?c
prp-rng      | ?p rdfs:range ?c                                   | ?x ?p ?y                                   | ?y a ?c
prp-fp       | ?p a owl:FunctionalProperty                        | ?x ?p ?y, ?x ?p ?z                         | ?y owl:sameAs ?z
prp-ifp      | ?p a owl:InverseFunctionalProperty                 | ?x ?p ?z, ?y ?p ?z                         | ?x owl:sameAs ?y
prp-irp      | ?p a owl:IrreflexiveProperty                       | ?x ?p ?x                                   | false
prp-symp     | ?p a owl:SymmetricProperty                         | ?x ?p ?y                                   | ?y ?p ?x
prp-asyp     | ?p a owl:AsymmetricProperty                        | ?x ?p ?y, ?y ?p ?x                         | false
prp-trp      | ?p a owl:TransitiveProperty                        | ?x ?p ?y, ?y ?p ?z                         | ?x ?p ?z
prp-spo1     | ?p rdfs:subPropertyOf ?q                           | ?x ?p ?y                                   | ?x ?q ?y
prp-spo2     | ?p owl:propertyChainAxiom ?l                       | ?x path(?l) ?y                             | ?x ?p ?y
prp-eqp1     | ?p owl:equivalentProperty ?q                       | ?x ?p ?y                                   | ?x ?q ?y
prp-eqp2     | ?p owl:equivalentProperty ?q                       | ?x ?q ?y                                   | ?x ?p ?y
prp-pdw      | ?p owl:propertyDisjointWith ?q                     | ?x ?p ?y, ?x ?q ?y                         | false
prp-adp      | ?d a owl:AllDisjointProperties, ?d owl:members ?l, ?p,?q of ?l | ?x ?p ?y, ?x ?q ?y             | false
prp-inv1     | ?p owl:inverseOf ?q                                | ?x ?p ?y                                   | ?y ?q ?x
prp-inv2     | ?p owl:inverseOf ?q                                | ?x ?q ?y                                   | ?y ?p ?x
prp-key      | ?c owl:hasKey ?l                                   | ?x a ?c, ?x agree(?l) ?y, ?y a ?c          | ?x owl:sameAs ?y
prp-npa1     | ?n owl:sourceIndividual ?x, ?n owl:assertionProperty ?p, ?n owl:targetIndividual ?y | ?x ?p ?y | false
prp-npa2     | ?n owl:sourceIndividual ?x, ?n owl:assertionProperty ?p, ?n owl:targetValue ?y      | ?x ?p ?y | false

cls-nothing2 |                                                    | ?x a owl:Nothing                           | false
cls-int1     | ?c owl:intersectionOf ?l                           | ?x a all(?l)                               | ?x a ?c
cls-int2     | ?c owl:intersectionOf ?l, ?m in ?l                 | ?x a ?c                                    | ?x a ?m
cls-uni      | ?c owl:unionOf ?l, ?m in ?l                        | ?x a ?m                                    | ?x a ?c
cls-com      | ?c owl:complementOf ?d                             | ?x a ?c, ?x a ?d                           | false
cls-svf1     | ?r owl:someValuesFrom ?c, ?r owl:onProperty ?p     | ?x ?p ?y, ?y a ?c                          | ?x a ?r
cls-svf2     | ?r owl:someValuesFrom owl:Thing, ?r owl:onProperty ?p | ?x ?p ?y                                | ?x a ?r
cls-avf      | ?r owl:allValuesFrom ?c, ?r owl:onProperty ?p      | ?x ?p ?y, ?x a ?r                          | ?y a ?c
cls-hv1      | ?r owl:hasValue ?y, ?r owl:onProperty ?p           | ?x a ?r                                    | ?x ?p ?y
cls-hv2      | ?r owl:hasValue ?y, ?r owl:onProperty ?p           | ?x ?p ?y                                   | ?x a ?r
cls-maxc1    | ?r owl:maxCardinality 0, ?r owl:onProperty ?p      | ?x ?p ?y, ?x a ?r                          | false
cls-maxc2    | ?r owl:maxCardinality 1, ?r owl:onProperty ?p      | ?x ?p ?y, ?x a ?r, ?x ?p ?z                | ?y owl:sameAs ?z
cls-maxqc1   | ?r owl:maxQualifiedCardinality 0, ?r owl:onProperty ?p, ?r owl:onClass ?c        | ?x ?p ?y, ?x a ?r, ?y a ?c | false
cls-maxqc2   | ?r owl:maxQualifiedCardinality 0, ?r owl:onProperty ?p, ?r owl:onClass owl:Thing | ?x ?p ?y, ?x a ?r          | false
cls-maxqc3   | ?r owl:maxQualifiedCardinality 1, ?r owl:onProperty ?p, ?r owl:onClass ?c        | ?x ?p ?y, ?x a ?r, ?y a ?c, ?x ?p ?z, ?z a ?c | ?y owl:sameAs ?z
cls-maxqc4   | ?r owl:maxQualifiedCardinality 1, ?r owl:onProperty ?p, ?r owl:onClass owl:Thing | ?x ?p ?y, ?x a ?r, ?x ?p ?z | ?y owl:sameAs ?z
cls-oo       | ?c owl:oneOf ?l, ?m in ?l                          |                                            | ?m a ?c

cax-sco      |                                                    | ?x a ?c, ?c rdfs:subClassOf ?d             | ?x a ?d
cax-eqc1     |                                                    | ?x a ?c, ?c owl:equivalentClass ?d         | ?x a ?d
cax-eqc2     |                                                    | ?x a ?d, ?c owl:equivalentClass ?d         | ?x a ?c
cax-dw       | ?c owl:disjointWith ?d                             | ?x a ?c, ?x a ?d                           | false
cax-adc      | ?a a owl:AllDisjointClasses, ?a owl:members ?l, ?c,?d of ?l | ?x a ?c, ?x a ?d                  | false

scm-cls      |                                                    | ?c a owl:Class                             | ?c rdfs:subClassOf ?c
scm-cls      |                                                    | ?c a owl:Class                             | ?c owl:equivalentClass ?c
scm-cls      |                                                    | ?c a owl:Class                             | ?c rdfs:subClassOf owl:Thing
scm-cls      |                                                    | ?c a owl:Class                             | owl:Nothing rdfs:subClassOf ?c
scm-sco      |                                                    | ?c rdfs:subClassOf ?d, ?d rdfs:subClassOf ?e | ?c rdfs:subClassOf ?e
scm-eqc1     |                                                    | ?c owl:equivalentClass ?d                  | ?c rdfs:subClassOf ?d
scm-eqc1     |                                                    | ?c owl:equivalentClass ?d                  | ?d rdfs:subClassOf ?c
scm-eqc2     |                                                    | ?c rdfs:subClassOf ?d, ?d rdfs:subClassOf ?c | ?c owl:equivalentClass ?d
scm-op       |                                                    | ?p a owl:ObjectProperty                    | ?p rdfs:subPropertyOf ?p
scm-op       |                                                    | ?p a owl:ObjectProperty                    | ?p owl:equivalentProperty ?p
scm-dp       |                                                    | ?p a owl:DatatypeProperty                  | ?p rdfs:subPropertyOf ?p
scm-dp       |                                                    | ?p a owl:DatatypeProperty                  | ?p owl:equivalentProperty ?p
scm-spo      |                                                    | ?p rdfs:subPropertyOf ?q, ?q rdfs:subPropertyOf ?r | ?p rdfs:subPropertyOf ?r
scm-eqp1     |                                                    | ?p owl:equivalentProperty ?q               | ?p rdfs:subPropertyOf ?q
scm-eqp1     |                                                    | ?p owl:equivalentProperty ?q               | ?q rdfs:subPropertyOf ?p
scm-eqp2     |                                                    | ?p rdfs:subPropertyOf ?q, ?q rdfs:subPropertyOf ?p | ?p owl:equivalentProperty ?q
scm-dom1     |                                                    | ?p rdfs:domain ?c, ?c rdfs:subClassOf ?d   | ?p rdfs:domain ?d
scm-dom2     |                                                    | ?q rdfs:domain ?c, ?p rdfs:subPropertyOf ?q | ?p rdfs:domain ?c
scm-rng1     |                                                    | ?p rdfs:range ?c, ?c rdfs:subClassOf ?d    | ?p rdfs:range ?d
scm-rng2     |                                                    | ?q rdfs:range ?c, ?p rdfs:subPropertyOf ?q | ?p rdfs:range ?c
scm-hv       | | ?r owl:hasValue ?i, ?r owl:onProperty ?p, ?s owl:hasValue ?i, ?s owl:onProperty ?q, ?p rdfs:subPropertyOf ?q             | ?r rdfs:subClassOf ?s
scm-svf1     | | ?r owl:someValuesFrom ?c, ?r owl:onProperty ?p, ?s owl:someValuesFrom ?d, ?s owl:onProperty ?p, ?c rdfs:subClassOf ?d    | ?r rdfs:subClassOf ?s
scm-svf2     | | ?r owl:someValuesFrom ?c, ?r owl:onProperty ?p, ?s owl:someValuesFrom ?c, ?s owl:onProperty ?q, ?p rdfs:subPropertyOf ?q | ?r rdfs:subClassOf ?s
scm-avf1     | | ?r owl:allValuesFrom ?c, ?r owl:onProperty ?p, ?s owl:allValuesFrom ?d, ?s owl:onProperty ?p, ?c rdfs:subClassOf ?d      | ?r rdfs:subClassOf ?s
scm-avf2     | | ?r owl:allValuesFrom ?c, ?r owl:onProperty ?p, ?s owl:allValuesFrom ?c, ?s owl:onProperty ?q, ?p rdfs:subPropertyOf ?q   | ?s rdfs:subClassOf ?r
scm-int      | ?c owl:intersectionOf ?l, ?m in ?l                 |                                            | ?c rdfs:subClassOf ?m
scm-uni      | ?c owl:unionOf ?l, ?m in ?l                        |                                            | ?m rdfs:subClassOf ?c

ext-card     | ?r owl:cardinality 0                               |                                            | ?r owl:maxCardinality 0
ext-card     | ?r owl:cardinality 1                               |                                            | ?r owl:maxCardinality 1
ext-card     | ?r owl:qualifiedCardinality 0                      |                                            | ?r owl:maxQualifiedCardinality 0
ext-card     | ?r owl:qualifiedCardinality 1                      |                                            | ?r owl:maxQualifiedCardinality 1
ext-union    | ?c owl:disjointUnionOf ?l, ?m in ?l                |                                            | ?m rdfs:subClassOf ?c
ext-union    | ?c owl:disjointUnionOf ?l, ?m,?n of ?l             |                                            | ?m owl:disjointWith ?n
ext-range    | ?r owl:onDataRange ?c                              |                                            | ?r owl:onClass ?c
"""  # noqa: E501

Atom = tuple[str, str, str]
"""Three terms or variables (`?x`); or a list atom: ('?m', 'in', '?l'), ('?m,?n', 'of', '?l'),
('?x', 'a', 'all(?l)'), ('?x', 'path(?l)', '?y'), ('?x', 'agree(?l)', '?y')."""


class Rule(NamedTuple):
    """A row, or the rest of it after some atoms are matched. `premises` are the triples matched so far."""

    name: str
    schema: tuple[Atom, ...]
    data: tuple[Atom, ...]
    head: Atom | None
    premises: tuple[Triple, ...] = ()


def _term(word: str) -> str:
    if word[0] == "?" or "(" in word or word in ("in", "of"):
        return word
    if word in ("0", "1"):
        return NUMBERS[int(word)]
    return iri(word)


def _atoms(text: str) -> tuple[Atom, ...]:
    atoms = [part.split() for part in text.split(", ") if part.strip()]
    return tuple((_term(s), _term(p), _term(o)) for s, p, o in atoms)


def _rule(row: str) -> Rule:
    name, schema, data, head = (cell.strip() for cell in row.split("|"))
    return Rule(name, _atoms(schema), _atoms(data), None if head == "false" else _atoms(head)[0])


NUMBERS: Final[tuple[Term, Term]] = (
    f'"0"^^{iri("xsd:nonNegativeInteger")}',
    f'"1"^^{iri("xsd:nonNegativeInteger")}',
)
"""The literals 0 and 1 of the table. Other spellings are equal by value (dt-eq)."""

RULES: Final[tuple[Rule, ...]] = tuple(_rule(row) for row in TABLE.splitlines() if row.strip())

ANNOTATIONS: Final = iris(
    "rdfs:label rdfs:comment rdfs:seeAlso rdfs:isDefinedBy owl:deprecated owl:versionInfo owl:priorVersion "
    "owl:backwardCompatibleWith owl:incompatibleWith"
)
DATATYPES: Final = iris(
    "rdfs:Literal rdf:PlainLiteral rdf:XMLLiteral rdf:langString xsd:decimal xsd:integer "
    "xsd:nonNegativeInteger xsd:nonPositiveInteger xsd:positiveInteger xsd:negativeInteger xsd:long xsd:int "
    "xsd:short xsd:byte xsd:unsignedLong xsd:unsignedInt xsd:unsignedShort xsd:unsignedByte xsd:float "
    "xsd:double xsd:string xsd:normalizedString xsd:token xsd:language xsd:Name xsd:NCName xsd:NMTOKEN "
    "xsd:boolean xsd:hexBinary xsd:base64Binary xsd:anyURI xsd:dateTime xsd:dateTimeStamp xsd:date"
)

AXIOMS: Final[dict[Triple, str]] = {
    (iri("owl:Thing"), iri("a"), iri("owl:Class")): "cls-thing",
    (iri("owl:Nothing"), iri("a"), iri("owl:Class")): "cls-nothing1",
}
"""Axiomatic triples that are premises of other rules, with their rule's name."""

DECLARATIONS: Final[dict[Triple, str]] = {
    **{(term, iri("a"), iri("owl:AnnotationProperty")): "prp-ap" for term in ANNOTATIONS},
    **{(term, iri("a"), iri("rdfs:Datatype")): "dt-type1" for term in DATATYPES},
}
"""Axiomatic triples without further conclusions. They are not stored."""
