"""The scene in a tab: the frame in which viser draws, and above it what may be switched on."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.redrawing import in_view
from semmap.nodes.extern.web.proxy import PATH
from semmap.nodes.extern.web.scene.tab import SWITCHES, Switch, TabScene

_ICONS: Final[dict[Switch, str]] = {
    "names": "label",
    "walls": "border_style",
    "relations": "timeline",
    "from here": "visibility",
    "boxes": "check_box_outline_blank",
    "observations": "center_focus_weak",
    "cloud": "grain",
    "cameras": "photo_camera",
}


def scene(page: Page, tab: TabScene) -> None:
    """Draw it where it is called."""
    tab.is_in_view = in_view()
    frame = ui.element("iframe").props(f'src="{PATH}/{page.id}/" title="The scene in three dimensions"')
    with ui.element("div").classes("semmap-scene-tools").props('role="toolbar" aria-label="The scene"'):
        for name in SWITCHES:
            _switch(tab, name)
        home = ui.button(icon="home", on_click=tab.look_over).tooltip("Look at everything")
        home.props('flat dense round color=secondary aria-label="Look at everything"')
    said = ui.label().classes("semmap-unseen").props('role="status" aria-label="Selected"')
    past = ui.label().classes("semmap-scene-past").props('role="status"')

    def show() -> None:
        past.text = f"as it was after commit {page.state.commit:,}"
        past.visible = not page.moment.is_now
        frame.classes(**{"remove" if page.moment.is_now else "add": "is-past"})

    def say() -> None:
        said.text = ", ".join(page.selected[:20])

    page.on_select(say)
    page.on_change(show)
    page.on_moment(show)
    show()


def _switch(tab: TabScene, name: Switch) -> None:
    button = ui.button(icon=_ICONS[name]).tooltip(SWITCHES[name])

    def show() -> None:
        is_on = name in tab.on
        colour = "primary" if is_on else "grey-6"
        button.props(f'flat dense round color={colour} aria-pressed={str(is_on).lower()} aria-label="{name}"')

    def turn() -> None:
        tab.switch(name, on=name not in tab.on)
        show()

    button.on_click(turn)
    show()
