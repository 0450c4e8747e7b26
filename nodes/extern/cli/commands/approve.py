"""The verb `approve`: what agents ask to be allowed to do."""

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
"""Facts of a request that are shown; the others are counted."""
_A_NAME = re.compile(r"[\w./@-]{1,100}")


@command(example="semmap approve 3")
@click.argument("number", type=int, required=False)
@click.option("--reject", is_flag=True, help="Reject it instead.")
@click.option("--all", "all_", is_flag=True, help="With --reject: reject all that wait.")
@click.option("--format", "format", type=click.Choice(["text", "json"]), default="text", show_default=True)
@with_client
def approve(client: Client, number: int | None, reject: bool, all_: bool, format: str) -> None:
    """Approve what an agent asks to change.

    Without NUMBER, show the requests that wait, a line each: what would be changed, the most telling facts
    that would follow (JSON has all), and the agent's reason. What an agent wrote is in double quotes.
    """
    if all_ and (number is not None or not reject):
        raise errors.BadRequest(
            "--all goes with --reject and without a number: semmap approve --reject --all"
        )
    if reject and number is None and not all_:
        raise errors.BadRequest(
            "say which one to reject, such as: semmap approve 3 --reject; or all that wait, with --all"
        )
    found = client.approve(number, reject=reject, all=all_)
    if format == "json":
        print_json(found)
    elif number is not None or all_:
        print_lines(f"{request.decision} {request.number}: {escaped(request.text)}" for request in found)
        print_lines([] if found else ["nothing waited for approval"])
    else:
        print_lines(map(_line, found))
        print_lines([] if found else ["nothing waits for approval"])


def _line(request: Request) -> str:
    """A request on one line, whatever its texts are."""
    agent = request.agent if _A_NAME.fullmatch(request.agent) else quoted(request.agent)
    facts = [escaped(fact) for fact in request.follows[:_FEW]]
    if (rest := len(request.follows) - len(facts)) > 0:
        facts.append(f"{rest} more")
    then = f"; then {', '.join(facts)}" if facts else ""
    why = quoted(request.reason) if request.reason else "none given"
    return f"{request.number}  {agent}: {escaped(request.text)}{then}; reason: {why}"
