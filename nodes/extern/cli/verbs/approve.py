"""The verb `approve`: what agents ask to be allowed to do."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from nodes.extern.cli.calling import print_json, print_lines, talks
from schemas import errors

if TYPE_CHECKING:
    from nodes.extern.client import Client
    from schemas.approvals import Request

_FEW = 12


@click.command()
@click.argument("number", type=int, required=False)
@click.option("--reject", is_flag=True, help="Reject it instead.")
@click.option("--format", "format", type=click.Choice(["text", "json"]), default="text", show_default=True)
@talks
def approve(client: Client, number: int | None, reject: bool, format: str) -> None:
    """Approve what an agent asks to change.

    Without NUMBER, show the requests that wait: what would be changed, why, and what would follow.
    """
    if reject and number is None:
        raise errors.BadRequest("say which one to reject, such as: semmap approve 3 --reject")
    found = client.approve(number, reject=reject)
    if format == "json":
        print_json(found)
    elif number is not None:
        print_lines(f"{request.decision} {request.number}: {request.text}" for request in found)
    else:
        print_lines(line for request in found for line in _lines(request))
        print_lines([] if found else ["nothing waits for approval"])


def _lines(request: Request) -> list[str]:
    why = f" ({request.reason})" if request.reason else ""
    facts = list(request.follows[:_FEW])
    rest = len(request.follows) - len(facts)
    return [
        f"{request.number}  {request.agent}: {request.text}{why}",
        *(f"     {fact}" for fact in facts),
        *([f"     and {rest} more"] if rest else []),
    ]
