"""Data ranges decide membership, contradict, and are named in explanations."""

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.data_ranges import read_range
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.terms import iri
from tests.kb_node.reasoner import proofs
from tests.kb_node.reasoner.graphs import triple, triples


def restricted(base, *facets):
    """Return a data range with facets in Turtle."""
    listed = " ".join(f"[ {facet} ]" for facet in facets)
    return f"[ a rdfs:Datatype ; owl:onDatatype {base} ; owl:withRestrictions ( {listed} ) ]"


PERCENT = restricted("xsd:integer", "xsd:minInclusive 0", "xsd:maxInclusive 100")
NAMED = f" . :percent a rdfs:Datatype ; owl:equivalentClass {PERCENT}"


def one_of(*members):
    """Return a data range that lists its members in Turtle."""
    return f"[ a rdfs:Datatype ; owl:oneOf ( {' '.join(map(str, members))} ) ]"


LEVEL = one_of("'low'", "'high'", 3)
RANGES = {
    PERCENT: (("0", "100", "'7'^^xsd:byte", "5.0"), ("-1", "101", "5.5", "'5'", "'5'^^xsd:float")),
    ":percent" + NAMED: (("100",), ("101", "'x'")),
    restricted(":percent", "xsd:minExclusive 50") + NAMED: (("51", "100"), ("50", "101")),
    restricted("xsd:float", "xsd:minInclusive 0"): (
        ("'0.5'^^xsd:float", "'INF'^^xsd:float"),
        ("'-1'^^xsd:float", "1"),
    ),
    restricted("xsd:date", "xsd:maxExclusive '2026-01-01'^^xsd:date"): (
        ("'2025-12-31'^^xsd:date", "'2030-01-01Z'^^xsd:date"),  # a date with a zone is not comparable
        ("'2026-01-01'^^xsd:date",),
    ),
    restricted("xsd:string", "xsd:pattern '[A-Z]{2}-\\\\d+'"): (
        ("'AB-12'",),
        ("'AB-'", "'xAB-12'", "'AB-12'@en"),
    ),
    restricted("xsd:string", "xsd:pattern '^a$'"): (("'^a$'",), ("'a'",)),
    restricted("xsd:string", "xsd:minLength 2", "xsd:maxLength 3"): (("'ab'", "'abc'"), ("'a'", "'abcd'")),
    restricted("xsd:hexBinary", "xsd:length 2"): (("'0A0B'^^xsd:hexBinary",), ("'0A'^^xsd:hexBinary",)),
    restricted("rdf:PlainLiteral", "rdf:langRange 'de'"): (("'a'@de", "'a'@de-AT"), ("'a'@den", "'a'")),
    LEVEL: (("'low'", "'3'^^xsd:byte"), ("'mid'", "4")),
    one_of(0, 1, 2): (("1", "'2.0'^^xsd:decimal"), ("3", "'1'", "0.5")),  # the rules have a 0 and a 1, too
    one_of(2, 3) + " . :Twofold rdfs:subClassOf [ owl:onProperty :e ; owl:hasValue 2.0 ]": (("2",), ("4",)),
    "[ a rdfs:Datatype ; owl:unionOf ( xsd:integer xsd:string ) ]": (("1", "'a'"), ("1.5",)),
    f"[ a rdfs:Datatype ; owl:unionOf ( {PERCENT} {LEVEL} ) ]": (("1", "'low'"), ("-1", "'mid'")),
    "[ a rdfs:Datatype ; owl:intersectionOf ( xsd:integer"
    " [ a rdfs:Datatype ; owl:datatypeComplementOf xsd:byte ] ) ]": (
        ("300",),
        ("1", "'a'"),
    ),
    "[ a rdfs:Datatype ; owl:datatypeComplementOf xsd:integer ]": (("'a'", "1.5"), ("1",)),
    "xsd:time": (("'12:00:00'^^xsd:time",), ("'12:00:00'", "'noon'^^xsd:time")),
    "owl:real": (("1", "'1/3'^^owl:rational"), ("'1'^^xsd:float", "'a'")),
    ":unknown . :unknown a rdfs:Datatype": (("'1 2 3'^^:unknown", "1", "'a'"), ()),
    restricted(":unknown", "xsd:minLength 2") + " . :unknown a rdfs:Datatype": (("'a'^^:unknown", "1"), ()),
    restricted("xsd:string", "xsd:pattern '[a-c]'"): (("'a'", "'x'^^:unknown"), ("'x'",)),
    restricted("xsd:string", "xsd:pattern '[a-z-[aeiou]]'"): (("'a'",), ("1",)),  # Python lacks subtraction
}


