"""Results of SPARQL queries, and changes of standing queries. Terms are N-Triples text."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from semmap.schemas.explanations import Term

Row = tuple[Term | None, ...]
"""One solution: a term for each variable, None where it is unbound."""


class SparqlResult(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The result of a query on the map after commit `seq`.

    `select` has one row per solution, in the query's order. `ask` has a `verdict`. `graph` (CONSTRUCT,
    DESCRIBE) has one row per triple, sorted, without duplicates. If the result is empty, `notes` lists the
    terms of the query that the map does not contain.
    """

    kind: Literal["select", "ask", "graph"]
    variables: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()
    verdict: bool = False
    notes: tuple[str, ...] = ()
    seq: int


class Watching(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A standing query that was started, with its rows after commit `seq`.

    It ends `lease_s` seconds after it was last renewed. `notes` are those of a `SparqlResult`.
    """

    watch: str
    variables: tuple[str, ...]
    rows: tuple[Row, ...]
    seq: int
    lease_s: float
    notes: tuple[str, ...] = ()


class RowsChanged(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The rows that a standing query gained and lost by commit `seq`, including duplicates.

    `since` is the commit of the previous evaluation: `seq - 1`, or earlier if several commits were evaluated
    together under load. With an `error`, the query has ended.
    """

    watch: str
    seq: int
    since: int
    appeared: tuple[Row, ...] = ()
    disappeared: tuple[Row, ...] = ()
    error: str = ""
