"""The class tree with how many there are of each; a class that is chosen filters the table."""

from __future__ import annotations

from typing import Any, Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.view import View
from semmap.nodes.extern.web.views.trees import Node, class_tree

_OPEN_DEPTH: Final = 2


def classes(page: Page) -> None:
    """Draw it where it is called."""
    view = View.of(page)
    with_empty = ui.switch("also classes of which there is nothing").props("dense size=sm")

    def chosen(event: Any) -> None:
        view.want(class_=str(event.value or "").rpartition("/")[2])

    tree = ui.tree([], on_select=chosen).classes("w-full")
    tree.props('dense no-transition selected-color=primary aria-label="Classes"')
    drawn: list[Node] = []

    def draw() -> None:
        nonlocal drawn
        nodes = class_tree(page.live.classes, page.state.entities.values(), with_empty=bool(with_empty.value))
        if nodes != drawn:
            is_first, drawn = not drawn, nodes
            tree.props["nodes"] = nodes
            if is_first and nodes:
                tree.expand(_upper(nodes, _OPEN_DEPTH))

    def follow() -> None:
        """The filter may have been changed elsewhere: no class stays marked that it is not set to."""
        if str(tree.props.get("selected") or "").rpartition("/")[2] != view.wanted.class_:
            tree.deselect()

    with_empty.on_value_change(draw)
    view.on_wanted(follow)
    view.now_and_then(draw, 1.0)


def _upper(nodes: list[Node], depth: int) -> list[str]:
    """The ids of the nodes down to a depth."""
    if depth <= 0:
        return []
    return [id for node in nodes for id in (node["id"], *_upper(node["children"], depth - 1))]
