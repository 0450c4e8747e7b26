"""Replies that are plain lines: no layout, and so nothing of rich to import."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import date, datetime

from semmap.schemas import wording
from semmap.schemas.explanations import Explanation
from semmap.schemas.language import Found
from semmap.schemas.map_history import Difference
from semmap.schemas.relations import Relation
from semmap.schemas.replies import Changed, Inferred, LoggedCommit, Moved

_MOST = 20
"""Lines of what would follow, or would no longer; names of what a thing bears."""
_FEW_ENTITIES = 6
"""Entities of which it is said what a commit did to them."""
_BEARS = {"isOn": "supports", "isInside": "holds"}
"""By relation, what the other thing does."""


def changed(reply: Changed) -> Iterable[str]:
    """A change in words, with what was left out and how it was read."""
    yield reply.text + (f" (commit {reply.commit})" if reply.commit is not None else "")
    yield from (f"  left out: {skipped}" for skipped in reply.skipped)
    yield from (f"  note: {note}" for note in reply.notes)
    yield from _few("would follow", reply.follows)
    yield from _few("would no longer follow", reply.no_longer_follows)


def moved(reply: Moved) -> Iterable[str]:
    """The move of a body in words, with the commit by which the map followed, or why there is none."""
    yield reply.text + (f" (commit {reply.commit})" if reply.commit is not None else "")
    yield from (f"  note: {note}" for note in reply.notes)


def difference(found: Difference) -> Iterable[str]:
    """What changed, one line an entity; then how much did, and between which commits and times."""
    about: dict[str, list[str]] = {}
    for change in found.changes:
        about.setdefault(change.name, []).append(change.text)
    for related in found.relations:
        about.setdefault(related.subject, []).append(related.text)
    yield from (f"{name}: {'; '.join(texts)}" for name, texts in sorted(about.items()))
    if found.first == found.last:
        yield f"nothing has changed since commit {found.last} ({_clock(found.last_ns)})"
        return
    count = wording.entities(len(about)) if about else "nothing"
    times = f"{_clock(found.first_ns)} and {_clock(found.last_ns)}"
    yield f"{count} changed between commits {found.first} and {found.last} ({times})"


def touched(commit: LoggedCommit) -> str:
    """What was and what is, of a few entities; of the others their number."""
    about: dict[str, list[str]] = {}
    for change in commit.changes:
        about.setdefault(change.name, []).append(change.text)
    said = [f"{name}: {'; '.join(texts)}" for name, texts in list(about.items())[:_FEW_ENTITIES]]
    touched = len({*commit.changed, *commit.removed})
    if touched > len(said):
        said.append(f"{touched - len(said)} more" if said else wording.entities(touched))
    if commit.tbox:
        said.append("another TBox")
    return ", ".join(said) or f"+{commit.inserted} -{commit.retracted} triples"


def _clock(stamp_ns: int) -> str:
    """A local time; of another day than today with its date."""
    then = datetime.fromtimestamp(stamp_ns / 1e9)
    return f"{then:%H:%M:%S}" if then.date() == date.today() else f"{then:%Y-%m-%d %H:%M:%S}"


def _few(what: str, texts: Sequence[str]) -> Iterable[str]:
    """The first of many; the rest is counted."""
    shown = texts if len(texts) <= _MOST else texts[: _MOST - 1]
    yield from (f"  {what}: {text}" for text in shown)
    if len(shown) < len(texts):
        yield f"  {what}: {len(texts) - len(shown)} more facts"


def inferred(reply: Inferred) -> Iterable[str]:
    """What follows, one line a triple."""
    return reply.text or ("nothing follows beyond what is asserted",)


def relations(found: Sequence[Relation]) -> Iterable[str]:
    """A sentence each; of several things that are on one, or inside it, one sentence without measurements."""
    borne: dict[tuple[str, str], list[str]] = {}
    for relation in found:
        if relation.holds and relation.relation in _BEARS:
            borne.setdefault((relation.relation, relation.object), []).append(relation.subject)
    for relation in found:
        names = borne.get((relation.relation, relation.object), ())
        if len(names) < 2 or not relation.holds:
            yield relation.text
        elif relation.subject == names[0]:
            yield f"{relation.object} {_BEARS[relation.relation]} {wording.few(names, _MOST)}"


def found(answer: Found) -> Iterable[str]:
    """What a description means: a line a thing with its reasons; what to ask back, or what is nearest."""
    for said, meant in answer.read_as:
        yield f"'{said}' is read as '{meant}'"
    if answer.outcome == "none":
        yield answer.text
        if answer.nearest:
            yield "nearest:"
    for candidate in (*answer.candidates, *answer.nearest):
        indent = "  " if answer.outcome == "none" else ""
        yield f"{indent}{candidate.entity}: {', '.join(candidate.reasons) or candidate.called}"
    if answer.others:
        yield f"and {answer.others} others"
    yield from answer.gone
    if answer.question:
        yield answer.question


def explanation(e: Explanation) -> Iterable[str]:
    """The sentence, and the asserted triples that it rests on."""
    yield e.text
