"""Expressions of time in questions about the past: at 10:00, since this morning, five minutes ago."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from typing import Final

from semmap.nodes.language.lexicon.past import PastLexicon
from semmap.schemas.moments import Moment

_CLOCK: Final = re.compile(r"(\d{1,2})[:.](\d\d)(?:[:.](\d\d))?")
_DATE: Final = re.compile(r"(\d{4}-\d\d-\d\d)(?:t(\d\d:\d\d(?::\d\d)?))?")
_UNITS_S: Final = {"second": 1, "minute": 60, "hour": 3600, "day": 86_400, "week": 604_800}
_S: Final = 1_000_000_000
_DAY_S: Final = 86_400


@dataclass(frozen=True, slots=True)
class Period:
    """A time of a question: a moment `at`, or a period with both, one or no end. `is_day` is a whole day."""

    since: Moment | None = None
    until: Moment | None = None
    at: Moment | None = None

    def combined(self, other: Period) -> Period | None:
        """Return a period with the ends of both, or None if both have the same end."""
        pairs = ((self.since, other.since), (self.until, other.until), (self.at, other.at))
        if any(one is not None and two is not None for one, two in pairs):
            return None
        since, until, at = (one or two for one, two in pairs)
        return Period(since, until, at)


class TimeReader:
    """Reads expressions of time of one language, relative to a time `now`."""

    def __init__(self, lexicon: PastLexicon, now: datetime) -> None:
        self._lexicon, self._now = lexicon, now

    def read(self, words: list[str], i: int) -> tuple[int, Period]:
        """Return the number of words and the period of the longest expression of time at `i`, or 0."""
        try:
            return self._longest(words, i)
        except (OverflowError, ValueError):  # a time that no calendar has: 999999999999 days ago
            return 0, Period()

    def _longest(self, words: list[str], i: int) -> tuple[int, Period]:
        found = [
            self._between(words, i),
            self._during(words, i),
            *(self._with_preposition(kind, words, i) for kind in ("since", "until", "at", "during")),
        ]
        length, moment = self._moment(words, i)
        is_bare = length == 1 and (words[i].isdigit() or self._lexicon.match_time("now", words, i) > 0)
        if moment is not None and not is_bare:
            found.append((length, _at(moment)))
        return max(found, key=lambda one: one[0])

    def _between(self, words: list[str], i: int) -> tuple[int, Period]:
        """Read *between 10:00 and 11:00* and *from 10:00 to 11:00*."""
        for kind in ("between", "since"):
            first = self._lexicon.match_time(kind, words, i)
            if not first:
                continue
            length, since = self._moment(words, i + first)
            j = i + first + length
            if since is None or not (joined := self._lexicon.match_time("and", words, j)):
                continue
            more, until = self._moment(words, j + joined)
            if until is not None:
                return j + joined + more - i, Period(since, until)
        return 0, Period()

    def _during(self, words: list[str], i: int) -> tuple[int, Period]:
        """Read *in the last ten minutes* and *the past hour*."""
        j = i + self._lexicon.match_time("during", words, i)
        if not (last := self._lexicon.match_time("last", words, j)):
            return 0, Period()
        length, seconds = self._duration(words, j + last)
        if not length:
            length, seconds = self._unit(words, j + last)
        if not length:
            return 0, Period()
        return j + last + length - i, Period(since=self._ago(seconds))

    def _with_preposition(self, kind: str, words: list[str], i: int) -> tuple[int, Period]:
        first = self._lexicon.match_time(kind, words, i)
        if not first:
            return 0, Period()
        length, moment = self._moment(words, i + first)
        if moment is None:
            return 0, Period()
        end = first + length
        if kind == "since":
            return end, Period(since=moment)
        if kind == "until":
            return end, Period(until=moment)
        return end, _at(moment)

    def _moment(self, words: list[str], i: int) -> tuple[int, Moment | None]:
        """Read a point of time or a part of the day: `10:00`, `yesterday at ten`, `5 minutes ago`."""
        if i >= len(words):
            return 0, None
        if length := self._lexicon.match_time("commit", words, i):
            number = words[i + length] if i + length < len(words) else ""
            return (length + 1, Moment(commit=int(number))) if number.isdecimal() else (0, None)
        length, seconds = self._duration(words, i)
        if length and (ago := self._lexicon.match_time("ago", words, i + length)):
            return length + ago, self._ago(seconds)
        if length := self._lexicon.match_time("now", words, i):
            return length, _moment(self._now, 0)
        if (dated := _DATE.fullmatch(words[i])) is not None:
            return self._on_date(dated, words, i)
        length, day = self._day(words, i)
        if length:
            more, clock = self._clock_after(words, i + length)
            if clock is not None:
                return length + more, _of_day(day, *clock)
            part = self._part(words, i)
            return (
                part
                if part[0] > length
                else (length, _moment(datetime.combine(day, datetime.min.time()), _DAY_S))
            )
        if (part := self._part(words, i))[0]:
            return part
        length, time = self._clock(words, i)
        if time is None:
            return 0, None
        more, day = self._day_after(words, i + length)
        if more:
            return length + more, _of_day(day, *time)
        return length, self._latest(time, is_spoken=_CLOCK.fullmatch(words[i]) is None)

    def _latest(self, time: tuple[int, ...], *, is_spoken: bool) -> Moment:
        """Return the latest such time that is over; *at ten* may be in the morning or in the evening."""
        hours = (time[0] + 12, time[0]) if is_spoken and 0 < time[0] < 12 else (time[0],)
        days = (self._now.date(), self._now.date() - timedelta(days=1))
        moments = [_of_day(day, hour, *time[1:]) for day in days for hour in hours]
        return next((one for one in moments if one.first_ns <= self._now.timestamp() * _S), moments[-1])

    def _on_date(self, dated: re.Match[str], words: list[str], i: int) -> tuple[int, Moment | None]:
        try:
            day = date.fromisoformat(dated[1])
        except ValueError:
            return 0, None
        if dated[2]:
            hour, minute, *rest = map(int, dated[2].split(":"))
            return 1, _of_day(day, hour, minute, *rest)
        more, clock = self._clock_after(words, i + 1)
        if clock is not None:
            return 1 + more, _of_day(day, *clock)
        return 1, _moment(datetime.combine(day, datetime.min.time()), _DAY_S)

    def _day(self, words: list[str], i: int) -> tuple[int, date]:
        length, before = self._lexicon.look_up("days", words, i)
        today = self._now.date()
        if length:
            return length, today - timedelta(days=before)
        article = self._lexicon.match_time("last", words, i)
        length, weekday = self._lexicon.look_up("weekdays", words, i + article)
        if length:
            before = (today.weekday() - weekday) % 7
            return article + length, today - timedelta(days=before or 7 * (article > 0))
        return 0, today

    def _day_after(self, words: list[str], i: int) -> tuple[int, date]:
        """Read the day after a clock time: 10:00 yesterday, 10:00 on 2026-03-01."""
        j = i + self._lexicon.match_time("on_day", words, i)
        if j < len(words) and (dated := _DATE.fullmatch(words[j])) is not None and not dated[2]:
            try:
                return j + 1 - i, date.fromisoformat(dated[1])
            except ValueError:
                return 0, self._now.date()
        length, day = self._day(words, j)
        return (j + length - i, day) if length else (0, day)

    def _clock_after(self, words: list[str], i: int) -> tuple[int, tuple[int, ...] | None]:
        for skipped in (self._lexicon.match_time("at", words, i), 0):
            length, clock = self._clock(words, i + skipped)
            if clock is not None:
                return skipped + length, clock
        return 0, None

    def _part(self, words: list[str], i: int) -> tuple[int, Moment | None]:
        length, hours = self._lexicon.look_up("parts", words, i)
        if not length:
            return 0, None
        first, last, before = hours
        day = datetime.combine(self._now.date() - timedelta(days=before), datetime.min.time())
        return length, _moment(day + timedelta(hours=first), (last - first) * 3600)

    def _clock(self, words: list[str], i: int) -> tuple[int, tuple[int, ...] | None]:
        """Read a clock time as hour, minute and, if given, second."""
        if i >= len(words):
            return 0, None
        length, hour = self._lexicon.look_up("points", words, i)
        if length:
            return length, (hour, 0)
        for kind, minute in (("half", 30), ("quarter_past", 15), ("quarter_to", -15)):
            if first := self._lexicon.match_time(kind, words, i):
                length, number = self._number(words, i + first)
                if length and 0 < number <= 24:
                    of_day = int(number) * 60 + minute
                    return self._half_of_day(words, i, first + length, (of_day // 60, of_day % 60))
        if (written := _CLOCK.fullmatch(words[i])) is not None:
            time = tuple(int(part) for part in written.groups() if part is not None)
            end = 1 + self._lexicon.match_time("clock", words, i + 1)
            return self._half_of_day(words, i, end, time)
        length, number = self._number(words, i)
        if not length or number != int(number) or number > 24:
            return 0, None
        clock = self._lexicon.match_time("clock", words, i + length)
        return self._half_of_day(words, i, length + clock, (int(number), 0))

    def _half_of_day(
        self, words: list[str], i: int, length: int, time: tuple[int, ...]
    ) -> tuple[int, tuple[int, ...] | None]:
        hour, *rest = time
        for kind, added in (("am", 0), ("pm", 12)):
            if (half := self._lexicon.match_time(kind, words, i + length)) and 0 < hour <= 12:
                return length + half, _valid((hour % 12 + added, *rest))
        return length, _valid(time)

    def _number(self, words: list[str], i: int) -> tuple[int, float]:
        if i < len(words) and words[i].isdecimal():
            return 1, float(words[i])
        length, number = self._lexicon.look_up("numbers", words, i)
        return (length, float(number)) if length else (0, 0.0)

    def _duration(self, words: list[str], i: int) -> tuple[int, float]:
        """Read *ten minutes*, *a couple of hours*, and *two hours and 5 minutes*; return seconds."""
        if couple := self._lexicon.match_time("couple", words, i):
            length, unit_s = self._unit(words, i + couple)
            return (couple + length, 2.0 * unit_s) if length else (0, 0.0)
        end, total_s = i, 0.0
        while True:
            j = end + (self._lexicon.match_time("and", words, end) if end > i else 0)
            number_length, number = self._number(words, j)
            if not number_length:
                break
            length, unit_s = self._unit(words, j + number_length)
            if not length:
                break
            end, total_s = j + number_length + length, total_s + number * unit_s
        return end - i, total_s

    def _unit(self, words: list[str], i: int) -> tuple[int, float]:
        found = ((self._lexicon.match_time(unit, words, i), float(s)) for unit, s in _UNITS_S.items())
        return max(found, key=lambda one: one[0])

    def _ago(self, seconds: float) -> Moment:
        return _moment(self._now - timedelta(seconds=seconds), 0)


def _valid(time: tuple[int, ...]) -> tuple[int, ...] | None:
    hour, minute, second = (*time, 0, 0)[:3]
    return time if hour < 24 and minute < 60 and second < 60 else (0, 0) if time[:2] == (24, 0) else None


def _of_day(day: date, hour: int, minute: int, second: int | None = None) -> Moment:
    begin = datetime(day.year, day.month, day.day, hour, minute, second or 0)
    return _moment(begin, 60 if second is None else 1)


def _moment(begin: datetime, seconds: int) -> Moment:
    first_ns = round(begin.timestamp() * 1_000_000) * 1000
    return Moment(first_ns=first_ns, last_ns=first_ns + max(seconds * _S - 1, 0))


def _at(moment: Moment) -> Period:
    """Return a moment, or a part of the day or whole day as a period."""
    is_long = moment.commit is None and moment.last_ns - moment.first_ns > 3600 * _S
    return Period(since=moment, until=moment) if is_long else Period(at=moment)
