"""Random sampling of mutants; reproducible for the same code, number and seed."""

from __future__ import annotations

import ast
import random
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cosmic_ray.plugins
from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code

from tests.mutants.operators import NAMES
from tests.mutants.untouched import Position, find_untouched, is_within


@dataclass(frozen=True)
class Mutant:
    """One change of one module."""

    path: str
    """From the root of the repository."""
    line: int
    operator: str
    """As Cosmic Ray names it."""
    occurrence: int
    """The how many-th place of the module where this operator can be applied, from 0."""
    before: str
    """The line that is changed."""
    after: str
    code: str
    """The whole module, changed."""

    def describe(self) -> str:
        """Return the place and the change, in one line."""
        return f"{self.path}:{self.line}  {self.before}  ->  {self.after}"


@dataclass(frozen=True)
class _Change:
    start: Position
    operator: str
    occurrence: int


def draw(root: Path, part: str, number: int, seed: int) -> list[Mutant]:
    """Return `number` mutants of the modules below `root / part`, at most one for each line.

    Each line that can be changed is as likely as any other. On a line, each place is equally likely, and
    at a place each change.
    """
    dice = random.Random(seed)
    changes = {path: _changes(code) for path, code in _modules(root, part)}
    lines = [(path, line) for path, of_lines in changes.items() for line in of_lines]
    dice.shuffle(lines)
    drawn: list[Mutant] = []
    for path, line in lines:
        if len(drawn) == number:
            break
        if mutant := _drawn(dice, path, (root / path).read_text(), changes[path][line]):
            drawn.append(mutant)
    return drawn


def _modules(root: Path, part: str) -> Iterator[tuple[str, str]]:
    """Path and code of each module below `part`, in the order of their paths."""
    at = root / part
    for path in [at] if at.is_file() else sorted(at.rglob("*.py")):
        yield path.relative_to(root).as_posix(), path.read_text()


def _changes(code: str) -> dict[int, list[_Change]]:
    """All changes that can be made to this code, by line."""
    nodes, untouched = [*ast_nodes(get_ast(code))], find_untouched(code)
    by_line: dict[int, list[_Change]] = defaultdict(list)
    for name in NAMES:
        operator = cosmic_ray.plugins.get_operator(name)()
        places = ((node, start) for node in nodes for start, _ in operator.mutation_positions(node))
        for occurrence, (node, start) in enumerate(places):
            # Cosmic Ray takes the `*` before keyword-only parameters for a product.
            if node.parent and node.parent.type != "parameters" and not is_within(start, untouched):
                by_line[start[0]].append(_Change(start, name, occurrence))
    return dict(sorted(by_line.items()))


def _drawn(dice: random.Random, path: str, code: str, changes: list[_Change]) -> Mutant | None:
    """One of the changes of a line that gives another program; None where none does."""
    by_place: dict[Position, list[_Change]] = defaultdict(list)
    for change in changes:
        by_place[change.start].append(change)
    places = [*by_place.values()]
    dice.shuffle(places)
    for place in places:
        dice.shuffle(place)
        for change in place:
            if mutant := _made(path, code, change):
                return mutant
    return None


def _made(path: str, code: str, change: _Change) -> Mutant | None:
    operator = cosmic_ray.plugins.get_operator(change.operator)()
    try:
        changed = mutate_code(code, operator, change.occurrence)
    except AttributeError:  # Cosmic Ray cannot replace `errors.Refused` in an `except`
        return None
    if changed is None or not _is_other_program(code, changed):
        return None
    line = change.start[0]
    before, after = code.splitlines(), changed.splitlines()
    return Mutant(
        path,
        line,
        change.operator.removeprefix("core/"),
        change.occurrence,
        _clean(before[line - 1]),
        _clean(after[line - 1]) if len(after) == len(before) else "(without it)",
        changed,
    )


def _clean(line: str) -> str:
    return " ".join(line.split())


def _is_other_program(code: str, changed: str) -> bool:
    try:
        return ast.dump(ast.parse(changed)) != ast.dump(ast.parse(code))
    except SyntaxError:
        return False
