"""Commands that are not completely correct, grouped by the first error."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from benchmarks.language.scoring import is_whole, matched
from benchmarks.language.trials import Pairs
from semmap.nodes.training.language.corpus import Example, Filled
from semmap.schemas.language import SemanticFrame, Understood


class Group(NamedTuple):
    """One kind of error and its commands."""

    title: str
    commands: tuple[str, ...]


def groups(pairs: Pairs) -> list[Group]:
    """Return each wrong command in exactly one group, the largest group first."""
    found: dict[str, list[str]] = {}
    for example, understood in pairs:
        if not is_whole(example, understood):
            title, what = next(_errors(example, understood))
            text = f"{' '.join(example.words)}: {what}"
            found.setdefault(title, []).append(text)
    ordered = sorted(found.items(), key=lambda item: (-len(item[1]), item[0]))
    return [Group(title, tuple(commands)) for title, commands in ordered]


def lines(found: list[Group]) -> Iterator[str]:
    """Yield a line for each group with its size, followed by its commands."""
    for group in found:
        yield f"{len(group.commands):3}  {group.title}"
        yield from (f"       {command}" for command in group.commands)


def _errors(example: Example, understood: Understood) -> Iterator[tuple[str, str]]:
    pairs = matched(example.frames, understood.frames)
    yield from _wrong_frames(example, understood, pairs)
    for seen, said in pairs:
        yield from _wrong_arguments(example, seen, said)
    there = {thing.name for thing in example.things}
    told = {found.token: found.entity for found in understood.groundings}
    for token, name in example.groundings:
        if name in there and told.get(token) != name:
            meant = told.get(token, "nothing")
            yield "another entity, or none", f"{example.words[token - 1]} is {name}, was {meant}"
    yield "other", ""


def _wrong_frames(
    example: Example, understood: Understood, pairs: list[tuple[Filled, SemanticFrame]]
) -> Iterator[tuple[str, str]]:
    missed = [frame for frame in example.frames if not any(frame is seen for seen, _ in pairs)]
    too_many = [frame for frame in understood.frames if not any(frame is said for _, said in pairs)]
    for frame in missed:
        instead = [other for other in too_many if set(other.verb) & set(frame.verb)]
        if {frame.name, *(other.name for other in instead)} == {"Taking", "Bringing"}:
            yield "Taking or Bringing", f"is {frame.name}"
        elif instead:
            yield "another frame", f"is {frame.name}, was {instead[0].name}"
        else:
            yield "a frame not found", f"{frame.name}"
    for other in too_many:
        yield "a frame too many", f"{other.name}"


def _wrong_arguments(example: Example, seen: Filled, said: SemanticFrame) -> Iterator[tuple[str, str]]:
    def words(first: int, last: int) -> str:
        return " ".join(example.words[first - 1 : last])

    for role in seen.arguments:
        text = f"{role.name} is '{words(role.first, role.last)}'"
        alike = [a for a in said.arguments if a.span == (role.first, role.last)]
        overlapping = [a for a in said.arguments if a.span[0] <= role.last and role.first <= a.span[1]]
        if any(a.role == role.name for a in alike):
            right = next(a for a in alike if a.role == role.name)
            if role.head is not None and right.head != role.head:
                heads = f"about '{words(role.head, role.head)}', was '{words(right.head, right.head)}'"
                yield "the right words, another head", f"{text}, {heads}"
        elif alike:
            yield "the right words, another role", f"{text}, was {alike[0].role}"
        elif overlapping:
            others = " and ".join(f"{a.role} '{a.text}'" for a in overlapping)
            yield "other words", f"{text}, was {others}"
        else:
            yield "an argument not found", text
    for a in said.arguments:
        if not any(a.span[0] <= role.last and role.first <= a.span[1] for role in seen.arguments):
            yield "an argument too many", f"{a.role} '{a.text}'"
