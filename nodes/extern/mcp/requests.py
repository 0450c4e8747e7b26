"""What a person reads of a change that waits for approval: a line of words, and facts, the telling first.

The words are made from the command itself. What an agent wrote (a reference, the value of a property, a
reason) stands in double quotes, with escapes for whatever would end the quotation or the line.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from operator import itemgetter
from typing import Any, Final

from msgspec import Struct

from semmap.nodes.extern.cli.output.printable import quoted
from semmap.schemas import commands, errors, wording
from semmap.schemas.changes import Change
from semmap.schemas.entities import Pose, Size
from semmap.schemas.replies import Changed, LoggedCommit

_TELLING: Final = ("isOn", "isInside", "isLocatedIn", "isAttachedTo", "touches")
"""Relations that a person wants to hear of first: where things would be."""
_IMPLIED: Final = ("type", "hasReference")
"""Properties whose facts say little: the words of the change have said as much."""
_PLAIN: Final = re.compile(r"[\w:.-]{1,128}")
_LONGEST: Final = 200
"""Characters of a quotation, at most."""
_FEW: Final = 5
_MOST_FACTS: Final = 150


class Summary(Struct, frozen=True, kw_only=True):
    """A change in words, why it is asked for, and the facts that would come and go."""

    text: str
    reason: str
    follows: tuple[str, ...] = ()


def summarize_change(command: Any, tried: Changed) -> Summary:
    """Of a proposal, as it was tried out."""
    return Summary(text=_change_in_words(command, tried), reason=command.reason, follows=facts(tried))


def summarize_undo(undone: LoggedCommit, tried: Changed, reason: str) -> Summary:
    """Of the undoing of a commit: what that would take back, and why the commit was made."""
    taken = [_taken_back(change) for change in undone.changes[:_FEW]]
    if (rest := len(undone.changes) - len(taken)) > 0:
        taken.append(f"and {wording.counted(rest, 'more change')}")
    what = "; ".join(taken) or f"it touched {wording.few(tried.names)}"
    was = f" (the reason given for it was {_text(undone.reason)})" if undone.reason else ""
    return Summary(text=f"undo commit {undone.seq}: {what}{was}", reason=reason, follows=facts(tried))


def facts(tried: Changed) -> tuple[str, ...]:
    """What would follow and what no longer: where things are comes first, what the words imply last."""
    told = [(_rank(fact), fact) for fact in tried.follows]
    told += [(_rank(fact), f"no longer: {fact}") for fact in tried.no_longer_follows]
    return tuple(fact for _, fact in sorted(told, key=itemgetter(0))[:_MOST_FACTS])


def _rank(fact: str) -> int:
    """The lower, the more telling."""
    words = fact.split(" ", 2)
    predicate = words[1] if len(words) > 1 else ""
    if predicate in _TELLING:
        return _TELLING.index(predicate)
    return len(_TELLING) + (predicate in _IMPLIED)


def _change_in_words(command: Any, tried: Changed) -> str:
    name = wording.few(tried.names)
    match command:
        case commands.Remove():
            return f"remove {name}"
        case commands.Set():
            return f"set {_word(command.property)} of {name} to {', '.join(map(_value, command.values))}"
        case commands.Unset():
            which = "" if command.value is None else f" {_value(command.value)}"
            return f"unset {_word(command.property)}{which} of {name}"
        case commands.Add():
            return ", ".join([f"add {_word(command.class_)} {name}", *_details(command)])
    class_ = [] if command.class_ is None else [f"class {_word(command.class_)}"]
    return f"update {name}: {', '.join([*class_, *_details(command)])}"


def _details(command: commands.Add | commands.Update) -> Iterator[str]:
    """The fields that add and update share, as far as they are given."""
    if command.at is not None:
        yield f"at {_numbers(command.at)}"
    if command.yaw is not None:
        yield f"yaw {command.yaw:.3g} rad"
    if command.size is not None:
        yield f"size {_numbers(command.size)}"
    if command.ref is not None:
        yield f"called {_text(command.ref)}"
    if command.alt or (command.alt is not None and isinstance(command, commands.Update)):
        yield f"also called {', '.join(map(_text, command.alt)) or 'nothing'}"
    if isinstance(command, commands.Update) and command.carry:
        yield "with what is on it"


def _taken_back(change: Change) -> str:
    name = change.name
    match change.kind, change.was:
        case "added", _:
            return f"{name} ({change.now}) would be removed"
        case "removed", _:
            return f"{name} ({change.was}) would be back"
        case "pose", Pose(position_m=position):
            return f"{name} would be at {_numbers(position)} again"
        case kind, was:
            values = was if isinstance(was, tuple) else () if was is None else (was,)
            told = ", ".join(_value(value) for value in values) or "nothing"
            return f"{change.property_ or kind} of {name} would be {told} again"


def _value(value: Any) -> str:
    """A property's value: texts in quotes."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:g}" if isinstance(value, int | float) else _text(str(value))


def _text(text: str) -> str:
    return quoted(errors.shortened(text, _LONGEST))


def _word(word: str) -> str:
    """A class or a property as an agent wrote it: in quotes unless it is one plain word."""
    return word if _PLAIN.fullmatch(word) else _text(word)


def _numbers(vector: tuple[float, ...] | Size) -> str:
    return f"({', '.join(f'{round(value, 3) + 0.0:g}' for value in vector)})"
