"""The nodes of a part of a system, by the names that users give them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from semmap.schemas import errors
from semmap.schemas.keys import NODES, ROUTER

PARTS: Final[Mapping[str, str]] = {node.removesuffix("_node"): node for node in (*NODES, ROUTER)}
"""What a node is called after `semmap up --only`, and its name on the wire; that one is taken, too."""


def nodes_of(text: str) -> tuple[str, ...]:
    """The nodes in a list such as `kb,coordinator`, each once, in that order. Raises BadRequest."""
    words = [word for part in text.split(",") if (word := part.strip())]
    if not words:
        raise errors.BadRequest(f"--only takes the names of nodes: {errors.enumerated(tuple(PARTS))}")
    for word in words:
        if word not in PARTS and word not in PARTS.values():
            raise errors.BadRequest(
                f"there is no node '{word}'; --only takes any of {', '.join(PARTS)}, separated by commas"
            )
    return tuple(dict.fromkeys(PARTS.get(word, word) for word in words))
