"""What `find` answered, as it is shown: what to select, what to say, and what to ask back."""

from __future__ import annotations

from typing import Literal, NamedTuple

from semmap.schemas.language import Candidate, Found

Tone = Literal["found", "question", "nothing"]


class Answer(NamedTuple):
    """An answer to a description."""

    tone: Tone
    text: str
    """The outcome in a sentence."""
    select: tuple[str, ...]
    """The entities to be selected: those that are meant, and none where it is not known which."""
    choices: tuple[Candidate, ...]
    """What may be chosen from: each candidate with its reasons, or what fits least badly."""
    notes: tuple[str, ...] = ()


def answer(found: Found) -> Answer:
    """How an answer is to be shown."""
    notes = [f"“{said}” is read as “{meant}”" for said, meant in found.read_as]
    if found.others:
        notes.append(f"and {found.others} others, which are not listed")
    notes += found.gone
    if found.outcome == "ambiguous":
        text = found.question or found.text or "Which one?"
        return Answer("question", text, (), found.candidates, tuple(notes))
    if found.outcome == "none":
        return Answer("nothing", found.text, (), found.nearest, tuple(notes))
    names = tuple(candidate.entity for candidate in found.candidates)
    text = found.text or (names[0] if len(names) == 1 else f"{len(names)} things")
    return Answer("found", text, names, found.candidates, tuple(notes))


def reasons(candidate: Candidate) -> str:
    """Why it may be meant: `called plate, nearest to the kitchen window`."""
    return ", ".join(candidate.reasons) or candidate.called
