"""Sentences that are shown at the foot of a tab for some seconds."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Final, Literal

from nicegui import ui

Tone = Literal["info", "positive", "warning", "negative"]

_SHOWN_S: Final = {"info": 4.0, "positive": 3.0, "warning": 8.0, "negative": 10.0}
_MOST: Final = 2


@dataclass
class _Notice:
    shown: ui.notification
    until_s: float
    """It is gone then, whether or not the browser has said so: it may be asleep."""
    times: int = 1


class Notices:
    """Two are shown at most, the newest; one that is told again is counted, and stays where it is."""

    def __init__(self) -> None:
        self._notices: dict[str, _Notice] = {}

    def tell(self, text: str, tone: Tone) -> None:
        """Show it as text, in the tab whose context this is called in."""
        now_s = time.monotonic()
        for gone in [told for told, notice in self._notices.items() if notice.until_s < now_s]:
            del self._notices[gone]
        until_s = now_s + _SHOWN_S[tone]
        if (same := self._notices.get(text)) is not None:
            same.times, same.until_s = same.times + 1, until_s
            same.shown.message = f"{text} ({same.times} times)"
            same.shown.update()
            return
        while len(self._notices) >= _MOST:
            self._notices.pop(next(iter(self._notices))).shown.dismiss()
        shown: ui.notification = ui.notification(
            text,
            type=tone,
            timeout=_SHOWN_S[tone],
            actions=[{"label": "Close", "color": "dark" if tone == "warning" else "white"}],
            on_dismiss=lambda: self._forget(text, shown),
        )
        self._notices[text] = _Notice(shown, until_s)

    def _forget(self, text: str, shown: ui.notification) -> None:
        if (found := self._notices.get(text)) is not None and found.shown is shown:
            del self._notices[text]
