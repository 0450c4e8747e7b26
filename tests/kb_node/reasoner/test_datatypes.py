import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.kb_node.reasoner.datatypes import (
    canonical,
    contains,
    datatypes,
    is_ill_typed,
    order_key,
    value,
)
from semmap.nodes.kb_node.reasoner.terms import iri, literal, quoted


def lit(text, datatype):
    return f'"{text}"^^{iri(datatype)}'


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (lit("1.0", "xsd:float"), lit("1.00", "xsd:float")),
        (lit("1e2", "xsd:double"), lit("100", "xsd:double")),
        (lit("16777216", "xsd:float"), lit("16777217", "xsd:float")),
        (lit("3", "xsd:byte"), lit("3.0", "xsd:decimal")),
        (lit("true", "xsd:boolean"), lit("1", "xsd:boolean")),
        (lit("a", "xsd:token"), '"a"'),
        (lit("0a", "xsd:hexBinary"), lit("0A", "xsd:hexBinary")),
        ('"chair"@en', '"chair"@EN'),
        (lit("chair@en", "rdf:PlainLiteral"), '"chair"@en'),
        (lit("2026-01-01T24:00:00Z", "xsd:dateTime"), lit("2026-01-02T01:00:00+01:00", "xsd:dateTime")),
        (lit("00:30:00Z", "xsd:time"), lit("01:30:00+01:00", "xsd:time")),
        (lit("24:00:00", "xsd:time"), lit("00:00:00.0", "xsd:time")),
        (lit("P1Y", "xsd:duration"), lit("P12M", "xsd:yearMonthDuration")),
        (lit("P1DT1H", "xsd:dayTimeDuration"), lit("PT90000S", "xsd:duration")),
        (lit("2026Z", "xsd:gYear"), lit("2026+00:00", "xsd:gYear")),
        (lit("6/4", "owl:rational"), lit("1.5", "xsd:decimal")),
        (lit("[1,  2]", "rdf:JSON"), lit(" [1,2]", "rdf:JSON")),
    ],
)
def test_spellings_of_one_value(one, other):
    assert value(one) == value(other) is not None


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (lit("1.0", "xsd:float"), lit("1.0", "xsd:double")),
        (lit("0.0", "xsd:float"), lit("-0.0", "xsd:float")),
        (lit("1", "xsd:integer"), lit("1", "xsd:float")),
        ('"chair"@en', '"chair"@de'),
        ('"chair"@en', '"chair"'),
        (lit("2026-01-01T00:00:00Z", "xsd:dateTime"), lit("2026-01-01T00:00:00", "xsd:dateTime")),
        (lit("P1M", "xsd:duration"), lit("P30D", "xsd:duration")),
        (lit("12:00:00", "xsd:time"), lit("12:00:00Z", "xsd:time")),
        (lit("2026", "xsd:gYear"), lit("2026", "xsd:integer")),
        (lit("1/3", "owl:rational"), lit("0.3333", "xsd:decimal")),
    ],
)
def test_different_values(one, other):
    assert value(one) != value(other)


@pytest.mark.parametrize(
    "term",
    [
        lit("abc", "xsd:float"),
        lit("inf", "xsd:double"),
        lit("1.5", "xsd:integer"),
        lit("128", "xsd:byte"),
        lit("-1", "xsd:nonNegativeInteger"),
        lit("yes", "xsd:boolean"),
        lit("0", "xsd:hexBinary"),
        lit("=", "xsd:base64Binary"),
        lit("a b", "xsd:NMTOKEN"),
        lit(":a", "xsd:anyURI"),
        lit("2026-02-30", "xsd:date"),
        lit("2026-01-01T00:00:00", "xsd:dateTimeStamp"),
        lit("<a>", "rdf:XMLLiteral"),
        lit("untagged", "rdf:PlainLiteral"),
        lit("noon", "xsd:time"),
        lit("25:00:00", "xsd:time"),
        lit("24:00:01", "xsd:time"),
        lit("abc", "xsd:gYear"),
        lit("--13", "xsd:gMonth"),
        lit("--02-30", "xsd:gMonthDay"),
        lit("---32", "xsd:gDay"),
        lit("P", "xsd:duration"),
        lit("P1DT", "xsd:duration"),
        lit("P1D", "xsd:yearMonthDuration"),
        lit("P1M", "xsd:dayTimeDuration"),
        lit("1/0", "owl:rational"),
        lit("{", "rdf:JSON"),
    ],
)
def test_ill_typed(term):
    assert is_ill_typed(term)
    assert value(term) is None
    assert datatypes(term) == []


def test_a_literal_of_an_unknown_datatype_is_not_ill_typed():
    assert not is_ill_typed('"x"^^<http://example.org/d>')


def test_a_value_is_in_every_datatype_that_holds_it():
    assert contains(iri("xsd:byte"), lit("42.0", "xsd:decimal"))
    assert not contains(iri("xsd:byte"), lit("300", "xsd:integer"))
    assert not contains(iri("xsd:float"), lit("1", "xsd:integer"))
    assert contains(iri("rdfs:Literal"), '"anything"')
    assert contains(iri("owl:real"), lit("1/3", "owl:rational"))
    assert not contains(iri("xsd:decimal"), lit("1/3", "owl:rational"))
    assert contains(iri("xsd:duration"), lit("P1D", "xsd:dayTimeDuration"))
    assert contains(iri("xsd:dayTimeDuration"), lit("P1D", "xsd:duration"))
    assert not contains(iri("xsd:yearMonthDuration"), lit("P1D", "xsd:duration"))


