"""Detects the type of a file from its content."""

from __future__ import annotations

import json
import re
from contextlib import suppress
from typing import Literal

from msgspec import UNSET, DecodeError, Raw, Struct, UnsetType
from msgspec import json as _json

from semmap.schemas import codec
from semmap.schemas.errors import BadFile
from semmap.schemas.file_kinds import other_kind
from semmap.schemas.nesting import require_shallow
from semmap.schemas.packing import beginning, unpacked

Kind = Literal["abox", "scene", "huric"]

_HEAD = 4096
"""Number of bytes that are searched for the XML root."""
_OF_JSON = (".json", ".jsonld")
_TRIG = re.compile(rb"\{\s*([<#\[(]|_:|\w*:\w)")
_BOM = b"\xef\xbb\xbf"
_BLANK = _BOM + b" \t\r\n"


def kind_of(content: bytes, filename: str) -> Kind:
    """Return the type of a file, packed or not.

    Raises BadFile for an empty file, for a file of another kind such as an image, and for unknown JSON.
    """
    head = beginning(content, _HEAD, filename)
    start = head.lstrip(_BLANK) or unpacked(content, filename).lstrip(_BLANK)
    if not start:
        raise BadFile(f"{filename or 'the file'} is empty")
    if kind := other_kind(head):
        raise BadFile(f"{filename or 'the file'} is not a map, but {kind}")
    if start[:1] == b"<" and b"<huricExample" in head:
        return "huric"
    if _TRIG.match(start) and not filename.removesuffix(".gz").lower().endswith(_OF_JSON):
        return "abox"
    if start[:1] in (b"{", b"["):
        return _kind_of_json(unpacked(content, filename), filename.removesuffix(".gz"))
    return "abox"


class _Top(Struct):
    """The key that identifies a scene."""

    entities: Raw | UnsetType = UNSET


def _kind_of_json(content: bytes, filename: str) -> Kind:
    with suppress(DecodeError, UnicodeDecodeError, RecursionError):  # not a scene: see below
        if _json.decode(content.removeprefix(_BOM), type=codec.prepared(_Top)).entities is not UNSET:
            return "scene"
    try:
        require_shallow(content, "json")
        document = json.loads(content)
    except ValueError as error:
        if content.lstrip(_BLANK)[:1] == b"[" and not filename.lower().endswith(_OF_JSON):
            return "abox"  # Turtle may begin with a bracket, too
        raise BadFile(f"{filename or 'the file'} is not valid JSON: {error}") from None
    if isinstance(document, dict) and "entities" in document:
        return "scene"
    tops = document if isinstance(document, list) else [document]
    if all(isinstance(top, dict) and any(key.startswith("@") for key in top) for top in tops):
        return "abox"
    raise BadFile(
        f'{filename or "the file"} is JSON, but neither a scene ({{"entities": [...]}})'
        ' nor JSON-LD (with "@id" or "@graph")'
    )
