"""The output of `sparql` and of `watch` with a query."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from semmap.nodes.extern.cli import output
from semmap.nodes.extern.cli.common import is_json, print_event
from semmap.nodes.extern.cli.output.formats import Format
from semmap.nodes.extern.cli.output.printable import print_escaped, write
from semmap.nodes.extern.files import read_file
from semmap.ontology import vocabulary as v
from semmap.schemas import codec, errors
from semmap.schemas.sparql import Row

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client
    from semmap.nodes.extern.sparql_client import StandingQuery


def read_query(word: str) -> str:
    """Return the query of an argument: its text, the content of `@FILE`, or standard input for `-`."""
    if word == "-":
        content = sys.stdin.buffer.read()
    elif word.startswith("@"):
        content = read_file(Path(word[1:]))
    else:
        return word
    try:
        return codec.decode_text(content)
    except UnicodeDecodeError:
        raise errors.BadFile(f"{word} is not a UTF-8 text file") from None


def ask(
    client: Client,
    query: str,
    *,
    inferred: bool,
    format: Format | None,
    timeout: float,
    limit: int,
    as_of: str | None,
) -> None:
    """Run a query and print its result: by default a table, a truth value, or Turtle for a graph."""
    result = client.sparql(read_query(query), inferred=inferred, timeout=timeout, limit=limit, as_of=as_of)
    _note(result.notes)
    format = format or ("turtle" if result.kind == "graph" else "table")
    if format != "table" or result.kind == "ask":
        write(output.sparql_formats.text(result, format))
        return
    if result.rows:
        print_rows(result.variables, result.rows)
    print(f"{_rows(len(result.rows))} (commit {result.seq})")


def watch(client: Client, query: str, *, inferred: bool) -> None:
    """Print the rows of a query, then the rows that appear and disappear."""
    with client.watch(read_query(query), inferred=inferred) as standing:
        _note(standing.notes)
        if is_json():
            print_event(_begin(standing), ())
        else:
            if standing.rows:
                print_rows(standing.variables, standing.rows)
            print(f"{_rows(len(standing.rows))} (commit {standing.seq}); watching", flush=True)
        for changed in standing.changes():
            print_event(changed, output.sparql_formats.news(standing.variables, changed))


def _begin(standing: StandingQuery) -> dict[str, Any]:
    return {"variables": standing.variables, "rows": standing.rows, "seq": standing.seq}


def _note(notes: Iterable[str]) -> None:
    """Print the notes of a result to stderr."""
    for note in notes:
        print_escaped(f"note: {note}", file=sys.stderr)


def print_rows(variables: tuple[str, ...], rows: tuple[Row, ...]) -> None:
    """Print a table, with lines and colours if the output is a terminal."""
    if sys.stdout.isatty():
        output.show.console().print(output.sparql_formats.table(variables, rows))
    else:
        print(*output.sparql_formats.plain_table(variables, rows), sep="\n")


def watch_places(client: Client, **where: Any) -> None:
    """Print the entities at a location, then those that appear and disappear there."""
    with client.watch(**where) as standing:
        names = _names(standing.rows)
        there = f"{', '.join(names) or 'nothing'} (commit {standing.seq}); watching"
        print_event({"there": names, "seq": standing.seq}, [there])
        for changed in standing.changes():
            for sign, key, rows in (
                ("-", "disappeared", changed.disappeared),
                ("+", "appeared", changed.appeared),
            ):
                for name in _names(rows):
                    event = {key: name, "seq": changed.seq}
                    print_event(event, [f"{sign} {name}  (commit {changed.seq})"])


def _names(rows: Iterable[Row]) -> list[str]:
    return [v.entity_name(term) for (term,) in rows if term is not None]


def _rows(count: int) -> str:
    return "1 row" if count == 1 else f"{count} rows"
