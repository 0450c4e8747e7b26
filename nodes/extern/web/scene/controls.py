"""The scene in a tab: the frame in which viser draws, and above it what may be switched on."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from nodes.extern.web.page import Page
from nodes.extern.web.proxy import PATH
from nodes.extern.web.scene.tab import SWITCHES, Switch, TabScene

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
_PAST: Final = "outline: 4px solid #e0a030; outline-offset: -4px"


def scene(page: Page, tab: TabScene) -> None:
    """Draw it where it is called."""
    with ui.column().classes("w-full h-full gap-0 relative"):
        with ui.row().classes("w-full items-center gap-1 q-px-sm q-py-xs").props('role="toolbar"'):
            for name in SWITCHES:
                _switch(tab, name)
            ui.button(icon="home", on_click=tab.look_over).props(
                'flat dense aria-label="Look at everything"'
            ).tooltip("Look at everything")
            past = ui.badge(color="orange-8").props('role="status"')
        frame = ui.element("iframe").props(f'src="{PATH}/{page.id}/" title="Scene"').classes("w-full grow")

    def show() -> None:
        past.text = "" if page.moment.is_now else f"as it was after commit {page.state.commit}"
        past.set_visibility(not page.moment.is_now)
        frame.style(replace=f"border: 0; {'' if page.moment.is_now else _PAST}")

    page.on_change(show)
    page.on_moment(show)
    show()


def _switch(tab: TabScene, name: Switch) -> None:
    button = ui.button(icon=_ICONS[name]).tooltip(SWITCHES[name])

    def show() -> None:
        is_on = name in tab.on
        colour = "primary" if is_on else "grey-7"
        button.props(
            f'flat dense color={colour} aria-label="{name.capitalize()}" aria-pressed={str(is_on).lower()}'
        )

    def turn() -> None:
        tab.switch(name, on=name not in tab.on)
        show()

    button.on_click(turn)
    show()
