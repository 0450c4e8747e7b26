"""The forms that edit and delete the selected entities, one or several."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.details.deletion import delete_selected
from semmap.nodes.extern.web.panels.details.fields import Fields
from semmap.nodes.extern.web.panels.details.states import draw_common_states
from semmap.nodes.extern.web.views.entities import forms
from semmap.schemas import errors, wording
from semmap.schemas.entities import Entity

_MOST: Final = 12


class Edit:
    """The form of one entity. Typed contents stay when the entity changes."""

    def __init__(self, page: Page, entity: Entity) -> None:
        self._page, self._entity = page, entity
        with ui.expansion("Edit", icon="edit").props("dense").classes("w-full semmap-edit"):
            self._fields = Fields(page, named=False)
            with ui.row().classes("w-full items-center justify-between q-mt-sm"):
                if page.is_allowed("remove"):
                    ui.button("Delete", icon="delete", on_click=self._delete).props("flat color=negative")
                ui.space()
                ui.button("Reset", on_click=self._reset).props("flat")
                ui.button("Save", on_click=self._save).props("unelevated")
        self._fields.set_classes(forms.class_choices(page.live.classes))
        self._reset()

    def show(self, entity: Entity) -> None:
        """Show the current values, unless the form has been edited."""
        untouched = self._fields.form == self._before
        self._entity = entity
        if untouched:
            self._reset()

    def _reset(self) -> None:
        self._fields.set_form(forms.form_of(self._entity))
        self._before = self._fields.form

    async def _save(self) -> None:
        filled = self._fields.form
        try:
            command = forms.build_update(self._entity, filled, self._before)
        except errors.BadRequest as error:
            self._page.notify(error.text, "warning")
            return
        if command is None:
            self._page.notify("no changes to save")
            return
        if (reply := await self._page.change(command)) is not None:
            self._before = filled
            self._page.notify("; ".join((reply.text, *reply.notes)), "positive")

    async def _delete(self) -> None:
        await delete_selected(self._page)


def draw_several(page: Page, names: tuple[str, ...]) -> None:
    """Draw the forms for several entities."""
    entities = tuple(page.state.entities[name] for name in names)
    ui.label(f"{wording.entities(len(names))} selected").classes("semmap-heading").props(
        'role="heading" aria-level="2"'
    )
    with ui.row().classes("w-full gap-1"):
        for name in names[:_MOST]:
            _chip(page, name)
        if len(names) > _MOST:
            ui.label(f"… and {len(names) - _MOST} more").classes("semmap-quiet")
    if not page.moment.is_now:
        return
    if page.is_allowed("update"):
        ui.label("Offset").classes("semmap-title")
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
    if page.is_allowed("set"):
        ui.label("Common states").classes("semmap-title")
        draw_common_states(page, entities)
    if page.is_allowed("remove"):
        ui.button("Delete all", icon="delete", on_click=lambda: _delete(page)).props("flat color=negative")


def _chip(page: Page, name: str) -> None:
    ui.chip(name, on_click=lambda: page.select([name], by="detail")).props("dense outline clickable")


async def _delete(page: Page) -> None:
    await delete_selected(page)


async def _move(page: Page, names: tuple[str, ...], by: list[float | None]) -> None:
    present = [page.live.entities[name] for name in names if name in page.live.entities]
    try:
        command = forms.build_move(present, by)
    except errors.BadRequest as error:
        page.notify(error.text, "warning")
        return
    if (reply := await page.change(command)) is not None:
        page.notify(reply.text, "positive")
