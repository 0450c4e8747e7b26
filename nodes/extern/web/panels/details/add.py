"""The form that adds an entity."""

from __future__ import annotations

import asyncio
from typing import Any

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.details.fields import Fields
from semmap.nodes.extern.web.panels.widgets.map_view import MapView
from semmap.nodes.extern.web.views.entities import forms
from semmap.schemas import errors


def add(page: Page) -> None:
    """Draw the form; to be called only if the role may add entities."""
    view = MapView.of(page)
    with ui.column().classes("w-full gap-3"):
        fields = Fields(page, named=True)
        with ui.row().classes("w-full justify-end gap-2"):
            ui.button("Clear", on_click=lambda: fields.set_form(forms.EntityForm())).props("flat")
            button = ui.button("Add", icon="add").props("unelevated")

    async def send() -> None:
        try:
            command = forms.build_add(fields.form)
        except errors.BadRequest as error:
            page.notify(error.text, "warning")
            return
        button.disable()
        try:
            reply = await page.change(command)
        finally:
            button.enable()
        if reply is None:
            return
        page.notify("; ".join((reply.text, *reply.notes)), "positive")
        fields.set_form(forms.EntityForm(class_=command.class_))
        await _select_when_known(page, reply.names)

    button.on_click(send)

    def update_classes(_: Any = None) -> None:
        fields.set_classes(forms.class_choices(page.live.classes))

    view.redraw_periodically(update_classes, 5.0)


async def _select_when_known(page: Page, names: tuple[str, ...]) -> None:
    """Select the added entities as soon as the tab has received them."""
    for _ in range(40):
        if all(name in page.state.entities for name in names):
            page.select(names, by="add")
            return
        await asyncio.sleep(0.05)
