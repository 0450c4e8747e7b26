"""Property values as text and as JSON."""

import pytest

from semmap.nodes.kb_node.entities.property_values import is_same_value, literal, to_json_value
from semmap.ontology import vocabulary as v
from semmap.schemas import errors

INTEGER, DECIMAL, DOUBLE, BYTE, TIME = (
    v.iri(v.XSD + name) for name in ("integer", "decimal", "double", "byte", "dateTime")
)
ANY_TEXT = v.iri(f"{v.RDFS}Literal")


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
    assert literal("p", frozenset(ranges), text) == term
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
        literal("p", frozenset((datatype,)), text)
    assert caught.value.text == said


def test_values_are_compared_by_value():
    assert is_same_value(v.literal("01", INTEGER), v.literal("1.0", DECIMAL))
    assert not is_same_value(v.literal("1", INTEGER), v.literal("1"))
    assert not is_same_value(v.literal("x", INTEGER), v.literal("y", INTEGER))
    assert is_same_value(v.dm("a"), v.dm("a"))
    assert not is_same_value(v.dm("a"), v.literal("a"))
    assert to_json_value(v.dm("color_red")) == "color_red"
    assert to_json_value('"x"^^<http://www.w3.org/2001/XMLSchema#integer>') == "x"
