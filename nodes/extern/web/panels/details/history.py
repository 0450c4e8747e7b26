"""The history of one entity, with buttons that show or undo each commit."""

from __future__ import annotations

from collections.abc import Iterable

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.rows import Rows
from semmap.nodes.extern.web.views.entities.entity_history import Event, history_events
from semmap.schemas.commands import Undo
from semmap.schemas.errors import shortened
from semmap.schemas.replies import LoggedCommit


class History:
    """The commits that changed one entity, the newest first."""

    def __init__(self, page: Page, name: str) -> None:
        """Draw an empty list."""
        self._page, self._name = page, name
        listed = ui.element("ol").classes("semmap-history").props('aria-label="History"')
        self._rows = Rows(listed, self._draw, tag="li")

    def show(self, commits: Iterable[LoggedCommit]) -> None:
        """Show these commits."""
        entities = self._page.state.entities.values()
        places = [entity for entity in entities if entity.place and entity.name != self._name]
        self._rows.show((event.commit, event) for event in history_events(self._name, commits, places))

    def _draw(self, event: Event) -> None:
        page = self._page
        for text in event.texts:
            ui.label(shortened(text, 1000))
        with ui.row().classes("w-full items-center gap-1 no-wrap"):
            confidence = f", confidence {event.confidence}" if event.confidence else ""
            title = f"commit {event.commit} · {event.when.replace('T', ' ')} · {event.by}{confidence}"
            ui.label(shortened(f"{title} · {event.reason}", 300)).classes("text-caption grow").style(
                "min-width: 0"
            )
            _button(
                "visibility", f"Show the map after commit {event.commit}", lambda: page.go_to(event.commit)
            )
            if page.is_allowed("undo") and page.moment.is_now:
                _button("undo", f"Undo commit {event.commit}", lambda: _undo(page, event.commit))


def _button(icon: str, label: str, on_click: object) -> None:
    button = ui.button(icon=icon, on_click=on_click).props("flat round dense size=sm")  # type: ignore[arg-type]
    button.props["aria-label"] = label
    button.tooltip(label)


async def _undo(page: Page, commit: int) -> None:
    if (reply := await page.change(Undo(commit=commit))) is not None:
        page.notify(reply.text, "positive")
