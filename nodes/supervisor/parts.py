"""The nodes of a part of a system, by their short names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from semmap.schemas import errors
from semmap.schemas.keys import NODES, ROUTER

PARTS: Final[Mapping[str, str]] = {node.removesuffix("_node"): node for node in (*NODES, ROUTER)}
"""Maps the names used by `semmap up --only` to node names, which are accepted too."""


def nodes_of(text: str) -> tuple[str, ...]:
    """Return the nodes in a list such as `kb,coordinator`, without duplicates. Raises BadRequest."""
    words = [word for part in text.split(",") if (word := part.strip())]
    if not words:
        raise errors.BadRequest(f"--only requires names of nodes: {errors.enumerated(tuple(PARTS))}")
    for word in words:
        if word not in PARTS and word not in PARTS.values():
            raise errors.BadRequest(
                f"--only: unknown node '{word}'; use a comma-separated list of {', '.join(PARTS)}"
            )
    return tuple(dict.fromkeys(PARTS.get(word, word) for word in words))
