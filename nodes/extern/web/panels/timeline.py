"""The timeline: a slider over the commits, playback, steps, and the differences to another moment."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any, Final

from nicegui import ui

from semmap.nodes.extern.cli.output.lines import format_commit_changes
from semmap.nodes.extern.phrasing import author, moment
from semmap.nodes.extern.web.differences import Difference, Mark, format_counts
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.rows import Rows
from semmap.nodes.extern.web.views.time_scale import STEPS, index_at, positions_of
from semmap.nodes.runtime import playback_clock
from semmap.schemas import errors

_SPEEDS: Final = {0.1: "0.1 ×", 1.0: "1 ×", 10.0: "10 ×", 100.0: "100 ×", 1000.0: "1000 ×"}
_COMPARED: Final = {"before": "previous commit", "now": "now", "": "nothing"}
_SMALL: Final = "dense options-dense borderless"
_EMIT_ONCE: Final = "(at) => { element.props['model-value'] = at; emit(at); }"
"""Emits a slider position once.

The slider emits it again on key-up if its property still has the old value. If Home was pressed in between,
this would return to the past.
"""
_DRAWN_S: Final = 0.15
"""Minimum time for which playback shows a moment."""
_FEW: Final = 12
COLOURS: Final[dict[Mark, str]] = {
    "added": "positive",
    "removed": "negative",
    "moved": "deep-purple",
    "changed": "teal",
}
"""The colour of each kind of difference, from the palette of the page."""


def timeline(page: Page) -> None:
    """Draw the timeline."""
    _Timeline(page)


class _Timeline:
    def __init__(self, page: Page) -> None:
        self._page = page
        self._is_playing = False
        self._has_choices = False
        self._is_over_time = False
        """Whether the slider is over time, not over commits."""
        self._position = 0
        """The position of the slider over time that the user has set last."""
        self._requested: int | None = None
        with ui.column().classes("semmap-bar") as self._bar:
            self._bar.props('role="group" aria-label="Time"')
            with ui.row().classes("w-full items-center no-wrap gap-2"):
                self._previous = self._button("skip_previous", "Previous commit", lambda: self._step(-1))
                self._play = self._button("play_arrow", "Play", self._toggle)
                self._next = self._button("skip_next", "Next commit", lambda: self._step(1))
                self._slider = ui.element("q-slider").classes("col")
                self._slider.props('min=1 max=1 model-value=1 label aria-label="Commit"')
                self._slider.on("update:model-value", self._on_slider, js_handler=_EMIT_ONCE)
                self._now = ui.button("Now", on_click=lambda: self._go(None))
                self._now.props("dense unelevated color=warning text-color=black padding='2px 10px'")
                self._now.tooltip("Return to the current map (Home)")
                options = self._button("tune", "Speed and comparison", self._toggle_choices)
                self._options = options.classes("semmap-narrow").props("aria-expanded=false")
            with ui.row().classes("w-full items-center gap-3 semmap-time-row"):
                self._caption = ui.label().props('role="status"').classes("ellipsis semmap-time-caption")
                with ui.element("div").classes("semmap-time-choices"):
                    self._when = ui.input(placeholder="commit or time").classes("w-36")
                    self._when.props(f'{_SMALL} aria-label="Go to commit or time, such as 12:30 or 2h ago"')
                    self._when.on("keydown.enter", self._go_to_when)
                    self._scale = self._button("schedule", "Slider over time", self._toggle_scale)
                    self._scale.props("aria-pressed=false")
                    self._speed = ui.select(_SPEEDS, value=1.0)
                    self._speed.props(f'{_SMALL} aria-label="Speed"')
                    compared = ui.select(_COMPARED, value=page.compared, label="Compare with")
                    compared.props(_SMALL).classes("w-40")
                    compared.on_value_change(lambda event: self._compare(compared))
            self._differences = ui.row().classes("w-full items-center gap-1")
            self._differences.props('aria-label="Differences"')
            with self._differences:
                self._summary = ui.label().classes("text-caption")
                self._chips = Rows(ui.row().classes("items-center gap-1"), self._draw_chip)
                self._more = ui.label().classes("text-caption")
        page.on_moment(self._show)
        page.on_change(self._show)
        page.client.on_delete(self._close)
        self._stop = page.history.listen(self._on_history)
        page.history.start_reading()
        self._show()

    def _button(self, icon: str, label: str, act: Any) -> ui.button:
        button = ui.button(icon=icon, on_click=act).tooltip(label)
        return button.props(f'flat round dense color=secondary aria-label="{label}"')

    def _toggle_choices(self) -> None:
        """Show or hide the time, the speed and the comparison, for which a phone has no room otherwise."""
        self._has_choices = not self._has_choices
        self._bar.classes(**{"add" if self._has_choices else "remove": "has-choices"})
        self._options.props(f"aria-expanded={str(self._has_choices).lower()}")

    def _toggle_scale(self) -> None:
        """Show the slider over time or over commits."""
        self._is_over_time = not self._is_over_time
        colour = "primary" if self._is_over_time else "secondary"
        self._scale.props(f"color={colour} aria-pressed={str(self._is_over_time).lower()}")
        self._slider.props(f'aria-label="{"Time" if self._is_over_time else "Commit"}"')
        self._show()

    def _positions(self) -> list[int]:
        """Return the positions of the known commits on the slider over time."""
        return positions_of([row.stamp_ns for row in self._page.history.rows])

    def _slider_props(self, shown: int, last: int) -> dict[str, object]:
        """Return the range, the position and the label of the slider."""
        history = self._page.history
        if not self._is_over_time:
            return {
                "min": history.first,
                "max": max(last, history.first),
                "model-value": shown,
                "label-value": shown,
            }
        positions, index = self._positions(), shown - history.first
        row = history.row(shown)
        is_chosen = row is not None and index_at(positions, self._position) == index
        position = self._position if is_chosen else positions[index] if row is not None else STEPS
        label = "" if row is None else moment(row.stamp_ns)
        return {"min": 0, "max": STEPS, "model-value": position, "label-value": label}

    def _close(self) -> None:
        self._is_playing = False
        self._stop()

    def _on_history(self) -> None:
        with self._page.client:
            self._show()

    # Navigation

    def _go(self, commit: int | None) -> None:
        self._is_playing = False
        self._page.go_to(commit)

    @property
    def _shown(self) -> int:
        """The commit that is shown."""
        return self._page.state.commit

    def _step(self, by: int) -> None:
        to = self._shown + by
        if to < self._page.history.first:
            self._page.notify(f"the history begins with commit {self._page.history.first}")
        elif to >= self._page.live.commit:
            self._go(None)
        else:
            self._go(to)

    def _on_slider(self, event: Any) -> None:
        """Go to the position of the slider. Only the last position counts, and one request runs at a time."""
        commit = self._position = int(event.args)
        self._slider.props["model-value"] = commit
        rows = self._page.history.rows
        if self._is_over_time:
            if not rows:
                return
            commit = rows[index_at(self._positions(), commit)].seq
        self._is_playing = False
        was, self._requested = self._requested, commit
        if was is None:
            self._page.start_task(self._follow_slider())

    async def _follow_slider(self) -> None:
        try:
            commit: int | None = None
            while self._requested is not None and self._requested != commit:
                commit = self._requested
                if commit >= self._page.live.commit:
                    self._page.go_to(None)
                else:
                    await self._page.show_commit(commit)
        finally:
            self._requested = None
            self._show()

    def _compare(self, choice: ui.select) -> None:
        choice.run_method("blur")
        self._page.compare(choice.value)

    def _go_to_when(self) -> None:
        self._when.run_method("blur")  # so that the shortcuts Home and u work again
        text = str(self._when.value or "").strip()
        if not text:
            return
        try:
            commit = self._page.history.seq_at(text)
        except errors.SemmapError as error:
            self._page.notify(error.text, "warning")
            return
        self._when.value = ""
        self._go(None if commit == self._page.live.commit else commit)

    # Playback

    def _toggle(self) -> None:
        self._is_playing = not self._is_playing
        if self._is_playing:
            self._page.start_task(self._play_back())
        self._show()

    async def _play_back(self) -> None:
        page = self._page
        if page.moment.is_now and not await page.show_commit(page.history.first):
            self._is_playing = False
        while self._is_playing and not page.moment.is_now:
            if page.history.row(self._shown) is None:  # its row is not read yet
                await page.history.read()
            stamps = [row.stamp_ns for row in page.history.rows]
            index = self._shown - page.history.first
            if not 0 <= index < len(stamps):
                break
            target, wait_s = playback_clock.next_position(
                stamps, index, speed=float(self._speed.value), least_s=_DRAWN_S
            )
            await asyncio.sleep(wait_s)
            if not self._is_playing or self._shown - page.history.first != index:
                continue
            if target == index or page.history.rows[target].seq >= page.live.commit:
                page.go_to(None)
            elif not await page.show_commit(page.history.rows[target].seq):
                break
        self._is_playing = False
        self._show()

    # Drawing

    def _show(self) -> None:
        page, shown = self._page, self._shown
        last = page.live.commit
        is_past = not page.moment.is_now
        at = self._slider_props(shown, last)
        if self._requested is not None:
            del at["model-value"]
        if not at.items() <= self._slider.props.items():
            self._slider.props.update(at)
        self._play.props(f"icon={'pause' if self._is_playing else 'play_arrow'}")
        self._now.set_visibility(is_past)
        self._bar.classes(add="is-past" if is_past else "", remove="" if is_past else "is-past")
        self._next.set_enabled(is_past)
        self._previous.set_enabled(shown > page.history.first)
        self._caption.text = self._caption_text(shown, last, is_past=is_past)
        is_compared = is_past and bool(page.compared)
        since = "since then" if page.compared == "now" else "by this commit"
        self._differences.set_visibility(is_compared)
        self._summary.text = f"{format_counts(page.differences)} {since}" if is_compared else ""
        self._draw_differences(page.differences if is_compared else {})

    def _caption_text(self, shown: int, last: int, *, is_past: bool) -> str:
        if not is_past:
            return f"Now: commit {shown}" if shown >= 0 else "No map"
        row = self._page.history.row(shown)
        if row is None:
            return f"Past: commit {shown} of {last}"
        reason = row.reason or format_commit_changes(row)
        return f"Past: commit {shown} of {last} · {moment(row.stamp_ns)} · {author(row)}: {reason}"

    def _draw_differences(self, found: Mapping[str, Difference]) -> None:
        self._chips.show((name, (name, found[name])) for name in list(found)[:_FEW])
        self._more.text = f"… and {len(found) - _FEW} more" if len(found) > _FEW else ""

    def _draw_chip(self, content: tuple[str, Difference]) -> None:
        name, difference = content
        chip = ui.chip(name, on_click=lambda: self._page.select((name,), by="timeline"))
        chip.props(f"dense square color={COLOURS[difference.mark]} text-color=white")
        chip.tooltip(difference.text)
