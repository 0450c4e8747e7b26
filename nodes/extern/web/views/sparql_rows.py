"""SPARQL results as table rows, with the entities in each row."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any, Final, NamedTuple

from semmap.nodes.extern.cli.output.sparql_formats import format_term
from semmap.ontology import vocabulary as v
from semmap.schemas import wording
from semmap.schemas.explanations import Term
from semmap.schemas.sparql import Row, RowsChanged, SparqlResult

ID: Final = "id"
NAMES: Final = "names"
_TRIPLE: Final = ("subject", "predicate", "object")


class Rows(NamedTuple):
    """`columns` are the names of the variables; the cells of a row have the keys `c0`, `c1`, ..."""

    columns: tuple[str, ...]
    rows: list[dict[str, Any]]


def rows_of(result: SparqlResult, entities: Collection[str]) -> Rows:
    """Return the rows of a result. The `names` of a row are its terms that are in `entities`."""
    if result.kind == "ask":
        return Rows(("answer",), [{ID: 0, "c0": "yes" if result.verdict else "no", NAMES: []}])
    columns = result.variables if result.kind == "select" else _TRIPLE
    return Rows(columns, [row_of(i, row, entities) for i, row in enumerate(result.rows)])


def row_of(number: int, row: Row, entities: Collection[str]) -> dict[str, Any]:
    """Return one row of the table, with this number as its id."""
    cells = {f"c{i}": format_term(term) for i, term in enumerate(row)}
    return {ID: number, **cells, NAMES: names_in(row, entities)}


def names_in(row: Sequence[Term | None], entities: Collection[str]) -> list[str]:
    """Return the entities among the terms of a row, each once."""
    iris = [v.entity_name(term) for term in row if term is not None and term.startswith("<")]
    return [name for name in dict.fromkeys(iris) if name in entities]


def format_summary(result: SparqlResult, elapsed_s: float) -> str:
    """Return the number of rows, the commit and the time of a query."""
    count = "" if result.kind == "ask" else f"{wording.counted(len(result.rows), 'row')}, "
    return f"{count}commit {result.seq}, {_time(elapsed_s)}"


def _time(seconds: float) -> str:
    return f"{1000.0 * seconds:.0f} ms" if seconds < 1.0 else f"{seconds:.1f} s"


class StandingRows:
    """The rows of a standing query as a table, with a mark for rows that were just added or removed.

    The number of a row does not change, so the table keeps unchanged rows in place.
    """

    def __init__(self, rows: Sequence[Row]) -> None:
        self._rows: list[tuple[int, Row]] = list(enumerate(rows))
        self._next = len(rows)
        self._added: dict[int, int] = {}
        self._removed: list[tuple[int, Row]] = []

    def apply(self, change: RowsChanged) -> None:
        """Apply a change, and clear the marks of earlier ones."""
        self._added, self._removed = {}, []
        for row in change.disappeared:
            known = next((pair for pair in self._rows if pair[1] == row), None)
            if known is not None:
                self._rows.remove(known)
                self._removed.append(known)
        for row in change.appeared:
            self._rows.append((self._next, row))
            self._added[self._next] = change.seq
            self._next += 1

    def clear_marks(self) -> None:
        """Clear the marks, and drop the removed rows."""
        self._added, self._removed = {}, []

    def table(self, entities: Collection[str]) -> list[dict[str, Any]]:
        """Return the rows, including those just removed; `state` is "added", "removed" or empty."""
        return [
            {**row_of(number, row, entities), "state": state}
            for state, pairs in (("", self._rows), ("removed", self._removed))
            for number, row in pairs
            for state in ("added" if number in self._added else state,)
        ]

    def __len__(self) -> int:
        return len(self._rows)
