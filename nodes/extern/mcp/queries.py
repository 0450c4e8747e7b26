"""The read-only tools: functions of a client and of the arguments of a tool. They raise SemmapError."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import Any, Final, TypeVar

from semmap.nodes.extern.client import Client
from semmap.nodes.extern.mcp import arguments as a
from semmap.nodes.extern.mcp import rows
from semmap.nodes.extern.mcp.answers import (
    Answer,
    Authors,
    attribute_text,
    format_time,
    read_cursor,
    round_metres,
)
from semmap.nodes.extern.mcp.consistent_read import known, newest, read_at_one_commit
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Explanation
from semmap.schemas.language import Candidate
from semmap.schemas.moments import When

R = TypeVar("R")
Found = tuple[dict[str, Any], Sequence[Any] | None]
"""The head of a reply, and its items."""

_RELATIONS: Final = " ".join(f"dm:{name}" for name in rows.PLACED)
_WHERE_ALL: Final = f"SELECT ?e ?r ?o WHERE {{ VALUES ?r {{ {_RELATIONS} }} ?e ?r ?o }}"
MOST_ROWS: Final = 2000
_FEW: Final = 5
_MOST_PLACES: Final = 40
"""The number of places whose contents are listed for the overview, which shows at most as many."""
_ON_A_PAGE: Final = 60
"""An upper bound of the number of rows on a page of a list."""


def overview(client: Client, _: a.Overview) -> Answer:
    """Return the number of entities per class and place."""

    def read() -> dict[str, Any]:
        entities = client.list()
        where = rows.places_of(client.sparql(_WHERE_ALL, inferred=True, limit=100_000).rows)
        return rows.overview(client.status(), entities, _contents(client, entities, where))

    return _answer(client, read)


def _contents(
    client: Client, entities: Sequence[Entity], where: dict[str, dict[str, list[str]]]
) -> dict[str, Sequence[Entity]]:
    """Return what is in each place, as `list` does: in its parts, too, and where poses put it.

    `where` has the inferred places. If there are very many places, those with few things are as inferred.
    """
    inferred: dict[str, list[Entity]] = {entity.name: [] for entity in entities if entity.place}
    for thing in entities:
        for place in where.get(thing.name, {}).get("in", ()):
            if place in inferred:
                inferred[place].append(thing)
    fullest = sorted(inferred, key=lambda place: -len(inferred[place]))[:_MOST_PLACES]
    found: dict[str, Sequence[Entity]] = {**inferred}
    for place in fullest:
        with suppress(errors.UnknownName):  # removed since the list; a changed map is read again
            found[place] = client.list(in_=place)
    return found


def find(client: Client, arguments: a.Find) -> Answer:
    """Return the entities that a noun phrase describes."""
    found = client.find(
        arguments.text,
        viewer=arguments.viewer,
        viewpoint=arguments.viewpoint,
        asker=arguments.asker,
        answer=arguments.answer,
        as_of=arguments.as_of,
    )
    authors = Authors(client.list(as_of=arguments.as_of))

    def quote(text: str) -> dict[str, str]:
        return attribute_text(text, authors.by(text))

    def candidate(each: Candidate) -> dict[str, Any]:
        return rows.candidate(each, authors.by(each.called, *each.reasons))

    head: dict[str, Any] = {"outcome": found.outcome, "answer": quote(found.text)}
    if arguments.as_of is not None:
        head["as_of"] = arguments.as_of
    if found.question:
        head["question_to_ask_back"] = quote(found.question)
    if found.nearest:
        head["nearest"] = [candidate(each) for each in found.nearest[:_FEW]]
    if found.gone:
        head["gone"] = [quote(text) for text in found.gone[:_FEW]]
    if found.read_as:
        head["read_as"] = dict(found.read_as)
    items = [candidate(each) for each in found.candidates]
    return Answer(first=found.seq, last=found.seq, head=head, items=items, of="candidates")


def understand(client: Client, arguments: a.Understand) -> Answer:
    """Return the steps of a command, with what is not understood and what contradicts the map."""

    def read(as_of: When | None) -> Found:
        if as_of is not None:
            raise errors.Refused("the map has changed since that page; call understand without a cursor")
        return rows.understood(
            client.understand(arguments.text, language=arguments.language), Authors(client.list()).by
        )

    return _paged(client, arguments, None, read, of="steps")


def get(client: Client, arguments: a.Get) -> Answer:
    """Return one entity."""

    def read(as_of: When | None) -> Found:
        return rows.described(client.get(arguments.name, as_of=as_of, where=as_of is None))

    return _paged(client, arguments, arguments.as_of, read, of="facts")


def relations(client: Client, arguments: a.Relations) -> Answer:
    """Return the spatial relations of an entity."""

    def read(as_of: When | None) -> Found:
        found = client.relations(
            arguments.name,
            arguments.other,
            viewer=arguments.viewer,
            viewpoint=arguments.viewpoint,
            as_of=as_of,
        )
        return {"subject": found[0].subject if found else arguments.name}, [rows.relation(r) for r in found]

    return _paged(client, arguments, arguments.as_of, read, of="relations")


def list_(client: Client, arguments: a.List) -> Answer:
    """Return the entities of a class, or at a location."""
    start = read_cursor(arguments.cursor)[1] if arguments.cursor else 0

    def read(as_of: When | None) -> Found:
        if arguments.all and as_of is not None:
            raise errors.Refused(
                "individuals that are not in space are listed for the current map only; call list without"
                " as_of and cursor, or without all"
            )
        found = client.list(
            arguments.class_,
            as_of=as_of,
            on=arguments.on,
            in_=arguments.in_,
            near=arguments.near,
            within=arguments.within,
            nearest=arguments.nearest,
            to=arguments.to,
            all=arguments.all,
        )
        page = found[start : start + _ON_A_PAGE]
        where = placed(client, page) if as_of is None else {}
        return {}, [rows.entity(entity, where.get(entity.name, {})) for entity in found]

    return _paged(client, arguments, arguments.as_of, read, of="entities")


def query(client: Client, arguments: a.Query) -> Answer:
    """Return the result of a SPARQL query."""

    def read(as_of: When | None) -> Found:
        found = client.sparql(
            arguments.query, inferred=arguments.inferred, as_of=as_of, timeout=5.0, limit=MOST_ROWS
        )
        notes = {"notes": list(found.notes)} if found.notes else {}
        if found.kind == "ask":
            return {"answer": found.verdict, **notes}, None
        variables = found.variables if found.kind == "select" else ("subject", "predicate", "object")
        return {"variables": variables, **notes}, [rows.solution(row) for row in found.rows]

    return _paged(client, arguments, arguments.as_of, read, of="rows")


def explain(client: Client, arguments: a.Explain) -> Answer:
    """Explain why a statement holds or, negated, cannot hold."""

    def read(as_of: When | None) -> Found:
        if as_of is not None:
            raise errors.Refused("the map has changed since that page; call explain without a cursor")
        found = client.explain(
            arguments.name, arguments.predicate, arguments.value, negated=arguments.negated
        )
        because: dict[str, Any] = {"because": attribute_text(found.text, "the reasoner")}
        return because | _asserted(found), _proof(found)

    return _paged(client, arguments, None, read, of="steps")


def could(client: Client, arguments: a.Could) -> Answer:
    """Return whether a statement would be consistent with the map, with the proof if it is not."""

    def read(as_of: When | None) -> Found:
        if as_of is not None:
            raise errors.Refused("the map has changed since that page; call could without a cursor")
        found = client.could(arguments.name, arguments.predicate, arguments.value)
        head = {"possible": found.possible, "answer": attribute_text(found.text, "the reasoner")}
        if found.explanation is None:
            return head, None
        return head | _asserted(found.explanation), _proof(found.explanation)

    return _paged(client, arguments, None, read, of="steps")


def route(client: Client, arguments: a.FindWay) -> Answer:
    """Return the shortest path between two places, things or positions, and its corners."""

    def read(as_of: When | None) -> Found:
        found = client.route(arguments.from_, arguments.to, radius=arguments.radius, as_of=as_of)
        head = {
            "answer": attribute_text(found.text, "semmap"),
            "metres": round(found.metres, 2),
            "places": found.places,
            "doors": found.doors,
            **({"closed": found.closed} if found.closed else {}),
            **({"notes": attribute_text("; ".join(found.notes), "semmap")} if found.notes else {}),
        }
        return head, [round_metres(point) for point in found.points]

    return _paged(client, arguments, arguments.as_of, read, of="points")


def history(client: Client, arguments: a.History) -> Answer:
    """Return the newest commits, in order."""

    def read(as_of: When | None) -> Found:
        found = client.history(
            arguments.name,
            since=arguments.since,
            until=as_of if arguments.until is None else arguments.until,
            limit=arguments.limit,
            by=arguments.by,
            in_=arguments.in_,
            on=arguments.on,
        )
        return {}, [rows.commit(commit) for commit in found]

    return _paged(client, arguments, None, read, of="commits")


def diff(client: Client, arguments: a.Diff) -> Answer:
    """Return the changes between two commits or times."""

    def read(as_of: When | None) -> Found:
        found = client.diff(
            arguments.since,
            as_of if arguments.until is None else arguments.until,
            on=arguments.on,
            in_=arguments.in_,
        )
        return {"since": found.first, "until": found.last}, list(rows.difference(found))

    return _paged(client, arguments, None, read, of="changes")


def when_(client: Client, arguments: a.WasWhen) -> Answer:
    """Return when one entity was on, inside, in or attached to another."""

    def read(_: When | None) -> Found:
        found = client.when(arguments.name, arguments.relation, arguments.other)
        spells = [
            {
                "since": spell.since,
                "from": format_time(spell.since_ns) if spell.since else "before the history begins",
                **(
                    {"until": spell.until, "to": format_time(spell.until_ns)}
                    if spell.until is not None and spell.until_ns is not None
                    else {"until": "now"}
                ),
            }
            for spell in found.spells
        ]
        return {"answer": found.text, "total_s": round(found.total_s, 1)}, spells

    return _paged(client, arguments, None, read, of="spells")


def trail(client: Client, arguments: a.FindTrail) -> Answer:
    """Return when live entities entered and left places, and their last position in the period."""

    def read(_: When | None) -> Found:
        found = client.trail(
            arguments.name,
            since=arguments.since,
            until=arguments.until,
            at=arguments.at,
            in_=arguments.in_,
            limit=MOST_ROWS,
            points=_FEW,
        )
        visits = [
            {
                "name": visit.name,
                "place": visit.place,
                "from": format_time(visit.since_ns),
                "to": "now" if visit.until_ns is None else format_time(visit.until_ns),
            }
            for visit in reversed(found.visits)
        ]
        last = [
            {"name": p.name, "time": format_time(p.ns), "at": p.at, "places": p.places}
            for p in found.track[-1:]
        ]
        head = {"answer": found.text, "stored_since": format_time(found.kept_since_ns), "last_position": last}
        return head, visits if arguments.at is None else []

    return _paged(client, arguments, None, read, of="visits")


def last_seen(client: Client, arguments: a.LastSeen) -> Answer:
    """Return where and when an entity was last seen or placed, also if it was removed."""

    def read() -> dict[str, Any]:
        found = client.last_seen(arguments.name)
        position = {} if found.pose is None else {"position": found.pose.position_m}
        seen = {} if found.seen_ns is None else {"last_observed": format_time(found.seen_ns)}
        status = {"removed": True} if found.removed is not None else {}
        return {"name": found.name, "answer": found.text, **position, **seen, **status}

    return _answer(client, read)


def render_picture(client: Client, arguments: a.Picture) -> tuple[Answer, bytes]:
    """Return an image of the scene (PNG) with its caption."""
    png, first, last = _now(
        client,
        lambda: client.picture(
            place=arguments.place, labels=True, width=arguments.width, height=arguments.height
        ),
    )
    head = {"picture": "the scene as it is simulated", "of": arguments.place or "everything"}
    return Answer(first=first, last=last, head=head), png


def _asserted(found: Explanation) -> dict[str, Any]:
    return {"asserted": {"said": [v.to_words(triple) for triple in found.support]}}


def _proof(found: Explanation) -> list[dict[str, Any]]:
    """Return the steps of a proof."""
    return [
        {
            "rule": step.rule,
            "from": {"said": [v.to_words(triple) for triple in step.premises]},
            "follows": {
                "said": "a contradiction" if step.conclusion is None else v.to_words(step.conclusion)
            },
        }
        for step in found.steps
    ]


def _answer(client: Client, read: Callable[[], dict[str, Any]]) -> Answer:
    """Return a reply without pages."""
    head, first, last = _now(client, read)
    return Answer(first=first, last=last, head=head)


def _paged(
    client: Client,
    arguments: a.Paged,
    as_of: When | None,
    read: Callable[[When | None], Found],
    *,
    of: str,
) -> Answer:
    """Return a reply in pages. Later pages refer to the commit of the first page."""
    wanted = None if arguments.cursor is None else read_cursor(arguments.cursor)[0]
    (head, items), first, last = _now(client, partial(read, as_of))
    if wanted is not None and not first == last == wanted:
        (head, items), first, last = read(wanted if as_of is None else as_of), wanted, wanted
    if as_of is not None:
        head = {"as_of": as_of, **head}
    return Answer(first=first, last=last, head=head, items=items, of=of)


def _now(client: Client, read: Callable[[], R]) -> tuple[R, int, int]:
    return read_at_one_commit(partial(known, client), partial(newest, client), read)


def placed(client: Client, entities: Sequence[Entity]) -> dict[str, dict[str, list[str]]]:
    """Return what these entities are on, inside and in."""
    if not entities:
        return {}
    values = " ".join(f"<{entity.iri}>" for entity in entities)
    query = f"SELECT ?e ?r ?o WHERE {{ VALUES ?e {{ {values} }} VALUES ?r {{ {_RELATIONS} }} ?e ?r ?o }}"
    return rows.places_of(client.sparql(query, inferred=True).rows)
