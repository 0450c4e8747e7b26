"""Deleting what is selected, once that is confirmed; and taking back the last change."""

from __future__ import annotations

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.views.consequences import consequences, facts_of
from semmap.schemas import wording
from semmap.schemas.commands import Remove, Undo
from semmap.schemas.errors import shortened

_NAMED = 5
_FACTS = 8


async def delete_selected(page: Page) -> None:
    """Ask whether what is selected is to be deleted, and do so if it is."""
    names = page.selected
    if not page.may("remove"):
        page.tell("Your certificate may not delete.", "warning")
        return
    if not names:
        page.tell("Nothing is selected; select what is to be deleted first.")
        return
    tried = await page.change(Remove(names=names, dry_run=True))
    if tried is None:
        return
    if (
        await _confirms(page, names, consequences(tried), facts_of(tried))
        and (done := await page.change(Remove(names=names))) is not None
    ):
        page.tell(done.text, "positive")


async def undo(page: Page) -> None:
    """Take back the newest change that a person asked for."""
    if not page.may("undo"):
        page.tell("Your certificate may not undo.", "warning")
        return
    if (done := await page.change(Undo())) is not None:
        page.tell(done.text, "positive")


async def _confirms(
    page: Page, names: tuple[str, ...], also: tuple[str, ...], facts: tuple[str, ...]
) -> bool:
    """Ask in a dialog of the tab: the panel with the button may be drawn anew, and would take it along."""
    what = names[0] if len(names) == 1 else wording.entities(len(names))
    with (
        page.client,
        ui.dialog().props('aria-label="Delete"') as dialog,
        ui.card().classes("semmap-refused"),
    ):
        ui.label(f"Delete {shortened(what, 80)}?").classes("text-h6")
        if len(names) > 1:
            more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
            ui.label(", ".join(names[:_NAMED]) + more).classes("semmap-quiet")
        for sentence in also:
            ui.label(shortened(sentence, 1000)).classes("semmap-sentence")
        if facts:
            with (
                ui.expansion(f"With it {'goes' if len(facts) == 1 else 'go'} {_counted(facts)}")
                .props("dense")
                .classes("w-full")
            ):
                for fact in facts[:_FACTS]:
                    ui.label(shortened(fact, 200))
                if len(facts) > _FACTS:
                    ui.label(f"and {len(facts) - _FACTS} more")
        with ui.row().classes("w-full justify-end"):
            ui.button("Cancel", on_click=lambda: dialog.submit(False)).props("flat")
            ui.button("Delete", on_click=lambda: dialog.submit(True)).props("color=negative autofocus")
    chosen = await dialog
    if not dialog.is_deleted:  # as it is when the tab is closed
        dialog.delete()
    return bool(chosen)


def _counted(facts: tuple[str, ...]) -> str:
    return wording.counted(len(facts), "inferred fact")
