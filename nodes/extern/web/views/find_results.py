"""The reply to `find` as the search box shows it."""

from __future__ import annotations

from typing import Literal, NamedTuple

from semmap.schemas.language import Candidate, Found

Tone = Literal["found", "question", "nothing"]


class FindResult(NamedTuple):
    """The result of a search."""

    tone: Tone
    text: str
    """The outcome in a sentence."""
    select: tuple[str, ...]
    """The entities to select; none if the description is ambiguous."""
    choices: tuple[Candidate, ...]
    """The candidates, or the closest matches if nothing matches."""
    notes: tuple[str, ...] = ()


def summarize(found: Found) -> FindResult:
    """Return the reply in the form in which it is shown."""
    notes = [f"“{typed}” is read as “{meant}”" for typed, meant in found.read_as]
    if found.others:
        notes.append(f"… and {found.others} more")
    notes += found.gone
    if found.outcome == "ambiguous":
        text = found.question or found.text or "Which one?"
        return FindResult("question", text, (), found.candidates, tuple(notes))
    if found.outcome == "none":
        return FindResult("nothing", found.text, (), found.nearest, tuple(notes))
    names = tuple(candidate.entity for candidate in found.candidates)
    text = found.text or (names[0] if len(names) == 1 else f"{len(names)} entities")
    return FindResult("found", text, names, found.candidates, tuple(notes))


def format_reasons(candidate: Candidate) -> str:
    """Return why a candidate matches: `called plate, nearest to the kitchen window`."""
    return ", ".join(candidate.reasons) or candidate.called
