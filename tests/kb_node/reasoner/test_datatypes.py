import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.kb_node.reasoner.datatypes import (
    canonical,
    contains,
    datatypes,
    distinguishes_strings,
    excludes,
    includes,
    includes_common,
    is_datatype,
    is_ill_typed,
    known,
    length,
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


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("3", "xsd:integer"),
        ("3.5", "xsd:decimal"),
        ("3.5e1", "xsd:double"),
        ("1/2", "owl:rational"),
        ("2026-01-02", "xsd:date"),
        ("2026-01-02T03:04:05", "xsd:dateTime"),
        ("03:04:05", "xsd:time"),
        ("2026", "xsd:gYear"),
        ("2026-01", "xsd:gYearMonth"),
        ("--01-12", "xsd:gMonthDay"),
        ("---12", "xsd:gDay"),
        ("P1DT2H", "xsd:duration"),
    ],
)
def test_digits_of_other_scripts_are_no_digits(text, name):
    other = text.translate({ord("0") + digit: chr(0x0660 + digit) for digit in range(10)})
    assert not is_ill_typed(lit(text, name))
    assert is_ill_typed(lit(other, name))


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
        *(
            tuple(lit(f"{year}{rest}", f"xsd:{name}") for year in ("-0400", "-0044", "0000", "2026", "12026"))
            for name, rest in (
                ("gYear", ""),
                ("gYearMonth", "-03"),
                ("date", "-03-15"),
                ("dateTime", "-03-15T12:00:00"),
                ("dateTimeStamp", "-03-15T12:00:00Z"),
            )
        ),
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


BOUNDS = {
    "long": (-9223372036854775808, 9223372036854775807),
    "int": (-2147483648, 2147483647),
    "short": (-32768, 32767),
    "byte": (-128, 127),
    "unsignedLong": (0, 18446744073709551615),
    "unsignedInt": (0, 4294967295),
    "unsignedShort": (0, 65535),
    "unsignedByte": (0, 255),
    "nonNegativeInteger": (0, None),
    "positiveInteger": (1, None),
    "nonPositiveInteger": (None, 0),
    "negativeInteger": (None, -1),
}


@pytest.mark.parametrize(("name", "bounds"), BOUNDS.items(), ids=BOUNDS)
def test_an_integer_type_has_its_bounds(name, bounds):
    for bound, beyond in zip(bounds, (-1, 1), strict=True):
        within = 10**30 * beyond if bound is None else bound
        assert value(lit(str(within), f"xsd:{name}")) == value(lit(str(within), "xsd:integer"))
        assert contains(iri(f"xsd:{name}"), lit(str(within), "xsd:integer"))
        if bound is not None:
            assert is_ill_typed(lit(str(bound + beyond), f"xsd:{name}"))
            assert not contains(iri(f"xsd:{name}"), lit(str(bound + beyond), "xsd:integer"))


@pytest.mark.parametrize(
    ("wide", "narrow", "is_wider"),
    [
        ("xsd:integer", "xsd:byte", True),
        ("xsd:byte", "xsd:integer", False),
        ("xsd:long", "xsd:unsignedInt", True),
        ("xsd:long", "xsd:unsignedLong", False),
        ("xsd:nonNegativeInteger", "xsd:positiveInteger", True),
        ("xsd:positiveInteger", "xsd:nonNegativeInteger", False),
        ("xsd:nonPositiveInteger", "xsd:negativeInteger", True),
        ("xsd:decimal", "xsd:int", True),
        ("xsd:decimal", "owl:rational", False),
        ("owl:real", "xsd:decimal", True),
        ("owl:rational", "owl:real", True),
        ("owl:real", "xsd:float", False),
        ("xsd:string", "xsd:token", True),
        ("xsd:token", "xsd:string", False),
        ("xsd:Name", "xsd:NCName", True),
        ("rdf:PlainLiteral", "xsd:language", True),
        ("rdf:PlainLiteral", "rdf:langString", True),
        ("rdf:PlainLiteral", "xsd:integer", False),
        ("xsd:duration", "xsd:dayTimeDuration", True),
        ("xsd:dayTimeDuration", "xsd:duration", False),
        ("xsd:dateTime", "xsd:dateTimeStamp", True),
        ("xsd:dateTimeStamp", "xsd:dateTime", False),
        ("rdfs:Literal", "xsd:float", True),
        ("xsd:float", "xsd:float", True),
        ("xsd:float", "xsd:double", False),
    ],
)
def test_which_datatypes_are_part_of_others(wide, narrow, is_wider):
    assert includes(iri(wide), iri(narrow)) == is_wider
    assert includes_common(iri(wide), [iri(narrow)]) == is_wider


