"""Random worlds: a schema with any constructs of OWL 2 RL, facts, and changes of both."""

import random
from typing import NamedTuple

from tests.kb_node.reasoner.graphs import triple, triples

CLASSES = [f":C{n}" for n in range(7)]
OBJECT_PROPERTIES = [f":p{n}" for n in range(5)]
DATA_PROPERTIES = [f":d{n}" for n in range(4)]
INDIVIDUALS = [f":i{n}" for n in range(6)]
LITERALS = (
    '"1"^^xsd:integer', '"01"^^xsd:integer', '"1.0"^^xsd:decimal', '"1"^^xsd:byte', '"2"^^xsd:integer',
    '"1.50"^^xsd:float', '"1.5"^^xsd:float', '"-0.0"^^xsd:float', '"300"^^xsd:integer', '"a"', '"a"@en',
    '"a"^^xsd:token', '"a"@EN', '"true"^^xsd:boolean', '"x"^^:unknown',
)  # fmt: skip
DATATYPES = [
    f"xsd:{name}" for name in ("integer", "decimal", "byte", "float", "string", "nonNegativeInteger")
] + ["rdfs:Literal"]
AXIOMS = (
    "{c} rdfs:subClassOf {c}",
    "{c} rdfs:subClassOf {c}",
    "{c} rdfs:subClassOf {e}",
    "{e} rdfs:subClassOf {c}",
    "{c} owl:equivalentClass {c}",
    "{c} owl:equivalentClass {e}",
    "{c} owl:equivalentClass [ owl:oneOf ( {i} ) ]",
    "{c} owl:oneOf ( {i} {i} )",
    "{c} owl:disjointWith {c}",
    "{c} owl:complementOf {c}",
    "[] a owl:AllDisjointClasses ; owl:members ( {c} {c} {c} )",
    "{c} owl:hasKey ( {d} )",
    "{c} owl:hasKey ( {d} {d} )",
    "{c} owl:hasKey ( {p} {d} )",
    "{p} rdfs:domain {c}",
    "{p} rdfs:range {c}",
    "{d} rdfs:domain {c}",
    "{d} rdfs:range {t}",
    "{p} rdfs:subPropertyOf {p}",
    "{d} rdfs:subPropertyOf {d}",
    "{p} owl:equivalentProperty {p}",
    "{p} owl:inverseOf {p}",
    "{p} owl:propertyDisjointWith {p}",
    "{d} owl:propertyDisjointWith {d}",
    "[] a owl:AllDisjointProperties ; owl:members ( {p} {p} )",
    "{p} owl:propertyChainAxiom ( {p} {p} )",
    "{p} owl:propertyChainAxiom ( {p} {p} {p} )",
    "{p} a owl:FunctionalProperty",
    "{d} a owl:FunctionalProperty",
    "{p} a owl:InverseFunctionalProperty",
    "{d} a owl:InverseFunctionalProperty",
    "{p} a owl:TransitiveProperty",
    "{p} a owl:SymmetricProperty",
    "{p} a owl:AsymmetricProperty",
    "{p} a owl:IrreflexiveProperty",
    "[] a owl:NegativePropertyAssertion ; owl:sourceIndividual {i} ; owl:assertionProperty {p} ;"
    " owl:targetIndividual {i}",
    "[] a owl:NegativePropertyAssertion ; owl:sourceIndividual {i} ; owl:assertionProperty {d} ;"
    " owl:targetValue {l}",
    "[] a owl:AllDifferent ; owl:members ( {i} {i} )",
    "[] a owl:AllDifferent ; owl:distinctMembers ( {i} {i} )",
    "{c} a owl:Class",
    "{p} a owl:ObjectProperty",
)
EXPRESSIONS = (
    "[ owl:unionOf ( {c} {c} ) ]",
    "[ owl:intersectionOf ( {c} {c} ) ]",
    "[ owl:intersectionOf ( {c} {r} ) ]",
    "[ owl:oneOf ( {i} {i} ) ]",
    "{r}",
    "{r}",
    "{r}",
)
RESTRICTIONS = (
    "owl:onProperty {p} ; owl:hasValue {i}",
    "owl:onProperty {d} ; owl:hasValue {l}",
    "owl:onProperty {p} ; owl:someValuesFrom {c}",
    "owl:onProperty {p} ; owl:someValuesFrom owl:Thing",
    "owl:onProperty {d} ; owl:someValuesFrom {t}",
    "owl:onProperty {p} ; owl:allValuesFrom {c}",
    "owl:onProperty {d} ; owl:allValuesFrom {t}",
    'owl:onProperty {p} ; owl:maxCardinality "{n}"^^xsd:nonNegativeInteger',
    'owl:onProperty {d} ; owl:maxCardinality "{n}"^^xsd:nonNegativeInteger',
    'owl:onProperty {p} ; owl:maxQualifiedCardinality "{n}"^^xsd:nonNegativeInteger ; owl:onClass {c}',
    'owl:onProperty {d} ; owl:maxQualifiedCardinality "{n}"^^xsd:nonNegativeInteger ; owl:onDataRange {t}',
    'owl:onProperty {p} ; owl:qualifiedCardinality "1"^^xsd:nonNegativeInteger ; owl:onClass {c}',
    'owl:onProperty {p} ; owl:cardinality "1"^^xsd:nonNegativeInteger',
)
KEYS = [text for text in AXIOMS if "hasKey" in text] * 4 + [
    text for text in AXIOMS if text.startswith(("{d}", "{c} rdfs:subClassOf", "[] a owl:AllDifferent"))
]
NOMINALS = [text for text in AXIOMS if "oneOf" in text] * 3 + [
    text
    for text in AXIOMS
    if "{e}" in text or "range" in text or "Functional" in text or "disjointWith" in text
]

