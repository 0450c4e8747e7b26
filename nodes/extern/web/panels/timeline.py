"""The time: a slider over the commits, play, step, what is different, and back to now."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any, Final

from nicegui import ui

from semmap.nodes.extern.cli.output.lines import format_commit_changes
from semmap.nodes.extern.phrasing import author, moment
from semmap.nodes.extern.web.differences import Difference, Mark, counted
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.rows import Rows
from semmap.nodes.runtime import rhythm
from semmap.schemas import errors

_SPEEDS: Final = {0.1: "0.1 ×", 1.0: "1 ×", 10.0: "10 ×", 100.0: "100 ×", 1000.0: "1000 ×"}
_COMPARED: Final = {"before": "the commit before", "now": "now", "": "nothing"}
_SMALL: Final = "dense options-dense borderless"
_TELL_ONCE: Final = "(at) => { element.props['model-value'] = at; emit(at); }"
"""A slider tells where it is until its property says so: of a key it tells when that goes down and when it
goes up. The second time may come after Home, and led back to the past; so the property says so at once."""
_DRAWN_S: Final = 0.15
"""No moment is shown for less while the past is played."""
_FEW: Final = 12
COLOURS: Final[dict[Mark, str]] = {
    "added": "positive",
    "removed": "negative",
    "moved": "deep-purple",
    "changed": "teal",
}
"""In which colour of the page's palette a difference is marked."""


def timeline(page: Page) -> None:
    """Draw it where it is called."""
    _Timeline(page)


