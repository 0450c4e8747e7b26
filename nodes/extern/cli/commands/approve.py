"""The command `approve`: changes that agents have requested."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import click

from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import print_json, print_lines, with_client
from semmap.nodes.extern.cli.output.printable import escaped, quoted
from semmap.schemas import errors

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client
    from semmap.schemas.approvals import Request

_FEW = 4
"""How many facts of a request are printed; the others are counted."""
_PLAIN_NAME = re.compile(r"[\w./@-]{1,100}")


@command(example="semmap approve 3")
@click.argument("number", type=int, required=False)
@click.option("--reject", is_flag=True, help="Reject the request instead.")
@click.option("--all", "all_", is_flag=True, help="With --reject: reject all pending requests.")
@click.option("--format", "format", type=click.Choice(["text", "json"]), default="text", show_default=True)
@with_client
def approve(client: Client, number: int | None, reject: bool, all_: bool, format: str) -> None:
    """Approve a change that an agent has requested.

    Without NUMBER, list the pending requests: the change, its most important inferred facts (JSON has all of
    them), and the agent's reason. Text from an agent is in double quotes.
    """
    if all_ and (number is not None or not reject):
        raise errors.BadRequest("--all requires --reject and no NUMBER: semmap approve --reject --all")
    if reject and number is None and not all_:
        raise errors.BadRequest("--reject requires a NUMBER or --all, as in: semmap approve 3 --reject")
    found = client.approve(number, reject=reject, all=all_)
    if format == "json":
        print_json(found)
    elif number is not None or all_:
        print_lines(f"{request.decision} {request.number}: {escaped(request.text)}" for request in found)
        print_lines([] if found else ["no pending requests"])
    else:
        print_lines(map(_line, found))
        print_lines([] if found else ["no pending requests"])


def _line(request: Request) -> str:
    """Return a request as one line, with control characters in its texts escaped."""
    agent = request.agent if _PLAIN_NAME.fullmatch(request.agent) else quoted(request.agent)
    facts = [escaped(fact) for fact in request.follows[:_FEW]]
    if (rest := len(request.follows) - len(facts)) > 0:
        facts.append(f"{rest} more")
    then = f"; then {', '.join(facts)}" if facts else ""
    why = quoted(request.reason) if request.reason else "none given"
    return f"{request.number}  {agent}: {escaped(request.text)}{then}; reason: {why}"
