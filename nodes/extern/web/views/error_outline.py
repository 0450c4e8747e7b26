"""Long error texts as a sentence with a list, such as the unknown classes of an ontology."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final, NamedTuple

MOST: Final = 5
"""The number of items that are shown; the others are folded."""
_LEAST: Final = 3
_MORE: Final = re.compile(r"(.*[')]) and (\d+ more)")
_CLOSING: Final = {"(": ")", "[": "]", "'": "'", '"': '"', "<": ">"}


class Outline(NamedTuple):
    """A text with a list: `unknown classes`, its items, and what follows the list."""

    head: str
    items: tuple[str, ...] = ()
    tail: str = ""


def outline_error(text: str) -> Outline:
    """Return the parts of an error text with a list of at least three items; otherwise only the `head`.

    A list has an item on each line, or starts at the first quotation mark and is separated by commas. Commas
    and semicolons in brackets or quotation marks belong to an item.
    """
    first, *lines = [line.strip() for line in text.splitlines() if line.strip()] or [""]
    if len(lines) >= _LEAST:
        return Outline(first, tuple(lines))
    start = text.find("'")
    if start > 0 and text[start - 1] == " " and not lines:
        listed, *rest = _split(text[start:], ";")
        items = _split(listed, ",")
        if len(items) >= _LEAST and all(item.startswith("'") for item in items):
            if (counted := _MORE.fullmatch(items[-1])) is not None:
                items[-1:] = counted.groups()
            return Outline(text[:start].strip(" :"), tuple(items), "; ".join(rest))
    return Outline(text)


def fold(items: Sequence[str], most: int = MOST) -> tuple[Sequence[str], Sequence[str]]:
    """Return the items that are shown and those that are folded, at least two of them."""
    return (items, ()) if len(items) <= most + 1 else (items[:most], items[most:])


def _split(text: str, separator: str) -> list[str]:
    """Return the parts of a text, without separators in brackets and quotation marks."""
    parts, closing = [""], [""]
    for at, letter in enumerate(text):
        if letter == closing[-1]:
            closing.pop()
        elif letter in _CLOSING and not _is_apostrophe(text, at):
            closing.append(_CLOSING[letter])
        elif letter == separator and closing == [""]:
            parts.append("")
            continue
        parts[-1] += letter
    return [part.strip() for part in parts]


def _is_apostrophe(text: str, at: int) -> bool:
    return text[at] == "'" and at > 0 and text[at - 1].isalnum()