class _Timeline:
    """Of one tab."""

    def __init__(self, page: Page) -> None:
        self._page = page
        self._is_playing = False
        self._wanted: int | None = None
        with ui.column().classes("semmap-bar") as self._bar:
            self._bar.props('role="group" aria-label="Time"')
            with ui.row().classes("w-full items-center no-wrap gap-2"):
                self._back = self._button("skip_previous", "One commit back", lambda: self._step(-1))
                self._play = self._button("play_arrow", "Play", self._toggle)
                self._on = self._button("skip_next", "One commit on", lambda: self._step(1))
                self._slider = ui.element("q-slider").classes("col")
                self._slider.props('min=1 max=1 model-value=1 label aria-label="Commit"')
                self._slider.on("update:model-value", self._on_slider, js_handler=_TELL_ONCE)
                self._now = ui.button("Now", on_click=lambda: self._go(None))
                self._now.props("dense unelevated color=warning text-color=black padding='2px 10px'")
                self._now.tooltip("Back to now (Home)")
            with ui.row().classes("w-full items-center gap-3 semmap-time-row"):
                self._caption = ui.label().props('role="status"').classes("ellipsis semmap-time-said")
                with ui.element("div").classes("semmap-time-choices"):
                    self._when = ui.input(placeholder="commit or time").classes("w-36")
                    self._when.props(f'{_SMALL} aria-label="Go to a commit or a time, such as 12:30"')
                    self._when.on("keydown.enter", self._go_to_when)
                    self._speed = ui.select(_SPEEDS, value=1.0)
                    self._speed.props(f'{_SMALL} aria-label="Speed"')
                    compared = ui.select(_COMPARED, value=page.compared, label="marked against")
                    compared.props(_SMALL).classes("w-40")
                    compared.on_value_change(lambda event: self._compare(compared))
            self._differences = ui.row().classes("w-full items-center gap-1")
            self._differences.props('aria-label="What is different"')
            with self._differences:
                self._counted = ui.label().classes("text-caption")
                self._chips = Rows(ui.row().classes("items-center gap-1"), self._chip)
                self._more = ui.label().classes("text-caption")
        page.on_moment(self._show)
        page.on_change(self._show)
        page.client.on_delete(self._leave)
        self._stop = page.tape.listen(self._told)
        page.tape.read()
        self._show()

    def _button(self, icon: str, label: str, act: Any) -> ui.button:
        button = ui.button(icon=icon, on_click=act).tooltip(label)
        return button.props(f'flat round dense color=secondary aria-label="{label}"')

    def _leave(self) -> None:
        self._is_playing = False
        self._stop()

    def _told(self) -> None:
        """More is known of the commits."""
        with self._page.client:
            self._show()

    # Where to

    def _go(self, commit: int | None) -> None:
        self._is_playing = False
        self._page.go_to(commit)

    @property
    def _shown(self) -> int:
        """The commit after which the map is shown."""
        return self._page.state.commit

    def _step(self, by: int) -> None:
        to = self._shown + by
        if to < self._page.tape.first:
            self._page.tell(f"The history begins with commit {self._page.tape.first}.")
        elif to >= self._page.live.commit:
            self._go(None)
        else:
            self._go(to)

    def _on_slider(self, event: Any) -> None:
        """The slider is dragged: the newest place counts, and one at a time is fetched."""
        commit = int(event.args)
        self._slider.props["model-value"] = commit
        self._is_playing = False
        was, self._wanted = self._wanted, commit
        if was is None:
            self._page.later(self._follow_slider())

    async def _follow_slider(self) -> None:
        try:
            commit: int | None = None
            while self._wanted is not None and self._wanted != commit:
                commit = self._wanted
                if commit >= self._page.live.commit:
                    self._page.go_to(None)
                else:
                    await self._page.arrive(commit)
        finally:
            self._wanted = None
            self._show()

    def _compare(self, choice: ui.select) -> None:
        choice.run_method("blur")
        self._page.compare(choice.value)

    def _go_to_when(self) -> None:
        self._when.run_method("blur")  # so that Home goes back to now, and u undoes
        text = str(self._when.value or "").strip()
        if not text:
            return
        try:
            commit = self._page.tape.seq_at(text)
        except errors.SemmapError as error:
            self._page.tell(error.text, "warning")
            return
        self._when.value = ""
        self._go(None if commit == self._page.live.commit else commit)

    # Playing

    def _toggle(self) -> None:
        self._is_playing = not self._is_playing
        if self._is_playing:
            self._page.later(self._run())
        self._show()

    async def _run(self) -> None:
        page = self._page
        if page.moment.is_now and not await page.arrive(page.tape.first):
            self._is_playing = False
        while self._is_playing and not page.moment.is_now:
            if page.tape.row(self._shown) is None:  # it has just come, and what it is has not
                await page.tape.caught_up()
            stamps = [row.stamp_ns for row in page.tape.rows]
            here = self._shown - page.tape.first
            if not 0 <= here < len(stamps):
                break
            place, wait_s = rhythm.ahead(stamps, here, speed=float(self._speed.value), least_s=_DRAWN_S)
            await asyncio.sleep(wait_s)
            if not self._is_playing or self._shown - page.tape.first != here:
                continue
            if place == here or page.tape.rows[place].seq >= page.live.commit:
                page.go_to(None)
            elif not await page.arrive(page.tape.rows[place].seq):
                break
        self._is_playing = False
        self._show()

    # What is shown

    def _show(self) -> None:
        page, shown = self._page, self._shown
        last = page.live.commit
        is_past = not page.moment.is_now
        at = {"min": page.tape.first, "max": max(last, page.tape.first)}
        if self._wanted is None:
            at["model-value"] = shown
        if not at.items() <= self._slider.props.items():
            self._slider.props.update(at)
        self._play.props(f"icon={'pause' if self._is_playing else 'play_arrow'}")
        self._now.set_visibility(is_past)
        self._bar.classes(add="is-past" if is_past else "", remove="" if is_past else "is-past")
        self._on.set_enabled(is_past)
        self._back.set_enabled(shown > page.tape.first)
        self._caption.text = self._said(shown, last, is_past=is_past)
        is_compared = is_past and bool(page.compared)
        against = "since then" if page.compared == "now" else "by this commit"
        self._differences.set_visibility(is_compared)
        self._counted.text = f"{counted(page.differences)} {against}" if is_compared else ""
        self._draw_differences(page.differences if is_compared else {})

    def _said(self, shown: int, last: int, *, is_past: bool) -> str:
        if not is_past:
            return f"Now: commit {shown}" if shown >= 0 else "No map yet"
        row = self._page.tape.row(shown)
        if row is None:
            return f"The past: commit {shown} of {last}"
        why = row.reason or format_commit_changes(row)
        return f"The past: commit {shown} of {last} · {moment(row.stamp_ns)} · {author(row)}: {why}"

    def _draw_differences(self, found: Mapping[str, Difference]) -> None:
        self._chips.show((name, (name, found[name])) for name in list(found)[:_FEW])
        self._more.text = f"and {len(found) - _FEW} more" if len(found) > _FEW else ""

    def _chip(self, content: tuple[str, Difference]) -> None:
        name, difference = content
        chip = ui.chip(name, on_click=lambda: self._page.select((name,), by="timeline"))
        chip.props(f"dense square color={COLOURS[difference.mark]} text-color=white")
        chip.tooltip(difference.text)
