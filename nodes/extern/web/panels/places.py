"""The tree of places with how many things are in each; a place that is chosen filters the table."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.view import View
from semmap.nodes.extern.web.views.trees import Node, place_tree


def places(page: Page) -> None:
    """Draw it where it is called."""
    view = View.of(page)

    def chosen(event: Any) -> None:
        name = event.value or ""
        view.want(room=name)
        if name:
            page.select([name], by="places")

    tree = ui.tree([], on_select=chosen).classes("w-full")
    tree.props('dense no-transition selected-color=primary aria-label="Places"')
    empty = ui.label("The map has no places.").classes("text-caption q-pa-sm")
    drawn: list[Node] = []

    def draw() -> None:
        nonlocal drawn
        nodes = place_tree(page.state.entities, view.whereabouts)
        empty.set_visibility(not nodes)
        if nodes != drawn:
            is_first, drawn = not drawn, nodes
            tree.props["nodes"] = nodes
            if is_first:
                tree.expand()

    def follow() -> None:
        """The filter may have been changed elsewhere: no place stays marked that it is not set to."""
        if (tree.props.get("selected") or "") != view.wanted.room:
            tree.deselect()

    view.on_wanted(follow)
    view.now_and_then(draw, 1.0)
