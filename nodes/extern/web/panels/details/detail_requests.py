"""The requests for the details of one entity, now or in the past."""

from __future__ import annotations

import asyncio
from typing import Any, NamedTuple

from semmap.nodes.extern.web.knowledge_cache import KnowledgeCache
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.views.entities.facts import Facts, exclude_asserted, group_facts
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Command, History, Infer, LastSeen, Relations, Sparql, Tell
from semmap.schemas.entities import Entity
from semmap.schemas.relations import Relation
from semmap.schemas.replies import LoggedCommit

_WORDS = 120
_COMMITS = 100
_TIMEOUT_S = 60.0
"""Timeout for past inferences, which the knowledge base computes in another process."""
_QUERY_S = 30.0


class Details(NamedTuple):
    """The replies about one entity; empty where a request failed."""

    description: str
    facts: Facts
    commits: tuple[LoggedCommit, ...]
    last_seen: str
    relations: tuple[Relation, ...]
    problems: tuple[str, ...]
    """The errors of failed requests."""


async def fetch_details(page: Page, knowledge: KnowledgeCache, entity: Entity) -> Details:
    """Request the details of an entity at the moment shown.

    For the past they do not include inferred facts.
    """
    commit, name = page.moment.commit, entity.name
    problems: list[str] = []

    async def send(command: Command[Any] | None) -> Any:
        """Return the reply; None for no command, or on an error."""
        try:
            return None if command is None else await page.live.ask(command)
        except errors.SemmapError as error:
            problems.append(error.text)
            return None

    is_now = commit is None
    relations, commits, description, seen, inferred = await asyncio.gather(
        send(Relations(name=name, as_of=commit)),
        send(History(name=name, until=commit, limit=_COMMITS)),
        send(Tell(name=name, words=_WORDS) if is_now else None),
        send(LastSeen(name=name) if is_now else None),
        send(Infer(name=name) if is_now else None),
    )
    follows = () if inferred is None else inferred.triples
    relations = tuple(relations or ())
    return Details(
        description="" if description is None else description.text,
        facts=group_facts(entity, knowledge.properties, follows, relations, knowledge.words),
        commits=commits or (),
        last_seen="" if seen is None else seen.text,
        relations=relations,
        problems=tuple(dict.fromkeys(problems)),
    )


async def add_past_inferences(
    page: Page, knowledge: KnowledgeCache, entity: Entity, details: Details, commit: int
) -> Details:
    """Return the details with the facts that were inferred after a commit. Raises SemmapError."""
    iri = v.iri(entity.iri)
    query = f"SELECT ?p ?o {{ {iri} ?p ?o }}"
    found = await page.live.ask(
        Sparql(query=query, inferred=True, as_of=commit, timeout=_QUERY_S), _TIMEOUT_S
    )
    triples = [(iri, p, o) for p, o in found.rows if p is not None and o is not None]
    follows = exclude_asserted(entity, triples)
    return details._replace(
        facts=group_facts(entity, knowledge.properties, follows, details.relations, knowledge.words)
    )
