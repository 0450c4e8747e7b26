"""A select field whose options may change while it is open."""

from __future__ import annotations

from typing import Any, Final

from nicegui import ui
from nicegui.events import GenericEventArguments

_ENTER: Final = """(event) => {
  const select = getElement(%d)?.$refs.qRef, typed = event.target.value?.trim().toLocaleLowerCase();
  if (event.key !== "Enter" || !typed || !select || select.getOptionIndex() !== -1) return;
  const labels = select.options.map(({label}) => label.toLocaleLowerCase());
  const fits = [(label) => label.split(" · ")[0] === typed, (label) => label.startsWith(typed),
    (label) => label.includes(typed)];
  select.setOptionIndex(fits.map((test) => labels.findIndex(test)).find((index) => index !== -1) ?? -1);
}"""
"""Marks the best match before the field takes the marked option: a label that is the typed text, or
else one that begins with it, or else one that contains it."""


class SelectField(ui.select):
    """Like `ui.select`, but the chosen option is identified by its label, and Enter takes the best match.

    The browser reports the index of an option. If options were added or removed since it drew them, that
    index would select another option.
    """

    def __init__(self, *arguments: Any, **named: Any) -> None:
        """Create it like `ui.select`."""
        super().__init__(*arguments, **named)
        if named.get("with_input") and "new_value_mode" not in named:
            self.on("keydown", js_handler=_ENTER % self.id)

    def _event_args_to_value(self, e: GenericEventArguments) -> Any:
        if isinstance(e.args, list):
            e.args = [arg for given in e.args if (arg := self._with_current_index(given)) is not None]
        else:
            e.args = self._with_current_index(e.args)
        return super()._event_args_to_value(e)

    def _with_current_index(self, given: Any) -> Any:
        """Return the option with its current index; None if it no longer exists."""
        if not isinstance(given, dict) or "label" not in given:
            return given
        label = given["label"]
        return {**given, "value": self._labels.index(label)} if label in self._labels else None
