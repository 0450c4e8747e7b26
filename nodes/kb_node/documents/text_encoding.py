"""Converts documents to UTF-8: text in UTF-16 or UTF-32, and XML in the encoding that it declares."""

from __future__ import annotations

import codecs
import re
from typing import Final

_BOMS: Final = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16, whose mark is the beginning of this one
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_WITHOUT_BOM: Final = ((b"<\0", "utf-16-le"), (b"\0<", "utf-16-be"))
"""How XML in UTF-16 may begin."""
_DECLARATION: Final = re.compile(rb"""\s*<\?xml\s[^>]*?\bencoding\s*=\s*["']([\w.:-]+)["']""")
_TEXT_DECLARATION: Final = re.compile(
    r"""(\s*<\?xml\s[^>]*?\bencoding\s*=\s*)(?:"[\w.:-]*"|'[\w.:-]*')""", re.ASCII
)
_CHARACTER_SETS: Final = re.compile(r"ascii|iso8859|cp\d|koi8|mac|gb|big5|euc|shift_jis|utf-(8|16|32)\b")
"""The names of Python's codecs for text. The others, such as Punycode, are not encodings of files."""


def is_wide(content: bytes) -> bool:
    """Return whether a document is in UTF-16 or UTF-32."""
    return b"\0" in content[:4] or content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))


def to_utf8(content: bytes) -> bytes:
    """Return a document in UTF-8 without a byte order mark; XML then declares UTF-8.

    Lines keep their numbers. Raises ValueError for text that is not in its encoding, with the line, and for
    an unknown encoding.
    """
    encoding, text = _detect(content)
    if encoding == "utf-8":
        _decode(text, encoding)
        return text
    decoded = _decode(text, encoding)
    return _TEXT_DECLARATION.sub(r'\1"UTF-8"', decoded, count=1).encode()


def _detect(content: bytes) -> tuple[str, bytes]:
    """Return the codec of a document, and its text without a byte order mark."""
    for mark, encoding in _BOMS:
        if content.startswith(mark) and (mark != codecs.BOM_UTF16_LE or len(content) > len(mark)):
            return encoding, content.removeprefix(mark)
    for beginning, encoding in _WITHOUT_BOM:
        if content.startswith(beginning):
            return encoding, content
    declared = _DECLARATION.match(content)
    return ("utf-8" if declared is None else _codec(declared[1].decode())), content


def _codec(name: str) -> str:
    """Return Python's name of an encoding that XML declares in one byte for each character of ASCII."""
    try:
        known = codecs.lookup(name).name
    except LookupError:
        known = ""
    if not _CHARACTER_SETS.match(known):
        raise ValueError(f"unknown encoding '{name}'; save it as UTF-8")
    if known.startswith(("utf-16", "utf-32")):
        raise ValueError(f"it declares the encoding {name}, but it is not in {name}; save it as UTF-8")
    return known


def _decode(text: bytes, encoding: str) -> str:
    try:
        return text.decode(encoding)
    except UnicodeDecodeError as error:
        line = text[: error.start].decode(encoding, "replace").count("\n") + 1
        raise ValueError(f"it is not {encoding.upper()} text (line {line}); save it as UTF-8") from None
