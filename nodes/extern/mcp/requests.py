"""Summaries of changes that wait for approval: a line of text, and inferred facts, the most important first.

The text is made from the command. Texts of an agent (labels, values of properties, reasons) are in double
quotes, with quotes and line ends escaped.
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
"""The most important relations, which are listed first: the locations of objects."""
_IMPLIED: Final = ("type", "hasReference")
"""Properties that are listed last, because the text of the change already includes them."""
_PLAIN: Final = re.compile(r"[\w:.-]{1,128}")
_LONGEST: Final = 200
"""The maximum length of a quoted text."""
_FEW: Final = 5
_MOST_FACTS: Final = 150


class Summary(Struct, frozen=True, kw_only=True):
    """A change as text, its reason, and the facts that it would add and remove."""

    text: str
    reason: str
    follows: tuple[str, ...] = ()


def summarize_change(command: Any, tried: Changed) -> Summary:
    """Summarize a proposal after its dry run."""
    return Summary(text=_change_in_words(command, tried), reason=command.reason, follows=facts(tried))


def summarize_action(command: commands.Open | commands.Close | commands.Drive) -> Summary:
    """Summarize an action on a body of the scene: an entity that opens or closes, or a robot that drives."""
    text = f"{command.VERB} {_word(command.name)}"
    if isinstance(command, commands.Drive):
        text += f" through {', '.join(map(_numbers, command.to))}" if command.to else ""
        text += "" if command.yaw is None else f" to yaw {command.yaw:.3g} rad"
    else:
        text += "" if command.joint is None else f" by joint {_word(command.joint)}"
        text += f" to {command.to:.0%}" if isinstance(command, commands.Open) and command.to < 1.0 else ""
    return Summary(text=text, reason=command.reason)


def summarize_undo(undone: LoggedCommit, tried: Changed, reason: str) -> Summary:
    """Summarize the undoing of a commit: the reverted changes, and the reason of the commit."""
    reverted = [_reverted(change) for change in undone.changes[:_FEW]]
    if (rest := len(undone.changes) - len(reverted)) > 0:
        reverted.append(f"and {wording.counted(rest, 'more change')}")
    what = "; ".join(reverted) or f"it changed {wording.few(tried.names)}"
    was = f" (reason of the commit: {_text(undone.reason)})" if undone.reason else ""
    return Summary(text=f"undo commit {undone.seq}: {what}{was}", reason=reason, follows=facts(tried))


def facts(tried: Changed) -> tuple[str, ...]:
    """Return the facts that would be added and removed, the most important first."""
    ranked = [(_rank(fact), fact) for fact in tried.follows]
    ranked += [(_rank(fact), f"no longer: {fact}") for fact in tried.no_longer_follows]
    return tuple(fact for _, fact in sorted(ranked, key=itemgetter(0))[:_MOST_FACTS])


def _rank(fact: str) -> int:
    """Return the rank of a fact; the most important one has the lowest."""
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
        case commands.Attach():
            at = [] if command.at is None else [f"at {_numbers(command.at)} in its frame"]
            contents = ["with the objects on it"] if command.carry else []
            return ", ".join([f"attach {name} to {_word(command.to)}", *at, *contents])
        case commands.Detach():
            return f"detach {name}"
        case commands.Add():
            return ", ".join([f"add {_word(command.class_)} {name}", *_details(command)])
    class_ = [] if command.class_ is None else [f"class {_word(command.class_)}"]
    return f"update {name}: {', '.join([*class_, *_details(command)])}"


def _details(command: commands.Add | commands.Update) -> Iterator[str]:
    """Yield the set fields that `add` and `update` have in common."""
    if command.at is not None:
        yield f"at {_numbers(command.at)}"
    for placing, target in (("on", command.on), ("in", command.in_), ("next to", command.next_to)):
        if target is not None:
            yield f"{placing} {_word(target)}"
    if command.yaw is not None:
        yield f"yaw {command.yaw:.3g} rad"
    if command.size is not None:
        yield f"size {_numbers(command.size)}"
    if command.ref is not None:
        yield f"label {_text(command.ref)}"
    if command.alt or (command.alt is not None and isinstance(command, commands.Update)):
        yield f"aliases {', '.join(map(_text, command.alt)) or 'none'}"
    if isinstance(command, commands.Update) and command.carry:
        yield "with the objects on it"


def _reverted(change: Change) -> str:
    name = change.name
    match change.kind, change.was:
        case "added", _:
            return f"{name} ({change.now}) would be removed"
        case "removed", _:
            return f"{name} ({change.was}) would be restored"
        case "pose", Pose(position_m=position):
            return f"{name} would be at {_numbers(position)} again"
        case kind, was:
            values = was if isinstance(was, tuple) else () if was is None else (was,)
            shown = ", ".join(_value(value) for value in values) or "not set"
            return f"{change.property_ or kind} of {name} would be {shown} again"


def _value(value: Any) -> str:
    """Return the value of a property; texts are quoted."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:g}" if isinstance(value, int | float) else _text(str(value))


def _text(text: str) -> str:
    return quoted(errors.shortened(text, _LONGEST))


def _word(word: str) -> str:
    """Return a class or property of an agent's command, quoted unless it is a plain word."""
    return word if _PLAIN.fullmatch(word) else _text(word)


def _numbers(vector: tuple[float, ...] | Size) -> str:
    return f"({', '.join(f'{round(value, 3) + 0.0:g}' for value in vector)})"
