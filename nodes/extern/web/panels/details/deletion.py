"""Deletion of the selected entities, after a confirmation, and undo."""

from __future__ import annotations

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.views.entities.deletion_effects import describe_effects, own_facts
from semmap.schemas import wording
from semmap.schemas.commands import Remove, Undo
from semmap.schemas.errors import shortened

_NAMED = 5
_FACTS = 8


async def delete_selected(page: Page) -> None:
    """Delete the selected entities after a confirmation that lists the effects."""
    names = page.selected
    if not page.is_allowed("remove"):
        page.notify("deletion is not permitted for the role of this page", "warning")
        return
    if not names:
        page.notify("no selection; select the entities to delete")
        return
    tried = await page.change(Remove(names=names, dry_run=True))
    if tried is None:
        return
    if (
        await _confirm(page, names, describe_effects(tried), own_facts(tried))
        and (reply := await page.change(Remove(names=names))) is not None
    ):
        page.notify(reply.text, "positive")


async def undo(page: Page) -> None:
    """Undo the last change by a user; steps of the arrow keys that were not sent are discarded."""
    if page.discard_pending is not None and await page.discard_pending():
        page.notify("move discarded")
        return
    if not page.is_allowed("undo"):
        page.notify("undo is not permitted for the role of this page", "warning")
        return
    if (reply := await page.change(Undo())) is not None:
        page.notify(reply.text, "positive")


async def _confirm(
    page: Page, names: tuple[str, ...], effects: tuple[str, ...], facts: tuple[str, ...]
) -> bool:
    """Return whether the user confirms the deletion.

    The dialog belongs to the tab, because the panel with the button may be redrawn, which would delete its
    elements.
    """
    subject = names[0] if len(names) == 1 else wording.entities(len(names))
    with (
        page.client,
        ui.dialog().props('aria-label="Delete"') as dialog,
        ui.card().classes("semmap-refused"),
    ):
        ui.label(f"Delete {shortened(subject, 80)}?").classes("text-h6")
        if len(names) > 1:
            more = f" … and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
            ui.label(", ".join(names[:_NAMED]) + more).classes("semmap-quiet")
        for sentence in effects:
            ui.label(shortened(sentence, 1000)).classes("semmap-sentence")
        if facts:
            with (
                ui.expansion(f"Lost with it: {wording.counted(len(facts), 'inferred fact')}")
                .props("dense")
                .classes("w-full")
            ):
                for fact in facts[:_FACTS]:
                    ui.label(shortened(fact, 200))
                if len(facts) > _FACTS:
                    ui.label(f"… and {len(facts) - _FACTS} more")
        with ui.row().classes("w-full justify-end"):
            ui.button("Cancel", on_click=lambda: dialog.submit(False)).props("flat")
            ui.button("Delete", on_click=lambda: dialog.submit(True)).props("color=negative autofocus")
    chosen = await dialog
    if not dialog.is_deleted:  # closing the tab deletes it
        dialog.delete()
    return bool(chosen)
