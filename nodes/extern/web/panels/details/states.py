"""The fields that set the states of one or several entities."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.map_view import MapView
from semmap.nodes.extern.web.panels.widgets.rows import Rows, Update
from semmap.nodes.extern.web.panels.widgets.select_field import SelectField
from semmap.nodes.extern.web.views.entities import forms
from semmap.nodes.extern.web.views.entities.states import State, common_states, list_states
from semmap.schemas import errors
from semmap.schemas.entities import Entity

_UNSET = "not set"


class States:
    """The states of one entity."""

    def __init__(self, page: Page, entity: Entity) -> None:
        self._page = page
        self._name = entity.name
        self._shows_all = False
        with ui.expansion("States", icon="tune").props("dense").classes("w-full semmap-states") as self._all:
            fields = ui.column().classes("w-full gap-2")
            self._more = ui.button(on_click=self._show_all).props("flat dense")
        self._rows = Rows(fields, self._draw, classes="w-full")
        self._all.value = True
        self.show(entity)

    def show(self, entity: Entity) -> None:
        """Show the current values; text that is being entered stays."""
        page = self._page
        self._entity = entity
        found = list_states(entity, MapView.of(page).knowledge.properties.values(), page.state.entities)
        self._all.set_visibility(bool(found))
        if self._is_editable:
            usual = [state for state in found if state.now is not None or state.kind in ("switch", "number")]
            others = [state for state in found if state not in usual]
        else:
            usual, others = [state for state in found if state.text], []
        self._more.text = f"Add property ({len(others)})"
        self._more.set_visibility(bool(others) and not self._shows_all)
        shown = [*usual, *(others if self._shows_all else ())]
        self._rows.show(((state.name, state.kind, state.multiple), state) for state in shown)

    @property
    def _is_editable(self) -> bool:
        return self._page.is_allowed("set") and self._page.moment.is_now

    def _show_all(self) -> None:
        """Show also the properties that are not set, which are drawn on request only."""
        self._shows_all = True
        self.show(self._entity)

    def _draw(self, state: State) -> Update[State] | None:
        if self._is_editable:
            return _field(state, _sender(self._page, (self._name,), state))
        ui.label(f"{state.label}: {state.text}")
        return None


def draw_common_states(page: Page, entities: tuple[Entity, ...]) -> None:
    """Draw the fields for states that all of these entities can have."""
    known = MapView.of(page).knowledge.properties.values()
    names = tuple(entity.name for entity in entities)
    with ui.column().classes("w-full gap-2"):
        for state in common_states(entities, known, page.state.entities):
            if state.kind in ("switch", "number", "choice"):
                _field(state, _sender(page, names, state))


def _sender(page: Page, names: tuple[str, ...], state: State) -> Callable[[Any], Any]:
    async def send(entered: Any) -> None:
        present = [page.live.entities[name] for name in names if name in page.live.entities]
        now = {entity.name: entity.properties.get(state.name) for entity in present}
        try:
            command = forms.build_state_changes(state, entered, now)
        except errors.BadRequest as error:
            page.notify(error.text, "warning")
            return
        if command is None:
            return
        single = command.changes[0] if len(names) == 1 else command
        if (reply := await page.change(single)) is not None:
            page.notify(reply.text, "positive")

    return send


def _field(state: State, send: Callable[[Any], Any]) -> Update[State]:
    """Draw a field; return the function that shows a new value in it."""
    with ui.row().classes("w-full items-center no-wrap gap-2 semmap-state-row"):
        label = ui.label(state.label).classes("semmap-state-label")
        if state.hint:
            label.tooltip(state.hint)
        match state.kind:
            case "switch":
                return _switch(state, send)
            case "number":
                return _number(state, send)
            case "text":
                return _text(state, send)
            case _:
                return _choice(state, send)


def _switch(state: State, send: Callable[[Any], Any]) -> Update[State]:
    """Draw a toggle with yes, no and not set."""
    words = {True: "yes", False: "no", None: _UNSET}
    toggle = ui.toggle({str(k): word for k, word in words.items()}, value=_switched(state))
    toggle.props("dense no-caps unelevated size=sm toggle-color=primary").props["aria-label"] = state.label
    meaning: dict[str, bool | None] = {"True": True, "False": False, "None": None}

    async def on_change(event: Any) -> None:
        await send(meaning[event.value])

    toggle.on_value_change(on_change)
    return lambda state: toggle.set_value(_switched(state))


def _switched(state: State) -> str:
    return str(state.now if isinstance(state.now, bool) else None)


def _number(state: State, send: Callable[[Any], Any]) -> Update[State]:
    def now(state: State) -> float | None:
        return state.now if isinstance(state.now, (int, float)) else None

    field = ui.number(value=now(state), suffix=state.unit or None, placeholder=_UNSET).props("dense outlined")
    field.classes("grow").style("min-width: 0").props["aria-label"] = state.label
    return _send_on_leave(field, now, send)


def _text(state: State, send: Callable[[Any], Any]) -> Update[State]:
    def now(state: State) -> str:
        return state.text

    field = ui.input(value=now(state), placeholder=_UNSET).props("dense outlined maxlength=1000")
    field.classes("grow").style("min-width: 0").props["aria-label"] = state.label
    return _send_on_leave(field, now, send)


def _send_on_leave(field: Any, now: Callable[[State], Any], send: Callable[[Any], Any]) -> Update[State]:
    """Send the contents when Enter is pressed or the field loses the focus."""
    sent = field.value

    async def leave() -> None:
        nonlocal sent
        if field.value != sent:
            sent = field.value
            await send(field.value)

    def update(state: State) -> None:
        nonlocal sent
        is_being_entered = field.value != sent
        sent = now(state)
        if not is_being_entered:
            field.value = sent

    field.on("keydown.enter", leave)
    field.on("blur", leave)
    return update


def _choice(state: State, send: Callable[[Any], Any]) -> Update[State]:
    choices, value = _choices(state)
    field = SelectField(choices, value=value, multiple=state.multiple, clearable=True, with_input=True)
    field.props("dense outlined options-dense" + (" use-chips" if state.multiple else ""))
    field.classes("grow").style("min-width: 0").props["aria-label"] = state.label

    async def on_change(event: Any) -> None:
        await send(event.value or None)

    field.on_value_change(on_change)

    def update(state: State) -> None:
        choices, value = _choices(state)
        if field.options != choices:
            field.set_options(choices, value=value)
        else:
            field.value = value

    return update


def _choices(state: State) -> tuple[dict[str, str], Any]:
    """Return the options and the selected value or values."""
    choices = dict(state.choices)
    stated = state.now if isinstance(state.now, tuple) else () if state.now is None else (state.now,)
    now = [str(value) for value in stated]
    for name in now:
        choices.setdefault(name, name)
    return choices, now if state.multiple else (now[0] if now else None)
