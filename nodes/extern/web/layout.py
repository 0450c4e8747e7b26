"""How a tab is laid out: what there is to the left, the scene in the middle, details to the right."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from nicegui import events, ui
from nicegui.elements.mixins.text_element import TextElement

from semmap.nodes.extern.web.deleting import delete_selected, undo
from semmap.nodes.extern.web.marks import marks
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.add import add
from semmap.nodes.extern.web.panels.classes import classes
from semmap.nodes.extern.web.panels.commits import commits
from semmap.nodes.extern.web.panels.consistency import consistency
from semmap.nodes.extern.web.panels.detail import detail
from semmap.nodes.extern.web.panels.entities import entities
from semmap.nodes.extern.web.panels.files import files
from semmap.nodes.extern.web.panels.find import find
from semmap.nodes.extern.web.panels.graph import graph
from semmap.nodes.extern.web.panels.log import log
from semmap.nodes.extern.web.panels.places import places
from semmap.nodes.extern.web.panels.plan import plan
from semmap.nodes.extern.web.panels.refused import refused
from semmap.nodes.extern.web.panels.sparql import sparql
from semmap.nodes.extern.web.panels.standing import standing
from semmap.nodes.extern.web.panels.status import status
from semmap.nodes.extern.web.panels.timeline import timeline
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
    "SPARQL": (sparql, standing),
    "Check": (consistency,),
    "Files": (files,),
    "System": (status, log),
}
_LIST_PX, _TABLE_PX = 340, 760
"""How wide the lists are: with the columns that most want, and with all."""
KEYS: Final = {
    "/": "search",
    "Del": "delete what is selected, after a confirmation",
    "u": "undo the last change",
    "Home": "back to now",
    "Esc": "leave a drag or pointing at a place; otherwise select nothing",
    "?": "this list",
}


def layout(page: Page) -> None:
    """Draw everything of a tab."""
    page.refuse = lambda command, error: refused(page, command, error)
    ui.add_css(_CSS)
    ui.add_body_html(f"<script>{_SCRIPT}</script>")
    ui.colors(primary="#0f766e", secondary="#475569", accent="#0f766e", dark="#171b20", dark_page="#101316")
    dark = ui.dark_mode(None)
    with ui.header(elevated=False).classes("semmap-header") as header:
        pass
    with ui.left_drawer(bordered=False, value=True).props(f"width={_LIST_PX} breakpoint=960") as left:
        page.widen = lambda wide: left.props(f"width={_TABLE_PX if wide else _LIST_PX}")
        _Tabs(page, LEFT, "What there is").draw()
    with ui.right_drawer(bordered=False, value=True).props("width=370 breakpoint=960") as right:
        may = {name: panels for name, panels in RIGHT.items() if name != "Add" or page.may("add")}
        details = _Tabs(page, may, "Details of what is selected, and adding")
        details.draw()
    with ui.column().classes("semmap-centre"):
        _away(page)
        centre = _Tabs(page, CENTRE, "Views")
        centre.draw()
        stage = centre.containers["Scene"].classes("semmap-scene")
        with ui.element("div").classes("semmap-time"):
            timeline(page)

    def open_add() -> None:
        right.show()
        details.show("Add")

    with header:
        _header(page, left, right, dark, open_add)
    _keys(page)
    _look(page, left, right)
    marks(page)
    ui.on("semmap_scene", lambda: _begin_scene(page, stage))
    ui.timer(0.05, lambda: _ready(page), once=True)


def _ready(page: Page) -> None:
    """Everything but the scene is drawn: whoever waits for that, such as a test, sees it."""
    page.client.run_javascript("semmapStart(); document.body.classList.add('semmap-ready')")


def _begin_scene(page: Page, stage: ui.element) -> None:
    """The scene begins when the browser has drawn the rest: both are drawn on the same thread there."""
    draw, page.draw_scene = page.draw_scene, None
    if draw is not None:
        with stage:
            draw()


def _header(
    page: Page, left: ui.left_drawer, right: ui.right_drawer, dark: ui.dark_mode, open_add: Callable[[], None]
) -> None:
    _opens(_icon("menu", "Show or hide the lists", left.toggle), left)
    heading("semmap", 1).classes("semmap-name")
    with ui.element("div").classes("semmap-search").props('role="search"'):
        find(page)
    ui.element("div").classes("semmap-space")
    _state(page)
    if page.may("add"):
        _icon("add", "Add an entity", open_add)
    if page.may("undo"):
        _icon("undo", "Undo the last change (u)", lambda: undo(page))

    def toggle_dark() -> None:
        dark.value = not page.dark

    _icon("dark_mode", "Dark or light", toggle_dark)
    _icon("keyboard", "Keys (?)", help_).classes("semmap-wide")
    _opens(_icon("view_sidebar", "Show or hide the details", right.toggle), right)


def heading(text: str, level: int) -> TextElement:
    """A heading, 1 for that of the page and 2 for those of its panels."""
    return TextElement(tag=f"h{level}", text=text)


def _icon(icon: str, label: str, on_click: Callable[..., Any]) -> ui.button:
    """A button that is a picture, with its name for those who do not see it."""
    button = ui.button(icon=icon, on_click=on_click).props(
        f'flat round dense color=secondary aria-label="{label}"'
    )
    return button.tooltip(label)


def _opens(button: ui.button, drawer: ui.left_drawer | ui.right_drawer) -> None:
    """Have the button say whether the drawer is open."""

    def show() -> None:
        button.props["aria-expanded"] = str(bool(drawer.value)).lower()

    drawer.on_value_change(show)
    show()


def _state(page: Page) -> None:
    """Which moment is shown, whether it goes on with the map, and the way back to now."""
    with ui.element("div").classes("semmap-state").props('role="status"'):
        dot = ui.element("span").classes("semmap-dot")
        commit = ui.label().classes("semmap-commit")
        many = ui.label().classes("semmap-entities")
        back = ui.button("Back to now", on_click=lambda: page.go_to(None)).props("flat dense color=warning")

    def show() -> None:
        is_now, is_away = page.moment.is_now, not page.live.connected
        dot.classes(
            add="is-away" if is_away else "" if is_now else "is-past",
            remove="is-past" if is_away or is_now else "is-away",
        )
        if not is_away:
            dot.classes(remove="is-away")
        commit.text = f"commit {page.state.commit:,}" if page.state.commit >= 0 else ""
        many.text = wording.entities(len(page.state.entities)) if page.state.commit >= 0 else ""
        back.visible = not is_now

    page.on_change(show)
    page.on_connection(show)
    show()


def _away(page: Page) -> None:
    """A strip that says so while the knowledge base is not there."""
    strip = ui.label().classes("semmap-away").props('role="alert"')

    def show() -> None:
        strip.text = f"{page.live.why_not[:1].upper()}{page.live.why_not[1:]}."
        strip.visible = not page.live.connected

    page.on_connection(show)
    show()


def _keys(page: Page) -> None:
    page.on_key("u", lambda: page.later(undo(page)))
    page.on_key("Delete", lambda: page.later(delete_selected(page)))
    page.on_key("Home", lambda: page.go_to(None))
    page.on_key("Escape", page.escape)
    page.on_key("?", help_)
    ui.on("semmap_key", lambda event: page.press(_told(event).get("key", "")))


def _look(page: Page, left: ui.left_drawer, right: ui.right_drawer) -> None:
    """What only the browser knows: is it dark, is it a phone?"""

    def looks(event: events.GenericEventArguments) -> None:
        said = _told(event)
        is_first, was_narrow = not page.is_seen, page.narrow
        page.looks(dark=said.get("dark") is True, narrow=said.get("narrow") is True)
        if page.narrow and (is_first or not was_narrow):
            left.hide()
            right.hide()

    def on_select() -> None:
        if page.narrow and page.selected and page.selected_by not in ("scene", "ticks"):
            left.hide()
            right.show()

    ui.on("semmap_look", looks)
    page.on_select(on_select)


def _told(event: events.GenericEventArguments) -> dict[str, Any]:
    """What the browser says of an event; it may be anything."""
    said = event.args[0] if isinstance(event.args, list) and event.args else event.args
    return said if isinstance(said, dict) else {}


def help_() -> None:
    """Show which keys there are."""
    with ui.dialog(value=True).props('aria-label="Keys"') as dialog, ui.card():
        heading("Keys", 2).classes("text-h6")
        with ui.element("table").classes("semmap-keys"), ui.element("tbody"):
            for key, does in KEYS.items():
                with ui.element("tr"):
                    with ui.element("td"):
                        TextElement(tag="kbd", text=key)
                    with ui.element("td"):
                        ui.label(does)
        with ui.row().classes("w-full justify-end"):
            ui.button("Close", on_click=dialog.close).props("flat autofocus")
    dialog.on("hide", dialog.delete)


class _Tabs:
    """Tabs, of which one is shown. Each is drawn when it is shown first, and stays while others are."""

    def __init__(self, page: Page, panels: Panels, label: str) -> None:
        self._page = page
        self._panels = panels
        self._label = label
        self._drawn: set[str] = set()
        self.containers: dict[str, ui.column] = {}

    def draw(self) -> None:
        """Draw them where it is called, with the first one shown."""
        first = next(iter(self._panels))
        with ui.column().classes("semmap-drawer"):
            self._tabs = ui.tabs(on_change=lambda event: self._turn_to(str(event.value)))
            self._tabs.classes("semmap-tabs").props(f'dense align=left no-caps aria-label="{self._label}"')
            with self._tabs:
                for name in self._panels:
                    ui.tab(name)
            for name in self._panels:
                container = ui.column().classes("semmap-panel").props(f'role="tabpanel" aria-label="{name}"')
                self.containers[name] = container
        self.show(first)

    def show(self, name: str) -> None:
        """Turn to a tab."""
        self._tabs.value = name

    def _turn_to(self, name: str) -> None:
        for other, container in self.containers.items():
            container.visible = other == name
        if name not in self._drawn:
            self._drawn.add(name)
            with self.containers[name]:
                heading(name, 2).classes("semmap-unseen")
                for panel in self._panels[name]:
                    panel(self._page)
        self._page.turned()
