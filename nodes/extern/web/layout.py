"""The layout of a tab: lists on the left, views in the middle, details on the right."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from nicegui import events, ui
from nicegui.elements.mixins.text_element import TextElement

from semmap.nodes.extern.web.keyboard_moves import KeyboardMoves
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.commits import commits
from semmap.nodes.extern.web.panels.consistency import consistency
from semmap.nodes.extern.web.panels.details.add import add
from semmap.nodes.extern.web.panels.details.deletion import delete_selected, undo
from semmap.nodes.extern.web.panels.details.detail import detail
from semmap.nodes.extern.web.panels.details.rejection import show_rejection
from semmap.nodes.extern.web.panels.entities import entities
from semmap.nodes.extern.web.panels.files import files
from semmap.nodes.extern.web.panels.find import find
from semmap.nodes.extern.web.panels.graph import graph
from semmap.nodes.extern.web.panels.log import log
from semmap.nodes.extern.web.panels.ontology import ontology
from semmap.nodes.extern.web.panels.plan import plan
from semmap.nodes.extern.web.panels.sparql import sparql
from semmap.nodes.extern.web.panels.standing_queries import standing_queries
from semmap.nodes.extern.web.panels.status import status
from semmap.nodes.extern.web.panels.timeline import timeline
from semmap.nodes.extern.web.panels.trees import classes, places
from semmap.nodes.extern.web.status_attributes import add_status_attributes
from semmap.schemas import wording

Panel = Callable[[Page], None]
Panels = Mapping[str, Sequence[Panel]]

_HERE: Final = Path(__file__).parent
_CSS: Final = (_HERE / "page.css").read_text()
_SCRIPT: Final = (_HERE / "page.js").read_text()

LEFT: Final[Panels] = {"Entities": (entities,), "Classes": (classes,), "Places": (places,)}
RIGHT: Final[Panels] = {"Details": (detail,), "Add": (add,)}
CENTRE: Final[Panels] = {
    "Scene": (),
    "History": (commits,),
    "Graph": (graph,),
    "Plan": (plan,),
    "SPARQL": (sparql, standing_queries),
    "Ontology": (ontology,),
    "Check": (consistency,),
    "Files": (files,),
    "System": (status, log),
}
_LEFT_PX, _RIGHT_PX, _TABLE_PX = 340, 370, 760
"""Width of the lists and of the details in a large window, and of the lists with all columns."""
_LEAST_PX: Final = 200
_NARROW_PX: Final = 960
"""Up to here a drawer covers the views, as on a phone."""
_SHARE: Final = 0.26
"""The width of the lists and of the details in a small window; the rest is for the views."""
KEYS: Final = {
    "/": "search",
    "Del": "delete the selected entities, after a confirmation",
    "u": "undo the last change",
    "Home": "return to the current map",
    "f": "show the selected entities in the scene; so does a double click there",
    "arrow keys": "move the selected entities by 10 cm, with Shift by 1 cm",
    "Esc": "cancel dragging or picking; otherwise clear the selection",
    "?": "show this list",
}


def layout(page: Page) -> None:
    """Draw a tab."""
    page.show_rejection = lambda command, error: show_rejection(page, command, error)
    ui.add_css(_CSS)
    ui.add_body_html(f"<script>{_SCRIPT}</script>")
    ui.colors(primary="#0f766e", secondary="#475569", accent="#0f766e", dark="#171b20", dark_page="#101316")
    dark = ui.dark_mode(None)
    with ui.header(elevated=False).classes("semmap-header") as header:
        pass
    with ui.left_drawer(bordered=False, value=True).props("breakpoint=960") as left:
        lists = _Width(left, "left", _LEFT_PX)
        page.set_wide_lists = lambda wide: lists.set_usual(_TABLE_PX if wide else _LEFT_PX)
        _Tabs(page, LEFT, "Lists").draw()
    with ui.right_drawer(bordered=False, value=True).props("breakpoint=960") as right:
        widths = (lists, _Width(right, "right", _RIGHT_PX))
        allowed = {name: panels for name, panels in RIGHT.items() if name != "Add" or page.is_allowed("add")}
        details = _Tabs(page, allowed, "Details and adding")
        details.draw()
    with ui.column().classes("semmap-centre").props("id=views tabindex=-1"):
        _draw_offline_banner(page)
        centre = _Tabs(page, CENTRE, "Views")
        centre.draw()
        stage = centre.containers["Scene"].classes("semmap-scene")
        with ui.element("div").classes("semmap-time"):
            timeline(page)

    def open_add() -> None:
        right.show()
        details.show("Add")

    with header:
        _draw_header(page, left, right, dark, open_add)
    _bind_keys(page)
    _bind_appearance(page, left, right, widths)
    add_status_attributes(page)
    ui.on("semmap_scene", lambda: _begin_scene(page, stage))
    ui.timer(0.05, lambda: _mark_ready(page), once=True)


def _mark_ready(page: Page) -> None:
    """Mark the page as drawn, except the scene. Tests wait for this mark."""
    page.client.run_javascript("semmapStart(); document.body.classList.add('semmap-ready')")


def _begin_scene(page: Page, stage: ui.element) -> None:
    """Draw the scene. It comes last, because the browser draws everything on one thread."""
    draw, page.draw_scene = page.draw_scene, None
    if draw is not None:
        with stage:
            draw()


def _draw_header(
    page: Page, left: ui.left_drawer, right: ui.right_drawer, dark: ui.dark_mode, open_add: Callable[[], None]
) -> None:
    ui.link("Skip to the views", "#views").classes("semmap-skip")
    _bind_expanded(_icon("menu", "Show or hide the lists", left.toggle), left)
    heading("semmap", 1).classes("semmap-name")
    with ui.element("div").classes("semmap-search").props('role="search"'):
        find(page)
    ui.element("div").classes("semmap-space")
    _draw_state(page)
    if page.is_allowed("add"):
        _icon("add", "Add an entity", open_add)
    if page.is_allowed("undo"):
        _icon("undo", "Undo the last change (u)", lambda: undo(page))

    def toggle_dark() -> None:
        dark.value = not page.dark

    _icon("dark_mode", "Toggle dark mode", toggle_dark)
    _icon("keyboard", "Keyboard shortcuts (?)", show_keys).classes("semmap-wide")
    _bind_expanded(_icon("view_sidebar", "Show or hide the details", right.toggle), right)


def heading(text: str, level: int) -> TextElement:
    """Draw a heading: level 1 for the page, 2 for its panels."""
    return TextElement(tag=f"h{level}", text=text)


def _icon(icon: str, label: str, on_click: Callable[..., Any]) -> ui.button:
    """Draw an icon button with an accessible label."""
    button = ui.button(icon=icon, on_click=on_click).props(
        f'flat round dense color=secondary aria-label="{label}"'
    )
    return button.tooltip(label)


def _bind_expanded(button: ui.button, drawer: ui.left_drawer | ui.right_drawer) -> None:
    """Keep `aria-expanded` of the button equal to the state of the drawer."""

    def show() -> None:
        button.props["aria-expanded"] = str(bool(drawer.value)).lower()

    drawer.on_value_change(show)
    show()


def _draw_state(page: Page) -> None:
    """Draw the commit shown, the number of entities, and a button that returns to the current map."""
    with ui.element("div").classes("semmap-state").props('role="status"'):
        dot = ui.element("span").classes("semmap-dot")
        commit = ui.label().classes("semmap-commit")
        count = ui.label().classes("semmap-entities")
        back = ui.button("Back to now", on_click=lambda: page.go_to(None)).props(
            "dense unelevated color=warning text-color=black padding='2px 10px'"
        )

    def show() -> None:
        is_now, is_away = page.moment.is_now, not page.live.connected
        dot.classes(
            add="is-away" if is_away else "" if is_now else "is-past",
            remove="is-past" if is_away or is_now else "is-away",
        )
        if not is_away:
            dot.classes(remove="is-away")
        commit.text = f"commit {page.state.commit:,}" if page.state.commit >= 0 else ""
        count.text = wording.entities(len(page.state.entities)) if page.state.commit >= 0 else ""
        back.visible = not is_now

    page.on_change(show)
    page.on_connection(show)
    show()


def _draw_offline_banner(page: Page) -> None:
    """Draw a banner that is visible while there is no connection to the knowledge base."""
    banner = ui.label().classes("semmap-away").props('role="alert"')

    def show() -> None:
        banner.text = f"{page.live.offline_reason[:1].upper()}{page.live.offline_reason[1:]}."
        banner.visible = not page.live.connected

    page.on_connection(show)
    show()


def _bind_keys(page: Page) -> None:
    page.on_key("u", lambda: page.start_task(undo(page)))
    page.on_key("Delete", lambda: page.start_task(delete_selected(page)))
    page.on_key("Home", lambda: page.go_to(None))
    page.on_key("Escape", page.escape)
    page.on_key("?", show_keys)
    KeyboardMoves(page)
    ui.on("semmap_key", lambda event: page.press(_event_data(event).get("key", "")))


class _Width:
    """The width of a drawer [px]: what the user has set by its grip, or else what fits the window."""

    def __init__(self, drawer: ui.left_drawer | ui.right_drawer, side: str, usual_px: int) -> None:
        self._drawer = drawer
        self._side = side
        self._usual_px = usual_px
        self._set_px = 0
        """What the user has set; 0 before that."""
        self._window_px = 1280
        name = "lists" if side == "left" else "details"
        self._grip = ui.element("div").classes(f"semmap-grip is-{side}")
        self._grip.props(f'role=separator tabindex=0 aria-label="Width of the {name}" data-side={side}')
        self._show()

    def set_usual(self, usual_px: int) -> None:
        """Set the width that the content needs; it replaces what the user has set."""
        self._usual_px, self._set_px = usual_px, 0
        self._show()

    def set_window(self, window_px: int) -> None:
        """Fit the width of the browser window."""
        self._window_px = window_px
        self._show()

    def on_grip(self, event: events.GenericEventArguments) -> None:
        """Set the width that the user asks for; 0 returns to what fits the window."""
        request = _event_data(event)
        if request.get("side") == self._side and isinstance(px := request.get("px"), int | float):
            self._set_px = round(px)
            self._show()

    def _show(self) -> None:
        is_table = self._usual_px == _TABLE_PX
        fitting_px = self._usual_px if is_table else min(self._usual_px, round(_SHARE * self._window_px))
        px = min(max(self._set_px or fitting_px, _LEAST_PX), max(_LEAST_PX, self._window_px // 2))
        if self._window_px <= _NARROW_PX:
            px = self._usual_px
        self._drawer.props(f"width={px}")
        self._grip.props(f"aria-valuenow={px}")


def _bind_appearance(
    page: Page, left: ui.left_drawer, right: ui.right_drawer, widths: Sequence[_Width]
) -> None:
    """Receive from the browser whether it is dark, and its width; a narrow one shows one drawer at a time."""
    for width in widths:
        ui.on("semmap_width", width.on_grip)

    def on_report(event: events.GenericEventArguments) -> None:
        report = _event_data(event)
        if isinstance(window_px := report.get("width"), int):
            for width in widths:
                width.set_window(window_px)
        is_first, was_narrow = not page.is_appearance_known, page.narrow
        page.set_appearance(dark=report.get("dark") is True, narrow=report.get("narrow") is True)
        if page.narrow and (is_first or not was_narrow):
            left.hide()
            right.hide()

    def on_select() -> None:
        if page.narrow and page.selected and page.selected_by not in ("scene", "ticks"):
            left.hide()
            right.show()

    ui.on("semmap_appearance", on_report)
    page.on_select(on_select)


def _event_data(event: events.GenericEventArguments) -> dict[str, Any]:
    """Return the data of a browser event; empty if it is not an object."""
    data = event.args[0] if isinstance(event.args, list) and event.args else event.args
    return data if isinstance(data, dict) else {}


def show_keys() -> None:
    """Show the keyboard shortcuts in a dialog."""
    with ui.dialog(value=True).props('aria-label="Keyboard shortcuts"') as dialog, ui.card():
        heading("Keyboard shortcuts", 2).classes("text-h6")
        with ui.element("table").classes("semmap-keys"), ui.element("tbody"):
            for key, action in KEYS.items():
                with ui.element("tr"):
                    with ui.element("td"):
                        TextElement(tag="kbd", text=key)
                    with ui.element("td"):
                        ui.label(action)
        with ui.row().classes("w-full justify-end"):
            ui.button("Close", on_click=dialog.close).props("flat autofocus")
    dialog.on("hide", dialog.delete)


class _Tabs:
    """Tabs of panels. Each tab is drawn when it is first shown."""

    def __init__(self, page: Page, panels: Panels, label: str) -> None:
        self._page = page
        self._panels = panels
        self._label = label
        self._drawn: set[str] = set()
        self.containers: dict[str, ui.column] = {}

    def draw(self) -> None:
        """Draw the tabs, and show the first one."""
        first = next(iter(self._panels))
        with ui.column().classes("semmap-drawer"):
            self._tabs = ui.tabs(on_change=lambda event: self._on_change(str(event.value)))
            self._tabs.classes("semmap-tabs").props(f'dense align=left no-caps aria-label="{self._label}"')
            with self._tabs:
                for name in self._panels:
                    ui.tab(name)
            for name in self._panels:
                container = ui.column().classes("semmap-panel").props(f'role="tabpanel" aria-label="{name}"')
                self.containers[name] = container
        self.show(first)

    def show(self, name: str) -> None:
        """Show a tab."""
        self._tabs.value = name

    def _on_change(self, name: str) -> None:
        for other, container in self.containers.items():
            container.visible = other == name
        if name not in self._drawn:
            self._drawn.add(name)
            with self.containers[name]:
                heading(name, 2).classes("semmap-unseen")
                for panel in self._panels[name]:
                    panel(self._page)
        self._page.tab_changed()
