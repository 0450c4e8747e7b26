"""The commands of natural language: `find`, `understand` and `tell`."""

from __future__ import annotations

import shutil
import sys
import textwrap
from typing import TYPE_CHECKING, Any, Final

import click

from semmap.nodes.extern.cli.angles import from_pose
from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import TIME, print_json, print_lines, with_client
from semmap.nodes.extern.cli.output import lines, lu4r
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.cli.shell_completion import entity_names
from semmap.schemas import errors

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client
    from semmap.schemas.language import Language, Mood

_WHY: Final[dict[Mood, str]] = {
    "command": "'{text}': no command recognized; example: take the cup from the table",
    "question": "'{text}' is a question, not a command; example of a command: take the cup from the table",
    "past": "'{text}' is a statement about the past, not a command; example of a command: take the cup from"
    " the table",
}


@command(example="semmap tell kitchen1 --words 50")
@click.argument("name", required=False, shell_complete=entity_names)
@click.option(
    "--words",
    type=click.IntRange(20, 5000),
    default=150,
    show_default=True,
    help="Maximum number of words.",
)
@click.option("--as-of", metavar="COMMIT|TIME", help=f"The map after a commit or at a time. {TIME}")
@click.option("--format", "format", type=click.Choice(["text", "json"]), default="text", show_default=True)
@with_client
def tell(client: Client, name: str | None, words: int, as_of: str | None, format: str) -> None:
    """Describe the map, a place or an object in a short text.

    NAME is a name, or a label or class that only one entity has. Without it, the whole map is described.
    """
    found = client.tell(name, words=words, as_of=as_of)
    if format == "json":
        print_json(found)
    else:
        width = shutil.get_terminal_size().columns
        print_lines(textwrap.wrap(found.text, width) if sys.stdout.isatty() else [found.text])


@command(example='semmap find "the red cup on the kitchen table"')
@click.argument("text")
@click.option(
    "--from", "viewer", metavar="VIEWER", help="Viewer, for left of, behind, the second from the left ..."
)
@from_pose
@click.option("--for", "asker", metavar="NAME", help="Speaker: the person that 'my' refers to.")
@click.option("--answer", metavar="TEXT", help="Answer to the clarification question: 'the one on the desk'.")
@click.option("--as-of", metavar="COMMIT|TIME", help=f"The map after a commit or at a time. {TIME}")
@click.option("--format", type=click.Choice(["text", "json"]), default="text", show_default=True)
@with_client
def find(client: Client, text: str, format: str, **fields: Any) -> None:
    """Find the entities that a noun phrase describes.

    The phrase is English or Italian. If several entities match, a clarification question is printed. If none
    matches, the nearest ones are printed to stderr, and the exit status is 1.
    """
    found = client.find(text=text, **fields)
    if format == "json":
        print_json(found)
    else:
        out = sys.stderr if found.outcome == "none" else None
        for line in lines.format_matches(found):
            print_escaped(line, file=out)
    if found.outcome == "none":
        sys.exit(errors.Refused.exit_status)


@command(example='semmap understand "take the bottle from the table"')
@click.argument("text")
@click.option(
    "--format",
    "format",
    type=click.Choice(["text", "json", "lu4r"]),
    default="text",
    show_default=True,
    help="lu4r: the format of the LU4R interpreter.",
)
@click.option("--language", type=click.Choice(["english", "italian"]), help="Default: detected.")
@with_client
def understand(client: Client, text: str, format: str, language: Language | None) -> None:
    """Parse a spoken command, or answer a question about the past.

    The text is English or Italian. The arguments of its FrameNet frames are resolved to entities of the
    map. Unknown verbs, and arguments that do not match the map, are reported on stderr. The exit status is 1
    if no frame is recognized.
    """
    found = client.understand(text, language=language)
    done = found.steps or found.frames or found.past
    if format != "text":
        print_json(found if format == "json" else lu4r.document(found))
        sys.exit(0 if done else errors.Refused.exit_status)
    unknown = f"unknown {'verbs' if len(found.unknown) > 1 else 'verb'}: {', '.join(found.unknown)}"
    doubts = (*found.doubts, *((unknown,) if found.unknown else ()))
    if not done:
        raise errors.Refused("; ".join(doubts) if found.unknown else _WHY[found.mood].format(text=text))
    actions = found.steps or found.frames
    print_lines(
        [action.text for action in actions] + [text for text in (found.answer, found.question) if text]
    )
    print_lines(f"note: {doubt}" for doubt in doubts)