@pytest.mark.parametrize(
    "ascending",
    [
        (
            lit("-1", "xsd:integer"),
            lit("0.5", "xsd:decimal"),
            lit("2", "xsd:float"),
            lit("INF", "xsd:double"),
        ),
        (lit("23:00:00", "xsd:time"), lit("23:00:00.5", "xsd:time")),
        (lit("-0044", "xsd:gYear"), lit("2026", "xsd:gYear"), lit("12026", "xsd:gYear")),
        (lit("2026-01-31", "xsd:date"), lit("2026-02-01", "xsd:date")),
        (lit("PT1H", "xsd:duration"), lit("P1D", "xsd:duration")),
    ],
)
def test_values_are_ordered(ascending):
    keys = [order_key(term) for term in ascending]
    assert len({kind for kind, _ in keys}) == 1
    assert sorted(keys) == keys


def test_values_without_an_order():
    assert order_key('"a"') is None
    assert order_key(lit("P1MT1H", "xsd:duration")) is None
    assert order_key(lit("12:00:00", "xsd:time"))[0] != order_key(lit("12:00:00Z", "xsd:time"))[0]


def test_escapes_are_read():
    assert literal(r'"a\"b\u00e9\n"').text == 'a"b\u00e9\n'


def test_no_literal():
    with pytest.raises(ValueError, match="not a literal"):
        literal("<http://example.org/a>")


@pytest.mark.parametrize(
    ("term", "wanted"),
    [
        (lit("+01.500", "xsd:decimal"), lit("1.5", "xsd:decimal")),
        (lit("-0.05", "xsd:decimal"), lit("-0.05", "xsd:decimal")),
        (lit("3.00", "xsd:decimal"), lit("3", "xsd:integer")),
        (lit("007", "xsd:byte"), lit("7", "xsd:integer")),
        (lit("1.00", "xsd:float"), lit("1.0", "xsd:float")),
        (lit("0.10000000149", "xsd:float"), lit("0.1", "xsd:float")),
        (lit("-0", "xsd:double"), lit("-0.0", "xsd:double")),
        (lit("-1e99", "xsd:float"), lit("-INF", "xsd:float")),
        (lit("1", "xsd:boolean"), lit("true", "xsd:boolean")),
        (lit("0a", "xsd:hexBinary"), lit("0A", "xsd:hexBinary")),
        (lit("YQ ==", "xsd:base64Binary"), lit("YQ==", "xsd:base64Binary")),
        (lit("a", "xsd:token"), '"a"'),
        ('"chair"@en-GB', '"chair"@en-gb'),
        (lit("2026-01-01T01:00:00.50+01:00", "xsd:dateTime"), lit("2026-01-01T00:00:00.5Z", "xsd:dateTime")),
        (lit("2026-01-01T24:00:00", "xsd:dateTime"), lit("2026-01-02T00:00:00", "xsd:dateTime")),
        (lit("01:30:00.50+02:00", "xsd:time"), lit("23:30:00.5Z", "xsd:time")),
        (lit("P1Y2M", "xsd:yearMonthDuration"), lit("P14M", "xsd:duration")),
        (lit("-PT1M0.5S", "xsd:duration"), lit("-PT60.5S", "xsd:duration")),
        (lit("P0Y", "xsd:duration"), lit("PT0S", "xsd:duration")),
        (lit("2026+00:00", "xsd:gYear"), lit("2026Z", "xsd:gYear")),
        (lit("2/6", "owl:rational"), lit("1/3", "owl:rational")),
        (lit("<b>", "rdf:HTML"), lit("<b>", "rdf:HTML")),
        (lit("abc", "xsd:float"), lit("abc", "xsd:float")),
        ('"x"^^<http://example.org/d>', '"x"^^<http://example.org/d>'),
        ("<http://example.org/a>", "<http://example.org/a>"),
    ],
)
def test_the_canonical_spelling(term, wanted):
    assert canonical(term) == wanted
    assert canonical(wanted) == wanted


@given(
    st.one_of(
        st.floats(width=32).map(lambda x: (repr(x).replace("inf", "INF").replace("nan", "NaN"), "float")),
        st.floats().map(lambda x: (repr(x).replace("inf", "INF").replace("nan", "NaN"), "double")),
        st.decimals(allow_nan=False, allow_infinity=False).map(lambda x: (f"{x:f}", "decimal")),
        st.datetimes().map(lambda x: (x.isoformat(), "dateTime")),
        st.text(st.characters(exclude_categories=["Cs"])).map(lambda x: (x, "string")),
    )
)
def test_a_canonical_spelling_has_the_value(text_and_datatype):
    text, name = text_and_datatype
    term = quoted(text, datatype=f"http://www.w3.org/2001/XMLSchema#{name}")
    assert literal(term).text == text
    assert value(canonical(term)) == value(term) is not None
    assert canonical(canonical(term)) == canonical(term)
