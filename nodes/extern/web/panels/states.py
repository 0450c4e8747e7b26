"""The states of one thing, or of several, to be set: switches, numbers with units, choices."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.choice import Choice
from semmap.nodes.extern.web.panels.rows import Renew, Rows
from semmap.nodes.extern.web.panels.view import View
from semmap.nodes.extern.web.views import forms
from semmap.nodes.extern.web.views.states import State, in_common, states
from semmap.schemas import errors
from semmap.schemas.entities import Entity

_UNSET = "not said"


class States:
    """The states of one thing, as they are and to be set."""

    def __init__(self, page: Page, entity: Entity) -> None:
        self._page = page
        self._name = entity.name
        self._shows_others = False
        with ui.expansion("States", icon="tune").props("dense").classes("w-full semmap-states") as self._all:
            fields = ui.column().classes("w-full gap-2")
            self._more = ui.button(on_click=self._show_others).props("flat dense")
        self._rows = Rows(fields, self._draw, classes="w-full")
        self._all.value = True
        self.show(entity)

    def show(self, entity: Entity) -> None:
        """As they are now; what is being entered stays."""
        page = self._page
        self._entity = entity
        found = states(entity, View.of(page).knowing.properties.values(), page.state.entities)
        self._all.set_visibility(bool(found))
        if self._is_set_here:
            usual = [state for state in found if state.now is not None or state.kind in ("switch", "number")]
            others = [state for state in found if state not in usual]
        else:
            usual, others = [state for state in found if state.spoken], []
        self._more.text = f"Say something else of it ({len(others)})"
        self._more.set_visibility(bool(others) and not self._shows_others)
        shown = [*usual, *(others if self._shows_others else ())]
        self._rows.show(((state.name, state.kind, state.several), state) for state in shown)

    @property
    def _is_set_here(self) -> bool:
        return self._page.may("set") and self._page.moment.is_now

    def _show_others(self) -> None:
        """What nobody has said yet and may be said: drawn when somebody wants to."""
        self._shows_others = True
        self.show(self._entity)

    def _draw(self, state: State) -> Renew[State] | None:
        if self._is_set_here:
            return _field(state, _sender(self._page, (self._name,), state))
        ui.label(f"{state.label}: {state.spoken}")
        return None


def states_in_common(page: Page, entities: tuple[Entity, ...]) -> None:
    """Draw the states that several things may have, to be set of all of them."""
    known = View.of(page).knowing.properties.values()
    names = tuple(entity.name for entity in entities)
    with ui.column().classes("w-full gap-2"):
        for state in in_common(entities, known, page.state.entities):
            if state.kind in ("switch", "number", "choice"):
                _field(state, _sender(page, names, state))


def _sender(page: Page, names: tuple[str, ...], state: State) -> Callable[[Any], Any]:
    async def send(entered: Any) -> None:
        there = [page.live.entities[name] for name in names if name in page.live.entities]
        now = {entity.name: entity.properties.get(state.name) for entity in there}
        try:
            command = forms.states(state, entered, now)
        except errors.BadRequest as error:
            page.tell(error.text, "warning")
            return
        if command is None:
            return
        single = command.changes[0] if len(names) == 1 else command
        if (reply := await page.change(single)) is not None:
            page.tell(reply.text, "positive")

    return send


def _field(state: State, send: Callable[[Any], Any]) -> Renew[State]:
    """Draw a field; what is returned shows the state as it has become since."""
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


def _switch(state: State, send: Callable[[Any], Any]) -> Renew[State]:
    """Three ways: yes, no, and nobody has said."""
    words = {True: "yes", False: "no", None: _UNSET}
    toggle = ui.toggle({str(k): word for k, word in words.items()}, value=_switched(state))
    toggle.props("dense no-caps unelevated size=sm toggle-color=primary").props["aria-label"] = state.label
    meaning: dict[str, bool | None] = {"True": True, "False": False, "None": None}

    async def chosen(event: Any) -> None:
        await send(meaning[event.value])

    toggle.on_value_change(chosen)
    return lambda state: toggle.set_value(_switched(state))


def _switched(state: State) -> str:
    return str(state.now if isinstance(state.now, bool) else None)


def _number(state: State, send: Callable[[Any], Any]) -> Renew[State]:
    def now(state: State) -> float | None:
        return state.now if isinstance(state.now, (int, float)) else None

    field = ui.number(value=now(state), suffix=state.unit or None, placeholder=_UNSET).props("dense outlined")
    field.classes("grow").style("min-width: 0").props["aria-label"] = state.label
    return _on_leaving(field, now, send)


def _text(state: State, send: Callable[[Any], Any]) -> Renew[State]:
    def now(state: State) -> str:
        return state.spoken

    field = ui.input(value=now(state), placeholder=_UNSET).props("dense outlined maxlength=1000")
    field.classes("grow").style("min-width: 0").props["aria-label"] = state.label
    return _on_leaving(field, now, send)


def _on_leaving(field: Any, now: Callable[[State], Any], send: Callable[[Any], Any]) -> Renew[State]:
    """Send what was entered when Enter is pressed or the field is left."""
    sent = field.value

    async def leave() -> None:
        nonlocal sent
        if field.value != sent:
            sent = field.value
            await send(field.value)

    def renew(state: State) -> None:
        nonlocal sent
        is_being_entered = field.value != sent
        sent = now(state)
        if not is_being_entered:
            field.value = sent

    field.on("keydown.enter", leave)
    field.on("blur", leave)
    return renew


def _choice(state: State, send: Callable[[Any], Any]) -> Renew[State]:
    choices, value = _choices(state)
    field = Choice(choices, value=value, multiple=state.several, clearable=True, with_input=True)
    field.props("dense outlined options-dense" + (" use-chips" if state.several else ""))
    field.classes("grow").style("min-width: 0").props["aria-label"] = state.label

    async def chosen(event: Any) -> None:
        await send(event.value or None)

    field.on_value_change(chosen)

    def renew(state: State) -> None:
        choices, value = _choices(state)
        if field.options != choices:
            field.set_options(choices, value=value)
        else:
            field.value = value

    return renew


def _choices(state: State) -> tuple[dict[str, str], Any]:
    """What there is to choose from, and what is chosen."""
    choices = dict(state.choices)
    stated = state.now if isinstance(state.now, tuple) else () if state.now is None else (state.now,)
    now = [str(value) for value in stated]
    for name in now:
        choices.setdefault(name, name)
    return choices, now if state.several else (now[0] if now else None)
