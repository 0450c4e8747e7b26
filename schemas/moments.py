"""Points in the map's history: a commit or a time."""

from __future__ import annotations

import contextlib
import re
from datetime import date, datetime
from typing import Annotated, NamedTuple

from msgspec import Meta

from semmap.schemas.errors import BadRequest

_S = 1_000_000_000
_FIRST_SECOND = 1_000_000_000
"""Numbers from here on are seconds since 1970 (2001 and later), smaller ones are commits."""
_FIRST_STAMP = _FIRST_SECOND * _S
"""Whole numbers from here on are stamps: nanoseconds since 1970."""
_ROUNDING_NS = 1000
"""Floats and datetimes round a stamp, to less than this."""

_WRITTEN = re.compile(
    r"(?P<date>\d{4}-\d\d-\d\d)(?P<time>[Tt ]\d\d(:\d\d(:\d\d([.,]\d+)?)?)?)?(?P<offset>Z|[+-]\d\d:?\d\d)?"
)
_OF_TODAY = re.compile(r"\d\d:\d\d(:\d\d([.,]\d+)?)?(Z|[+-]\d\d:?\d\d)?")
_LASTS_S = {
    len(time): seconds for time, seconds in (("", 86_400), ("T12", 3600), ("T12:30", 60), ("T12:30:05", 1))
}
"""The duration that a written time denotes, by its length; with a fraction of a second it is exact."""

When = (
    Annotated[int, Meta(ge=0)]
    | Annotated[float, Meta(ge=0.0)]
    | Annotated[str, Meta(min_length=1, max_length=100)]
)
"""A commit's number, seconds since 1970, a time stamp as in replies (`stamp_ns`), or ISO 8601.

Without an offset, a time is in the client's local time; without a date, it is today's. A time covers its
written precision: `12:30:05` is that second, `12:30` the minute, a date the whole day."""


class Moment(NamedTuple):
    """The state after a commit, or an interval of time [ns since 1970], both ends included."""

    commit: int | None = None
    first_ns: int = 0
    last_ns: int = 0


def read_moment(when: When) -> Moment:
    """Parse a commit number or a time. Raises BadRequest."""
    try:
        return _read_text(when) if isinstance(when, str) else _read_number(when)
    except (ValueError, OverflowError, OSError):
        raise BadRequest(
            f"'{when}' is neither a commit number nor a time like 2026-03-01T12:30, 12:30 or 1772368200.5"
        ) from None


def with_offset(when: When | None) -> When | None:
    """Return a time with an explicit offset and date, for a node in another time zone."""
    if not isinstance(when, str):
        return when
    when = _with_date(when)
    if (written := _WRITTEN.fullmatch(when)) is None or written["offset"]:
        return when
    try:
        return when + datetime.fromisoformat(when).astimezone().strftime("%z")[:5]
    except (ValueError, OverflowError, OSError):
        return when  # the node that parses it reports the error


def _read_text(text: str) -> Moment:
    for number in (int, float):
        with contextlib.suppress(ValueError):
            return _read_number(number(text))
    if (written := _WRITTEN.fullmatch(_with_date(text))) is None:
        raise ValueError
    time = written["time"] or ""
    begin = datetime.fromisoformat(f"{written['date']}{time or 'T00'}{written['offset'] or ''}")
    stamp_ns = round(begin.timestamp() * 1_000_000) * 1000
    seconds = _LASTS_S.get(len(time))
    return _exactly(stamp_ns) if seconds is None else _lasting(stamp_ns, seconds)


def _with_date(text: str) -> str:
    return f"{date.today().isoformat()}T{text}" if _OF_TODAY.fullmatch(text) else text


def _read_number(number: float) -> Moment:
    if number < 0:
        raise ValueError
    if isinstance(number, float):
        return _exactly(round(number * _S))
    if number < _FIRST_SECOND:
        return Moment(commit=number)
    return _exactly(number) if number >= _FIRST_STAMP else _lasting(number * _S, 1)


def _exactly(stamp_ns: int) -> Moment:
    return Moment(first_ns=stamp_ns - _ROUNDING_NS, last_ns=stamp_ns + _ROUNDING_NS)


def _lasting(first_ns: int, seconds: int) -> Moment:
    return Moment(first_ns=first_ns, last_ns=first_ns + seconds * _S - 1)
