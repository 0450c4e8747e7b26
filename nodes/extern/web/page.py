"""One open tab: what is selected in it, which moment it shows, and the ways to ask and to change.

Panels draw from `page.state` and never from `page.live`: they show the past as they show the present.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Coroutine, Iterable, Mapping
from typing import Any, Final, Literal, Protocol, TypeVar

from msgspec import Struct
from nicegui import Client, background_tasks, ui

from nodes.extern.web.live import Happening, Live
from schemas import errors
from schemas.commands import Command, List
from schemas.entities import Entity, Pose
from schemas.relations import ViewPoint

log = logging.getLogger(__name__)

R = TypeVar("R")
Tone = Literal["info", "positive", "warning", "negative"]

_SHOWN_MS: Final = {"info": 4000, "positive": 3000, "warning": 8000, "negative": 10_000}


class State(Protocol):
    """The map at a moment. `Live` is one, as it is now."""

    @property
    def entities(self) -> Mapping[str, Entity]:
        """By name."""

    @property
    def poses(self) -> Mapping[str, Pose]:
        """Where bodies stand, by name; of the past, where the map said that entities were."""

    @property
    def commit(self) -> int:
        """The last commit of it."""


class Moment(Struct, frozen=True):
    """Now, or after a commit of the past."""

    commit: int | None = None

    @property
    def is_now(self) -> bool:
        """Does it move on with the map?"""
        return self.commit is None


NOW: Final = Moment()

Place = tuple[float, float, float, float]
"""x, y, z [m] and yaw [rad], map frame."""


class Past(Struct, frozen=True, kw_only=True):
    """The map as it was after a commit."""

    entities: Mapping[str, Entity]
    poses: Mapping[str, Pose]
    commit: int


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
        self.dark = False
        self.narrow = False
        self.is_seen = False
        """The browser has said how it looks."""
        self.refuse: Callable[[Command[Any], errors.SemmapError], None] | None = None
        """Shows why a change was refused; set by the layout."""
        self.draw_scene: Callable[[], None] | None = None
        """Draws the scene with its switches where it is called; set by the scene."""
        self.pick: Callable[[], Awaitable[Place | None]] | None = None
        """Lets a person point at a place; set by the scene."""
        self.look: Callable[[], ViewPoint | None] | None = None
        """Whence the scene is seen; set by the scene."""
        self._on_select: list[Callable[[], None]] = []
        self._on_moment: list[Callable[[], None]] = []
        self._on_change: list[Callable[[], None]] = []
        self._on_connection: list[Callable[[], None]] = []
        self._on_poses: list[Callable[[tuple[str, ...]], None]] = []
        self._on_look: list[Callable[[], None]] = []
        self._on_key: dict[str, Callable[[], object]] = {}
        self._asked_for = 0
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
            self._on_look,
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
            self.later(self._fetch(commit, self._asked_for))

    async def _fetch(self, commit: int, number: int) -> None:
        entities = await self.ask(List(as_of=commit), timeout_s=30.0)
        if entities is None or number != self._asked_for:  # he has gone elsewhere meanwhile
            return
        by_name = {entity.name: entity for entity in entities if isinstance(entity, Entity)}
        poses = {name: entity.pose for name, entity in by_name.items() if entity.pose is not None}
        self._show(Moment(commit), Past(entities=by_name, poses=poses, commit=commit))

    def show(self, past: Past) -> None:
        """Show a past that somebody has at hand, without asking for it."""
        self._asked_for += 1
        self._show(Moment(past.commit), past)

    def _show(self, moment: Moment, state: State) -> None:
        was = self.moment
        self.moment, self.state = moment, state
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

    # Asking and changing

    async def ask(self, command: Command[R], timeout_s: float = 10.0) -> R | None:
        """The reply; None where there is none, and then the reason is shown."""
        try:
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
            return await self.live.ask(command, timeout_s)
        except errors.SemmapError as error:
            if self.refuse is not None and isinstance(error, errors.Refused):
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
            ui.notify(text, type=kind, timeout=_SHOWN_MS[kind], html=False, close_button="Close")

    def later(self, coroutine: Coroutine[Any, Any, Any]) -> asyncio.Task[Any]:
        """Let it run beside what is being drawn, in this tab."""

        async def inside() -> Any:
            with self.client:
                return await coroutine

        return background_tasks.create(inside(), name="page")
