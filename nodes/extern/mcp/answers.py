"""Replies to an agent: compact JSON of at most 4 000 characters, in pages.

Each reply includes its commit and the units. Texts that users wrote into the map (labels, reasons, values)
are in the field `said`, and their authors in `by`, so that a model can treat them as data.
"""

from __future__ import annotations

import json
import re
import time
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from msgspec import Struct

from semmap.nodes.extern.mcp.names import list_names_like_text
from semmap.schemas import errors
from semmap.schemas.entities import Entity, Pose, Provenance, Size
from semmap.schemas.wording import LONGEST_NAME

BUDGET: Final = 4000
"""The maximum length of a reply."""
UNITS: Final = "m, rad; map frame, z up, positions are bottom centres"
_LONGEST_TEXT: Final = 1000
_WHO: Final = re.compile(r"[^\w./@-]+")
SYSTEM: Final = "semmap"
_MOST_AUTHORS: Final = 5
_MOST_NAMES: Final = 3
_WORD: Final = re.compile(r"\w+|[^\w\s]")
_Words = tuple[str, ...]


class Answer(Struct, frozen=True, kw_only=True):
    """The result of a tool: the fields `head` and, unless it is None, the list `items` with the name `of`.

    `first` and `last` are the range of commits that the result may refer to. They differ only if the map
    changes faster than it can be read.
    """

    first: int
    last: int
    head: Mapping[str, Any]
    items: Sequence[Any] | None = None
    of: str = "items"

    @property
    def is_settled(self) -> bool:
        """Whether the result refers to a single commit."""
        return self.first == self.last


def text(answer: Answer, start: int = 0) -> str:
    """Return the page that begins with item `start`, as JSON with the cursor `next` of the next page.

    Raises BadRequest if there is no such item.
    """
    if answer.items is not None and start > len(answer.items):
        raise errors.BadRequest(f"the reply has {len(answer.items)} {answer.of}; call again without a cursor")
    head, page = _fill_page(answer, start, {})
    if marked := _mark_names([answer.head, *page]):
        head, page = _fill_page(answer, start, marked)
    if answer.items is None:
        return _within(head)
    end = start + len(page)
    rest = {"next": f"{answer.last}.{end}"} if end < len(answer.items) else {}
    return _json({**head, answer.of: page, **rest})


def _fill_page(answer: Answer, start: int, marked: Mapping[str, Any]) -> tuple[dict[str, Any], list[Any]]:
    """Return the head of a page, with the `marked` names, and the items that have room on it."""
    commit = answer.last if answer.is_settled else f"{answer.first} to {answer.last}, the map is changing"
    head: Any = {"commit": commit, "units": UNITS, **marked, **answer.head}
    page: list[Any] = []
    if (items := answer.items) is None:
        return head, page
    head["total"] = len(items)
    empty = {answer.of: [], "next": f"{answer.last}.{len(items)}"}
    if (room := BUDGET - len(_json({**head, **empty}))) < BUDGET // 2:
        head = _fitting(head, BUDGET // 2)
        room = BUDGET - len(_json({**head, **empty}))
    for item in items[start:]:
        shown = _fitting(item, BUDGET // 4)
        room -= len(_json(shown)) + 1
        if room < 0:
            break
        page.append(shown)
    return head, page


def _mark_names(shown: Iterable[Any]) -> dict[str, Any]:
    """Return the beginnings of entity names that read like a text, if there are any."""
    found = dict.fromkeys(list_names_like_text(shown))
    if not found:
        return {}
    return {"names_that_are_data": [f"{name[:LONGEST_NAME]}..." for name in list(found)[:_MOST_NAMES]]}


def read_cursor(cursor: str) -> tuple[int, int]:
    """Return the commit of the pages, and the first item of the page. Raises BadRequest."""
    match = re.fullmatch(r"(\d{1,15})\.(\d{1,9})", cursor)
    if match is None:
        raise errors.BadRequest("invalid cursor; use the `next` of the previous page, or no cursor")
    return int(match[1]), int(match[2])


def attribute_text(text: str, by: Provenance | str) -> dict[str, str]:
    """Return a text from the map with its author."""
    return {"said": text, "by": by if isinstance(by, str) else format_author(by.source, by.agent)}


def format_author(source: str, agent: str) -> str:
    """Return an author, such as `operator cli/ann`. The unverified name is shortened and sanitized."""
    return f"{source} {_WHO.sub('_', agent)[:40]}".strip()


def format_time(stamp_ns: int) -> str:
    """Return a time in ISO 8601 with seconds, UTC."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(stamp_ns / 1e9))


def round_metres(vector: Sequence[float] | Size) -> list[float]:
    """Round to millimetres."""
    return [round(value, 3) + 0.0 for value in vector]


def pose_fields(pose: Pose | None) -> dict[str, Any]:
    """Return the fields of a pose: `at` and, unless it is 0, `yaw`."""
    if pose is None:
        return {}
    yaw = round(pose.yaw_rad, 3) + 0.0
    return {"at": round_metres(pose.position_m), **({"yaw": yaw} if yaw else {})}


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def _within(head: Mapping[str, Any]) -> str:
    """Return a reply without items, shortened to the maximum length."""
    shown = _json(_fitting(head, BUDGET))
    return (
        shown if len(shown) <= BUDGET else _json({"commit": head["commit"], "note": "the reply is too long"})
    )


def _fitting(item: Any, most: int) -> Any:
    """Truncate the texts and lists of an item to the length `most`."""
    length = _LONGEST_TEXT
    while len(_json(item)) > most and length > 1:
        item, length = _clipped(item, length), length // 2
    return item


def _clipped(value: Any, most: int) -> Any:
    if isinstance(value, str):
        return value if len(value) <= most else f"{value[:most]}... ({len(value) - most} more characters)"
    if isinstance(value, Mapping):
        return {key: _clipped(each, most) for key, each in value.items()}
    if isinstance(value, list | tuple):
        few = max(3, most // 20)
        cut = [_clipped(each, most) for each in value[:few]]
        return cut if len(value) <= few else [*cut, f"{len(value) - few} more"]
    return value


class Authors:
    """The authors of the labels of these entities."""

    def __init__(self, entities: Iterable[Entity]) -> None:
        self._by_words: dict[_Words, set[str]] = {}
        self._beginning: dict[str, set[_Words]] = {}  # labels (as words), by their first word
        for entity in entities:
            by = format_author(entity.reference_provenance.source, entity.reference_provenance.agent)
            for reference in (entity.preferred_reference, *entity.alternative_references):
                if words := _words(reference or ""):
                    self._by_words.setdefault(words, set()).add(by)
                    self._beginning.setdefault(words[0], set()).add(words)

    def by(self, *texts: str) -> str:
        """Return the author of texts of the system: `semmap`, or `semmap, quoting agent helper and file`."""
        found: set[str] = set()
        for text in texts:
            words = _words(text)
            for start, word in enumerate(words):
                for reference in self._beginning.get(word, ()):
                    if words[start : start + len(reference)] == reference:
                        found |= self._by_words[reference]
        if not found:
            return SYSTEM
        named = sorted(found)[:_MOST_AUTHORS]
        others = ["others"] if len(found) > _MOST_AUTHORS else []
        return f"{SYSTEM}, quoting {' and '.join([*named, *others])}"


def _words(text: str) -> _Words:
    """Return the words and punctuation marks, in lower case."""
    return tuple(_WORD.findall(text.casefold()))
