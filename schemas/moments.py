"""Points in the map's history: a commit, or a time."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, NamedTuple

from msgspec import Meta

from schemas.errors import BadRequest

_FIRST_SECOND = 1_000_000_000
"""Numbers from here on are seconds since 1970 (2001 and later), smaller ones are commits."""

When = Annotated[int, Meta(ge=0)] | Annotated[float, Meta(ge=0.0)] | Annotated[str, Meta(min_length=1)]
"""As it is written: a commit's number, seconds since 1970, or ISO 8601 (without an offset it is local time,
that of the client where a client of ours sends it)."""


class Moment(NamedTuple):
    """Just after a commit, or a time [ns since 1970]; exactly one of them is given."""

    commit: int | None = None
    stamp_ns: int | None = None


def read_moment(when: When) -> Moment:
    """What is meant by a commit's number or a time. Raises BadRequest."""
    if isinstance(when, str):
        return _read_text(when)
    if isinstance(when, int) and when < _FIRST_SECOND:
        return Moment(commit=when)
    return Moment(stamp_ns=round(when * 1_000_000_000))


def with_offset(when: When | None) -> When | None:
    """The same for a reader in another time zone: a time without an offset gets that of this machine."""
    if not isinstance(when, str) or when.replace(".", "", 1).isdigit():
        return when
    try:
        return datetime.fromisoformat(when).astimezone().isoformat()
    except (ValueError, OverflowError, OSError):
        return when  # whoever reads it says what is wrong with it


def _read_text(text: str) -> Moment:
    for number in (int, float):
        try:
            if (value := number(text)) >= 0:
                return read_moment(value)
        except (ValueError, OverflowError):
            continue
    try:
        return Moment(stamp_ns=round(datetime.fromisoformat(text).timestamp() * 1_000_000) * 1000)
    except (ValueError, OverflowError, OSError):
        raise BadRequest(
            f"'{text}' is neither a commit's number nor a time like 2026-03-01T12:30 or 1772368200.5"
        ) from None
