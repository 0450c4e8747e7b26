"""The trees of classes and of places. A selected node filters the table of entities."""

from __future__ import annotations

from typing import Any, Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.map_view import MapView
from semmap.nodes.extern.web.views.trees import Node, class_tree, place_tree

_OPEN_DEPTH: Final = 2


def classes(page: Page) -> None:
    """Draw the class tree with the number of entities of each class."""
    view = MapView.of(page)
    with_empty = ui.switch("Include unused classes").props("dense size=sm")

    def on_select(event: Any) -> None:
        view.set_filter(class_=str(event.value or "").rpartition("/")[2])

    tree = ui.tree([], on_select=on_select).classes("w-full")
    tree.props('dense no-transition selected-color=primary aria-label="Classes"')
    drawn: list[Node] = []

    def draw() -> None:
        nonlocal drawn
        nodes = class_tree(page.live.classes, page.state.entities.values(), with_empty=bool(with_empty.value))
        if nodes != drawn:
            is_first, drawn = not drawn, nodes
            tree.props["nodes"] = nodes
            if is_first and nodes:
                tree.expand(_ids_to_depth(nodes, _OPEN_DEPTH))

    def follow_filter() -> None:
        """Deselect a class that is no longer in the filter, which other panels change, too."""
        if str(tree.props.get("selected") or "").rpartition("/")[2] != view.filter.class_:
            tree.deselect()

    with_empty.on_value_change(draw)
    view.on_filter(follow_filter)
    view.redraw_periodically(draw, 1.0)


def places(page: Page) -> None:
    """Draw the tree of places with the number of entities in each place."""
    view = MapView.of(page)

    def on_select(event: Any) -> None:
        name = event.value or ""
        view.set_filter(room=name)
        if name:
            page.select([name], by="places")

    tree = ui.tree([], on_select=on_select).classes("w-full")
    tree.props('dense no-transition selected-color=primary aria-label="Places"')
    empty = ui.label("The map has no places.").classes("text-caption q-pa-sm")
    drawn: list[Node] = []

    def draw() -> None:
        nonlocal drawn
        nodes = place_tree(page.state.entities, view.locations)
        empty.set_visibility(not nodes)
        if nodes != drawn:
            is_first, drawn = not drawn, nodes
            tree.props["nodes"] = nodes
            if is_first:
                tree.expand()

    def follow_filter() -> None:
        """Deselect a place that is no longer in the filter, which other panels change, too."""
        if (tree.props.get("selected") or "") != view.filter.room:
            tree.deselect()

    view.on_filter(follow_filter)
    view.redraw_periodically(draw, 1.0)


def _ids_to_depth(nodes: list[Node], depth: int) -> list[str]:
    """Return the ids of the nodes down to a depth."""
    if depth <= 0:
        return []
    return [id for node in nodes for id in (node["id"], *_ids_to_depth(node["children"], depth - 1))]
