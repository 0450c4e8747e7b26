"""How a tab is laid out: what there is to the left, the scene in the middle, details to the right."""

from __future__ import annotations

from collections.abc import Callable

from nicegui import ui

from nodes.extern.web.page import Page
from nodes.extern.web.panels.add import add
from nodes.extern.web.panels.classes import classes
from nodes.extern.web.panels.consistency import consistency
from nodes.extern.web.panels.detail import detail
from nodes.extern.web.panels.edit import edit
from nodes.extern.web.panels.entities import entities
from nodes.extern.web.panels.files import files
from nodes.extern.web.panels.find import find
from nodes.extern.web.panels.graph import graph
from nodes.extern.web.panels.history import history
from nodes.extern.web.panels.log import log
from nodes.extern.web.panels.places import places
from nodes.extern.web.panels.plan import plan
from nodes.extern.web.panels.refused import refused
from nodes.extern.web.panels.sparql import sparql
from nodes.extern.web.panels.standing import standing
from nodes.extern.web.panels.status import status
from nodes.extern.web.panels.timeline import timeline
from schemas import wording

Panel = Callable[[Page], None]

LEFT: dict[str, Panel] = {"Entities": entities, "Classes": classes, "Places": places}
CENTRE: dict[str, tuple[Panel, ...]] = {
    "History": (history,),
    "Graph": (graph,),
    "Plan": (plan,),
    "SPARQL": (sparql, standing),
    "Check": (consistency,),
    "Files": (files,),
    "System": (status, log),
}


def layout(page: Page) -> None:
    """Draw everything of a tab."""
    page.refuse = lambda command, error: refused(page, command, error)
    ui.query(".nicegui-content").classes("p-0 gap-0")
    with ui.header().classes("items-center"):
        ui.label("semmap").classes("text-h6")
        find(page)
        _state(page)
    with ui.left_drawer(value=True).classes("p-0"):
        _tabs(page, {name: (panel,) for name, panel in LEFT.items()})
    with ui.right_drawer(value=True).classes("p-0"):
        _tabs(page, {"Details": (detail, edit), "Add": (add,)})
    _tabs(page, {"Scene": (scene,), **CENTRE})
    with ui.footer():
        timeline(page)


def _state(page: Page) -> None:
    """Which moment is shown, and whether it goes on."""
    label = ui.label()

    def show() -> None:
        entities = wording.entities(len(page.state.entities))
        label.text = f"commit {page.state.commit}, {entities}" if page.live.connected else page.live.why_not

    page.on_change(show)
    page.on_connection(show)
    show()


def scene(page: Page) -> None:
    """The frame in which viser draws."""
    if page.draw_scene is not None:
        page.draw_scene()


def _tabs(page: Page, panels: dict[str, tuple[Panel, ...]]) -> None:
    with ui.tabs() as tabs:
        for name in panels:
            ui.tab(name)
    with ui.tab_panels(tabs, value=next(iter(panels)), animated=False, keep_alive=True).classes("w-full"):
        for name, drawn in panels.items():
            with ui.tab_panel(name):
                for panel in drawn:
                    panel(page)
