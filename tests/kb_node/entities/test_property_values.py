"""Property values as text and as JSON."""

import pytest

from semmap.nodes.kb_node.entities.property_values import is_same_value, literal, retype, to_json_value
from semmap.nodes.kb_node.reasoner.data_ranges import read_common
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node import home
from tests.kb_node.home import turtle

INTEGER, DECIMAL, DOUBLE, BYTE, TIME = (
    v.iri(v.XSD + name) for name in ("integer", "decimal", "double", "byte", "dateTime")
)
ANY_TEXT = v.iri(f"{v.RDFS}Literal")


def nothing(*pattern):
    """Return the triples of an empty graph."""
    return ()


@pytest.mark.parametrize(
    ("ranges", "text", "term", "shown"),
    [
        ({v.XSD_BOOLEAN}, "Yes", v.literal("true", v.XSD_BOOLEAN), True),
        ({v.XSD_BOOLEAN}, "off", v.literal("false", v.XSD_BOOLEAN), False),
        ({v.XSD_BOOLEAN}, "0", v.literal("false", v.XSD_BOOLEAN), False),
        ({INTEGER}, " 12 ", v.literal("12", INTEGER), 12),
        ({INTEGER}, "9" * 30, v.literal("9" * 30, INTEGER), "9" * 30),
        ({v.XSD_FLOAT}, "12", v.literal("12.0", v.XSD_FLOAT), 12.0),
        ({v.XSD_FLOAT}, "3e38", v.literal("3e+38", v.XSD_FLOAT), 3e38),
        ({DOUBLE}, "1e39", v.literal("1e+39", DOUBLE), 1e39),
        ({v.XSD_FLOAT}, "-INF", v.literal("-INF", v.XSD_FLOAT), "-INF"),
        ({v.XSD_FLOAT}, "NaN", v.literal("NaN", v.XSD_FLOAT), "NaN"),
        ({DECIMAL}, "1.50", v.literal("1.50", DECIMAL), 1.5),
        ({v.XSD_STRING}, "joe@it", v.literal("joe@it"), "joe@it"),
        ({v.XSD_STRING}, "007", v.literal("007"), "007"),
        ({ANY_TEXT}, "rosso@it", v.literal("rosso", lang="it"), "rosso@it"),
        ({ANY_TEXT}, "12", v.literal("12"), "12"),
        ({TIME}, "2026-03-01T12:30:05", v.literal("2026-03-01T12:30:05", TIME), "2026-03-01T12:30:05"),
        (set(), "true", v.literal("true", v.XSD_BOOLEAN), True),
        (set(), "12", v.literal("12", INTEGER), 12),
        (set(), "1.5", v.literal("1.5", DECIMAL), 1.5),
        (set(), "a chair", v.literal("a chair"), "a chair"),
        (set(), "", v.literal(""), ""),
        (set(), '"7"^^<http://www.w3.org/2001/XMLSchema#byte>', v.literal("7", BYTE), 7),
    ],
)
def test_text_is_typed_by_the_range(ranges, text, term, shown):
    assert literal("p", read_common(ranges, nothing), text) == term
    assert to_json_value(term) == shown
    assert type(to_json_value(term)) is type(shown)


@pytest.mark.parametrize(
    ("datatype", "text", "said"),
    [
        (v.XSD_BOOLEAN, "maybe", "p takes true or false, not 'maybe'"),
        (v.XSD_FLOAT, "heavy", "p takes a number, not 'heavy'"),
        (DOUBLE, "fast", "p takes a number, not 'fast'"),
        (v.XSD_FLOAT, "inf", "p takes a number, not 'inf'"),
        (v.XSD_FLOAT, "1e39", "p takes a number, and 1e39 is too large for one"),
        (DOUBLE, "-1e400", "p takes a number, and -1e400 is too large for one"),
        (INTEGER, "1.5", "p takes a whole number, not '1.5'"),
        (BYTE, "300", "p takes xsd:byte, not '300'"),
        (TIME, "noon", "p takes xsd:dateTime, not 'noon'"),
        (BYTE, '"x"', """p takes a literal of xsd:byte, not "x\""""),
    ],
)
def test_a_value_outside_the_range_is_rejected(datatype, text, said):
    with pytest.raises(errors.BadRequest) as caught:
        literal("p", read_common([datatype], nothing), text)
    assert caught.value.text == said


DEFINED = turtle(
    ":percent a rdfs:Datatype ; owl:equivalentClass [ owl:onDatatype xsd:integer ; owl:withRestrictions"
    " ( [ xsd:minInclusive 0 ] [ xsd:maxInclusive 100 ] ) ] ."
    " :alias a rdfs:Datatype ; owl:equivalentClass xsd:float ."
    " :level a rdfs:Datatype ; owl:oneOf ( 'low' 2 ) . :vector a rdfs:Datatype ."
    " :number a rdfs:Datatype ; owl:unionOf ( xsd:integer xsd:float ) ."
    " :noByte a rdfs:Datatype ; owl:datatypeComplementOf xsd:byte ."
)


