"""The built-ins of SWRL that compare values and calculate: `swrlb:lessThan`, `swrlb:multiply` ..."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, Final

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.explanations import Term
from semmap.nodes.kb_node.reasoner.terms import PREFIXES, is_literal, literal, quoted

NAMESPACE: Final = "<http://www.w3.org/2003/11/swrlb#"
_PLACES: Final = 10**18
"""Quotients that are not decimal numbers are rounded to 18 places."""
_DIGITS: Final = 400
"""Results with more digits are not calculated."""
_ORDERS: Final[dict[str, Callable[[Any, Any], bool]]] = {
    "lessThan": operator.lt,
    "lessThanOrEqual": operator.le,
    "greaterThan": operator.gt,
    "greaterThanOrEqual": operator.ge,
}
SIGNS: Final = {
    "equal": "=",
    "notEqual": "≠",
    "lessThan": "<",
    "lessThanOrEqual": "≤",
    "greaterThan": ">",
    "greaterThanOrEqual": "≥",
    "add": "+",
    "subtract": "-",
    "multiply": "×",
    "divide": "/",
}
"""The signs of built-ins in sentences."""


def _divide(one: Any, other: Any) -> Any:
    quotient = one / other
    return round(quotient * _PLACES) / Fraction(_PLACES) if isinstance(quotient, Fraction) else quotient


def _quotient(one: Any, other: Any) -> Any:
    return Fraction(math.trunc(one / other))


def _remainder(one: Any, other: Any) -> Any:
    return one - other * math.trunc(one / other)


_ARITHMETIC: Final[dict[str, tuple[int, Callable[..., Any]]]] = {
    "subtract": (2, operator.sub),
    "divide": (2, _divide),
    "integerDivide": (2, _quotient),
    "mod": (2, _remainder),
    "abs": (1, abs),
    "unaryPlus": (1, operator.pos),
    "unaryMinus": (1, operator.neg),
    "floor": (1, math.floor),
    "ceiling": (1, math.ceil),
    "round": (1, lambda number: math.floor(number + Fraction(1, 2))),
}
"""Arithmetic built-ins, with the number of their operands."""
_OF_MANY: Final[dict[str, Callable[[Sequence[Any]], Any]]] = {"add": sum, "multiply": math.prod}


def is_comparison(name: str) -> bool:
    """Return whether a built-in compares two values."""
    return name in ("equal", "notEqual") or name in _ORDERS


def is_supported(name: str, count: int) -> bool:
    """Return whether a built-in is supported with a number of arguments."""
    if is_comparison(name):
        return count == 2
    return (name in _OF_MANY and count > 2) or (name in _ARITHMETIC and count == 1 + _ARITHMETIC[name][0])


def compare(name: str, one: Term, other: Term) -> bool:
    """Return whether a comparison holds. It does not hold for values without a common order."""
    if name == "equal":
        return is_equal(one, other)
    if name == "notEqual":
        return not is_equal(one, other)
    first, second = _order(one), _order(other)
    if first is None or second is None or first[0] != second[0]:
        return False
    return bool(_ORDERS[name](first[1], second[1]))


def is_equal(one: Term, other: Term) -> bool:
    """Return whether two terms have the same value. Numbers are compared across datatypes."""
    if one == other:
        return True
    if not (is_literal(one) and is_literal(other)):
        return False
    first, second = datatypes.value(one), datatypes.value(other)
    if first is None or second is None:
        return False
    numbers = _number(one), _number(other)
    return first == second or (None not in numbers and numbers[0] == numbers[1])


def calculate(name: str, operands: Sequence[Term]) -> Term | None:
    """Return the result of an arithmetic built-in as a literal; None if there is none."""
    numbers = [_number(operand) for operand in operands]
    if any(number is None for number in numbers):
        return None
    kinds = {(datatypes.value(operand) or ("",))[0] for operand in operands}
    try:
        result: Any = _ARITHMETIC[name][1](*numbers) if name in _ARITHMETIC else _OF_MANY[name](numbers)
        for kind in ("double", "float"):
            if kind in kinds:
                return datatypes.canonical(quoted(repr(float(result)), datatype=PREFIXES["xsd"] + kind))
        number = Fraction(result)
        if max(abs(number.numerator), number.denominator) >= 10**_DIGITS:
            return None
        text = f"{number.numerator}/{number.denominator}"
        return datatypes.canonical(quoted(text, datatype=PREFIXES["owl"] + "rational"))
    except (ArithmeticError, ValueError):
        return None


def _number(term: Term) -> Any:
    order = datatypes.order_key(term) if is_literal(term) else None
    return order[1] if order is not None and order[0] == "number" else None


def _order(term: Term) -> tuple[str, Any] | None:
    if not is_literal(term):
        return None
    value = datatypes.value(term)
    if value is not None and value[0] == "text":
        return ("text", literal(term).text)
    return datatypes.order_key(term)
