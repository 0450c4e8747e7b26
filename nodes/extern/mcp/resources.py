"""The resources: the schema, for who writes queries, and standing questions, whose changes are notified.

A standing question is in its URI: `semmap://watch/in/kitchen1`, `on/table1`, `near/cup1`, `class/Cup`, or
`query/` with a SELECT, percent-encoded.
"""

from __future__ import annotations

import re
from typing import Any, Final
from urllib.parse import unquote

from semmap.nodes.extern.client import Client
from semmap.nodes.extern.mcp import answers, rows
from semmap.nodes.extern.mcp.answers import Answer
from semmap.nodes.extern.mcp.consistent_read import newest
from semmap.ontology.prefixes import WELL_KNOWN
from semmap.schemas import errors

SCHEMA: Final = "semmap://schema"
CLASSES: Final = f"{SCHEMA}/classes"
PROPERTIES: Final = f"{SCHEMA}/properties"
WATCH: Final = "semmap://watch/"
KINDS: Final = ("in", "on", "near", "class", "query")
_CLASS: Final = re.compile(r"[\w.-]{1,200}")


def read(client: Client, uri: str) -> str:
    """What a resource says now, as JSON of at most 4 000 characters. Raises SemmapError."""
    if uri == SCHEMA:
        return answers.text(_schema(client))
    for page, of in ((CLASSES, _classes), (PROPERTIES, _properties)):
        if uri == page or uri.startswith(f"{page}/"):
            cursor = uri.removeprefix(page).removeprefix("/")
            return answers.text(of(client), answers.read_cursor(cursor)[1] if cursor else 0)
    if uri.startswith(WATCH):
        with client.watch(**asked(uri)) as standing:
            found = [rows.solution(row) for row in standing.rows]
            head = {"variables": standing.variables}
            return answers.text(
                Answer(first=standing.seq, last=standing.seq, head=head, items=found, of="rows")
            )
    there = f"{SCHEMA}, {CLASSES}, {PROPERTIES} and {WATCH}KIND/WORD"
    raise errors.Refused(f"there is no such resource; there are: {there}")


def asked(uri: str) -> dict[str, Any]:
    """What a standing question's URI asks, as the arguments of `Client.watch`. Raises BadRequest."""
    kind, _, word = uri.removeprefix(WATCH).partition("/")
    word = unquote(word)
    if kind not in KINDS or not word:
        raise errors.BadRequest(f"write {WATCH}KIND/WORD, where KIND is {errors.enumerated(KINDS)}")
    if kind == "query":
        return {"query": word, "inferred": True}
    if kind == "class":
        if not _CLASS.fullmatch(word):
            raise errors.BadRequest(f"'{word[:100]}' is no name of a class; try {WATCH}class/Cup")
        return {"query": f"SELECT ?entity {{ ?entity a <{WELL_KNOWN['dm']}{word}> }}", "inferred": True}
    return {"in_" if kind == "in" else kind: word}


def _schema(client: Client) -> Answer:
    seq = newest(client)
    head = {
        "prefixes": dict(WELL_KNOWN),
        "classes": f"{CLASSES}, by pages: {CLASSES}/NEXT",
        "properties": f"{PROPERTIES}, by pages: {PROPERTIES}/NEXT",
        "measured": [f"dm:{name}" for name in rows.PLACED],
        "example": "SELECT ?e ?p { ?e a dm:Cup ; dm:isLocatedIn ?p }",
    }
    return Answer(first=seq, last=seq, head=head)


def _classes(client: Client) -> Answer:
    """Every class with its parents: `Cup < Drinking_Vessel`."""
    found = [
        f"{info.prefixed or info.name} < {', '.join(info.parents)}" if info.parents else info.name
        for info in client.classes()
    ]
    return _listed(client, found, "classes")


def _properties(client: Client) -> Answer:
    """Every property with what it is of and what it takes: `isOpen: Door -> boolean`."""
    found = [
        f"{info.name}: {', '.join(info.domain) or 'anything'} -> {', '.join(info.range) or 'anything'}"
        for info in client.properties()
    ]
    return _listed(client, found, "properties")


def _listed(client: Client, found: list[str], of: str) -> Answer:
    seq = newest(client)
    return Answer(first=seq, last=seq, head={}, items=found, of=of)
