"""Points in the map's history: a commit or a time."""

from __future__ import annotations

import contextlib
import re
from datetime import date, datetime, timedelta
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
_CLOCK = r"\d\d:\d\d(?::\d\d(?:[.,]\d+)?)?(?:Z|[+-]\d\d:?\d\d)?"
_OF_A_DAY = re.compile(rf"(?P<day>today|yesterday)?(?:(?(day)(?: at)? )(?P<clock>{_CLOCK}))?", re.IGNORECASE)
_AGO = re.compile(
    r"(?P<number>an?|one|\d+(?:\.\d+)?) ?"
    r"(?:(?P<seconds>s|secs?|seconds?)|(?P<minutes>m|mins?|minutes?)|(?P<hours>h|hrs?|hours?)|(?P<days>d|days?)"
    r"|(?P<weeks>w|weeks?))(?: ago)?",
    re.IGNORECASE,
)
_LASTS_S = {
    len(time): seconds for time, seconds in (("", 86_400), ("T12", 3600), ("T12:30", 60), ("T12:30:05", 1))
}
"""The duration that a written time denotes, by its length; with a fraction of a second it is exact."""

When = (
    Annotated[int, Meta(ge=0)]
    | Annotated[float, Meta(ge=0.0)]
    | Annotated[str, Meta(min_length=1, max_length=100)]
)
"""A commit's number, seconds since 1970, a time stamp as in replies (`stamp_ns`), ISO 8601, or words.

Without an offset, a time is in the client's local time; without a date, it is today's. A time covers its
written precision: `12:30:05` is that second, `12:30` the minute, a date the whole day. Words are `now`, an
age (`5 minutes ago`, `2h`), `today` and `yesterday`, also with a time (`yesterday 10:00`)."""


class Moment(NamedTuple):
    """The state after a commit, or an interval of time [ns since 1970], both ends included."""

    commit: int | None = None
    first_ns: int = 0
    last_ns: int = 0

    @property
    def is_exact(self) -> bool:
        """Whether it is a time without a duration, apart from its rounding."""
        return self.last_ns - self.first_ns <= 2 * _ROUNDING_NS


def read_moment(when: When) -> Moment:
    """Parse a commit number or a time. Raises BadRequest."""
    try:
        return _read_text(when) if isinstance(when, str) else _read_number(when)
    except (ValueError, OverflowError, OSError):
        raise BadRequest(
            f"'{when}' is neither a commit number nor a time like 2026-03-01T12:30, yesterday 12:30 or 2h ago"
        ) from None


def with_offset(when: When | None) -> When | None:
    """Return a time with an explicit offset and date, for a node with another clock or time zone."""
    if not isinstance(when, str):
        return when
    try:
        when = _with_date(when)
        if (written := _WRITTEN.fullmatch(when)) is None or written["offset"]:
            return when
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
    """Return a time of a day or an age as ISO 8601; any other text is returned unchanged."""
    text = " ".join(text.split()) if text.strip() == text else text
    if text.lower() == "now":
        return datetime.now().astimezone().isoformat(timespec="microseconds")
    if (ago := _AGO.fullmatch(text)) is not None:
        number = float(ago["number"]) if ago["number"][0].isdigit() else 1.0
        unit = next(name for name in ("seconds", "minutes", "hours", "days", "weeks") if ago[name])
        then = datetime.now().astimezone() - timedelta(**{unit: number})
        return then.isoformat(timespec="microseconds")
    if text and (written := _OF_A_DAY.fullmatch(text)) is not None:
        is_yesterday = (written["day"] or "").lower() == "yesterday"
        day = (date.today() - timedelta(days=is_yesterday)).isoformat()
        return f"{day}T{written['clock']}" if written["clock"] else day
    return text


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