def range_of(name):
    """Return a datatype of the graph above, or one of XML Schema or RDF."""
    term = v.iri(v.XSD + name[4:]) if name.startswith("xsd:") else v.entity_iri(name)
    term = v.RDF_LANG_STRING if name == "langString" else term
    return read_common([term], Facts(dict.fromkeys(DEFINED)).match)


@pytest.mark.parametrize(
    ("name", "text", "lexical", "datatype"),
    [
        ("xsd:time", "12:00:00", "12:00:00", "time"),
        ("xsd:gYear", "2026", "2026", "gYear"),
        ("xsd:duration", "P1D", "P1D", "duration"),
        ("percent", "95", "95", "integer"),
        ("alias", "3", "3.0", "float"),
        ("level", "low", "low", "string"),
        ("level", "2", "2", "integer"),
        ("number", "3", "3", "integer"),
        ("number", "2.5", "2.5", "float"),
        ("noByte", "300", "300", "integer"),
    ],
)
def test_the_datatype_is_one_of_the_range(name, text, lexical, datatype):
    assert literal("p", range_of(name), text) == v.literal(lexical, v.iri(v.XSD + datatype))


def test_a_datatype_without_a_definition_and_a_language_are_kept():
    assert literal("p", range_of("vector"), "1 2 3") == v.literal("1 2 3", v.entity_iri("vector"))
    assert literal("p", range_of("langString"), "Regal@de") == v.literal("Regal", lang="de")


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("xsd:time", "noon", "p takes xsd:time, not 'noon'"),
        ("percent", "-5", "p takes a whole number from 0 to 100, not '-5'"),
        (
            "percent",
            '"300"^^<http://www.w3.org/2001/XMLSchema#int>',
            'p takes an integer from 0 to 100, not "300"^^',
        ),
        ("level", "mid", """p takes one of "low", 2, not 'mid'"""),
        ("number", "many", "p takes an integer or float, not 'many'"),
        ("noByte", "3", "p takes anything but byte, not '3'"),
        ("langString", "Regal", "p takes a text with its language, such as Tasse@de, not 'Regal'"),
    ],
)
def test_a_value_outside_a_defined_range_is_rejected(name, text, said):
    with pytest.raises(errors.BadRequest) as caught:
        literal("p", range_of(name), text)
    assert caught.value.text.startswith(said)


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("percent", v.literal("95"), v.literal("95", INTEGER)),
        ("percent", v.literal("300", INTEGER), v.literal("300", INTEGER)),
        ("alias", v.literal("1.5", DECIMAL), v.literal("1.5", v.XSD_FLOAT)),
        ("xsd:string", v.literal("5", INTEGER), v.literal("5")),
        ("xsd:integer", v.literal("5", lang="en"), v.literal("5", lang="en")),
        ("langString", v.literal("a"), v.literal("a")),
    ],
)
def test_a_literal_outside_a_range_is_retyped_if_its_text_is_a_value(name, before, after):
    data_range = range_of(name)
    assert data_range is not None
    assert retype(data_range, before) == after


def test_values_are_compared_by_value():
    assert is_same_value(v.literal("01", INTEGER), v.literal("1.0", DECIMAL))
    assert not is_same_value(v.literal("1", INTEGER), v.literal("1"))
    assert not is_same_value(v.literal("x", INTEGER), v.literal("y", INTEGER))
    assert is_same_value(v.dm("a"), v.dm("a"))
    assert not is_same_value(v.dm("a"), v.literal("a"))
    assert to_json_value(v.dm("color_red")) == "color_red"
    assert to_json_value('"x"^^<http://www.w3.org/2001/XMLSchema#integer>') == "x"


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("mass", "-3", "mass takes a number from 0 to 1e9, not '-3'"),
        ("mass", "NaN", "mass takes a number from 0 to 1e9, not 'NaN'"),
        ("mass", "INF", "mass takes a number from 0 to 1e9, not 'INF'"),
        ("openness", "1.5", "openness takes a number from 0 to 1, not '1.5'"),
        ("openness", "-0.5", "openness takes a number from 0 to 1, not '-0.5'"),
    ],
)
def test_an_impossible_quantity_of_the_household_is_rejected(name, text, said):
    match = Facts(dict.fromkeys(home.household())).match
    data_range = read_common([o for _, _, o in match(v.dm(name), v.RDFS_RANGE, None)], match)
    assert literal(name, data_range, "0.5") == v.literal("0.5", v.XSD_FLOAT)
    with pytest.raises(errors.BadRequest) as caught:
        literal(name, data_range, text)
    assert caught.value.text == said
