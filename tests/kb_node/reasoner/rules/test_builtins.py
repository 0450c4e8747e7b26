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
