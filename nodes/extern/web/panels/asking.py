"""What the details of one thing are made of, asked for at once: as it is now, or as it was."""

from __future__ import annotations

import asyncio
from typing import Any, NamedTuple

from nodes.extern.web.knowing import Knowing
from nodes.extern.web.page import Page
from nodes.extern.web.views.facts import Facts, facts
from ontology import vocabulary as v
from schemas import errors
from schemas.commands import Command, History, Infer, LastSeen, Relations, Sparql, Tell
from schemas.entities import Entity
from schemas.explanations import Triple
from schemas.replies import LoggedCommit

_WORDS = 120
_COMMITS = 100


class Asked(NamedTuple):
    """What was answered about one thing; empty where that was not."""

    told: str
    facts: Facts
    commits: tuple[LoggedCommit, ...]
    last_seen: str
    problems: tuple[str, ...]
    """What was not answered, and why, a sentence each."""


async def ask(page: Page, knowing: Knowing, entity: Entity) -> Asked:
    """Ask everything about a thing, of the moment that the page shows."""
    commit, name = page.moment.commit, entity.name
    problems: list[str] = []

    async def answer(command: Command[Any] | None) -> Any:
        """The reply; None for none."""
        try:
            return None if command is None else await page.live.ask(command)
        except errors.SemmapError as error:
            problems.append(error.text)
            return None

    is_now = commit is None
    relations, commits, told, seen, follows = await asyncio.gather(
        answer(Relations(name=name, as_of=commit)),
        answer(History(name=name, until=commit, limit=_COMMITS)),
        answer(Tell(name=name, words=_WORDS) if is_now else None),
        answer(LastSeen(name=name) if is_now else None),
        _follows(answer, entity, commit),
    )
    return Asked(
        told="" if told is None else told.text,
        facts=facts(entity, knowing.properties, follows, relations or (), knowing.words),
        commits=commits or (),
        last_seen="" if seen is None else seen.text,
        problems=tuple(dict.fromkeys(problems)),
    )


async def _follows(answer: Any, entity: Entity, commit: int | None) -> tuple[Triple, ...]:
    """What follows about it; of the past, all that held and was not asserted."""
    if commit is None:
        inferred = await answer(Infer(name=entity.name))
        return () if inferred is None else tuple(inferred.triples)
    iri = v.iri(entity.iri)
    query = f"SELECT ?p ?o {{ {iri} ?p ?o }}"
    held = await answer(Sparql(query=query, inferred=True, as_of=commit))
    said = await answer(Sparql(query=query, as_of=commit))
    if held is None or said is None:
        return ()
    asserted = set(said.rows)
    return tuple((iri, *row) for row in held.rows if row not in asserted and None not in row)
