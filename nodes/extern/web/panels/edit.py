"""Changing what is selected: references, class, size and place; several at once; and deleting."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.deleting import delete_selected
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.fields import Fields
from semmap.nodes.extern.web.panels.states import states_in_common
from semmap.nodes.extern.web.views import forms
from semmap.schemas import errors, wording
from semmap.schemas.entities import Entity

_MOST: Final = 12


class Edit:
    """The form of one entity. What is typed into it stays when the entity changes meanwhile."""

    def __init__(self, page: Page, entity: Entity) -> None:
        self._page, self._entity = page, entity
        with ui.expansion("Edit", icon="edit").props("dense").classes("w-full semmap-edit"):
            self._fields = Fields(page, named=False)
            with ui.row().classes("w-full items-center justify-between q-mt-sm"):
                if page.may("remove"):
                    ui.button("Delete", icon="delete", on_click=self._delete).props("flat color=negative")
                ui.space()
                ui.button("Reset", on_click=self._reset).props("flat")
                ui.button("Save", on_click=self._save).props("unelevated")
        self._fields.offer(forms.class_choices(page.live.classes))
        self._reset()

    def show(self, entity: Entity) -> None:
        """The entity as it is now; a form that somebody has begun to fill in is left alone."""
        untouched = self._fields.filled == self._before
        self._entity = entity
        if untouched:
            self._reset()

    def _reset(self) -> None:
        self._fields.fill(forms.filled_from(self._entity))
        self._before = self._fields.filled

    async def _save(self) -> None:
        filled = self._fields.filled
        try:
            command = forms.edit(self._entity, filled, self._before)
        except errors.BadRequest as error:
            self._page.tell(error.text, "warning")
            return
        if command is None:
            self._page.tell("Nothing was changed in the form.")
            return
        if (done := await self._page.change(command)) is not None:
            self._before = filled
            self._page.tell("; ".join((done.text, *done.notes)), "positive")

    async def _delete(self) -> None:
        await delete_selected(self._page)


def several(page: Page, names: tuple[str, ...]) -> None:
    """Draw what may be done with several things at once."""
    entities = tuple(page.state.entities[name] for name in names)
    ui.label(f"{wording.entities(len(names))} selected").classes("semmap-heading").props(
        'role="heading" aria-level="2"'
    )
    with ui.row().classes("w-full gap-1"):
        for name in names[:_MOST]:
            _chip(page, name)
        if len(names) > _MOST:
            ui.label(f"and {len(names) - _MOST} more").classes("semmap-quiet")
    if not page.moment.is_now:
        return
    if page.may("update"):
        ui.label("Move all of them by").classes("semmap-title")
        with ui.row().classes("w-full items-center gap-2 no-wrap"):
            by = [
                ui.number(f"{axis} [m]", step=0.1)
                .props(f'dense outlined aria-label="offset {axis}"')
                .classes("grow")
                .style("flex-basis: 0; min-width: 0")
                for axis in "xyz"
            ]
            ui.button("Move", on_click=lambda: _move(page, names, [field.value for field in by])).props(
                "unelevated"
            )
    if page.may("set"):
        ui.label("Set a state of all of them").classes("semmap-title")
        states_in_common(page, entities)
    if page.may("remove"):
        ui.button("Delete all of them", icon="delete", on_click=lambda: _delete(page)).props(
            "flat color=negative"
        )


def _chip(page: Page, name: str) -> None:
    ui.chip(name, on_click=lambda: page.select([name], by="detail")).props("dense outline clickable")


async def _delete(page: Page) -> None:
    await delete_selected(page)


async def _move(page: Page, names: tuple[str, ...], by: list[float | None]) -> None:
    there = [page.live.entities[name] for name in names if name in page.live.entities]
    try:
        command = forms.offset(there, by)
    except errors.BadRequest as error:
        page.tell(error.text, "warning")
        return
    if (done := await page.change(command)) is not None:
        page.tell(done.text, "positive")
