"""Commands in free wording in a house of their own, with their steps and whether a doubt or question is due.

A development set: most commands were written before the grammar was read, and the grammar was improved with
them. The steps are those of the grammar where they were found right, and otherwise written by hand. The score
therefore shows changes, and not how well unseen commands are understood.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, NamedTuple

import msgspec

from benchmarks.table import Row
from semmap.schemas.language import Understood
from semmap.testing import own_system

_FOLDER: Final = Path(__file__).parent
_STRUCTURE_TEXT: Final = (
    "the a an and or but of to in on at is are was be been it its that this who which where what you "
    "your could would please can will may might should do does did not if so just now then there "
    "here with for from by as me my i we us have has had like want need make sure go ahead mind how "
    "about great kind was wondering try first second finally after before okay hey um uh buddy let "
    "shall well actually wait sorry no rather mean meant him forget right think know able "
    "job task thanks don favour again only keep her them he she they one any some all"
)
_STRUCTURE: Final = frozenset(_STRUCTURE_TEXT.split())
"""Words that state structure, politeness or nothing."""
_WORD: Final = re.compile(r"[^\W\d_]+")


class Judged(NamedTuple):
    """Whether the steps and signs of a command are right, and its words that are not in the result."""

    is_right: bool
    lost: tuple[str, ...]


def judge(command: dict[str, Any], understood: Understood) -> Judged:
    """Compare what is understood of a command with what is expected.

    The doubt that a step has a condition or a time does not count as a sign.
    """
    doubts = [doubt for doubt in understood.doubts if not re.search(" is a (condition|time); ", doubt)]
    signals = bool(doubts or understood.unknown or understood.question)
    is_right = [step.text for step in understood.steps] == command["steps"] and signals == command["signal"]
    parts = (understood.steps, understood.doubts, understood.unknown, understood.question, understood.answer)
    named = set(_WORD.findall(msgspec.json.encode(parts).decode().lower()))
    words = _WORD.findall(command["text"].lower())
    lost = tuple(word for word in words if len(word) > 2 and word not in _STRUCTURE and word not in named)
    return Judged(is_right, () if any(step.negated for step in understood.steps) else lost)


def rows(judged: Iterable[Judged]) -> list[Row]:
    """Return how many commands are right, and in how many a word is lost."""
    all_ = list(judged)
    return [
        Row(
            "free wording: whole right",
            sum(one.is_right for one in all_) / len(all_),
            "",
            0.8,
            0.9,
            more=True,
        ),
        Row("free wording: a word lost", sum(bool(one.lost) for one in all_) / len(all_), "", 0.05, 0.01),
    ]


def measure() -> list[Row]:
    """Start a system with the house of the commands, and judge all of them."""
    commands = json.loads((_FOLDER / "free_commands.json").read_text("utf-8"))
    options = ("--no-sim", "--no-record", "--abox", "none")
    with TemporaryDirectory() as folder, own_system(Path(folder), *options) as client:
        client.load(_FOLDER / "free_map.json")
        return rows(judge(command, client.understand(command["text"])) for command in commands)
