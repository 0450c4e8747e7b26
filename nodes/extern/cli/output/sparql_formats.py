"""SPARQL results as text: a table, JSON, CSV or Turtle."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from semmap.nodes.extern.cli.output import plain
from semmap.nodes.extern.cli.output.formats import Format
from semmap.nodes.runtime import extras
from semmap.ontology import vocabulary as v
from semmap.ontology.prefixes import WELL_KNOWN, used_by
from semmap.schemas import errors
from semmap.schemas.explanations import Term
from semmap.schemas.sparql import Row, RowsChanged, SparqlResult

if TYPE_CHECKING:
    from rich.table import Table


def plain_table(variables: tuple[str, ...], rows: tuple[Row, ...]) -> Iterator[str]:
    """Yield a table as plain lines with prefixed names, for a file or a pipe."""
    return plain.lines(variables, [[format_term(term) for term in row] for row in rows])


def table(variables: tuple[str, ...], rows: tuple[Row, ...]) -> Table:
    """Return the table for a terminal."""
    from semmap.nodes.extern.cli.output import tables

    shown = tables.table(*variables, fold=variables)
    for row in rows:
        shown.add(*map(format_term, row))
    return shown


def text(result: SparqlResult, format: Format) -> str:
    """Return a result as a document. Raises BadRequest if the format does not support this kind of result."""
    if format == "turtle":
        return _turtle(result)
    if result.kind == "ask":
        return _json({"head": {}, "boolean": result.verdict}) if format == "json" else _truth(result)
    if format == "csv":
        return "".join(f"{line}\r\n" for line in _csv(result))
    bindings = [
        {name: _binding(term) for name, term in zip(result.variables, row, strict=True) if term is not None}
        for row in result.rows
    ]
    return _json({"head": {"vars": list(result.variables)}, "results": {"bindings": bindings}})


def news(variables: tuple[str, ...], changed: RowsChanged) -> Iterator[str]:
    """Yield a line for each row that appeared (+) or disappeared (-), with its commit."""
    by = f"commit {changed.seq}"
    if changed.since < changed.seq - 1:
        by = f"commits {changed.since + 1} to {changed.seq}"
    for sign, rows in (("-", changed.disappeared), ("+", changed.appeared)):
        for row in rows:
            named = zip(variables, row, strict=True)
            yield f"{sign} {'  '.join(f'?{name} {format_term(term)}' for name, term in named)}  ({by})"


def format_term(term: Term | None) -> str:
    """Return a term in the syntax of Turtle: `:chair1`, `dm:Chair`, `1.5`, `"text"`."""
    if term is None:
        return ""
    if term.startswith("<"):
        for prefix, namespace in WELL_KNOWN.items():
            if term.startswith(f"<{namespace}"):
                return f"{prefix}:{term[len(namespace) + 1 : -1]}"
        return term
    if term.startswith('"') and v.datatype_of(term) not in (v.XSD_STRING, v.RDF_LANG_STRING):
        return v.lexical(term)
    return term


def _truth(result: SparqlResult) -> str:
    return "true\n" if result.verdict else "false\n"


def _csv(result: SparqlResult) -> Iterator[str]:
    yield ",".join(result.variables)
    for row in result.rows:
        yield ",".join(map(_cell, row))


def _cell(term: Term | None) -> str:
    """Return a term in the SPARQL 1.1 CSV format."""
    if term is None or term.startswith("_:"):
        return term or ""
    bare = v.bare(term) if term.startswith("<") else v.lexical(term)
    return '"' + bare.replace('"', '""') + '"' if any(c in bare for c in '",\r\n') else bare


def _binding(term: Term) -> dict[str, str]:
    """Return a term in the SPARQL 1.1 JSON format."""
    if term.startswith("<"):
        return {"type": "uri", "value": v.bare(term)}
    if term.startswith("_:"):
        return {"type": "bnode", "value": term[2:]}
    binding = {"type": "literal", "value": v.lexical(term)}
    if (language := v.language_of(term)) is not None:
        return {**binding, "xml:lang": language}
    datatype = v.datatype_of(term)
    return binding if datatype == v.XSD_STRING else {**binding, "datatype": v.bare(datatype)}


def _turtle(result: SparqlResult) -> str:
    if result.kind != "graph":
        raise errors.BadRequest(
            "--format turtle requires a CONSTRUCT or DESCRIBE query; for rows use table, json or csv"
        )
    lines = "".join(f"{' '.join(map(str, row))} .\n" for row in result.rows).encode()
    extras.require("RDF as Turtle", "kb")
    import pyoxigraph as ox

    triples = ox.parse(lines, ox.RdfFormat.N_TRIPLES)
    document = ox.serialize(triples, format=ox.RdfFormat.TURTLE, prefixes=_prefixes(result))
    if document is None:
        raise errors.InternalError("the triples were not serialized")
    return document.decode()


def _prefixes(result: SparqlResult) -> dict[str, str]:
    rows = [(s, p, o) for s, p, o in result.rows if s is not None and p is not None and o is not None]
    return used_by(rows, WELL_KNOWN)


def _json(document: Any) -> str:
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"
