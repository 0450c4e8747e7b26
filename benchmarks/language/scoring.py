"""Scores of parsed commands against the annotations."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from semmap.nodes.training.language.corpus import Example, Filled
from semmap.schemas.language import SemanticFrame, Understood


def f1(right: int, one: int, other: int) -> float:
    """Return the harmonic mean of precision and recall, or 0."""
    return 2 * right / (one + other) if one + other else 0.0


@dataclass(frozen=True, slots=True)
class Scores:
    """Shares, 0 to 1; F1 but for whole commands."""

    frames: float
    spans_in_right_frames: float
    heads_in_right_frames: float
    spans: float
    heads: float
    groundings: float
    whole: float


def scores(pairs: Iterable[tuple[Example, Understood]]) -> Scores:
    """A frame is right by its name and a word of its verb; its arguments are right by role, and span or head.

    A span is right from first to last word, a head if the word is the same; where none was annotated any word
    of the argument is right. Groundings are of words whose entity is in the map. A command
    is whole if frames, roles and heads are right, none is too many, and every head's entity is right.
    """
    n: Counter[str] = Counter()
    for example, understood in pairs:
        _count(n, example, understood)
    return Scores(
        f1(n["frames"], n["frames seen"], n["frames said"]),
        f1(n["spans"], n["seen in right"], n["said in right"]),
        f1(n["heads"], n["seen in right"], n["said in right"]),
        f1(n["spans"], n["arguments seen"], n["arguments said"]),
        f1(n["heads"], n["arguments seen"], n["arguments said"]),
        f1(n["groundings"], n["groundings seen"], n["groundings said"]),
        n["whole"] / n["commands"] if n["commands"] else 0.0,
    )


def _count(n: Counter[str], example: Example, understood: Understood) -> None:
    pairs = matched(example.frames, understood.frames)
    whole = len(pairs) == len(example.frames) == len(understood.frames)
    n["commands"] += 1
    n["frames"] += len(pairs)
    n["frames seen"] += len(example.frames)
    n["frames said"] += len(understood.frames)
    n["arguments seen"] += sum(len(frame.arguments) for frame in example.frames)
    n["arguments said"] += sum(len(frame.arguments) for frame in understood.frames)
    for seen, said in pairs:
        spans = Counter((role.name, (role.first, role.last)) for role in seen.arguments)
        n["spans"] += sum((spans & Counter((a.role, a.span) for a in said.arguments)).values())
        heads = _heads(seen, said)
        n["heads"] += heads
        n["seen in right"] += len(seen.arguments)
        n["said in right"] += len(said.arguments)
        whole = whole and heads == len(seen.arguments) == len(said.arguments)
    there = {thing.name for thing in example.things}
    gold = {token: name for token, name in example.groundings if name in there}
    unanswerable = {token for token, _ in example.groundings} - set(gold)
    said_of = {
        found.token: found.entity for found in understood.groundings if found.token not in unanswerable
    }
    n["groundings"] += sum(said_of.get(token) == name for token, name in gold.items())
    n["groundings seen"] += len(gold)
    n["groundings said"] += len(said_of)
    wanted = {role.head for frame in example.frames for role in frame.arguments if role.head}
    n["whole"] += whole and all(said_of.get(token) == name for token, name in gold.items() if token in wanted)


def is_whole(example: Example, understood: Understood) -> bool:
    """Return whether a command was parsed without any error."""
    return scores([(example, understood)]).whole == 1.0


def matched(seen: Iterable[Filled], said: Iterable[SemanticFrame]) -> list[tuple[Filled, SemanticFrame]]:
    """Return the annotated frames that were found, each with the prediction."""
    left = list(said)
    pairs = []
    for frame in seen:
        found = [other for other in left if other.name == frame.name and set(other.verb) & set(frame.verb)]
        if found:
            best = max(found, key=lambda other: len(set(other.verb) & set(frame.verb)))
            left.remove(best)
            pairs.append((frame, best))
    return pairs


def _heads(seen: Filled, said: SemanticFrame) -> int:
    left = list(said.arguments)
    right = 0
    for role in sorted(seen.arguments, key=lambda role: role.head is None):
        for argument in left:
            about = argument.head == role.head or (
                role.head is None and role.first <= argument.head <= role.last
            )
            if argument.role == role.name and about:
                left.remove(argument)
                right += 1
                break
    return right
