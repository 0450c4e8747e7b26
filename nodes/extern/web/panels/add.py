"""The form that adds an entity: its class by typing, its place by numbers or by a click in the scene."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.fields import Fields
from semmap.nodes.extern.web.panels.view import View
from semmap.nodes.extern.web.views import forms
from semmap.schemas import errors


def add(page: Page) -> None:
    """Draw it where it is called; only for who may add."""
    view = View.of(page)
    with ui.column().classes("w-full gap-3"):
        fields = Fields(page, named=True)
        with ui.row().classes("w-full justify-end gap-2"):
            ui.button("Clear", on_click=lambda: fields.fill(forms.Filled())).props("flat")
            button = ui.button("Add", icon="add").props("unelevated")

    async def send() -> None:
        try:
            command = forms.add(fields.filled)
        except errors.BadRequest as error:
            page.tell(_sentence(error.text), "warning")
            return
        button.disable()
        try:
            done = await page.change(command)
        finally:
            button.enable()
        if done is None:
            return
        page.tell("; ".join((done.text, *done.notes)), "positive")
        fields.fill(forms.Filled(class_=command.class_))
        await _shown(page, done.names)

    button.on_click(send)

    def offer(_: Any = None) -> None:
        fields.offer(forms.class_choices(page.live.classes))

    view.now_and_then(offer, 5.0)


async def _shown(page: Page, names: tuple[str, ...]) -> None:
    """Select what was added as soon as this tab knows of it."""
    import asyncio

    for _ in range(40):
        if all(name in page.state.entities for name in names):
            page.select(names, by="add")
            return
        await asyncio.sleep(0.05)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."
