"""Answers to SPARQL as the rows of a table, and which entities each row is about."""

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
    """`columns` by the names of the variables; of each row the texts by column number, as `c0`, `c1`, ..."""

    columns: tuple[str, ...]
    rows: list[dict[str, Any]]


def rows_of(result: SparqlResult, entities: Collection[str]) -> Rows:
    """The rows of an answer. `names` of each are those of its terms that are `entities`."""
    if result.kind == "ask":
        return Rows(("answer",), [{ID: 0, "c0": "yes" if result.verdict else "no", NAMES: []}])
    columns = result.variables if result.kind == "select" else _TRIPLE
    return Rows(columns, [row_of(i, row, entities) for i, row in enumerate(result.rows)])


def row_of(number: int, row: Row, entities: Collection[str]) -> dict[str, Any]:
    """One row of the table, under this number."""
    cells = {f"c{i}": format_term(term) for i, term in enumerate(row)}
    return {ID: number, **cells, NAMES: names_in(row, entities)}


def names_in(row: Sequence[Term | None], entities: Collection[str]) -> list[str]:
    """The entities among the terms of a row, each once."""
    iris = [v.entity_name(term) for term in row if term is not None and term.startswith("<")]
    return [name for name in dict.fromkeys(iris) if name in entities]


def summary(result: SparqlResult, elapsed_s: float) -> str:
    """How much there is, of which commit, and how long it took."""
    count = "" if result.kind == "ask" else f"{wording.counted(len(result.rows), 'row')}, "
    return f"{count}commit {result.seq}, {_time(elapsed_s)}"


def _time(seconds: float) -> str:
    return f"{1000.0 * seconds:.0f} ms" if seconds < 1.0 else f"{seconds:.1f} s"


class Standing:
    """The rows of a standing query as a table, each with whether it has just come or gone.

    A row keeps its number for as long as it is there, so that a table moves no more than it must.
    """

    def __init__(self, rows: Sequence[Row]) -> None:
        self._rows: list[tuple[int, Row]] = list(enumerate(rows))
        self._next = len(rows)
        self._came: dict[int, int] = {}
        self._gone: list[tuple[int, Row]] = []

    def take(self, news: RowsChanged) -> None:
        """Take over what has come and gone; what did so before is no longer new."""
        self._came, self._gone = {}, []
        for row in news.disappeared:
            known = next((pair for pair in self._rows if pair[1] == row), None)
            if known is not None:
                self._rows.remove(known)
                self._gone.append(known)
        for row in news.appeared:
            self._rows.append((self._next, row))
            self._came[self._next] = news.seq
            self._next += 1

    def settle(self) -> None:
        """What came and went is no longer new."""
        self._came, self._gone = {}, []

    def table(self, entities: Collection[str]) -> list[dict[str, Any]]:
        """The rows, those just gone among them; `state` is "came", "gone" or empty."""
        return [
            {**row_of(number, row, entities), "state": state}
            for state, pairs in (("", self._rows), ("gone", self._gone))
            for number, row in pairs
            for state in ("came" if number in self._came else state,)
        ]

    def __len__(self) -> int:
        return len(self._rows)
