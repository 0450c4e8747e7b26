"""Notices at the bottom of a tab, and error messages without command-line hints."""

from __future__ import annotations

import re
import time
from dataclasses import dataclass
from typing import Final, Literal

from nicegui import ui

Tone = Literal["info", "positive", "warning", "negative"]

_ADVICE: Final = (
    re.compile(r"[;,]? if that is intended, add --force"),
    re.compile(r"[;,:]? (for the reason )?see: semmap [a-z-]+( [^ ;,)]+)*"),
    re.compile(r"; --[a-z-]+ [^;]*"),
)
_OPTION: Final = re.compile(r" \(--[a-z][^()]*\)")
_SHOWN_S: Final = {"info": 4.0, "positive": 3.0, "warning": 8.0, "negative": 10.0}
_MOST: Final = 2


@dataclass
class _Notice:
    shown: ui.notification
    until_s: float
    """When it disappears, even if the browser sleeps and does not report it."""
    times: int = 1


class Notices:
    """The notices of a tab, at most two. A repeated notice is counted instead of shown twice."""

    def __init__(self) -> None:
        self._notices: dict[str, _Notice] = {}

    def show(self, text: str, tone: Tone) -> None:
        """Show a notice as plain text, in the tab of the current context."""
        now_s = time.monotonic()
        for expired in [text for text, notice in self._notices.items() if notice.until_s < now_s]:
            del self._notices[expired]
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


def strip_cli_hints(sentence: str) -> str:
    """Return a message without its hints to commands and options: the page has buttons for them."""
    for advice in _ADVICE:
        sentence = advice.sub("", sentence)
    return _OPTION.sub("", sentence)