@pytest.mark.parametrize(
    ("wide", "several", "is_wider"),
    [
        ("xsd:byte", ("xsd:nonNegativeInteger", "xsd:byte"), True),
        ("xsd:unsignedByte", ("xsd:nonNegativeInteger", "xsd:byte"), True),
        ("xsd:unsignedByte", ("xsd:nonPositiveInteger", "xsd:unsignedShort"), True),
        ("xsd:byte", ("xsd:unsignedByte", "xsd:short"), False),
        ("xsd:positiveInteger", ("xsd:nonNegativeInteger", "xsd:byte"), False),
        ("xsd:token", ("xsd:string", "xsd:byte"), False),
        ("xsd:byte", ("xsd:string", "xsd:token"), False),
    ],
)
def test_the_common_values_of_datatypes(wide, several, is_wider):
    assert includes_common(iri(wide), [iri(name) for name in several]) == is_wider


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("P1Y2M", "P14M"),
        ("-P1Y2M", "-P14M"),
        ("P1DT1H1M1.5S", "PT90061.5S"),
        ("-P2DT3H", "-PT183600S"),
        ("P0Y", "PT0S"),
        ("P2Y3DT4M", "P24MT259440S"),
    ],
)
def test_a_duration_is_months_and_seconds(text, same):
    assert canonical(lit(text, "xsd:duration")) == lit(same, "xsd:duration")


@pytest.mark.parametrize(
    ("kind", "text", "same"),
    [
        ("dateTime", "2024-02-29T23:30:00-01:30", "2024-03-01T01:00:00Z"),
        ("dateTime", "2026-01-01T00:10:00+00:20", "2025-12-31T23:50:00Z"),
        ("dateTime", "2026-01-01T12:00:00.250", "2026-01-01T12:00:00.25"),
        ("dateTime", "-0001-12-31T23:30:00-01:00", "0000-01-01T00:30:00Z"),
        ("dateTime", "9999-12-31T24:00:00", "10000-01-01T00:00:00"),
        ("dateTime", "123456-07-08T09:10:11", "123456-07-08T09:10:11"),
        ("date", "-0044-03-15", "-0044-03-15"),
        ("date", "0000-02-29-00:00", "0000-02-29Z"),
        ("date", "2026-01-01+00:00", "2026-01-01Z"),
        ("gYear", "-12026", "-12026"),
        ("gYearMonth", "12026-05+00:00", "12026-05Z"),
        ("time", "00:10:00+00:20", "23:50:00Z"),
        ("time", "23:50:01.5-00:20", "00:10:01.5Z"),
        ("time", "01:02:03", "01:02:03"),
        ("gYear", "2026-00:00", "2026Z"),
        ("gYear", "2026+02:00", "2026+02:00"),
        ("boolean", "0", "false"),
        ("hexBinary", "0a", "0A"),
        ("base64Binary", "YQ= =", "YQ=="),
        ("float", "0.1", "0.1"),
        ("float", "1e39", "INF"),
        ("float", "-1e39", "-INF"),
        ("double", "NaN", "NaN"),
        ("double", "0.30000000000000004", "0.30000000000000004"),
    ],
)
def test_the_spelling_of_times_binary_data_and_floats(kind, text, same):
    assert canonical(lit(text, f"xsd:{kind}")) == lit(same, f"xsd:{kind}")


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("dateTime", "2026-01-01T24:00:01Z"),
        ("dateTime", "2026-01-01T24:01:00Z"),
        ("dateTime", "2026-13-01T00:00:00Z"),
        ("dateTime", "2026-01-01T00:00:00+14:01"),
        ("time", "23:60:00"),
        ("time", "23:59:60"),
        ("time", "24:00:00.1"),
        ("date", "2026-02-29"),
        ("date", "-0001-02-29"),
        ("date", "012026-01-01"),
        ("dateTime", "12026-02-30T00:00:00"),
        ("gMonthDay", "--04-31"),
        ("gYear", "026"),
        ("base64Binary", "YQ_="),
    ],
)
def test_times_and_binary_data_outside_their_limits(kind, text):
    assert is_ill_typed(lit(text, f"xsd:{kind}"))


