"""A field to choose from options that may change while it is open."""

from __future__ import annotations

from typing import Any

from nicegui import ui
from nicegui.events import GenericEventArguments


class Choice(ui.select):
    """As `ui.select`, but what a person chose is what it is called, wherever it has moved to meanwhile.

    A browser names an option by its place. Options that came or went since it drew them would have another
    one chosen.
    """

    def _event_args_to_value(self, e: GenericEventArguments) -> Any:
        if isinstance(e.args, list):
            e.args = [arg for given in e.args if (arg := self._placed(given)) is not None]
        else:
            e.args = self._placed(e.args)
        return super()._event_args_to_value(e)

    def _placed(self, given: Any) -> Any:
        """An option with the place that it has now; None where there is no such option any more."""
        if not isinstance(given, dict) or "label" not in given:
            return given
        label = given["label"]
        return {**given, "value": self._labels.index(label)} if label in self._labels else None
