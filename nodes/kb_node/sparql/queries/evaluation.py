"""Evaluation of one query on one store."""

from __future__ import annotations

from itertools import islice
from typing import Final

import pyoxigraph as ox

from semmap.nodes.kb_node.sparql.queries.text import query_prefixes, syntax_error
from semmap.nodes.kb_node.sparql.queries.unknown_terms import unknown_term_notes
from semmap.nodes.kb_node.sparql.triples.dataset import ASSERTED, INFERRED, MEASURED, Dataset
from semmap.ontology import prefixes
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.explanations import Term
from semmap.schemas.sparql import Row, SparqlResult

_PREFERRED_PREFIX: Final = ox.NamedNode(v.bare(prefixes.PREFERRED_PREFIX))
_ZERO: Final = f'"0"^^<{v.XSD}integer>'
_SPO: Final = ("subject", "predicate", "object")


def evaluate(
    query: str, dataset: Dataset, *, inferred: bool, limit: int, measured: bool = False
) -> SparqlResult:
    """Evaluate a query over the asserted triples or, with `inferred`, over all triples that hold.

    `measured` adds the triples that were measured for the query. Raises BadRequest for invalid SPARQL,
    Refused for more than `limit` rows.
    """
    known = query_prefixes(declared_in(dataset))
    graphs = dataset.asserted_graphs()
    if inferred:
        graphs = [ASSERTED, INFERRED, MEASURED] if measured else [ASSERTED, INFERRED]
    try:
        found = dataset.store.query(
            query,
            prefixes=known,
            default_graph=graphs,
            named_graphs=[],
        )
        if isinstance(found, ox.QueryBoolean):
            verdict = bool(found)
            notes = () if verdict else tuple(unknown_term_notes(query, dataset, known))
            return SparqlResult(kind="ask", verdict=verdict, notes=notes, seq=dataset.seq)
        if isinstance(found, ox.QueryTriples):
            rows: tuple[Row, ...] = _graph(found, limit)
            notes = () if rows else tuple(unknown_term_notes(query, dataset, known))
            return SparqlResult(kind="graph", variables=_SPO, rows=rows, notes=notes, seq=dataset.seq)
        rows = tuple(tuple(map(_term, row)) for row in islice(found, limit + 1))
    except SyntaxError as error:
        raise syntax_error(query, error, known) from None
    except (RuntimeError, ValueError, OSError) as error:
        raise errors.Refused(f"the query cannot be evaluated: {' '.join(str(error).split())}") from None
    _require_few(len(rows), limit)
    variables = tuple(variable.value for variable in found.variables)
    notes = tuple(unknown_term_notes(query, dataset, known)) if _is_nothing(rows) else ()
    return SparqlResult(kind="select", variables=variables, rows=rows, notes=notes, seq=dataset.seq)


def _is_nothing(rows: tuple[Row, ...]) -> bool:
    """Return whether there is no row, or only a COUNT of 0."""
    return not rows or (len(rows) == 1 and set(rows[0]) <= {None, _ZERO})


def declared_in(dataset: Dataset) -> dict[str, str]:
    """Return the prefixes of the TBox's own namespaces."""
    quads = dataset.store.quads_for_pattern(None, _PREFERRED_PREFIX, None, ASSERTED)
    declared = prefixes.declared_in((str(q.subject), str(q.predicate), str(q.object)) for q in quads)
    return {prefix: namespace for namespace, prefix in declared.items()}


def _term(term: object) -> Term | None:
    return None if term is None else str(term)


def _graph(triples: ox.QueryTriples, limit: int) -> tuple[Row, ...]:
    """Return the triples, each once, sorted."""
    found: set[Row] = set()
    for triple in triples:
        found.add(tuple(map(str, triple)))
        _require_few(len(found), limit)
    return tuple(sorted(found, key=str))


def _require_few(rows: int, limit: int) -> None:
    if rows > limit:
        raise errors.Refused(
            f"the query has more than {limit} rows; narrow it, add LIMIT to it, or raise the limit"
        )
