"""Replies as plain lines, without tables. This module does not import rich."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import date, datetime

from semmap.schemas import wording
from semmap.schemas.changes import earlier_names
from semmap.schemas.explanations import Explanation
from semmap.schemas.language import Found
from semmap.schemas.map_history import Difference
from semmap.schemas.relations import Relation
from semmap.schemas.replies import Changed, Checked, Inferred, LoggedCommit, Moved

_MOST = 20
"""The maximum number of inferred facts, and of names of supported objects, that are printed."""
_FEW_ENTITIES = 6
"""The maximum number of entities whose changes are printed for a commit."""
_INVERSE = {"isOn": "supports", "isInside": "contains"}
"""The inverse of a relation, as a verb."""


def format_change(reply: Changed) -> Iterable[str]:
    """Yield a change with its commit, the skipped entities, notes, and consequences of a dry run."""
    yield reply.text + (f" (commit {reply.commit})" if reply.commit is not None else "")
    yield from (f"  skipped: {skipped}" for skipped in reply.skipped)
    yield from (f"note: {note}" for note in reply.notes)
    yield from _few("would be inferred", reply.follows)
    yield from _few("would no longer be inferred", reply.no_longer_follows)


def format_check(reply: Checked) -> Iterable[str]:
    """Yield the result of a consistency check, the violations of shapes, and contradicted relations."""
    yield f"{reply.text} ({reply.engine}, {reply.triples} triples, {reply.elapsed_s:.3f} s)"
    if reply.shapes:
        count = reply.violation_count
        found = wording.counted(count, "violation") if count else "no violations"
        yield f"{wording.counted(reply.shapes, 'SHACL shape')}: {found}"
    for violation in reply.violations:
        kind = "" if violation.severity == "violation" else f"{violation.severity}: "
        yield f"  {kind}{violation.text}"
    yield from (f"note: {relation.text}" for relation in reply.denied)
    yield from (f"note: {text}" for text in (*reply.withheld, *reply.crowds, *reply.notes))


def format_move(reply: Moved) -> Iterable[str]:
    """Yield the move of a body, with the commit that updated the map, or the reason why there is none."""
    yield reply.text + (f" (commit {reply.commit})" if reply.commit is not None else "")
    yield from (f"note: {note}" for note in reply.notes)


def format_difference(found: Difference) -> Iterable[str]:
    """Yield the changes, one line per entity, then a summary with the commits and times."""
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


def format_commit_changes(commit: LoggedCommit) -> str:
    """Return the changes of a commit for a few entities, and the number of the others."""
    about: dict[str, list[str]] = {}
    for change in commit.changes:
        about.setdefault(change.name, []).append(change.text)
    shown = [f"{name}: {'; '.join(texts)}" for name, texts in list(about.items())[:_FEW_ENTITIES]]
    touched = len({*commit.changed, *commit.removed} - earlier_names(commit.changes))
    if touched > len(shown):
        shown.append(f"{touched - len(shown)} more" if shown else wording.entities(touched))
    if commit.tbox:
        shown.append("new TBox")
    return ", ".join(shown) or f"+{commit.inserted} -{commit.retracted} triples"


def _clock(stamp_ns: int) -> str:
    """Return a local time, with the date unless it is today."""
    then = datetime.fromtimestamp(stamp_ns / 1e9)
    return f"{then:%H:%M:%S}" if then.date() == date.today() else f"{then:%Y-%m-%d %H:%M:%S}"


def _few(what: str, texts: Sequence[str]) -> Iterable[str]:
    """Yield the first of many facts, and the number of the others."""
    shown = texts if len(texts) <= _MOST else texts[: _MOST - 1]
    yield from (f"  {what}: {text}" for text in shown)
    if len(shown) < len(texts):
        yield f"  {what}: {len(texts) - len(shown)} more facts"


def format_inferred(reply: Inferred) -> Iterable[str]:
    """Return the inferred triples, one per line."""
    return reply.text or ("no inferred facts beyond the asserted ones",)


def format_relations(found: Sequence[Relation]) -> Iterable[str]:
    """Yield the relations, one per line. Several objects on or inside another one share a line."""
    contents: dict[tuple[str, str], list[str]] = {}
    for relation in found:
        if relation.holds and relation.relation in _INVERSE:
            contents.setdefault((relation.relation, relation.object), []).append(relation.subject)
    for relation in found:
        names = contents.get((relation.relation, relation.object), ())
        if len(names) < 2 or not relation.holds:
            yield relation.text
        elif relation.subject == names[0]:
            yield f"{relation.object} {_INVERSE[relation.relation]} {wording.few(names, _MOST)}"


def format_matches(answer: Found) -> Iterable[str]:
    """Yield the matches of a description with reasons, and a clarification question or nearest matches."""
    for written, corrected in answer.read_as:
        yield f"'{written}' is read as '{corrected}'"
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


def format_explanation(e: Explanation) -> Iterable[str]:
    """Yield an explanation with the asserted triples that it is based on."""
    yield e.text
