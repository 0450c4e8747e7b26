"""Splits a large load into several transactions, which limits memory and keeps completed parts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from msgspec import structs

from semmap.schemas import errors
from semmap.schemas.commits import Commit, Transaction
from semmap.schemas.explanations import Term, Triple

PART: Final = 100_000
"""Triples per part. The last entity of a part is completed."""
_STAR: Final = 64
"""Largest number of triples of an entity."""


def split(
    transaction: Transaction, size: int = PART, replaced: Mapping[Term, list[Triple]] = MappingProxyType({})
) -> list[Transaction]:
    """Split a transaction into parts. Only the last part has the original id.

    The command therefore counts as done only when all parts are. `replaced` are its removed triples, by the
    individual that they describe: they are removed by the part that describes it.
    """
    triples = transaction.insert
    ends = list(_ends(triples, size))
    pending = dict(replaced)
    parts = []
    for number, (start, end) in enumerate(zip([0, *ends], ends, strict=False), start=1):
        is_last = number == len(ends)
        owners = pending.keys() if is_last else pending.keys() & {s for s, _, _ in triples[start:end]}
        parts.append(
            structs.replace(
                transaction,
                id=transaction.id if is_last else f"{transaction.id}/{number}",
                reason=f"{transaction.reason}, part {number} of {len(ends)}",
                retract=tuple(t for owner in sorted(owners) for t in pending.pop(owner)),
                insert=triples[start:end],
            )
        )
    return parts


def commit_each(
    parts: Sequence[Transaction],
    commit: Callable[[Transaction], Commit | None],
    report: Callable[[str], None],
) -> list[Commit]:
    """Commit the parts and return the commits. Raises the error of a part with the commits made so far."""
    made: list[Commit] = []
    for number, part in enumerate(parts, start=1):
        report(f"part {number} of {len(parts)}")
        try:
            if (done := commit(part)) is not None:
                made.append(done)
        except errors.SemmapError as error:
            raise errors.in_part(error, [done.seq for done in made], number, len(parts)) from None
    return made


def _ends(triples: Sequence[Triple], size: int) -> Iterator[int]:
    """Yield the ends of parts, before a triple whose subject the preceding triples do not mention."""
    end = size
    while end < len(triples):
        near = {term for s, _, o in triples[max(0, end - _STAR) : end] for term in (s, o)}
        while end < len(triples) and triples[end][0] in near:
            near.update((triples[end][0], triples[end][2]))
            end += 1
        if end < len(triples):
            yield end
        end += size
    if triples:
        yield len(triples)
