"""Locations of entities and labels of the ontology, cached for all tabs.

They are read once and then updated by commits. The cache belongs to the event loop.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable
from typing import Final
from weakref import WeakKeyDictionary

from semmap.nodes.extern.web.differences import find_changed_bodies
from semmap.nodes.extern.web.live import Live, LiveEvent
from semmap.nodes.extern.web.views.entities.locations import QUERY, Locations
from semmap.nodes.extern.web.views.proof_lines import words_of
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.schemas import errors
from semmap.schemas.commands import Properties, Sparql
from semmap.schemas.commits import Commit
from semmap.schemas.entities import PropertyInfo
from semmap.schemas.moments import When

log = logging.getLogger(__name__)

_AGAIN_S: Final = 2.0
_ROWS: Final = 100_000
_QUERY_S: Final = 30.0

Listener = Callable[[frozenset[str] | None], None]
"""Receives the names of entities that changed, or whose body did; None if any may have changed."""

_CACHES: WeakKeyDictionary[Live, KnowledgeCache] = WeakKeyDictionary()


class KnowledgeCache:
    """The cache; `KnowledgeCache.of(live)` returns the one of the process."""

    def __init__(self, live: Live) -> None:
        self.locations = Locations()
        """The locations at the current commit of `live`."""
        self.properties: dict[str, PropertyInfo] = {}
        self.words: Words = words_of((), ())
        """Labels of classes and properties for sentences."""
        self.ontology_version = 0
        """Another number after each change of classes, properties and axioms, also those in the map."""
        self._live = live
        self._scene = live.scene
        self._listeners: list[Listener] = []
        self._since: list[Commit] | None = None
        """The commits received while the locations are being read; None otherwise."""
        self._again = False
        self._task: asyncio.Task[None] | None = None
        """It belongs to no tab, so it is not cancelled when one is closed."""
        live.listen(self._on_event)
        if live.commit >= 0:
            self._read()

    @classmethod
    def of(cls, live: Live) -> KnowledgeCache:
        """Return the cache of this process."""
        if (known := _CACHES.get(live)) is None:
            known = _CACHES[live] = cls(live)
        return known

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Call `listener` after each change, when the cache is up to date.

        Return a function that stops this.
        """
        self._listeners.append(listener)

        def stop() -> None:
            with contextlib.suppress(ValueError):
                self._listeners.remove(listener)

        return stop

    async def locations_at(self, moment: When) -> Locations:
        """Request the locations after a commit. Raises SemmapError."""
        found = Locations()
        query = Sparql(query=QUERY, inferred=True, as_of=moment, limit=_ROWS, timeout=_QUERY_S)
        found.reset((await self._live.ask(query, _QUERY_S)).rows)
        return found

    def _on_event(self, event: LiveEvent) -> None:
        if event.kind == "reset":
            self.ontology_version += 1
            self._read()
            self._notify(None)
        elif event.kind == "commit":
            self._apply(event.commits)
        elif event.kind == "scene":
            before, self._scene = self._scene, self._live.scene
            names = find_changed_bodies(before, self._scene)
            if names is None or names:
                self._notify(names)

    def _apply(self, commits: tuple[Commit, ...]) -> None:
        if self._since is not None:
            self._since.extend(commits)
        if any(map(_changes_ontology, commits)):
            self.ontology_version += 1
        if any(commit.tbox or commit.abridged is not None for commit in commits):
            self._read()
            self._notify(None)
            return
        changed: set[str] = set()
        for commit in commits:
            changed |= self.locations.apply(commit)
            changed.update(commit.names)
        self._notify(frozenset(changed))

    def _read(self) -> None:
        if self._since is not None:
            self._again = True
            return
        self._since = []
        self._task = asyncio.get_running_loop().create_task(self._fetch(), name="read locations")

    async def _fetch(self) -> None:
        live = self._live
        try:
            properties = await live.ask(Properties())
            query = Sparql(query=QUERY, inferred=True, limit=_ROWS, timeout=_QUERY_S)
            found = await live.ask(query, _QUERY_S)
        except errors.SemmapError as error:
            log.info("cannot read the locations of entities: %s", error.text)
            await asyncio.sleep(_AGAIN_S)
            self._since = None
            self._read()
            return
        self.properties = {p.name: p for p in properties}
        self.words = words_of(live.classes, properties)
        self.locations.reset(found.rows)
        for commit in self._since or ():
            if commit.seq > found.seq:
                self.locations.apply(commit)
        self._since = None
        self._notify(None)
        if self._again:
            self._again = False
            self._read()

    def _notify(self, names: frozenset[str] | None) -> None:
        for listener in tuple(self._listeners):
            listener(names)


def _changes_ontology(commit: Commit) -> bool:
    """Return whether a commit changes axioms; an abridged one may do so."""
    if commit.tbox or commit.abridged is not None:
        return True
    return any(map(is_schema, commit.inserted)) or any(map(is_schema, commit.retracted))
