"""One open tab: what is selected in it, which moment it shows, and the ways to ask and to change.

Panels draw from `page.state` and never from `page.live`: they show the past as they show the present.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Awaitable, Callable, Coroutine, Iterable, Iterator, Mapping
from typing import Any, Literal, TypeVar

from nicegui import Client, background_tasks

from semmap.nodes.extern.web.differences import Difference, differences
from semmap.nodes.extern.web.live import Happening, Live
from semmap.nodes.extern.web.moments import NOW, Moment, Past, State
from semmap.nodes.extern.web.notices import Notices, Tone
from semmap.nodes.extern.web.tape import tape_of
from semmap.nodes.extern.web.views.sentences import in_the_page
from semmap.schemas import errors
from semmap.schemas.commands import Command
from semmap.schemas.relations import ViewPoint

log = logging.getLogger(__name__)

R = TypeVar("R")
Compared = Literal["before", "now", ""]
"""With what a moment of the past is compared: the map before its commit, as it is now, or nothing."""

Place = tuple[float, float, float, float]
"""x, y, z [m] and yaw [rad], map frame."""


class Page:
    """One open tab. It belongs to the event loop, and ends with the tab."""

    def __init__(self, live: Live, client: Client) -> None:
        self.live = live
        self.id = client.id
        """Unique among the open tabs: the scene's frame is at `/scene/<id>/`."""
        self.client = client
        self.selected: tuple[str, ...] = ()
        self.moment = NOW
        self.state: State = live
        self.compared: Compared = "before"
        self.differences: Mapping[str, Difference] = {}
        """How the moment shown differs from what it is compared with, by name; now there are none."""
        self.dark = False
        self.narrow = False
        self.is_seen = False
        """The browser has said how it looks."""
        self.refuse: Callable[[Command[Any], errors.SemmapError], None] | None = None
        """Shows why a change was refused; set by the layout."""
        self.watch: Callable[[str, bool], object] | None = None
        """Watches a query, with what follows or without; set by the panel of standing queries."""
        self.widen: Callable[[bool], object] | None = None
        """Makes room for a wide table among the lists, or no more; set by the layout."""
        self.draw_scene: Callable[[], None] | None = None
        """Draws the scene with its switches where it is called, once; set by the scene."""
        self.pick: Callable[[], Awaitable[Place | None]] | None = None
        """Lets a person point at a place; set by the scene."""
        self.break_off: Callable[[], bool] | None = None
        """Ends pointing or dragging in the scene, and tells whether there was any; set by the scene."""
        self.look: Callable[[], ViewPoint | None] | None = None
        """Whence the scene is seen; set by the scene."""
        self._notices = Notices()
        self._on_select: list[Callable[[], None]] = []
        self._on_moment: list[Callable[[], None]] = []
        self._on_change: list[Callable[[], None]] = []
        self._on_connection: list[Callable[[], None]] = []
        self._on_turn: list[Callable[[], None]] = []
        self._on_poses: list[Callable[[tuple[str, ...]], None]] = []
        self._on_look: list[Callable[[], None]] = []
        self._on_key: dict[str, Callable[[], object]] = {}
        self._asked_for = 0
        self.pending = 0
        """How much is under way for this tab: what is asked for and not shown yet."""
        self._on_pending: list[Callable[[], None]] = []
        self._is_idle = asyncio.Event()
        self._is_idle.set()
        self.tape = tape_of(live)
        """The past of the map, for all tabs."""
        self._stop = live.listen(self._on_happening)
        client.on_delete(self.close)

    def close(self) -> None:
        """The tab is gone."""
        self._stop()
        for functions in (
            self._on_select,
            self._on_moment,
            self._on_change,
            self._on_connection,
            self._on_turn,
            self._on_look,
            self._on_pending,
        ):
            functions.clear()
        self._on_poses.clear()
        self._on_key.clear()

    # What is selected

    def select(self, names: Iterable[str], by: str = "") -> None:
        """Select these entities, and nothing else; `by` says who did, for whoever must not answer himself."""
        chosen = tuple(dict.fromkeys(names))
        if chosen == self.selected:
            return
        self.selected, self.selected_by = chosen, by
        self._tell(self._on_select)

    selected_by = ""

    def on_select(self, function: Callable[[], None]) -> None:
        """Call it when something else is selected."""
        self._on_select.append(function)

    # Where a person points, and whence he looks

    async def pick_place(self) -> Place | None:
        """The place that a person clicks at in the scene next; None for none, as when there is no scene."""
        return None if self.pick is None else await self.pick()

    def escape(self) -> None:
        """Leave what is half done in the scene; where nothing is, select nothing."""
        if self.break_off is None or not self.break_off():
            self.select(())

    @property
    def viewpoint(self) -> ViewPoint | None:
        """Whence the scene is seen, for commands that tell left from right; None without a scene."""
        return None if self.look is None else self.look()

    # The moment

    def go_to(self, commit: int | None) -> None:
        """Show the map after this commit, or, with None, as it is now."""
        self._asked_for += 1
        if commit is None:
            self._show(NOW, self.live)
        else:
            self.later(self.arrive(commit))

    async def arrive(self, commit: int) -> bool:
        """Show the map after this commit; whether it is shown now, and nobody went elsewhere meanwhile."""
        self._asked_for += 1
        number = self._asked_for
        try:
            past = await self.tape.past(commit)
            found = await self._compare(past)
        except errors.SemmapError as error:
            self.tell(error.text, "negative")
            return False
        if number != self._asked_for:
            return False
        self._show(Moment(commit), past, found)
        return True

    def compare(self, with_what: Compared) -> None:
        """Mark how a moment of the past differs from the one before, from now, or not at all."""
        self.compared = with_what
        if self.moment.commit is not None:
            self.go_to(self.moment.commit)

    async def _compare(self, past: Past) -> Mapping[str, Difference]:
        if self.compared == "now":
            return differences(past.entities, self.live.entities)
        if self.compared == "before" and past.commit > self.tape.first:
            before = await self.tape.past(past.commit - 1)
            return differences(before.entities, past.entities)
        return {}

    def _show(self, moment: Moment, state: State, found: Mapping[str, Difference] | None = None) -> None:
        was = self.moment
        self.moment, self.state, self.differences = moment, state, found or {}
        if moment != was:
            self._tell(self._on_moment)
        self._changed()

    def on_moment(self, function: Callable[[], None]) -> None:
        """Call it when another moment is shown."""
        self._on_moment.append(function)

    # What changes by itself

    def on_change(self, function: Callable[[], None]) -> None:
        """Call it when the state shown has changed: by a commit while it is now, or with the moment."""
        self._on_change.append(function)

    def on_poses(self, function: Callable[[tuple[str, ...]], None]) -> None:
        """Call it with the names of bodies that have moved, while it is now; ten times a second at most."""
        self._on_poses.append(function)

    def on_connection(self, function: Callable[[], None]) -> None:
        """Call it when the knowledge base has gone or come back."""
        self._on_connection.append(function)

    # The browser

    def looks(self, *, dark: bool, narrow: bool) -> None:
        """The browser says whether it shows the page dark, and whether it is as narrow as a phone."""
        self.dark, self.narrow, self.is_seen = dark, narrow, True
        self._tell(self._on_look)

    def on_look(self, function: Callable[[], None]) -> None:
        """Call it when `dark` or `narrow` has changed, and when they are known first."""
        self._on_look.append(function)

    def on_key(self, key: str, function: Callable[[], object]) -> None:
        """Call it when this key is pressed outside of what is written in; one function a key."""
        self._on_key[key] = function

    def press(self, key: str) -> None:
        """A key was pressed."""
        if (function := self._on_key.get(key)) is not None:
            self._tell([function])

    def _on_happening(self, happening: Happening) -> None:
        if happening.kind == "connection":
            self._tell(self._on_connection)
        elif happening.kind == "begun":
            if happening.anew:
                self.tell("Another map is behind this address now: the page has begun anew.", "warning")
                self.select(())
                self.go_to(None)
            elif self.moment.is_now:
                self._changed()
        elif happening.kind == "commit" and self.compared == "now" and isinstance(self.state, Past):
            self.differences = differences(self.state.entities, self.live.entities)
            self._changed()
        elif self.moment.is_now and happening.kind in ("commit", "scene"):
            self._changed()
        elif self.moment.is_now and happening.kind == "poses":
            self._tell(self._on_poses, happening.names)

    def _changed(self) -> None:
        gone = [name for name in self.selected if name not in self.state.entities]
        if gone and self.moment.is_now:
            self.select(name for name in self.selected if name in self.state.entities)
        self._tell(self._on_change)

    def _tell(self, functions: Iterable[Callable[..., object]], *arguments: Any) -> None:
        """One panel that fails does not keep the others from being told."""
        for function in tuple(functions):
            try:
                with self.client:
                    function(*arguments)
            except Exception:
                log.exception("a panel of the page has failed")

    def on_turn(self, function: Callable[[], None]) -> None:
        """Call it when another panel has come into view."""
        self._on_turn.append(function)

    def turned(self) -> None:
        """Tell that another panel has come into view."""
        self._tell(self._on_turn)

    # Asking and changing

    async def ask(self, command: Command[R], timeout_s: float = 10.0) -> R | None:
        """The reply; None where there is none, and then the reason is shown."""
        try:
            with self.under_way():
                return await self.live.ask(command, timeout_s)
        except errors.SemmapError as error:
            self.tell(error.text, "negative")
            return None

    async def change(self, command: Command[R], timeout_s: float = 60.0) -> R | None:
        """Send a change; None where it was refused, and then it is shown why and what would mend it."""
        if not self.moment.is_now:
            self.tell("This is the past, which does not change; go back to now first (Home).", "warning")
            return None
        try:
            with self.under_way():
                return await self.live.ask(command, timeout_s)
        except errors.SemmapError as error:
            if self.refuse is not None and not isinstance(error, errors.NoAnswer):
                with self.client:
                    self.refuse(command, error)
            else:
                self.tell(error.text, "negative")
            return None

    def may(self, verb: str) -> bool:
        """May whoever this page acts for ask for this command?"""
        return self.live.may(verb)

    def tell(self, text: str, kind: Tone = "info") -> None:
        """Show a sentence for some seconds, as text."""
        with self.client:
            self._notices.tell(in_the_page(text), kind)

    def later(self, coroutine: Coroutine[Any, Any, Any]) -> asyncio.Task[Any]:
        """Let it run beside what is being drawn, in this tab."""

        async def inside() -> Any:
            with self.client, self.under_way():
                return await coroutine

        return background_tasks.create(inside(), name="page")

    # What is under way

    @contextlib.contextmanager
    def under_way(self) -> Iterator[None]:
        """What goes on inside is not shown yet."""
        self._count(1)
        try:
            yield
        finally:
            self._count(-1)

    def _count(self, more: int) -> None:
        self.pending += more
        if self.pending:
            self._is_idle.clear()
        else:
            self._is_idle.set()
        if not self.client.is_deleted:
            self._tell(self._on_pending)

    def on_pending(self, function: Callable[[], None]) -> None:
        """Call it when `pending` has changed."""
        self._on_pending.append(function)

    async def settled(self) -> None:
        """Wait until nothing is under way."""
        await self._is_idle.wait()
