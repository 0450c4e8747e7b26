"""Sentences of the system, for whoever reads them in the page: without what a command line would need."""

from __future__ import annotations

import re
from typing import Final

_ADVICE: Final = (
    re.compile(r"[;,]? if that is intended, add --force"),
    re.compile(r"[;,:]? (for the reason )?see: semmap [a-z-]+( [^ ;,)]+)*"),
    re.compile(r"; --[a-z-]+ [^;]*"),
)
_OPTION: Final = re.compile(r" \(--[a-z][^()]*\)")


def in_the_page(sentence: str) -> str:
    """The same without the commands and options that it advises: here there are buttons for them."""
    for advice in _ADVICE:
        sentence = advice.sub("", sentence)
    return _OPTION.sub("", sentence)