FACTS = (
    *(["{i} a {c}", "{i} {p} {i}", "{i} {d} {l}"] * 4),
    "{i} owl:sameAs {i}",
    "{i} owl:differentFrom {i}",
)
TYPE_FACTS = ("{i} {k} {c}", "{i} {k} :Other", ":Other :kinds {i}", "{c} :kinds {i}") * 2
TRANSITIVE = [text for text in AXIOMS if "TransitiveProperty" in text] * 6 + [
    text
    for text in AXIOMS
    if "{e}" in text or text.startswith("{p} ") or "rdfs:subClassOf" in text or "disjointWith" in text
]
DATA_RANGES = (
    *[
        f"[ a rdfs:Datatype ; owl:onDatatype {datatype} ; owl:withRestrictions ( {facets} ) ]"
        for datatype, facets in (
            ("xsd:integer", "[ xsd:minInclusive 2 ]"),
            ("xsd:integer", "[ xsd:minInclusive 0 ] [ xsd:maxExclusive 2 ]"),
            ("xsd:float", "[ xsd:maxInclusive '1.5'^^xsd:float ]"),
            ("xsd:string", "[ xsd:pattern '[a-c]' ]"),
            ("rdf:PlainLiteral", "[ rdf:langRange 'en' ]"),
            (":unknown", "[ xsd:minLength 1 ]"),
        )
    ],
    "[ a rdfs:Datatype ; owl:oneOf ( {l} {l} ) ]",
    "[ a rdfs:Datatype ; owl:unionOf ( {t} {x} ) ]",
    "[ a rdfs:Datatype ; owl:intersectionOf ( {t} {x} ) ]",
    "[ a rdfs:Datatype ; owl:datatypeComplementOf {x} ]",
    "{t}",
)
RANGES = [
    "{d} rdfs:range {x}",
    ":Named a rdfs:Datatype ; owl:equivalentClass {x}",
    "{d} rdfs:range :Named",
    "{c} owl:equivalentClass [ a owl:Restriction ; owl:onProperty {d} ; owl:someValuesFrom {x} ]",
    "{c} rdfs:subClassOf [ a owl:Restriction ; owl:onProperty {d} ; owl:allValuesFrom {x} ]",
    "{c} owl:disjointUnionOf ( {c} {c} )",
] * 3 + [text for text in AXIOMS if "{d}" in text or "disjointWith" in text]
EQUALITIES = [
    "{p} rdfs:subPropertyOf owl:sameAs",
    "{p} rdfs:subPropertyOf owl:differentFrom",
] * 4 + [text for text in AXIOMS if "{p}" in text or "{e}" in text or "AllDifferent" in text]
TYPES = [
    "{k} rdfs:subPropertyOf rdf:type",
    "{k} rdfs:subPropertyOf rdf:type",
    "{k} rdfs:subPropertyOf {k}",
    "{k} owl:equivalentProperty {k}",
    "{k} owl:inverseOf :kinds",
    "{k} rdfs:domain {c}",
    "{k} owl:propertyDisjointWith {k}",
    "{k} owl:propertyChainAxiom ( {p} {k} )",
    "{k} a owl:IrreflexiveProperty",
    "{c} rdfs:subClassOf [ a owl:Restriction ; owl:onProperty {k} ; owl:hasValue {c} ]",
    "{c} owl:equivalentClass [ a owl:Restriction ; owl:onProperty {k} ; owl:hasValue {c} ]",
    "{c} owl:equivalentClass [ a owl:Restriction ; owl:onProperty {k} ; owl:someValuesFrom owl:Thing ]",
] * 3 + [text for text in AXIOMS if "{c}" in text and "Key" not in text]
"""The values of the properties `k`, which may be below rdf:type, are classes."""