@pytest.mark.parametrize(
    ("number", "same"),
    [
        ("1.50", '"1.5"^^' + iri("xsd:decimal")),
        ("-0.05", '"-0.05"^^' + iri("xsd:decimal")),
        ("100.0", '"100"^^' + iri("xsd:integer")),
        ("0.125", '"0.125"^^' + iri("xsd:decimal")),
    ],
)
def test_the_spelling_of_decimals(number, same):
    assert canonical(lit(number, "xsd:decimal")) == same
    assert canonical(lit("2/6", "owl:rational")) == '"1/3"^^' + iri("owl:rational")


@pytest.mark.parametrize(
    ("term", "count"),
    [
        ('"abc"', 3),
        ('"abc"@en', 3),
        (lit("0A0B", "xsd:hexBinary"), 2),
        (lit("YWI=", "xsd:base64Binary"), 2),
        (lit("urn:a", "xsd:anyURI"), 5),
        (lit("12", "xsd:integer"), None),
        (lit("x", "xsd:integer"), None),
    ],
)
def test_texts_and_binary_data_have_a_length(term, count):
    assert length(term) == count


def test_which_datatypes_are_known_and_distinguish_texts():
    assert is_datatype(iri("xsd:gDay"))
    assert not is_datatype(iri("xsd:unknown"))
    assert known() >= {iri("xsd:byte"), iri("xsd:token"), iri("rdf:langString"), iri("rdfs:Literal")}
    assert distinguishes_strings(iri("xsd:token"))
    assert not distinguishes_strings(iri("xsd:string"))
    assert not distinguishes_strings(iri("xsd:integer"))


def test_a_literal_is_excluded_only_if_its_datatype_is_known():
    assert excludes(iri("xsd:byte"), lit("300", "xsd:integer"))
    assert excludes(iri("xsd:byte"), lit("x", "xsd:integer"))
    assert not excludes(iri("xsd:byte"), lit("3", "xsd:integer"))
    assert not excludes(iri("xsd:byte"), '"3"^^<http://example.org/d>')


@pytest.mark.parametrize(
    ("term", "order"),
    [
        (lit("1.5", "xsd:double"), ("number", 1.5)),
        (lit("P1Y", "xsd:duration"), ("months", 12)),
        (lit("PT1M", "xsd:duration"), ("seconds", 60)),
        (lit("P1YT1S", "xsd:duration"), None),
        (lit("-0044", "xsd:gYear"), ("gYear ", (-44,))),
        (lit("--03Z", "xsd:gMonth"), ("gMonth Z", "--03")),
        (lit("true", "xsd:boolean"), None),
    ],
)
def test_what_a_value_is_ordered_by(term, order):
    assert order_key(term) == order


def test_the_texts_of_string_types():
    assert {d for d in map(str, datatypes('"en"')) if "XMLSchema" in d} == {
        iri(f"xsd:{name}")
        for name in ("string", "normalizedString", "token", "language", "NMTOKEN", "Name", "NCName")
    }
    assert {d for d in datatypes('"a b"') if "XMLSchema" in d} == {
        iri(f"xsd:{name}") for name in ("string", "normalizedString", "token")
    }
    assert {d for d in datatypes('"1:a"') if "XMLSchema" in d} == {
        iri(f"xsd:{name}") for name in ("string", "normalizedString", "token", "NMTOKEN")
    }
    assert datatypes("<urn:a>") == []
