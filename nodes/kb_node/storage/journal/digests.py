"""Digests of commits, each chained to the previous one, and of single values."""

from __future__ import annotations

import hashlib


def chain_digest(before: bytes, body: bytes) -> bytes:
    """Return the digest of a commit that follows those with the digest `before`."""
    digest = hashlib.blake2b(before, digest_size=16)
    digest.update(body)
    return digest.digest()


def is_intact(before: bytes, body: object, digest: object) -> bool:
    """Return whether a value is as it was written.

    SQLite may read a value of any type from a damaged page, also numbers and NULL.
    """
    return isinstance(body, bytes) and chain_digest(before, body) == digest
