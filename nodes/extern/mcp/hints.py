"""Translation of hints in messages: commands and options of the command line become tools and arguments."""

from __future__ import annotations

import re
from typing import Final

_REPLACEMENTS: Final[tuple[tuple[str, str], ...]] = (
    (r"--from VIEWER,? or --from-pose X Y Z YAW", "viewer, or viewpoint as x, y, z, yaw"),
    (r"--for PERSON", "asker"),
    (r"narrow it, add LIMIT to it, or raise the limit", "narrow it, or add LIMIT and OFFSET to it"),
    (r"[;,] if that is intended, add --force", "; only an operator can do that all the same"),
    (r"\(--near PLACE --within M\)", "(near the place, within so many metres)"),
    (r" \(--[^()]*\)", ""),
    (r" \(for the reason,? see: semmap check\)", ""),
    (r"semmap get ([\w.-]+)", r"get name=\1"),
    (r"semmap explain ([\w.-]+) (\S+) ([\w.-]+)", r"explain name=\1 predicate=\2 value=\3"),
    (r"semmap history ([\w.-]+)", r"history name=\1"),
    (r"semmap last-seen,", "last_seen,"),
    (r"semmap last-seen ([\w.-]+)", r"last_seen name=\1"),
    (r"semmap (open|close) ([\w.-]+) --joint ([\w.-]+)", r"\1 name=\2 joint=\3"),
    (r"semmap (open|close) ([\w.-]+)", r"\1 name=\2"),
    (r"semmap (close|when)\b", r"\1"),
    (r"semmap find --as-of\b", "find with as_of"),
    (r"semmap attach ([\w.-]+) --carry", r"propose verb=attach name=\1 carry=true"),
    (r"semmap (attach|detach) ([\w.-]+)", r"propose verb=\1 name=\2"),
    (r"semmap set ([\w.-]+) ([\w.-]+) ([\w.-]+)", r"propose verb=set name=\1 property=\2 values=[\3]"),
    (r", or add --force\b", ""),
    (r"semmap undo (\d+)", r"undo commit=\1, if that is your own"),
    (r"semmap update ([\w.-]+) --(at|size) X Y Z", r"propose verb=update name=\1 \2=[x, y, z]"),
    (r"semmap update ([\w.-]+) --(\w+) \[?[A-Z]+\]?", r"propose verb=update name=\1 with \2"),
    (r"semmap (unset|set|update|add|remove|attach|detach)\b", r"propose verb=\1"),
    (r"semmap (classes|properties)\b", r"the resource semmap://schema/\1"),
    (r"semmap status\b", "overview"),
)
_PATTERNS: Final = tuple((re.compile(pattern), instead) for pattern, instead in _REPLACEMENTS)
_OPTION: Final = re.compile(r"(?<![\w-])--([a-z]+(?:-[a-z]+)*)")


def translate_hints(text: str) -> str:
    """Replace the commands and options in a message by tools and their arguments."""
    if "--" not in text and "semmap " not in text and "LIMIT" not in text:
        return text
    for pattern, instead in _PATTERNS:
        text = pattern.sub(instead, text)
    return _OPTION.sub(lambda option: option[1].replace("-", "_"), text)
