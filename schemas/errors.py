"""The error tree, and its form on the wire.

SemmapError
├── Refused        exit status 1: the request is valid, but rejected
│   ├── Inconsistent, PreconditionFailed, UnknownName, NameTaken
├── Busy           exit status 1: not processed because the queue is full; retry later
├── BadRequest     exit status 2: the request is invalid
│   ├── UnknownClass, UnknownVerb, BadFile
├── NoAnswer       exit status 3: no node serves the key, or access is denied
└── InternalError  exit status 1: a fault in semmap
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import ClassVar

from msgspec import Struct

from semmap.schemas.explanations import Explanation

LONGEST_TEXT = 10_000
"""The maximum number of characters of an error text, as quoted input can be of any length."""
_LONGEST_WORD = 200
"""The maximum number of characters of a word for which similar ones are searched."""


class SemmapError(Exception):
    """The base of all errors in replies. The text is one sentence with the problem and the next step."""

    code: ClassVar[str] = "error"
    exit_status: ClassVar[int] = 1
    again_s: float | None = None
    """For Busy: the time after which to retry [s]."""

    def __init__(self, text: str, *, explanation: Explanation | None = None) -> None:
        super().__init__(text)
        self.text = text
        self.explanation = explanation


def in_part(error: SemmapError, done: Sequence[int], number: int, count: int) -> SemmapError:
    """Return the error of part `number` of `count`, with the commits `done` of the parts before it."""
    if not done:
        return error
    before = f"commit {done[0]}" if len(done) == 1 else f"commits {done[0]} to {done[-1]}"
    text = (
        f"{error.text}; this is in part {number} of {count}: the parts before it are committed ({before}),"
        " the rest is not"
    )
    return type(error)(text, explanation=error.explanation)


class Refused(SemmapError):
    """The request is valid, but was rejected."""

    code = "refused"


class Inconsistent(Refused):
    """The change would make the map inconsistent; `explanation` says why."""

    code = "inconsistent"


class PreconditionFailed(Refused):
    """The map is not in the state that the request requires."""

    code = "precondition-failed"


class UnknownName(Refused):
    """No entity has this name."""

    code = "unknown-name"


class NameTaken(Refused):
    """Another individual already has this name."""

    code = "name-taken"


class Busy(SemmapError):
    """The queue is full. The request was not processed, so it is safe to retry it."""

    code = "busy"

    def __init__(
        self, text: str, *, again_s: float | None = None, explanation: Explanation | None = None
    ) -> None:
        super().__init__(text, explanation=explanation)
        self.again_s = again_s


class BadRequest(SemmapError):
    """The request is invalid: wrong usage, or a malformed value or message."""

    code = "bad-request"
    exit_status = 2


class UnknownClass(BadRequest):
    """The TBox has no such class, or it is not a class of physical things."""

    code = "unknown-class"


class UnknownVerb(BadRequest):
    """No command has this name."""

    code = "unknown-verb"


class BadFile(BadRequest):
    """A file is missing, unreadable or malformed."""

    code = "bad-file"


class NoAnswer(SemmapError):
    """No reply: the node is not running, or this client has no access to it."""

    code = "no-answer"
    exit_status = 3


class InternalError(SemmapError):
    """A fault in semmap; the node has logged it and continues."""

    code = "internal"


class ErrorMessage(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """The content of an error reply. For `busy`, `again_s` is the time after which to retry [s]."""

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
    """Return the message for an error."""
    return ErrorMessage(
        code=error.code, text=shortened(error.text), explanation=error.explanation, again_s=error.again_s
    )


def from_message(message: ErrorMessage) -> SemmapError:
    """Return the error for a message; an unknown code from a newer version becomes a plain SemmapError."""
    error = _BY_CODE.get(message.code, SemmapError)(message.text, explanation=message.explanation)
    error.again_s = message.again_s
    return error


def shortened(text: str, most: int = LONGEST_TEXT) -> str:
    """Return `text`, truncated to `most` characters with the number of omitted ones."""
    return text if len(text) <= most else f"{text[:most]} ... (and {len(text) - most:,} more characters)"


SKIP_UNKNOWN = "; see: semmap classes; --skip-unknown leaves these out"
_A_WORD = 4
"""The minimum length of a word that is searched as a part of others."""
_FEW = 5
"""The maximum number of entities in an error text."""
_MANY = 3
"""The maximum number of unknown classes or properties in an error text."""


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return `; did you mean A, B or C?` with the most similar names, or an empty text if there are none."""
    names = nearest(word, known)
    return f"; did you mean {enumerated(names)}?" if names else ""


def suggestion(word: str, known: Iterable[str], listing: str) -> str:
    """Return `; did you mean A, B or C?`, or `; see: semmap LISTING` if no name is similar."""
    return did_you_mean(word, known) or f"; see: semmap {listing}"


def nearest(word: str, known: Iterable[str]) -> list[str]:
    """Return up to three names: those that contain the word, then words of it, then the most similar ones.

    The last word of `kitchen table` is its head, so `table` comes before `kitchen`. Without RapidFuzz, which
    clients need not have installed, difflib is used.
    """
    if len(word) > _LONGEST_WORD:
        return []  # comparing a long text is slow and finds no name
    try:
        from rapidfuzz import fuzz, process, utils  # slow to import: a tenth of a command's start-up time
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
    """Return `A, B or C`."""
    return " or ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def unknown_classes(
    users: Mapping[str, Sequence[str]],
    known: Iterable[str],
    hints: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """Return a sentence about the unknown classes of a file, their entities, and how to skip them.

    `hints` replace the similar names of a class: `; did you mean ...?`.
    """
    return f"{_unknown('class', 'classes', users, known, hints)}{SKIP_UNKNOWN}"


def unknown_properties(users: Mapping[str, Sequence[str]], known: Iterable[str]) -> str:
    """Return a sentence about properties that the TBox lacks, and the entities that use them."""
    return _unknown("property", "properties", users, known)


def _unknown(
    one: str,
    many: str,
    users: Mapping[str, Sequence[str]],
    known: Iterable[str],
    hints: Mapping[str, str] = MappingProxyType({}),
) -> str:
    known, few = list(known), max(1, _FEW // len(users))
    described = [
        f"'{name}' (of {_some(users[name], few)}{hints.get(name) or did_you_mean(name, known)})"
        for name in list(users)[:_MANY]
    ]
    return f"unknown {one if len(users) == 1 else many} {_listed(described, len(users))}"


def _some(names: Sequence[str], few: int) -> str:
    return _listed(names[:few], len(names))


def _listed(shown: Sequence[str], count: int) -> str:
    """Return the first of `count` names, and the number of the others."""
    return ", ".join(shown) + (f" and {count - len(shown)} more" if count > len(shown) else "")
