"""The states of one thing, or of several, to be set: switches, numbers with units, choices."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from nodes.extern.web.page import Page
from nodes.extern.web.panels.view import View
from nodes.extern.web.views import forms
from nodes.extern.web.views.states import State, in_common, states
from schemas import errors
from schemas.entities import Entity

_UNSET = "not said"


class States:
    """The states of one thing, as they are and to be set."""

    def __init__(self, page: Page, entity: Entity) -> None:
        self._page = page
        self._drawn: tuple[State, ...] | None = None
        with ui.expansion("States", icon="tune").props("dense").classes("w-full semmap-states") as self._all:
            self._fields = ui.column().classes("w-full gap-2")
        self._all.value = True
        self.show(entity)

    def show(self, entity: Entity) -> None:
        """As they are now."""
        page = self._page
        known = View.of(page).knowing.properties.values()
        found = states(entity, known, page.state.entities)
        if found == self._drawn:
            return
        self._drawn = found
        self._fields.clear()
        self._all.set_visibility(bool(found))
        if not (page.may("set") and page.moment.is_now):
            with self._fields:
                for state in found:
                    if state.spoken:
                        ui.label(f"{state.label}: {state.spoken}")
            return
        usual = [state for state in found if state.now is not None or state.kind in ("switch", "number")]
        with self._fields:
            for state in usual:
                _field(state, _sender(page, (entity.name,), state))
            if others := [state for state in found if state not in usual]:
                self._draw_others(entity, others)

    def _draw_others(self, entity: Entity, others: list[State]) -> None:
        """What nobody has said yet and may be said: drawn when somebody wants to."""

        def draw() -> None:
            button.delete()
            with self._fields:
                for state in others:
                    _field(state, _sender(self._page, (entity.name,), state))

        button = ui.button(f"Say something else of it ({len(others)})", on_click=draw).props("flat dense")


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


def _field(state: State, send: Callable[[Any], Any]) -> None:
    with ui.row().classes("w-full items-center no-wrap gap-2 semmap-state-row"):
        label = ui.label(state.label).classes("semmap-state-label")
        if state.hint:
            label.tooltip(state.hint)
        match state.kind:
            case "switch":
                _switch(state, send)
            case "number":
                _number(state, send)
            case "text":
                _text(state, send)
            case _:
                _choice(state, send)


def _switch(state: State, send: Callable[[Any], Any]) -> None:
    """Three ways: yes, no, and nobody has said."""
    words = {True: "yes", False: "no", None: _UNSET}
    now = state.now if isinstance(state.now, bool) else None
    toggle = ui.toggle({str(k): word for k, word in words.items()}, value=str(now))
    toggle.props("dense no-caps unelevated size=sm toggle-color=primary").props["aria-label"] = state.label
    meaning: dict[str, bool | None] = {"True": True, "False": False, "None": None}

    async def chosen(event: Any) -> None:
        await send(meaning[event.value])

    toggle.on_value_change(chosen)


def _number(state: State, send: Callable[[Any], Any]) -> None:
    now = state.now if isinstance(state.now, (int, float)) else None
    field = ui.number(value=now, suffix=state.unit or None, placeholder=_UNSET).props("dense outlined")
    field.classes("grow").style("min-width: 0").props["aria-label"] = state.label
    _on_leaving(field, now, send)


def _text(state: State, send: Callable[[Any], Any]) -> None:
    now = state.spoken
    field = ui.input(value=now, placeholder=_UNSET).props("dense outlined maxlength=1000")
    field.classes("grow").style("min-width: 0").props["aria-label"] = state.label
    _on_leaving(field, now, send)


def _on_leaving(field: Any, now: Any, send: Callable[[Any], Any]) -> None:
    """Send what was entered when Enter is pressed or the field is left."""
    sent = now

    async def leave() -> None:
        nonlocal sent
        if field.value != sent:
            sent = field.value
            await send(field.value)

    field.on("keydown.enter", leave)
    field.on("blur", leave)


def _choice(state: State, send: Callable[[Any], Any]) -> None:
    choices = dict(state.choices)
    stated = state.now if isinstance(state.now, tuple) else () if state.now is None else (state.now,)
    now = [str(value) for value in stated]
    for name in now:
        choices.setdefault(name, name)
    value: Any = now if state.several else (now[0] if now else None)
    field = ui.select(choices, value=value, multiple=state.several, clearable=True, with_input=True)
    field.props("dense outlined options-dense" + (" use-chips" if state.several else ""))
    field.classes("grow").style("min-width: 0").props["aria-label"] = state.label

    async def chosen(event: Any) -> None:
        await send(event.value or None)

    field.on_value_change(chosen)
