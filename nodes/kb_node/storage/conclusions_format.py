"""The format version of stored inferences: the closure of a TBox, the entities and columns of a checkpoint.

Inferences of another format are not read but computed again from the triples, which are the source of
truth. Increase the number whenever the same triples may lead to other inferences or to another layout. A
test compares digests of rules, layouts and examples.
"""

from __future__ import annotations

FORMAT = 13


def format_mark() -> bytes:
    """Return the mark that is stored with inferences."""
    return f"conclusions {FORMAT}".encode()