@pytest.mark.parametrize("data_range", RANGES)
def test_a_range_accepts_its_values_and_contradicts_others(data_range):
    inside, outside = RANGES[data_range]
    reasoner = Reasoner(triples(f":d rdfs:range {data_range} ."))
    assert reasoner.is_compiled
    assert not reasoner.outside_rl
    for value in inside:
        fact = triples(f":x :d {value} .")
        reasoner.apply(insert=fact)
        reasoner.apply(delete=fact)
    for value in outside:
        fact = triples(f":x :d {value} .")
        with pytest.raises(Inconsistent) as refused:
            reasoner.apply(insert=fact)
        proofs.check(refused.value.explanation, [*reasoner.asserted(), *fact])


def test_facets_decide_membership():
    restriction = (
        f"[ owl:onProperty :d ; owl:someValuesFrom {restricted('xsd:integer', 'xsd:minInclusive 90')} ]"
    )
    reasoner = Reasoner(triples(f":Full owl:equivalentClass {restriction} ."))
    reasoner.apply(insert=triples(":x :d 95 . :y :d 85 . :z a :Full ."))
    assert reasoner.holds(triple(":x a :Full"))
    assert not reasoner.holds(triple(":y a :Full"))
    explanation = reasoner.explain(triple(":x a :Full"))
    proofs.check(explanation, list(reasoner.asserted()))
    assert explanation.text == (
        "x is a Full, because it has d 95 (asserted), and a Full is by definition something that has a d that"
        " is an integer of at least 90."
    )
    reasoner.apply(delete=triples(":x :d 95 ."))
    assert not reasoner.holds(triple(":x a :Full"))


@pytest.mark.parametrize(
    ("data_range", "value", "said"),
    [
        (PERCENT, "300", "300 (integer) is not a value of integer from 0 to 100"),
        (LEVEL, "'mid'", '"mid" (string) is not one of "low", "high", 3'),
        (one_of(1, 2, 3, 4, 5), "9", "9 (integer) is not one of 1, 2, 3, 4, 5:"),
        (one_of(1, 2, 3, 4, 5, 6, 7), "9", "9 (integer) is not one of 1, 2, 3, 4, 5 and 2 more:"),
        (
            restricted("xsd:string", "xsd:maxLength 2"),
            "'abc'",
            '"abc" is not a value of string of at most 2 characters',
        ),
        (
            restricted("xsd:string", "xsd:minLength 3", "xsd:maxLength 8"),
            "'ab'",
            '"ab" is not a value of string of 3 to 8 characters',
        ),
        (
            restricted("xsd:integer", "xsd:minInclusive 0", "xsd:maxExclusive 9"),
            "9",
            "9 (integer) is not a value of integer of at least 0 and below 9",
        ),
        (
            "[ a rdfs:Datatype ; owl:datatypeComplementOf xsd:byte ]",
            "1",
            "1 (integer) is not a value of anything but byte",
        ),
    ],
)
def test_a_contradiction_names_the_range(data_range, value, said):
    reasoner = Reasoner(triples(f":d rdfs:range {data_range} ."))
    with pytest.raises(Inconsistent, match="is not") as refused:
        reasoner.apply(insert=triples(f":x :d {value} ."))
    assert said.replace(" (string)", "") in str(refused.value).replace(" (string)", "")


def test_a_value_that_contradicts_the_schema_alone_is_explained():
    same = f":n owl:equivalentClass {restricted('xsd:string', 'xsd:maxLength 1')} , xsd:string ."
    reasoner = Reasoner(triples(same))
    fact = triples(":x :d 'abc' .")
    with pytest.raises(Inconsistent) as refused:
        reasoner.apply(insert=fact)
    proofs.check(refused.value.explanation, [*reasoner.asserted(), *fact])


def test_disjoint_unions_work_both_ways():
    reasoner = Reasoner(triples(":Furniture owl:disjointUnionOf ( :Shelf :Table ) ."))
    reasoner.apply(insert=triples(":x a :Shelf ."))
    assert reasoner.holds(triple(":x a :Furniture"))
    with pytest.raises(Inconsistent) as refused:
        reasoner.apply(insert=triples(":x a :Table ."))
    assert str(refused.value) == (
        "x cannot be both a Shelf and a Table: it is a Shelf (asserted), it is a Table (asserted), and"
        " a Furniture is by definition something that is either a Shelf or a Table."
    )


@pytest.mark.parametrize(
    "graph",
    [
        ":r owl:onDatatype xsd:integer ; owl:withRestrictions ( [ a :Facet ] )",
        ":r owl:onDatatype xsd:integer ; owl:withRestrictions [ rdf:first [ xsd:minInclusive 1 ] ]",
        ":r owl:oneOf ( 1 :a )",
        ":r owl:unionOf ( xsd:integer :Class ) . :Class a owl:Class",
        ":r owl:datatypeComplementOf :r",
        ":r owl:equivalentClass :s . :s owl:equivalentClass :r",
    ],
)
def test_incomplete_and_cyclic_definitions_are_no_ranges(graph):
    facts = Facts(dict.fromkeys(triples(graph + " .")))
    assert read_range(triple(":r a :r")[0], facts.match) is None
    assert read_range(iri("xsd:float"), facts.match) is not None
