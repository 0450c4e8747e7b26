"""Digests: of a commit chained to the one before it, of everything else alone."""

from __future__ import annotations

import hashlib


def chain_digest(before: bytes, body: bytes) -> bytes:
    """The digest of a commit that comes after those with the digest `before`."""
    digest = hashlib.blake2b(before, digest_size=16)
    digest.update(body)
    return digest.digest()


def is_intact(before: bytes, body: object, digest: object) -> bool:
    """Is it what was written? From a damaged page SQLite may read anything, numbers and NULL too."""
    return isinstance(body, bytes) and chain_digest(before, body) == digest
