"""Reads name, role and expiry of a certificate: the few fields of X.509 that a client needs.

It does not verify the certificate: TLS does, on both ends. A client reads its own certificate only to report
early what its role does not permit, so the base installation needs no certificate library.
"""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import Iterator
from datetime import UTC, datetime
from typing import Final, NamedTuple

_PEM: Final = re.compile(rb"-----BEGIN CERTIFICATE-----(.+?)-----END CERTIFICATE-----", re.DOTALL)
_COMMON_NAME: Final = b"\x55\x04\x03"
_UNIT: Final = b"\x55\x04\x0b"
_VERSION: Final = 0xA0
_UTC_TIME: Final = 0x17
_UTF_8: Final = "utf-8"


class Certificate(NamedTuple):
    """Name (common name), role (organizational unit) and expiry."""

    name: str
    role: str
    expires: datetime


def read(pem: bytes) -> Certificate:
    """Read the first certificate of a PEM file. Raises ValueError for anything else."""
    if (match := _PEM.search(pem)) is None:
        raise ValueError("no certificate")
    try:
        (_, certificate), *_ = _elements(base64.b64decode(match[1]))
        (_, to_be_signed), *_ = _elements(certificate)
        fields = [f for f in _elements(to_be_signed) if f[0] != _VERSION]
        (_, _serial), (_, _algorithm), (_, _issuer), (_, validity), (_, subject), *_ = fields
        _, until = _elements(validity)
        names = dict(_attributes(subject))
        return Certificate(names[_COMMON_NAME], names.get(_UNIT, ""), _time(*until))
    except (IndexError, KeyError, UnicodeDecodeError, binascii.Error) as error:
        raise ValueError(f"not a certificate: {error}") from None


def _elements(der: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield tag and content of each DER element."""
    at = 0
    while at < len(der):
        tag, size, at = der[at], der[at + 1], at + 2
        if size & 0x80:
            count = size & 0x7F
            size, at = int.from_bytes(der[at : at + count], "big"), at + count
        if at + size > len(der):
            raise ValueError("it is truncated")
        yield tag, der[at : at + size]
        at += size


def _attributes(name: bytes) -> Iterator[tuple[bytes, str]]:
    for _, part in _elements(name):
        for _, attribute in _elements(part):
            (_, kind), (_, value) = _elements(attribute)
            yield kind, value.decode(_UTF_8)


def _time(tag: int, text: bytes) -> datetime:
    form = "%y%m%d%H%M%SZ" if tag == _UTC_TIME else "%Y%m%d%H%M%SZ"
    return datetime.strptime(text.decode("ascii"), form).replace(tzinfo=UTC)
