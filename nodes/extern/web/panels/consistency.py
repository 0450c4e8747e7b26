"""Consistency: contradictions, what is withheld or denied, and doubts, each with its entities and why."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.redrawing import Redrawing
from semmap.nodes.extern.web.views.findings import TITLES, Finding, findings, verdict
from semmap.schemas import errors
from semmap.schemas.commands import Check, List
from semmap.schemas.entities import Entity

_MOST: Final = 200
_TIMEOUT_S: Final = 120.0
_ICONS: Final = {
    "contradiction": ("error", "negative"),
    "withheld": ("block", "warning"),
    "denied": ("wrong_location", "warning"),
    "doubt": ("help", "info"),
    "body": ("view_in_ar", "info"),
    "crowd": ("groups", "info"),
}


def consistency(page: Page) -> None:
    """The verdict, and below it what there is to look at, the gravest first."""
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
        Redrawing(page, self._check_first)
        page.on_change(self._look)

    async def _check_first(self) -> None:
        if self._checked < 0:
            await self._check()

    def _look(self) -> None:
        """Say what the verdict is of, where that is not what is shown."""
        self._stale.text = ""
        if self._checked >= 0 and not self._page.moment.is_now:
            self._stale.text = (
                f"This is of the map as it was after commit {self._checked}, not of the past shown."
            )
        elif 0 <= self._checked < self._page.live.commit:
            more = self._page.live.commit - self._checked
            self._stale.text = f"The map has had {more} more commit{'s' * (more > 1)} since this check."

    async def _check(self) -> None:
        self._button.set_enabled(False)
        self._stale.text = "checking ..."
        try:
            checked = await self._page.live.ask(Check(), _TIMEOUT_S)
            listed = await self._page.live.ask(List(), _TIMEOUT_S)
        except errors.SemmapError as error:
            self._stale.text = error.text
            return
        finally:
            self._button.set_enabled(True)
        entities = [entity for entity in listed if isinstance(entity, Entity)]
        found = findings(checked, entities, self._page.live.classes)
        self._checked = self._page.live.commit
        self._verdict.text = verdict(checked)
        self._icon.name = "check_circle" if checked.consistent else "error"
        self._icon.props(f"color={'positive' if checked.consistent else 'negative'}")
        self._look()
        self._draw(found)

    def _draw(self, found: tuple[Finding, ...]) -> None:
        self._list.clear()
        with self._list:
            if not found:
                ui.label("Nothing is withheld, denied or in doubt.").props('role="listitem"')
            for finding in found[:_MOST]:
                self._one(finding)
            if len(found) > _MOST:
                ui.label(f"and {len(found) - _MOST} more").props('role="listitem"')

    def _one(self, finding: Finding) -> None:
        icon, colour = _ICONS[finding.gravity]
        with ui.card().classes("w-full p-2 gap-1").props('flat bordered role="listitem"'):
            with ui.row().classes("w-full items-center no-wrap gap-2"):
                ui.icon(icon).props(f'color={colour} aria-hidden="true"')
                ui.label(TITLES[finding.gravity]).classes("text-caption")
            ui.label(finding.text).classes("whitespace-pre-wrap")
            with ui.row().classes("gap-1"):
                for name in finding.names:
                    self._chip(name)
            if finding.why:
                with ui.expansion("Why", icon="account_tree").classes("w-full").props("dense"):
                    for line in finding.why:
                        ui.label(line).classes("text-caption whitespace-pre-wrap")

    def _chip(self, name: str) -> None:
        chip = ui.button(name, icon="my_location", on_click=lambda: self._page.select((name,), "consistency"))
        chip.props("dense flat no-caps size=sm")
