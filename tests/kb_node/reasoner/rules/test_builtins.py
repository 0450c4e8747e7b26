import pytest

from semmap.nodes.kb_node.reasoner.rules import builtins
from semmap.nodes.kb_node.reasoner.terms import PREFIXES


def number(text, datatype="integer"):
    return f'"{text}"^^<{PREFIXES["xsd"]}{datatype}>'


@pytest.mark.parametrize(
    ("name", "operands", "result"),
    [
        ("add", [number(1), number(2), number("0.5", "decimal")], number("3.5", "decimal")),
        ("subtract", [number(1), number(2)], number(-1)),
        ("multiply", [number(2), number("1.5", "float")], number("3", "float")),
        ("divide", [number(1), number(4)], number("0.25", "decimal")),
        ("divide", [number(1), number(3)], number("0.333333333333333333", "decimal")),
        ("divide", [number(1), number(0)], None),
        ("integerDivide", [number(-7), number(2)], number(-3)),
        ("mod", [number(-7), number(2)], number(-1)),
        ("abs", [number(-7)], number(7)),
        ("floor", [number("-1.5", "decimal")], number(-2)),
        ("ceiling", [number("1.2", "decimal")], number(2)),
        ("round", [number("2.5", "decimal")], number(3)),
        ("round", [number("2.4", "decimal")], number(2)),
        ("round", [number("-2.5", "decimal")], number(-2)),
        ("unaryMinus", [number(2)], number(-2)),
        ("add", [number(1), '"a"'], None),
        ("add", [number(1), number("0.5", "float"), number("0.25", "double")], number("1.75", "double")),
        ("unaryPlus", [number(-2)], number(-2)),
        ("multiply", [number(10**300), number(10**300)], None),
        ("multiply", [number(10**150), number(10**150)], number(10**300)),
        ("divide", [number("1", "double"), number("0", "double")], None),
    ],
)
def test_arithmetic(name, operands, result):
    found = builtins.calculate(name, operands)
    if result is None:
        assert found is None
    else:
        assert builtins.is_equal(found, result)
        assert found.partition("^^")[2] == result.partition("^^")[2]


@pytest.mark.parametrize(
    ("name", "one", "other", "holds"),
    [
        ("equal", number(1), number("1.0", "double"), True),
        ("notEqual", number(1), number(2), True),
        ("lessThan", number(1), number("1.5", "float"), True),
        ("greaterThanOrEqual", number(1), number(2), False),
        ("lessThan", '"a"', '"b"', True),
        ("lessThan", '"a"', number(1), False),
        ("greaterThan", number("2026-01-02", "date"), number("2026-01-01", "date"), True),
    ],
)
def test_comparison(name, one, other, holds):
    assert builtins.compare(name, one, other) is holds


_SMALLER, _EQUAL, _LARGER = ("1", "2"), ("2", "2.0"), ("3", "2")


@pytest.mark.parametrize(
    ("name", "smaller", "equal", "larger"),
    [
        ("equal", False, True, False),
        ("notEqual", True, False, True),
        ("lessThan", True, False, False),
        ("lessThanOrEqual", True, True, False),
        ("greaterThan", False, False, True),
        ("greaterThanOrEqual", False, True, True),
    ],
)
def test_each_comparison_of_numbers(name, smaller, equal, larger):
    found = [
        builtins.compare(name, number(one, "decimal"), number(other, "float"))
        for one, other in (_SMALLER, _EQUAL, _LARGER)
    ]
    assert found == [smaller, equal, larger]
    assert builtins.is_comparison(name)


@pytest.mark.parametrize(
    ("one", "other", "equal"),
    [
        ("<urn:a>", "<urn:a>", True),
        ("<urn:a>", "<urn:b>", False),
        ("<urn:a>", '"a"', False),
        ('"a"', '"a"@en', False),
        (number("x", "unknown"), number("x", "unknown"), True),
        (number("x", "unknown"), number("y", "unknown"), False),
        (number("NaN", "float"), number(1), False),
    ],
)
def test_equality_of_other_terms(one, other, equal):
    assert builtins.is_equal(one, other) is builtins.is_equal(other, one) is equal
    assert builtins.compare("notEqual", one, other) is not equal
    assert not builtins.compare("lessThan", one, other)


@pytest.mark.parametrize(
    ("name", "counts"),
    [
        ("equal", {2}),
        ("lessThan", {2}),
        ("add", {3, 4, 5}),
        ("multiply", {3, 4, 5}),
        ("subtract", {3}),
        ("abs", {2}),
        ("stringConcat", set()),
    ],
)
def test_the_numbers_of_arguments(name, counts):
    assert {count for count in range(6) if builtins.is_supported(name, count)} == counts
