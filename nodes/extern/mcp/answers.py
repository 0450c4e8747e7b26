"""Answers as an agent reads them: compact JSON of at most 4 000 characters, in pages.

Every answer says of which commit it is true, and in what units. What somebody wrote into the map (references,
reasons, texts) stands under `said`, and who it was under `by`: data, whatever it says.
"""

from __future__ import annotations

import json
import re
import time
from collections.abc import Mapping, Sequence
from typing import Any, Final

from msgspec import Struct

from semmap.schemas import errors
from semmap.schemas.entities import Pose, Provenance, Size

BUDGET: Final = 4000
"""Characters of an answer, at most."""
UNITS: Final = "m, rad; map frame, z up, positions are bottom centres"
_LONGEST_TEXT: Final = 1000
_WHO: Final = re.compile(r"[^\w./@-]+")


class Answer(Struct, frozen=True, kw_only=True):
    """What a tool found: `head` as it is, and `items` page by page, under the name `of`; None for no list.

    `first` and `last` are the commits that it is true of: the same but where the map changes faster than it
    can be asked.
    """

    first: int
    last: int
    head: Mapping[str, Any]
    items: Sequence[Any] | None = None
    of: str = "items"

    @property
    def is_settled(self) -> bool:
        """Is it true of one commit?"""
        return self.first == self.last


def text(answer: Answer, start: int = 0) -> str:
    """The page of an answer that begins with item `start`, as JSON; `next` is the cursor of the next one.

    Raises BadRequest where there is no such item.
    """
    commit = answer.last if answer.is_settled else f"{answer.first} to {answer.last}, the map is changing"
    head: Any = {"commit": commit, "units": UNITS, **answer.head}
    if (items := answer.items) is None:
        return _within(head)
    if start > len(items):
        raise errors.BadRequest(f"the answer has {len(items)} {answer.of}; ask again without a cursor")
    head["total"] = len(items)
    empty = {answer.of: [], "next": f"{answer.last}.{len(items)}"}
    if (room := BUDGET - len(_json({**head, **empty}))) < BUDGET // 2:
        head = _fitting(head, BUDGET // 2)
        room = BUDGET - len(_json({**head, **empty}))
    page: list[Any] = []
    for item in items[start:]:
        shown = _fitting(item, BUDGET // 4)
        room -= len(_json(shown)) + 1
        if room < 0:
            break
        page.append(shown)
    end = start + len(page)
    rest = {"next": f"{answer.last}.{end}"} if end < len(items) else {}
    return _json({**head, answer.of: page, **rest})


def read_cursor(cursor: str) -> tuple[int, int]:
    """The commit that the pages are of, and the first item of this one. Raises BadRequest."""
    match = re.fullmatch(r"(\d{1,15})\.(\d{1,9})", cursor)
    if match is None:
        raise errors.BadRequest("that is no cursor; give the `next` of the page before, or none")
    return int(match[1]), int(match[2])


def said(text: str, by: Provenance | str) -> dict[str, str]:
    """Text from the map, with who wrote it."""
    return {"said": text, "by": by if isinstance(by, str) else who(by.source, by.agent)}


def who(source: str, agent: str) -> str:
    """Who changed something: `operator cli/ann`. The name was claimed, so it is kept to a short word."""
    return f"{source} {_WHO.sub('_', agent)[:40]}".strip()


def when(stamp_ns: int) -> str:
    """A stamp in ISO 8601, to the second, UTC."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(stamp_ns / 1e9))


def metres(vector: Sequence[float] | Size) -> list[float]:
    """To the millimetre."""
    return [round(value, 3) + 0.0 for value in vector]


def stands(pose: Pose | None) -> dict[str, Any]:
    """A pose: where it is, and its yaw if it has one."""
    if pose is None:
        return {}
    yaw = round(pose.yaw_rad, 3) + 0.0
    return {"at": metres(pose.position_m), **({"yaw": yaw} if yaw else {})}


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def _within(head: Mapping[str, Any]) -> str:
    """An answer without items, shortened to the budget where it has to be."""
    shown = _json(_fitting(head, BUDGET))
    return (
        shown if len(shown) <= BUDGET else _json({"commit": head["commit"], "note": "the answer is too long"})
    )


def _fitting(item: Any, most: int) -> Any:
    """An item that leaves room for others: its texts, and then its lists, are cut where it is very long."""
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
