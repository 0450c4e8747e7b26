"""The requests for a class: its axioms, its users, and whether an entity of it can be added."""

from __future__ import annotations

from typing import Final, NamedTuple

from semmap.nodes.extern.web.knowledge_cache import KnowledgeCache
from semmap.nodes.extern.web.live import Live
from semmap.nodes.extern.web.views.class_details import axioms_query, users_query
from semmap.schemas import errors
from semmap.schemas.commands import Add, Sparql
from semmap.schemas.entities import ClassInfo
from semmap.schemas.explanations import Triple

_TIMEOUT_S: Final = 20.0


class ClassReport(NamedTuple):
    """The replies about a class; empty where a request failed."""

    axioms: tuple[Triple, ...] = ()
    users: tuple[tuple[str | None, ...], ...] = ()
    """The rows of the classes whose axioms mention it."""
    clash: errors.Inconsistent | None = None
    """Why an entity of it would make the map inconsistent; None if it would not, or was not tried."""
    commit: int = -1
    """The last commit before that was tried."""
    problem: errors.SemmapError | None = None
    """Why a request failed."""


class ClassRequests:
    """The report on the class that is shown in a tab.

    The requests take long for a large ontology, so they are sent again only for another class or after a
    change of the ontology, and not after a change of the map.
    """

    def __init__(self, live: Live, knowledge: KnowledgeCache) -> None:
        self._live, self._knowledge = live, knowledge
        self._key: tuple[str, int] | None = None
        self._report = ClassReport()

    async def fetch(self, known: ClassInfo) -> ClassReport:
        """Return the report on a class; its `problem` is set if a request failed."""
        key = known.iri, self._knowledge.ontology_version
        if key != self._key:
            report = await self._ask(known)
            may_differ_later = isinstance(
                report.problem, errors.NoAnswer | errors.Busy | errors.InternalError
            )
            self._key, self._report = None if may_differ_later else key, report
        return self._report

    async def _ask(self, known: ClassInfo) -> ClassReport:
        report = ClassReport(commit=self._live.commit)
        try:
            found = await self._query(axioms_query(known.iri))
            axioms = tuple((row[0] or "", row[1] or "", row[2] or "") for row in found)
            report = report._replace(axioms=axioms, users=await self._query(users_query(known.iri)))
            return report._replace(clash=await self._find_clash(known))
        except errors.SemmapError as error:
            return report._replace(problem=error)

    async def _query(self, query: str) -> tuple[tuple[str | None, ...], ...]:
        return (await self._live.ask(Sparql(query=query, timeout=_TIMEOUT_S), _TIMEOUT_S)).rows

    async def _find_clash(self, known: ClassInfo) -> errors.Inconsistent | None:
        """Return why the map would be inconsistent with another entity of the class, by a dry run."""
        if not known.spatial or not self._live.is_allowed("add"):
            return None
        try:
            await self._live.ask(Add(class_=known.name, dry_run=True))
        except errors.Inconsistent as clash:
            return clash
        except (errors.Refused, errors.BadRequest):
            return None  # for example, no free place
        return None
