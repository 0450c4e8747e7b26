"""Answers to SPARQL queries, and the news of standing ones. Terms are N-Triples text, as everywhere."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from semmap.schemas.explanations import Term

Row = tuple[Term | None, ...]
"""One solution: a term for each variable, None where it is unbound."""


class SparqlResult(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a query gave on the map as it was after commit `seq`.

    `select`: a row a solution, in the query's order. `ask`: `verdict`. `graph` (CONSTRUCT, DESCRIBE): a row
    a triple, sorted, each once. `notes`: where there is nothing, each term of the query that the map does
    not know, a sentence each.
    """

    kind: Literal["select", "ask", "graph"]
    variables: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()
    verdict: bool = False
    notes: tuple[str, ...] = ()
    seq: int


class Watching(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A standing query is watched: its rows after commit `seq`, and the news from then on.

    It ends `lease_s` after it was last renewed. `notes` are those of a `SparqlResult`.
    """

    watch: str
    variables: tuple[str, ...]
    rows: tuple[Row, ...]
    seq: int
    lease_s: float
    notes: tuple[str, ...] = ()


class RowsChanged(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Rows that a standing query has gained and lost by commit `seq`; a row that it has n times, n times.

    `since` is the commit after which its rows were looked at before: `seq - 1`, unless more was going on
    than could be evaluated, and several commits are told of in one. With an `error` the query has ended.
    """

    watch: str
    seq: int
    since: int
    appeared: tuple[Row, ...] = ()
    disappeared: tuple[Row, ...] = ()
    error: str = ""
