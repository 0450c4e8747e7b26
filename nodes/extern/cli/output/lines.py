"""Replies that are plain lines: no layout, and so nothing of rich to import."""

from __future__ import annotations

from collections.abc import Iterable

from schemas.explanations import Explanation
from schemas.replies import Changed, Inferred


def changed(reply: Changed) -> Iterable[str]:
    """A change in words, with what was left out and how it was read."""
    yield reply.text + (f" (commit {reply.commit})" if reply.commit is not None else "")
    yield from (f"  left out: {skipped}" for skipped in reply.skipped)
    yield from (f"  note: {note}" for note in reply.notes)
    yield from (f"  would follow: {text}" for text in reply.follows)
    yield from (f"  would no longer follow: {text}" for text in reply.no_longer_follows)


def inferred(reply: Inferred) -> Iterable[str]:
    """What follows, one line a triple."""
    return reply.text or ("nothing follows beyond what is asserted",)


def explanation(e: Explanation) -> Iterable[str]:
    """The sentence, and the asserted triples that it rests on."""
    yield e.text
