"""All interpretations of two classes, two properties and two individuals over one and over two elements.

The meaning of axioms is defined here independently, by sets. A set of interpretations is an integer with one
bit for each. So a conclusion that is false in an interpretation of the premise is found immediately.
"""

from functools import cache
from itertools import product

MEANINGS = {
    ":A rdfs:subClassOf :B": lambda m: m.A <= m.B,
    ":B rdfs:subClassOf :A": lambda m: m.B <= m.A,
    ":A owl:equivalentClass :B": lambda m: m.A == m.B,
    ":A owl:disjointWith :B": lambda m: not m.A & m.B,
    ":A owl:complementOf :B": lambda m: not m.A ^ (m.all - m.B),
    ":A rdfs:subClassOf owl:Nothing": lambda m: not m.A,
    ":A rdfs:subClassOf SOME(:p :B)": lambda m: all(m.to(m.p, x) & m.B for x in m.A),
    "SOME(:p :B) rdfs:subClassOf :A": lambda m: all(x in m.A for x in m.all if m.to(m.p, x) & m.B),
    ":A rdfs:subClassOf ONLY(:p :B)": lambda m: all(m.to(m.p, x) <= m.B for x in m.A),
    ":A rdfs:subClassOf MOST(:p)": lambda m: all(len(m.to(m.p, x)) < 2 for x in m.A),
    ":A rdfs:subClassOf HAS(:p :a)": lambda m: all(m.a in m.to(m.p, x) for x in m.A),
    ":A owl:oneOf (:a)": lambda m: not m.A ^ {m.a},
    ":A owl:oneOf (:a :b)": lambda m: not m.A ^ {m.a, m.b},
    ":p rdfs:domain :A": lambda m: all(x in m.A for x, _ in m.p),
    ":p rdfs:range :A": lambda m: all(y in m.A for _, y in m.p),
    ":q rdfs:range :B": lambda m: all(y in m.B for _, y in m.q),
    ":p a owl:FunctionalProperty": lambda m: all(len(m.to(m.p, x)) < 2 for x in m.all),
    ":p a owl:InverseFunctionalProperty": lambda m: all(len(m.to(m.inverse(m.p), x)) < 2 for x in m.all),
    ":p a owl:SymmetricProperty": lambda m: m.p == m.inverse(m.p),
    ":p a owl:AsymmetricProperty": lambda m: not m.p & m.inverse(m.p),
    ":p a owl:TransitiveProperty": lambda m: m.then(m.p, m.p) <= m.p,
    ":p a owl:IrreflexiveProperty": lambda m: all(x != y for x, y in m.p),
    ":p a owl:ReflexiveProperty": lambda m: all((x, x) in m.p for x in m.all),
    ":q a owl:FunctionalProperty": lambda m: all(len(m.to(m.q, x)) < 2 for x in m.all),
    ":p rdfs:subPropertyOf :q": lambda m: m.p <= m.q,
    ":p owl:inverseOf :q": lambda m: m.p == m.inverse(m.q),
    ":p owl:equivalentProperty :q": lambda m: m.p == m.q,
    ":p owl:propertyDisjointWith :q": lambda m: not m.p & m.q,
    ":p owl:propertyChainAxiom (:q :q)": lambda m: m.then(m.q, m.q) <= m.p,
    ":a a :A": lambda m: m.a in m.A,
    ":b a :A": lambda m: m.b in m.A,
    ":b a :B": lambda m: m.b in m.B,
    ":a a SOME(:p :B)": lambda m: bool(m.to(m.p, m.a) & m.B),
    ":a a [ owl:complementOf :B ]": lambda m: m.a not in m.B,
    ":a :p :b": lambda m: (m.a, m.b) in m.p,
    ":a :p :a": lambda m: (m.a, m.a) in m.p,
    ":a :p []": lambda m: bool(m.to(m.p, m.a)),
    ":b :p :a": lambda m: (m.b, m.a) in m.p,
    ":b :q :a": lambda m: (m.b, m.a) in m.q,
    ":a :q :b": lambda m: (m.a, m.b) in m.q,
    ":a owl:sameAs :b": lambda m: m.a == m.b,
    ":a owl:differentFrom :b": lambda m: m.a != m.b,
    "[] NEVER(:a :p :b)": lambda m: (m.a, m.b) not in m.p,
    ":a a [ owl:unionOf (:A :B) ]": lambda m: m.a in m.A | m.B,
    ":a a [ owl:intersectionOf (:A :B) ]": lambda m: m.a in m.A & m.B,
    ":A owl:unionOf (:B [ owl:oneOf (:a) ])": lambda m: not m.A ^ (m.B | {m.a}),
    ":A owl:intersectionOf (:B SOME(:p :B))": lambda m: not m.A ^ {x for x in m.B if m.to(m.p, x) & m.B},
    ":A owl:disjointUnionOf (:B [ owl:oneOf (:a) ])": lambda m: m.a not in m.B and not m.A ^ (m.B | {m.a}),
    ":A owl:hasKey (:p)": lambda m: all(x == y or not m.to(m.p, x) & m.to(m.p, y) for x in m.A for y in m.A),
    ":A rdfs:subClassOf SELF(:p)": lambda m: all((x, x) in m.p for x in m.A),
    ":A rdfs:subClassOf SOME([ owl:inverseOf :p ] :B)": lambda m: all(
        m.to(m.inverse(m.p), x) & m.B for x in m.A
    ),
    ":a a SELF(:q)": lambda m: (m.a, m.a) in m.q,
    ":a a ONLY(:p :B)": lambda m: m.to(m.p, m.a) <= m.B,
    ":a a MOST(:p)": lambda m: len(m.to(m.p, m.a)) < 2,
    ":a a LEAST(:p)": lambda m: len(m.to(m.p, m.a)) > 1,
    "[] a owl:AllDifferent ; owl:members (:b :a)": lambda m: m.a != m.b,
    "[] a owl:AllDisjointClasses ; owl:members (:B :A)": lambda m: not m.A & m.B,
    "[] a owl:AllDisjointProperties ; owl:members (:q :p)": lambda m: not m.p & m.q,
}
"""Axioms, with functions that return whether they are true in an interpretation."""


class Interpretation:
    """An assignment of classes, properties and individuals."""

    def __init__(self, everything, classes, properties, individuals):
        self.all = everything
        self.A, self.B = classes
        self.p, self.q = properties
        self.a, self.b = individuals

    def to(self, relation, x):
        return {y for one, y in relation if one == x}

    def inverse(self, relation):
        return {(y, x) for x, y in relation}

    def then(self, first, second):
        return {(x, z) for x, y in first for other, z in second if y == other}


def _subsets(items):
    return [
        {item for item, chosen in zip(items, choice, strict=True) if chosen}
        for choice in product((False, True), repeat=len(items))
    ]


@cache
def interpretations():
    found = []
    for everything in ({0}, {0, 1}):
        classes, pairs = _subsets(list(everything)), _subsets(list(product(everything, repeat=2)))
        for c, d, p, q in product(classes, classes, pairs, pairs):
            for individuals in product(everything, repeat=2):
                found.append(Interpretation(everything, (c, d), (p, q), individuals))
    return found


@cache
def where(axiom):
    """Return the interpretations in which an axiom is true, as bits."""
    true = MEANINGS[axiom]
    return sum(1 << i for i, m in enumerate(interpretations()) if true(m))
