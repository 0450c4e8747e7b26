"""The ontology: the superclasses, axioms, users and entities of one class."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.class_requests import ClassReport, ClassRequests
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.details.proof import draw_proof
from semmap.nodes.extern.web.panels.widgets.folded_list import draw_error, draw_folded
from semmap.nodes.extern.web.panels.widgets.map_view import MapView
from semmap.nodes.extern.web.panels.widgets.redraw import LazyRedraw
from semmap.nodes.extern.web.panels.widgets.select_field import SelectField
from semmap.nodes.extern.web.views.class_details import (
    ClassDetails,
    axiom_sentences,
    clash_sentence,
    class_details,
    class_names,
    class_options,
    is_unsatisfiable,
)
from semmap.ontology import vocabulary as v
from semmap.schemas import wording
from semmap.schemas.entities import ClassInfo

_MOST: Final = 12
"""The number of classes that are shown at once."""


def ontology(page: Page) -> None:
    """Draw the view of a class; the selection in the class tree is shown, too."""
    _Ontology(page)


class _Ontology:
    def __init__(self, page: Page) -> None:
        self._page, self._view = page, MapView.of(page)
        self._requests = ClassRequests(page.live, self._view.knowledge)
        self._classes: tuple[ClassInfo, ...] = ()
        """The classes that are offered."""
        self._redraw: LazyRedraw | None = None
        self._class = (
            SelectField({}, label="Class", with_input=True, clearable=True)
            .props("dense outlined options-dense hide-bottom-space")
            .classes("w-full")
            .on_value_change(self._again)
        )
        self._content = ui.column().classes("w-full gap-2 semmap-ontology")
        self._view.on_filter(self._follow_filter)
        self._view.on_entities_changed(self._again)
        self._offer(self._view.filter.class_)
        self._redraw = LazyRedraw(page, self._draw)

    def _again(self, *_: object) -> None:
        if self._redraw is not None:
            self._redraw.mark_stale()

    def _follow_filter(self) -> None:
        if self._view.filter.class_:
            self._show(self._view.filter.class_)

    def _show(self, name: str) -> None:
        if name in self._class.options:
            self._class.value = name
        else:  # not a class of physical things
            self._offer(name)

    async def _draw(self) -> None:
        """Draw the class, when everything about it is known."""
        page = self._page
        self._update_options()
        classes = {c.name: c for c in page.live.classes}
        name = str(self._class.value or "")
        if name not in classes:
            self._content.clear()
            with self._content:
                ui.label("Choose a class here, or in the class tree.").classes("semmap-quiet")
            return
        known = classes[name]
        details = class_details(
            name, classes, self._view.knowledge.properties.values(), page.state.entities.values()
        )
        report = await self._requests.fetch(known)
        named = [v.iri(classes[parent].iri) for parent in details.superclasses if parent in classes]
        axioms = axiom_sentences(report.axioms, named, self._view.knowledge.words)
        users = tuple(user for user in class_names(report.users, classes.values()) if user != name)
        self._content.clear()
        with self._content:
            self._draw_class(known, details, axioms, users, report)
            if report.problem is not None:
                draw_error(report.problem.text, classes="text-negative")

    def _update_options(self) -> None:
        """Offer the classes of the current ontology; the chosen one is kept if it still exists."""
        if self._page.live.classes is not self._classes:
            self._offer(str(self._class.value or ""))

    def _offer(self, chosen: str) -> None:
        self._classes = self._page.live.classes
        options = class_options(self._classes, chosen)
        self._class.set_options(options, value=chosen if chosen in options else None)

    def _draw_class(
        self,
        known: ClassInfo,
        details: ClassDetails,
        axioms: Sequence[str],
        users: Sequence[str],
        report: ClassReport,
    ) -> None:
        clash = report.clash
        is_faulty = clash is not None and is_unsatisfiable(known, clash.explanation)
        tone = "text-negative" if is_faulty else ""
        ui.label(details.title).classes(f"semmap-heading {tone}").props('role="heading" aria-level="3"')
        ui.label(known.iri).classes("semmap-quiet semmap-iri")
        if clash is not None:
            with ui.column().classes("w-full gap-0").props('role="alert"'):
                draw_error(clash_sentence(known, clash, report.commit), classes=tone)
                if clash.explanation is not None:
                    with ui.expansion("Proof").classes("w-full").props("dense"):
                        draw_proof(clash.explanation, self._view.knowledge.words, sentence=False)
        if details.comment:
            ui.label(details.comment).classes("semmap-sentence")
        self._draw_classes("Superclasses", details.superclasses)
        self._draw_classes("Inherited superclasses", details.inherited)
        self._draw_classes("Subclasses", details.subclasses)
        _draw_list("Axioms", axioms)
        self._draw_classes("Used in axioms of", users)
        _draw_list("Used by properties", details.properties)
        self._draw_entities(details)

    def _draw_classes(self, title: str, names: Sequence[str]) -> None:
        if not names:
            return
        ui.label(title).classes("semmap-title")
        with ui.row().classes("w-full gap-1"):
            for name in names[:_MOST]:
                chip = ui.chip(name, on_click=lambda name=name: self._show(name))
                chip.props("dense outline clickable")
            if len(names) > _MOST:
                ui.label(f"… and {len(names) - _MOST} more").classes("semmap-quiet")

    def _draw_entities(self, details: ClassDetails) -> None:
        every = (*details.asserted, *details.inferred)
        ui.label("Entities").classes("semmap-title")
        with ui.row().classes("w-full items-center gap-2"):
            if details.inferred:
                counts = f"{len(details.asserted)} asserted, {len(details.inferred)} inferred"
            else:
                counts = wording.entities(len(every))
            ui.label(counts)
            if every:
                ui.button("Select", on_click=lambda: self._page.select(every, by="ontology")).props(
                    "flat dense"
                )


def _draw_list(title: str, lines: Sequence[str]) -> None:
    if lines:
        ui.label(title).classes("semmap-title")
        with ui.column().classes("w-full gap-0"):
            draw_folded(lines)
