"""The parts of a module that are not mutated, because no test of behaviour can detect it."""

from __future__ import annotations

import ast
from collections.abc import Iterator

Position = tuple[int, int]
"""A line, from 1, and a column, from 0 and in characters."""
Span = tuple[Position, Position]
"""From a position up to another one."""

_LOGGERS = {"log", "_log", "logging", "warnings"}
_IDLE_DECORATORS = {"cache", "lru_cache", "override", "final", "overload", "runtime_checkable"}
"""Without one of these, a function does the same: at most, it takes longer."""


def find_untouched(code: str) -> list[Span]:
    """Return the spans that are left as they are.

    These are annotations, format strings, logging, assertions, type aliases, idle decorators, whether classes
    are frozen or have slots, and blocks for type checkers or for a module that is run as a program.
    """
    lines = code.splitlines()
    module = ast.parse(code)
    aliases = [node for node in module.body if isinstance(node, ast.Assign) and _is_union(node.value)]
    found = [*aliases, *(part for node in ast.walk(module) for part in _untouched(node))]
    spans = [(_start(node, lines), _end(node, lines)) for node in found]
    return spans + [((line, 0), (line + 1, 0)) for line in _idle_lines(module)]


def is_within(position: Position, spans: list[Span]) -> bool:
    """Return whether `position` is in one of the spans."""
    return any(start <= position < end for start, end in spans)


def _untouched(node: ast.AST) -> Iterator[ast.stmt | ast.expr]:
    match node:
        case ast.JoinedStr() | ast.Assert() | ast.BinOp(op=ast.BitOr(), right=ast.Constant(value=None)):
            yield node
        case ast.Call() if _first_name(node.func) in _LOGGERS:
            yield node
        case ast.keyword(arg="frozen" | "slots", value=ast.Constant() as value):  # mypy checks them
            yield value
        case ast.If() if _is_guard(node):
            yield node.test
            yield from node.body
        case ast.AnnAssign(annotation=annotation) | ast.arg(annotation=ast.expr() as annotation):
            yield annotation
        case ast.FunctionDef(returns=ast.expr() as returns):
            yield returns
        case ast.AsyncFunctionDef(returns=ast.expr() as returns):
            yield returns


def _is_union(value: ast.expr) -> bool:
    """Whether this can be `A | B`, of types."""
    match value:
        case ast.BinOp(op=ast.BitOr()):
            return _is_type(value.left) and _is_type(value.right)
    return False


def _is_type(value: ast.expr) -> bool:
    match value:
        case ast.Name() | ast.Attribute() | ast.Subscript() | ast.Constant(value=None):
            return True
    return _is_union(value)


def _is_guard(node: ast.If) -> bool:
    """Whether its block is for type checkers only, or for a module that is run as a program."""
    text = ast.unparse(node.test)
    return "TYPE_CHECKING" in text or text.startswith("__name__")


def _first_name(node: ast.expr) -> str:
    """The first name of `a.b.c`."""
    while isinstance(node, ast.Attribute):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""


def _idle_lines(module: ast.Module) -> Iterator[int]:
    """The lines of decorators without which nothing is done otherwise."""
    for node in ast.walk(module):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            yield from (decorator.lineno for decorator in node.decorator_list if _is_idle(decorator))


def _is_idle(decorator: ast.expr) -> bool:
    called = decorator.func if isinstance(decorator, ast.Call) else decorator
    return ast.unparse(called).rpartition(".")[2] in _IDLE_DECORATORS


def _start(node: ast.stmt | ast.expr, lines: list[str]) -> Position:
    return node.lineno, _column(lines[node.lineno - 1], node.col_offset)


def _end(node: ast.stmt | ast.expr, lines: list[str]) -> Position:
    line = node.end_lineno or node.lineno
    return line, _column(lines[line - 1], node.end_col_offset or 0)


def _column(line: str, byte: int) -> int:
    """A column in characters; the compiler counts bytes of UTF-8."""
    return len(line.encode()[:byte].decode())
