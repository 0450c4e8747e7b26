"""The output of `list`, `get`, `status` and `sparql` with `--robots`, robot by robot."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from semmap.nodes.extern.cli import output
from semmap.nodes.extern.cli.commands import sparql_output as sparql_answers
from semmap.nodes.extern.cli.common import print_count, print_error, print_json, print_lines
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.schemas import errors
from semmap.schemas.entities import Entity
from semmap.schemas.relations import Described
from semmap.schemas.replies import SystemStatus
from semmap.schemas.robots import Answer
from semmap.schemas.sparql import SparqlResult

if TYPE_CHECKING:
    from semmap.nodes.extern.fleet.robots import Robots


def print_entities(
    found: Sequence[Entity], sort: str | None, limit: int | None, columns: Sequence[str]
) -> None:
    """Print a table of entities, and their number."""
    shown = output.show.sort_entities(found, sort)[:limit]
    if shown:
        output.show.console().print(output.show.entity_table(shown, columns))
    print_count(_count(shown, found))


def _count(shown: Sequence[Entity], found: Sequence[Entity]) -> str:
    if len(shown) < len(found):
        return f"{len(shown)} of {len(found)} entities"
    return output.show.entity_line(shown)


def entities(
    robots: Robots,
    class_: str | None,
    format: str,
    as_of: str | None,
    sort: str | None,
    limit: int | None,
    columns: tuple[str, ...],
    **where: Any,
) -> None:
    """Print the output of `semmap list --robots`."""

    def show(found: Sequence[Entity]) -> None:
        shown = output.show.sort_entities(found, sort)[:limit]
        if shown:
            output.show.console().print(output.show.entity_table(shown, columns))
        print_escaped(_count(shown, found))

    _require(format, ("table", "json"))
    _require_own(where.pop("frame"))
    if where.pop("all"):
        raise errors.BadRequest("--robots and --all exclude each other; remove one of them")
    _print(robots.list(class_, as_of=as_of, **where), show, format)


def entity(robots: Robots, name: str, format: str, as_of: str | None, frame: str | None) -> None:
    """Print the output of `semmap get --robots`."""

    def show(found: Described) -> None:
        output.show.console().print(output.show.entity_card(found))

    _require_own(frame)
    _print(robots.get(name, where=True, as_of=as_of), show, format)


def status(robots: Robots, format: str) -> None:
    """Print the output of `semmap status --robots`."""

    def show(status: SystemStatus) -> None:
        output.show.console().print(output.show.status_table(status))
        print(output.show.status_line(status))
        print_lines(f"  {problem}" for problem in output.show.problem_lines(status))

    _print(robots.status(), show, format)


def rows(robots: Robots, query: str, format: str | None, **options: Any) -> None:
    """Print the output of `semmap sparql --robots`."""

    def show(result: SparqlResult) -> None:
        if result.kind == "select":
            sparql_answers.print_rows(result.variables, result.rows)
        else:
            print_escaped(
                output.sparql_formats.text(result, "table" if result.kind == "ask" else "turtle").rstrip()
            )

    _require(format or "table", ("table", "json"))
    answers = robots.sparql(sparql_answers.read_query(query), **options)
    _print(answers, show, format or "table")


def _require(format: str, possible: Sequence[str]) -> None:
    if format not in possible:
        raise errors.BadRequest(f"--robots does not support --format {format}; use {' or '.join(possible)}")


def _require_own(frame: str | None) -> None:
    if frame is not None:
        raise errors.BadRequest("--robots and --frame exclude each other; remove one of them")


def _print(answers: Iterable[Answer[Any]], show: Callable[[Any], None], format: str) -> None:
    """Print all replies, then all errors, and exit with a status other than 0 if a robot did not respond.

    Errors that robots return set the exit status only if no robot returned a result.
    """
    answers = list(answers)
    if format == "json":
        print_json(answers)
    for answer in answers if format != "json" else ():
        if answer.error is None:
            commit = "" if answer.commit is None else f" (commit {answer.commit})"
            print_escaped(f"{answer.robot or 'the system without a namespace'}{commit}:")
            show(answer.value)
    failed = [(answer.robot, errors.from_message(answer.error)) for answer in answers if answer.error]
    for robot, error in failed:
        print_error(f"{robot}: {error.text}")
    found = [error for _, error in failed]
    is_silent = any(isinstance(error, errors.NoAnswer) for error in found)
    if is_silent or (found and len(found) == len(answers)):
        sys.stdout.flush()
        sys.exit(errors.NoAnswer.exit_status if is_silent else found[0].exit_status)