class Change(NamedTuple):
    """One transaction."""

    delete: list
    insert: list


class World:
    """The asserted facts of a random world, and random changes of them."""

    def __init__(self, seed, templates=AXIOMS, without=()):
        """Templates that contain a word of `without` are not used."""

        def used(texts):
            return [text for text in texts if not any(word in text for word in without)]

        self.random = random.Random(seed)
        few = self.random.random() < 0.7  # few names, so that axioms interact more often
        self._names = {
            "c": CLASSES[: 3 if few else None],
            "p": OBJECT_PROPERTIES[: 2 if few else None],
            "d": DATA_PROPERTIES[: 2 if few else None],
            "i": INDIVIDUALS[: 4 if few else None],
            "l": self.random.choice((LITERALS, LITERALS[:5])),
            "t": DATATYPES,
            "x": DATA_RANGES,
            "n": "01",
            "k": (":k0", ":k1"),
            "e": EXPRESSIONS,
            "r": [f"[ a owl:Restriction ; {text} ]" for text in used(RESTRICTIONS)],
        }
        self._templates = self.random.choices(used(templates), k=10)
        self._facts = used((*FACTS, *TYPE_FACTS) if templates is TYPES else FACTS)
        self.axioms = [self._axiom() for _ in range(self.random.randint(1, 10))]
        self.asserted = dict.fromkeys(fact for axiom in self.axioms for fact in axiom)

    def change(self):
        """Return a random change: facts are deleted and inserted, sometimes also axioms."""
        chance = self.random.random
        gone, new = [], []
        if chance() < 0.12:
            if self.axioms and chance() < 0.5:
                gone.append(self.random.choice(self.axioms))
            if not gone or chance() < 0.3:
                new.append(self._axiom())
        schema = {fact for axiom in self.axioms for fact in axiom}
        facts = [fact for fact in self.asserted if fact not in schema]
        delete = [fact for axiom in gone for fact in axiom]
        insert = [fact for axiom in new for fact in axiom]
        if not (gone or new) or chance() < 0.3:
            delete += self.random.sample(facts, min(len(facts), self.random.choice((0, 0, 1, 1, 2, 4))))
            insert += [self._fact() for _ in range(self.random.choice((0, 1, 1, 2, 3, 6)))]
        return Change(delete, insert)

    def after(self, change):
        """Return the asserted facts after a change."""
        left = dict.fromkeys(fact for fact in self.asserted if fact not in change.delete)
        return left | dict.fromkeys(change.insert)

    def accept(self, change):
        """Record that a change was accepted."""
        self.asserted = self.after(change)
        self.axioms = [axiom for axiom in self.axioms if all(fact in self.asserted for fact in axiom)]
        known = {fact for axiom in self.axioms for fact in axiom}
        if new := [fact for fact in change.insert if _is_of_an_axiom(fact) and fact not in known]:
            self.axioms.append(new)

    def _axiom(self):
        return triples(self._fill(self.random.choice(self._templates)) + " .")

    def _fact(self):
        return triple(self._fill(self.random.choice(self._facts)))

    def _fill(self, text):
        choose = self.random.choice
        while "{" in text:
            start = text.index("{")
            word = choose(self._names[text[start + 1]])
            text = text[:start] + word + text[start + 3 :]
        return text


def _is_of_an_axiom(fact):
    _, p, o = fact
    return (
        not p.startswith("<http://example.org/")
        and (p.endswith("#type>") <= ("example.org" not in o))
        and ("sameAs" not in p and "differentFrom" not in p)
    )
