"""The scene in a tab: the frame in which viser draws, and a toolbar with switches."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.redraw import visibility_check
from semmap.nodes.extern.web.proxy import PATH
from semmap.nodes.extern.web.scene.tab import SWITCHES, Switch, TabScene

_ICONS: Final[dict[Switch, str]] = {
    "names": "label",
    "walls": "border_style",
    "relations": "timeline",
    "viewer-relative relations": "visibility",
    "boxes": "check_box_outline_blank",
    "observations": "center_focus_weak",
    "cloud": "grain",
    "cameras": "photo_camera",
}


def scene(page: Page, tab: TabScene) -> None:
    """Draw the scene."""
    tab.is_in_view = visibility_check()
    frame = ui.element("iframe").props(f'src="{PATH}/{page.id}/" title="3-D scene"')
    with ui.element("div").classes("semmap-scene-tools").props('role="toolbar" aria-label="Scene"'):
        for name in SWITCHES:
            _switch(tab, name)
        home = ui.button(icon="home", on_click=tab.show_all).tooltip("Show all")
        home.props('flat dense round color=secondary aria-label="Show all"')
    selection = ui.label().classes("semmap-unseen").props('role="status" aria-label="Selected"')
    past = ui.label().classes("semmap-scene-past").props('role="status"')

    def show() -> None:
        past.text = f"commit {page.state.commit:,}"
        past.visible = not page.moment.is_now
        frame.classes(**{"remove" if page.moment.is_now else "add": "is-past"})

    def show_selection() -> None:
        selection.text = ", ".join(page.selected[:20])

    page.on_select(show_selection)
    page.on_change(show)
    page.on_moment(show)
    show()


def _switch(tab: TabScene, name: Switch) -> None:
    button = ui.button(icon=_ICONS[name]).tooltip(SWITCHES[name])

    def show() -> None:
        is_on = name in tab.on
        colour = "primary" if is_on else "grey-6"
        button.props(f'flat dense round color={colour} aria-pressed={str(is_on).lower()} aria-label="{name}"')

    def toggle() -> None:
        tab.switch(name, on=name not in tab.on)
        show()

    button.on_click(toggle)
    show()
