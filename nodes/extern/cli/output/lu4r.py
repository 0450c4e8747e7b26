"""Parsed commands in the command frame representation of LU4R, a command interpreter for robots.

See Vanzo et al., "LU4R: adaptive spoken Language Understanding For Robots", IJCoL 3-1, 2017.
"""

from __future__ import annotations

from typing import Any

from semmap.schemas.language import Argument, SemanticFrame, Understood


def document(understood: Understood) -> dict[str, Any]:
    """Return the sentence and its frames, as `TAKING(theme:"the cup")` and with entities as arguments."""
    words = understood.words
    return {
        "sentence": " ".join(words),
        "frames": [
            {
                "name": frame.name.upper(),
                "lexicalUnit": " ".join(words[token - 1] for token in frame.verb),
                "cfr": _cfr(frame, grounded=False),
                "groundedCfr": _cfr(frame, grounded=True),
                "frameElements": [_element(argument, words) for argument in frame.arguments],
            }
            for frame in understood.frames
        ],
    }


def _cfr(frame: SemanticFrame, *, grounded: bool) -> str:
    filled = (
        f"{argument.role.lower()}:{argument.filler if grounded else _quoted(argument.text)}"
        for argument in frame.arguments
    )
    return f"{frame.name.upper()}({','.join(filled)})"


def _quoted(text: str) -> str:
    return f'"{text}"'


def _element(argument: Argument, words: tuple[str, ...]) -> dict[str, Any]:
    element: dict[str, Any] = {
        "type": argument.role.lower(),
        "text": argument.text,
        "semanticHead": words[argument.head - 1],
    }
    if argument.entity is not None:
        element["atom"] = argument.entity
    return element
