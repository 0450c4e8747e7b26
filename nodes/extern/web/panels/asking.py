"""What the details of one thing are made of, asked for at once: as it is now, or as it was."""

from __future__ import annotations

import asyncio
from typing import Any, NamedTuple

from semmap.nodes.extern.web.knowing import Knowing
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.views.facts import Facts, facts, followed
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Command, History, Infer, LastSeen, Relations, Sparql, Tell
from semmap.schemas.entities import Entity
from semmap.schemas.relations import Relation
from semmap.schemas.replies import LoggedCommit

_WORDS = 120
_COMMITS = 100
_PATIENCE_S = 60.0
"""For what followed in the past: the knowledge base works it out again, in a process of its own."""
_QUERY_S = 30.0


class Asked(NamedTuple):
    """What was answered about one thing; empty where that was not."""

    told: str
    facts: Facts
    commits: tuple[LoggedCommit, ...]
    last_seen: str
    relations: tuple[Relation, ...]
    problems: tuple[str, ...]
    """What was not answered, and why, a sentence each."""


async def ask(page: Page, knowing: Knowing, entity: Entity) -> Asked:
    """Ask about a thing at the moment that the page shows; of the past, all but what followed then."""
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
    relations, commits, told, seen, inferred = await asyncio.gather(
        answer(Relations(name=name, as_of=commit)),
        answer(History(name=name, until=commit, limit=_COMMITS)),
        answer(Tell(name=name, words=_WORDS) if is_now else None),
        answer(LastSeen(name=name) if is_now else None),
        answer(Infer(name=name) if is_now else None),
    )
    follows = () if inferred is None else inferred.triples
    relations = tuple(relations or ())
    return Asked(
        told="" if told is None else told.text,
        facts=facts(entity, knowing.properties, follows, relations, knowing.words),
        commits=commits or (),
        last_seen="" if seen is None else seen.text,
        relations=relations,
        problems=tuple(dict.fromkeys(problems)),
    )


async def with_what_followed(
    page: Page, knowing: Knowing, entity: Entity, asked: Asked, commit: int
) -> Asked:
    """The same with what followed after a commit of the past. Raises SemmapError."""
    iri = v.iri(entity.iri)
    query = f"SELECT ?p ?o {{ {iri} ?p ?o }}"
    held = await page.live.ask(
        Sparql(query=query, inferred=True, as_of=commit, timeout=_QUERY_S), _PATIENCE_S
    )
    triples = [(iri, p, o) for p, o in held.rows if p is not None and o is not None]
    follows = followed(entity, triples)
    return asked._replace(facts=facts(entity, knowing.properties, follows, asked.relations, knowing.words))
