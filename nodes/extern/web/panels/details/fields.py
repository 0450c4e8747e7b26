"""The fields that describe an entity, in the forms for adding and editing."""

from __future__ import annotations

import asyncio
from typing import Any, Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.select_field import SelectField
from semmap.nodes.extern.web.views.entities.forms import EntityForm, match_class

_AXES: Final = ("x", "y", "z")


class Fields:
    """The fields for class, name, label, aliases, pose and size."""

    def __init__(self, page: Page, *, named: bool) -> None:
        """Draw the fields; with `named` there is one for the name."""
        self._page = page
        self._classes: dict[str, str] = {}
        with ui.column().classes("w-full gap-2 semmap-fields"):
            self._class = (
                SelectField({}, label="Class", with_input=True, new_value_mode="add-unique", clearable=True)
                .props("dense outlined options-dense hide-bottom-space")
                .classes("w-full")
                .on_value_change(self._take_class)
            )
            self._name = ui.input("Name (empty: generated from the class)") if named else None
            if self._name is not None:
                self._name.props("dense outlined maxlength=128").classes("w-full")
            self._ref = ui.input("Label").props("dense outlined maxlength=1000").classes("w-full")
            self._alt = (
                ui.textarea("Aliases (one per line)")
                .props("dense outlined autogrow rows=1")
                .classes("w-full")
            )
            self._at = self._vector("Position [m]", "position")
            with ui.row().classes("w-full items-center gap-2 no-wrap"):
                self._yaw = _number("Yaw [°]")
                if page.pick is not None:
                    ui.button("Pick in scene", icon="my_location", on_click=self._pick).props(
                        "flat dense no-caps"
                    )
            self._size = self._vector("Size [m]", "size", least=0.0)

    @property
    def form(self) -> EntityForm:
        """The contents of the fields."""
        return EntityForm(
            class_=str(self._class.value or ""),
            name="" if self._name is None else str(self._name.value or ""),
            at=tuple(field.value for field in self._at),
            yaw_deg=self._yaw.value,
            size=tuple(field.value for field in self._size),
            ref=str(self._ref.value or ""),
            alt=str(self._alt.value or ""),
        )

    def set_form(self, filled: EntityForm) -> None:
        """Set the contents of the fields."""
        if filled.class_ and filled.class_ not in self._class.options:
            self._class.set_options({**dict(self._class.options), filled.class_: filled.class_})
        self._class.value = filled.class_ or None
        if self._name is not None:
            self._name.value = filled.name
        self._ref.value, self._alt.value, self._yaw.value = filled.ref, filled.alt, filled.yaw_deg
        for field, value in (
            *zip(self._at, filled.at, strict=True),
            *zip(self._size, filled.size, strict=True),
        ):
            field.value = value

    def set_classes(self, classes: dict[str, str]) -> None:
        """Set the classes to choose from, with their labels."""
        self._classes = dict(classes)  # typed text becomes an option, but is not a class
        chosen = self._class.value
        if chosen and chosen not in classes:
            classes = {**classes, chosen: chosen}
        if self._class.options != classes:
            self._class.set_options(classes, value=chosen)

    def _take_class(self) -> None:
        """Replace typed text by the class that it means."""
        typed = str(self._class.value or "")
        if typed and self._classes and (meant := match_class(typed, self._classes)) != typed:
            self._page.start_task(self._select_class(meant))

    async def _select_class(self, class_: str) -> None:
        """Select a class, after the field has made the typed text an option."""
        await asyncio.sleep(0.0)
        self._class.set_options(dict(self._classes), value=class_)
        # Keys pressed just before Enter may still be filtering: this opens the list again, and Quasar keeps
        # the typed text while it is open.
        self._class.run_method("hidePopup")
        self._class.run_method("updateInputValue", self._classes[class_], True, True)

    async def _pick(self) -> None:
        place = await self._page.pick_place()
        if place is not None:
            for field, value in zip(self._at, place, strict=False):
                field.value = round(value, 3)

    @staticmethod
    def _vector(label: str, field: str, *, least: float | None = None) -> list[ui.number]:
        with ui.row().classes("w-full gap-2 no-wrap items-center"):
            ui.label(label).classes("semmap-quiet").style("width: 84px; flex: none")
            return [_number(axis, f"{field} {axis}", least=least) for axis in _AXES]


def _number(label: str, aria_label: str = "", *, least: float | None = None) -> ui.number:
    options: dict[str, Any] = {} if least is None else {"min": least}
    return (
        ui.number(label, step=0.1, **options)
        .props(f'dense outlined hide-bottom-space aria-label="{aria_label or label}"')
        .classes("grow")
        .style("flex-basis: 0; min-width: 0")
    )
