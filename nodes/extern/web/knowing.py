"""What the page knows beyond the entities themselves: where they are, and what properties are called.

It is read once for all tabs, and kept up to date by the commits. Owned by the event loop.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable
from typing import Final
from weakref import WeakKeyDictionary

from semmap.nodes.extern.web.differences import bodies_otherwise
from semmap.nodes.extern.web.live import Happening, Live
from semmap.nodes.extern.web.views.steps import words_of
from semmap.nodes.extern.web.views.whereabouts import QUERY, Whereabouts
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.schemas import errors
from semmap.schemas.commands import Properties, Sparql
from semmap.schemas.commits import Commit
from semmap.schemas.entities import PropertyInfo
from semmap.schemas.moments import When

log = logging.getLogger(__name__)

_AGAIN_S: Final = 2.0
_ROWS: Final = 100_000
_QUERY_S: Final = 30.0

Told = Callable[[frozenset[str] | None], None]
"""Is given the names of what a commit touched, or whose body has changed; None for possibly everything."""

_KNOWING: WeakKeyDictionary[Live, Knowing] = WeakKeyDictionary()


class Knowing:
    """One for the process: use `Knowing.of(live)`."""

    def __init__(self, live: Live) -> None:
        self.whereabouts = Whereabouts()
        """As of the commit that `live` is at."""
        self.properties: dict[str, PropertyInfo] = {}
        self.words: Words = words_of((), ())
        """What classes and properties are called in a sentence."""
        self._live = live
        self._scene = live.scene
        self._told: list[Told] = []
        self._since: list[Commit] | None = None
        """The commits that came while the whereabouts are being read; None while they are not."""
        self._again = False
        self._task: asyncio.Task[None] | None = None
        """It belongs to no tab, so that none takes it along when it is closed."""
        live.listen(self._on_happening)
        if live.commit >= 0:
            self._read()

    @classmethod
    def of(cls, live: Live) -> Knowing:
        """That of this process."""
        if (known := _KNOWING.get(live)) is None:
            known = _KNOWING[live] = cls(live)
        return known

    def listen(self, told: Told) -> Callable[[], None]:
        """Call `told` after each change of the map, when all that is here is so; the answer ends that."""
        self._told.append(told)

        def stop() -> None:
            with contextlib.suppress(ValueError):
                self._told.remove(told)

        return stop

    async def at(self, moment: When) -> Whereabouts:
        """What everything was on and in after a commit. Raises SemmapError."""
        found = Whereabouts()
        query = Sparql(query=QUERY, inferred=True, as_of=moment, limit=_ROWS, timeout=_QUERY_S)
        found.begin((await self._live.ask(query, _QUERY_S)).rows)
        return found

    def _on_happening(self, happening: Happening) -> None:
        if happening.kind == "begun":
            self._read()
            self._tell(None)
        elif happening.kind == "commit":
            self._take(happening.commits)
        elif happening.kind == "scene":
            before, self._scene = self._scene, self._live.scene
            names = bodies_otherwise(before, self._scene)
            if names is None or names:
                self._tell(names)

    def _take(self, commits: tuple[Commit, ...]) -> None:
        if self._since is not None:
            self._since.extend(commits)
        if any(commit.tbox or commit.abridged is not None for commit in commits):
            self._read()
            self._tell(None)
            return
        touched: set[str] = set()
        for commit in commits:
            touched |= self.whereabouts.take(commit)
            touched.update(commit.names)
        self._tell(frozenset(touched))

    def _read(self) -> None:
        if self._since is not None:
            self._again = True
            return
        self._since = []
        self._task = asyncio.get_running_loop().create_task(self._fetch(), name="whereabouts")

    async def _fetch(self) -> None:
        live = self._live
        try:
            properties = await live.ask(Properties())
            query = Sparql(query=QUERY, inferred=True, limit=_ROWS, timeout=_QUERY_S)
            found = await live.ask(query, _QUERY_S)
        except errors.SemmapError as error:
            log.info("where things are could not be read: %s", error.text)
            await asyncio.sleep(_AGAIN_S)
            self._since = None
            self._read()
            return
        self.properties = {p.name: p for p in properties}
        self.words = words_of(live.classes, properties)
        self.whereabouts.begin(found.rows)
        for commit in self._since or ():
            if commit.seq > found.seq:
                self.whereabouts.take(commit)
        self._since = None
        self._tell(None)
        if self._again:
            self._again = False
            self._read()

    def _tell(self, names: frozenset[str] | None) -> None:
        for told in tuple(self._told):
            told(names)
