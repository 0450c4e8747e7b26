"""One open tab: its selection, the moment it shows, and methods to send requests and changes.

Panels draw `page.state` and never `page.live`, so they show the past like the present.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Awaitable, Callable, Coroutine, Iterable, Iterator, Mapping
from typing import Any, Literal, TypeVar

from nicegui import Client, background_tasks

from semmap.nodes.extern.web.differences import Difference, find_differences
from semmap.nodes.extern.web.history_cache import history_cache_of
from semmap.nodes.extern.web.live import Live, LiveEvent
from semmap.nodes.extern.web.map_state import NOW, MapState, Moment, Snapshot
from semmap.nodes.extern.web.notices import Notices, Tone, strip_cli_hints
from semmap.schemas import errors
from semmap.schemas.commands import Command
from semmap.schemas.entities import Pose
from semmap.schemas.relations import ViewPoint

log = logging.getLogger(__name__)

R = TypeVar("R")
Compared = Literal["before", "now", ""]
"""What a moment of the past is compared with: the commit before, the current map, or nothing."""

Place = tuple[float, float, float, float]
"""x, y, z [m] and yaw [rad], map frame."""


class Page:
    """One open tab. It is used on the event loop only."""

    def __init__(self, live: Live, client: Client) -> None:
        self.live = live
        self.id = client.id
        """Unique id of the tab; the frame of its scene is at `/scene/<id>/`."""
        self.client = client
        self.selected: tuple[str, ...] = ()
        self.moment = NOW
        self.state: MapState = live
        self.compared: Compared = "before"
        self.differences: Mapping[str, Difference] = {}
        """Differences between the moment shown and the one it is compared with, by name.

        Empty for the present.
        """
        self.dark = False
        self.narrow = False
        self.is_appearance_known = False
        """Whether the browser has reported `dark` and `narrow`."""
        self.show_rejection: Callable[[Command[Any], errors.SemmapError], None] | None = None
        """Shows why a change was rejected; set by the layout."""
        self.watch_query: Callable[[str, bool], object] | None = None
        """Starts a standing query, optionally with inferred facts; set by the panel of standing queries."""
        self.set_wide_lists: Callable[[bool], object] | None = None
        """Widens or narrows the left drawer; set by the layout."""
        self.draw_scene: Callable[[], None] | None = None
        """Draws the scene with its switches, once; set by the scene."""
        self.pick: Callable[[], Awaitable[Place | None]] | None = None
        """Returns the next position that the user clicks; set by the scene."""
        self.preview: Callable[[Mapping[str, Pose]], None] | None = None
        """Shows entities at other poses until it is called without any; set by the scene."""
        self.discard_pending: Callable[[], Awaitable[bool]] | None = None
        """Discards the last change by keys that was not sent, and returns whether there was one.

        Set by the arrow keys.
        """
        self.cancel_interaction: Callable[[], bool] | None = None
        """Cancels picking or dragging in the scene, and returns whether there was any; set by the scene."""
        self.get_viewpoint: Callable[[], ViewPoint | None] | None = None
        """Returns the viewpoint of the scene; set by the scene."""
        self._notices = Notices()
        self._on_select: list[Callable[[], None]] = []
        self._on_moment: list[Callable[[], None]] = []
        self._on_change: list[Callable[[], None]] = []
        self._on_connection: list[Callable[[], None]] = []
        self._on_tab_change: list[Callable[[], None]] = []
        self._on_poses: list[Callable[[tuple[str, ...]], None]] = []
        self._on_drives: list[Callable[[], None]] = []
        self._on_appearance_change: list[Callable[[], None]] = []
        self._on_key: dict[str, Callable[[], object]] = {}
        self._request = 0
        self.pending = 0
        """Number of operations whose results are not shown yet."""
        self._on_pending: list[Callable[[], None]] = []
        self._is_idle = asyncio.Event()
        self._is_idle.set()
        self.history = history_cache_of(live)
        """The history of the map, shared by all tabs."""
        self._stop = live.listen(self._on_event)
        client.on_delete(self.close)

    def close(self) -> None:
        """Release everything after the tab was closed."""
        self._stop()
        for functions in (
            self._on_select,
            self._on_moment,
            self._on_change,
            self._on_connection,
            self._on_tab_change,
            self._on_drives,
            self._on_appearance_change,
            self._on_pending,
        ):
            functions.clear()
        self._on_poses.clear()
        self._on_key.clear()

    # Selection

    def select(self, names: Iterable[str], by: str = "") -> None:
        """Select these entities only. `by` names the panel, so that it can ignore its own selection."""
        chosen = tuple(dict.fromkeys(names))
        if chosen == self.selected:
            return
        self.selected, self.selected_by = chosen, by
        self._call(self._on_select)

    selected_by = ""

    def on_select(self, function: Callable[[], None]) -> None:
        """Call a function when the selection has changed."""
        self._on_select.append(function)

    # The scene

    async def pick_place(self) -> Place | None:
        """Return the next position that the user clicks in the scene.

        Return None if picking is cancelled, or without a scene.
        """
        return None if self.pick is None else await self.pick()

    def escape(self) -> None:
        """Cancel picking or dragging in the scene; otherwise clear the selection."""
        if self.cancel_interaction is None or not self.cancel_interaction():
            self.select(())

    @property
    def viewpoint(self) -> ViewPoint | None:
        """The viewpoint of the scene, for commands with viewer-relative relations; None without a scene."""
        return None if self.get_viewpoint is None else self.get_viewpoint()

    # The moment

    def go_to(self, commit: int | None) -> None:
        """Show the map after a commit, or the current map for None."""
        self._request += 1
        if commit is None:
            self._show(NOW, self.live)
        else:
            self.start_task(self.show_commit(commit))

    async def show_commit(self, commit: int) -> bool:
        """Show the map after a commit; return False if that failed or another moment was requested since."""
        self._request += 1
        number = self._request
        try:
            past = await self.history.snapshot(commit)
            found = await self._compare(past)
        except errors.SemmapError as error:
            self.notify(error.text, "negative")
            return False
        if number != self._request:
            return False
        self._show(Moment(commit), past, found)
        return True

    def compare(self, with_what: Compared) -> None:
        """Set what a moment of the past is compared with."""
        self.compared = with_what
        if self.moment.commit is not None:
            self.go_to(self.moment.commit)

    async def _compare(self, past: Snapshot) -> Mapping[str, Difference]:
        if self.compared == "now":
            return find_differences(past.entities, self.live.entities)
        if self.compared == "before" and past.commit > self.history.first:
            before = await self.history.snapshot(past.commit - 1)
            return find_differences(before.entities, past.entities)
        return {}

    def _show(self, moment: Moment, state: MapState, found: Mapping[str, Difference] | None = None) -> None:
        was = self.moment
        self.moment, self.state, self.differences = moment, state, found or {}
        if moment != was:
            self._call(self._on_moment)
        self._changed()

    def on_moment(self, function: Callable[[], None]) -> None:
        """Call a function when another moment is shown."""
        self._on_moment.append(function)

    # Events of the system

    def on_change(self, function: Callable[[], None]) -> None:
        """Call a function when `state` has changed, by a commit or by another moment."""
        self._on_change.append(function)

    def on_poses(self, function: Callable[[tuple[str, ...]], None]) -> None:
        """Call a function with the names of moved bodies, at most ten times a second.

        It is not called while the past is shown.
        """
        self._on_poses.append(function)

    def on_drives(self, function: Callable[[], None]) -> None:
        """Call a function when robots began, continued or ended a drive."""
        self._on_drives.append(function)

    def on_connection(self, function: Callable[[], None]) -> None:
        """Call a function when the connection to the knowledge base was lost or restored."""
        self._on_connection.append(function)

    # The browser

    def set_appearance(self, *, dark: bool, narrow: bool) -> None:
        """Set whether the browser shows the page dark, and whether it is as narrow as a phone."""
        self.dark, self.narrow, self.is_appearance_known = dark, narrow, True
        self._call(self._on_appearance_change)

    def on_appearance_change(self, function: Callable[[], None]) -> None:
        """Call a function when `dark` or `narrow` has changed or is first known."""
        self._on_appearance_change.append(function)

    def on_key(self, key: str, function: Callable[[], object]) -> None:
        """Call a function when a key is pressed outside of input fields; one function per key."""
        self._on_key[key] = function

    def press(self, key: str) -> None:
        """Handle a pressed key."""
        if (function := self._on_key.get(key)) is not None:
            self._call([function])

    def _on_event(self, event: LiveEvent) -> None:
        if event.kind == "connection":
            self._call(self._on_connection)
        elif event.kind == "drives":
            self._call(self._on_drives)
        elif event.kind == "reset":
            if event.is_new_map:
                self.notify("the system now serves another map; the page was reset", "warning")
                self.select(())
                self.go_to(None)
            elif self.moment.is_now:
                self._changed()
        elif event.kind == "commit" and self.compared == "now" and isinstance(self.state, Snapshot):
            self.differences = find_differences(self.state.entities, self.live.entities)
            self._changed()
        elif self.moment.is_now and event.kind in ("commit", "scene"):
            self._changed()
        elif self.moment.is_now and event.kind == "poses":
            self._call(self._on_poses, event.names)

    def _changed(self) -> None:
        removed = [name for name in self.selected if name not in self.state.entities]
        if removed and self.moment.is_now:
            self.select(name for name in self.selected if name in self.state.entities)
        self._call(self._on_change)

    def _call(self, functions: Iterable[Callable[..., object]], *arguments: Any) -> None:
        """Call all functions, and log exceptions, so that one failed panel does not stop the others."""
        for function in tuple(functions):
            try:
                with self.client:
                    function(*arguments)
            except Exception:
                log.exception("a panel of the page failed")

    def on_tab_change(self, function: Callable[[], None]) -> None:
        """Call a function when another tab of panels is shown."""
        self._on_tab_change.append(function)

    def tab_changed(self) -> None:
        """Notify the panels that another tab is shown."""
        self._call(self._on_tab_change)

    # Requests and changes

    async def ask(self, command: Command[R], timeout_s: float = 10.0) -> R | None:
        """Send a command and return the reply. On an error show it, and return None."""
        try:
            with self.pending_work():
                return await self.live.ask(command, timeout_s)
        except errors.SemmapError as error:
            self.notify(error.text, "negative")
            return None

    async def change(self, command: Command[R], timeout_s: float = 60.0) -> R | None:
        """Send a change and return the reply. On an error show it with suggested fixes, and return None."""
        if not self.moment.is_now:
            self.notify("the past is read-only; press Home to return to the current map", "warning")
            return None
        try:
            with self.pending_work():
                return await self.live.ask(command, timeout_s)
        except errors.SemmapError as error:
            if self.show_rejection is not None and not isinstance(error, errors.NoAnswer):
                with self.client:
                    self.show_rejection(command, error)
            else:
                self.notify(error.text, "negative")
            return None

    def is_allowed(self, command: str) -> bool:
        """Return whether the role of this page may send a command."""
        return self.live.is_allowed(command)

    def notify(self, text: str, kind: Tone = "info") -> None:
        """Show a notice, as plain text."""
        with self.client:
            self._notices.show(strip_cli_hints(text), kind)

    def start_task(self, coroutine: Coroutine[Any, Any, Any]) -> asyncio.Task[Any]:
        """Run a coroutine in the background, in the context of this tab."""

        async def inside() -> Any:
            with self.client, self.pending_work():
                return await coroutine

        return background_tasks.create(inside(), name="page")

    # Pending operations

    @contextlib.contextmanager
    def pending_work(self) -> Iterator[None]:
        """Count the enclosed operation as pending."""
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
            self._call(self._on_pending)

    def on_pending(self, function: Callable[[], None]) -> None:
        """Call a function when `pending` has changed."""
        self._on_pending.append(function)

    async def settled(self) -> None:
        """Wait until nothing is pending."""
        await self._is_idle.wait()
