"""The error tree, and its form on the wire.

SemmapError
├── Refused        exit status 1: the request was understood and the map says no
│   ├── Inconsistent, PreconditionFailed, UnknownName, NameTaken
├── Busy           exit status 1: not looked at, because too much waits already; to be sent again later
├── BadRequest     exit status 2: the request cannot be understood
│   ├── UnknownClass, UnknownVerb, BadFile
├── NoAnswer       exit status 3: nobody serves the key, or this client may not ask it
└── InternalError  exit status 1: a fault of ours, told as one
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import ClassVar

from msgspec import Struct

from semmap.schemas.explanations import Explanation

LONGEST_TEXT = 10_000
"""Characters of an error that are sent: what a sentence quotes may be of any length."""
_LONGEST_WORD = 200
"""Characters of a word for which similar ones are looked for."""


class SemmapError(Exception):
    """Base of every error that crosses the wire. The text is one sentence saying what is possible."""

    code: ClassVar[str] = "error"
    exit_status: ClassVar[int] = 1
    again_s: float | None = None
    """Of Busy: after how long to come again [s]."""

    def __init__(self, text: str, *, explanation: Explanation | None = None) -> None:
        super().__init__(text)
        self.text = text
        self.explanation = explanation


def in_part(error: SemmapError, done: Sequence[int], number: int, count: int) -> SemmapError:
    """The error of part `number` of `count`, with what became of the others: `done` are their commits."""
    if not done:
        return error
    before = f"commit {done[0]}" if len(done) == 1 else f"commits {done[0]} to {done[-1]}"
    text = (
        f"{error.text}; that is in part {number} of {count}: what is before it is committed"
        f" ({before}) and stays, the rest is not"
    )
    return type(error)(text, explanation=error.explanation)


class Refused(SemmapError):
    """Understood, and not done."""

    code = "refused"


class Inconsistent(Refused):
    """The change would make the map inconsistent; `explanation` says why."""

    code = "inconsistent"


class PreconditionFailed(Refused):
    """The map is no longer as the sender believed it to be."""

    code = "precondition-failed"


class UnknownName(Refused):
    """No entity has this name."""

    code = "unknown-name"


class NameTaken(Refused):
    """Another individual has this name already."""

    code = "name-taken"


class Busy(SemmapError):
    """Not looked at: too much waits already. Nothing was done, so it is safe to send it again."""

    code = "busy"

    def __init__(
        self, text: str, *, again_s: float | None = None, explanation: Explanation | None = None
    ) -> None:
        super().__init__(text, explanation=explanation)
        self.again_s = again_s


class BadRequest(SemmapError):
    """The request cannot be understood: usage, a malformed value or message."""

    code = "bad-request"
    exit_status = 2


class UnknownClass(BadRequest):
    """The TBox has no such class, or it is not the class of a thing in space."""

    code = "unknown-class"


class UnknownVerb(BadRequest):
    """There is no such command."""

    code = "unknown-verb"


class BadFile(BadRequest):
    """A file is missing, unreadable or malformed."""

    code = "bad-file"


class NoAnswer(SemmapError):
    """Nobody replied: the node is not running, or this client may not ask it."""

    code = "no-answer"
    exit_status = 3


class InternalError(SemmapError):
    """A fault in semmap itself; the node that met it has logged it and lives on."""

    code = "internal"


class ErrorMessage(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """What an error reply carries. `again_s` is when to come again [s], of one that says busy."""

    code: str
    text: str
    explanation: Explanation | None = None
    again_s: float | None = None


_BY_CODE: dict[str, type[SemmapError]] = {
    error.code: error
    for error in (
        SemmapError,
        Refused,
        Inconsistent,
        PreconditionFailed,
        UnknownName,
        NameTaken,
        Busy,
        BadRequest,
        UnknownClass,
        UnknownVerb,
        BadFile,
        NoAnswer,
        InternalError,
    )
}


def to_message(error: SemmapError) -> ErrorMessage:
    """The wire form of `error`."""
    return ErrorMessage(
        code=error.code, text=shortened(error.text), explanation=error.explanation, again_s=error.again_s
    )


def from_message(message: ErrorMessage) -> SemmapError:
    """The error that `message` stands for; a code from a newer version becomes a plain SemmapError."""
    error = _BY_CODE.get(message.code, SemmapError)(message.text, explanation=message.explanation)
    error.again_s = message.again_s
    return error


def shortened(text: str, most: int = LONGEST_TEXT) -> str:
    """`text`, or of a longer one the beginning and the number of characters left out."""
    return text if len(text) <= most else f"{text[:most]} ... (and {len(text) - most:,} more characters)"


SKIP_UNKNOWN = "; --skip-unknown leaves these out"
_A_WORD = 4
"""Letters of a word that may be looked for within others."""
_FEW = 10
_MANY = 30


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """`; did you mean A, B or C?` with the nearest of `known`, or nothing when none is near."""
    names = nearest(word, known)
    return f"; did you mean {enumerated(names)}?" if names else ""


def nearest(word: str, known: Iterable[str]) -> list[str]:
    """Up to three of `known`: those first that the word is a part of, then words of it, then the nearest.

    Of `kitchen table` the last word says what it is, so `table` comes before `kitchen`.
    A client, which knows few names, may be without RapidFuzz.
    """
    if len(word) > _LONGEST_WORD:
        return []  # nobody meant it, and to compare it takes as long as it is
    try:
        from rapidfuzz import fuzz, process, utils  # takes a tenth of what a command line takes to begin
    except ImportError:
        import difflib

        return difflib.get_close_matches(word, list(known))
    names, part = list(known), word.casefold()
    near = process.extract(
        word, names, scorer=fuzz.ratio, processor=utils.default_process, limit=3, score_cutoff=60
    )
    longer = [name for name in names if part in name.casefold()] if len(part) >= _A_WORD else []
    longer.sort(key=lambda name: (len(name), name))
    parts = part.replace("_", " ").split()
    by_part = {name.casefold(): name for name in sorted(names)} if len(parts) > 1 else {}
    words = [by_part[word] for word in reversed(parts) if word in by_part]
    return list(dict.fromkeys([*longer[:2], *words, *(name for name, _, _ in near)]))[:3]


def enumerated(names: Sequence[str]) -> str:
    """`A, B or C`."""
    return " or ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def unknown_classes(
    users: Mapping[str, Sequence[str]],
    known: Iterable[str],
    hints: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """One sentence on the unknown classes of a file and whose they are, and how to go on without them.

    `hints` replace the nearest names of a class: `; did you mean ...?`.
    """
    return f"{_unknown('class', 'classes', users, known, hints)}{SKIP_UNKNOWN}"


def unknown_properties(users: Mapping[str, Sequence[str]], known: Iterable[str]) -> str:
    """One sentence on properties that the TBox does not have, and who has them."""
    return _unknown("property", "properties", users, known)


def _unknown(
    one: str,
    many: str,
    users: Mapping[str, Sequence[str]],
    known: Iterable[str],
    hints: Mapping[str, str] = MappingProxyType({}),
) -> str:
    known, few = list(known), max(1, _FEW // len(users))
    said = [
        f"'{name}' (of {_some(whose, few)}{hints.get(name) or did_you_mean(name, known)})"
        for name, whose in users.items()
    ]
    return f"unknown {one if len(said) == 1 else many} {_some(said, _MANY)}"


def _some(names: Sequence[str], few: int) -> str:
    return ", ".join(names[:few]) + (f" and {len(names) - few} more" if len(names) > few else "")
