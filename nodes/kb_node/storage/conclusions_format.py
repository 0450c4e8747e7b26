"""The format of the conclusions that are kept on disk: a TBox's closure, a checkpoint's entities and columns.

Conclusions of another format are not read but worked out again from the triples, which remain the truth. The
number grows whenever the same triples may lead to other conclusions, or these are laid out otherwise: a test
holds digests of rules, layouts and examples beside it.
"""

from __future__ import annotations

FORMAT = 6


def format_mark() -> bytes:
    """What conclusions are marked with that are kept."""
    return f"conclusions {FORMAT}".encode()
