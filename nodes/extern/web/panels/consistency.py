"""The consistency check: contradictions, violations of shapes, suppressed and denied facts, and doubts."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.redraw import LazyRedraw
from semmap.nodes.extern.web.views.findings import (
    TITLES,
    Finding,
    collect_findings,
    format_verdict,
    is_sound,
)
from semmap.schemas import errors, wording
from semmap.schemas.commands import Check, List
from semmap.schemas.entities import Entity

_MOST: Final = 200
_TIMEOUT_S: Final = 120.0
_ICONS: Final = {
    "contradiction": ("error", "negative"),
    "violation": ("rule", "negative"),
    "unchecked": ("help", "warning"),
    "suppressed": ("block", "warning"),
    "denied": ("wrong_location", "warning"),
    "doubt": ("help", "info"),
    "body": ("view_in_ar", "info"),
    "crowd": ("groups", "info"),
}


def consistency(page: Page) -> None:
    """Draw the verdict and the list of problems, the most severe first."""
    _Consistency(page)


class _Consistency:
    def __init__(self, page: Page) -> None:
        self._page = page
        self._checked = -1
        with ui.column().classes("w-full gap-2"):
            with ui.row().classes("w-full items-center gap-2"):
                self._icon = ui.icon("hourglass_empty", size="md").props('aria-hidden="true"')
                self._verdict = ui.label("Not checked yet").classes("text-subtitle1 grow")
                self._verdict.props('role="status"').mark("check-verdict")
                self._button = ui.button("Check again", icon="fact_check", on_click=self._check)
                self._button.props("dense no-caps").classes("px-3")
            self._stale = ui.label().classes("text-caption")
            self._list = ui.column().classes("w-full gap-1").props('role="list"').mark("check-findings")
        LazyRedraw(page, self._check_first)
        page.on_change(self._show_age)

    async def _check_first(self) -> None:
        if self._checked < 0:
            await self._check()

    def _show_age(self) -> None:
        """Show which commit was checked, if another one is shown."""
        self._stale.text = ""
        if self._checked >= 0 and not self._page.moment.is_now:
            self._stale.text = f"The check applies to commit {self._checked}, not to the commit shown."
        elif 0 <= self._checked < self._page.live.commit:
            more = self._page.live.commit - self._checked
            self._stale.text = f"Checked at commit {self._checked}, {wording.counted(more, 'commit')} ago."

    async def _check(self) -> None:
        self._button.set_enabled(False)
        self._stale.text = "Checking ..."
        try:
            checked = await self._page.live.ask(Check(), _TIMEOUT_S)
            listed = await self._page.live.ask(List(), _TIMEOUT_S)
        except errors.SemmapError as error:
            self._stale.text = error.text
            return
        finally:
            self._button.set_enabled(True)
        entities = [entity for entity in listed if isinstance(entity, Entity)]
        found = collect_findings(checked, entities, self._page.live.classes)
        self._checked = self._page.live.commit
        self._verdict.text = format_verdict(checked)
        sound = is_sound(checked)
        self._icon.name = "check_circle" if sound else "error"
        self._icon.props(f"color={'positive' if sound else 'negative'}")
        self._show_age()
        self._draw(found)

    def _draw(self, found: tuple[Finding, ...]) -> None:
        self._list.clear()
        with self._list:
            if not found:
                ui.label("No problems found.").props('role="listitem"')
            for finding in found[:_MOST]:
                self._draw_finding(finding)
            if len(found) > _MOST:
                ui.label(f"… and {len(found) - _MOST} more").props('role="listitem"')

    def _draw_finding(self, finding: Finding) -> None:
        icon, colour = _ICONS[finding.kind]
        with ui.card().classes("w-full p-2 gap-1").props('flat bordered role="listitem"'):
            with ui.row().classes("w-full items-center no-wrap gap-2"):
                ui.icon(icon).props(f'color={colour} aria-hidden="true"')
                ui.label(TITLES[finding.kind]).classes("text-caption")
            ui.label(finding.text).classes("whitespace-pre-wrap")
            with ui.row().classes("gap-1"):
                for name in finding.names:
                    self._chip(name)
            if finding.proof:
                with ui.expansion("Proof", icon="account_tree").classes("w-full").props("dense"):
                    for line in finding.proof:
                        ui.label(line).classes("text-caption whitespace-pre-wrap")

    def _chip(self, name: str) -> None:
        chip = ui.button(name, icon="my_location", on_click=lambda: self._page.select((name,), "consistency"))
        chip.props("dense flat no-caps size=sm")
