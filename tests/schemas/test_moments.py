import math
import time
from datetime import datetime, timedelta

import pytest

from semmap.schemas import codec, commands, errors
from semmap.schemas.moments import Moment, read_moment, with_offset

NOON_S = int(datetime(2026, 3, 1, 12, 0).timestamp())
NOON_NS = NOON_S * 10**9


def lasting(begin_ns, seconds):
    return Moment(first_ns=begin_ns, last_ns=begin_ns + seconds * 10**9 - 1)


def exactly(stamp_ns):
    return Moment(first_ns=stamp_ns - 1000, last_ns=stamp_ns + 1000)


@pytest.mark.parametrize(
    ("when", "moment"),
    [
        (7, Moment(commit=7)),
        ("7", Moment(commit=7)),
        ("2026-03-01", lasting(int(datetime(2026, 3, 1).timestamp()) * 10**9, 86_400)),
        ("2026-03-01+00:00", lasting(1_772_323_200 * 10**9, 86_400)),
        ("2026-03-01T12", lasting(NOON_NS, 3600)),
        ("2026-03-01T12:00", lasting(NOON_NS, 60)),
        ("2026-03-01 12:00:00", lasting(NOON_NS, 1)),
        ("2026-03-01T12:00:00.0", exactly(NOON_NS)),
        ("2026-03-01 12:00:00.25", exactly(NOON_NS + 250_000_000)),
        ("1970-01-12T13:46:40+00:00", lasting(10**15, 1)),
        ("1970-01-12T13:46:40Z", lasting(10**15, 1)),
        (1_772_368_200, lasting(1_772_368_200 * 10**9, 1)),
        ("1772368200.5", exactly(1_772_368_200_500_000_000)),
        (1_772_368_200_500_000_123, exactly(1_772_368_200_500_000_123)),
        (3.5, exactly(3_500_000_000)),
    ],
)
def test_a_moment_is_a_commit_or_a_time_as_long_as_it_is_written(when, moment):
    assert read_moment(when) == moment


@pytest.mark.parametrize("time_of_day", ["05:31", "05:31:07", "05:31:07.25", "05:31Z", "05:31+02:00"])
def test_a_time_without_a_date_is_today_s(time_of_day):
    today = f"{datetime.now():%Y-%m-%d}T{time_of_day}"
    assert read_moment(time_of_day) == read_moment(with_offset(time_of_day)) == read_moment(today)


@pytest.mark.parametrize(
    ("text", "day", "clock"),
    [
        ("today", 0, ""),
        ("yesterday", 1, ""),
        ("today 05:31", 0, "T05:31"),
        ("yesterday 05:31:07", 1, "T05:31:07"),
        ("Yesterday at 05:31", 1, "T05:31"),
        ("yesterday 05:31Z", 1, "T05:31Z"),
    ],
)
def test_today_and_yesterday_are_dates(text, day, clock):
    written = f"{datetime.now() - timedelta(days=day):%Y-%m-%d}{clock}"
    assert read_moment(text) == read_moment(with_offset(text)) == read_moment(written)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("now", 0),
        ("5 minutes ago", 300),
        ("1 minute ago", 60),
        ("10 min", 600),
        ("90s", 90),
        ("2h", 7200),
        ("5 mins ago", 300),
        ("2 hrs ago", 7200),
        ("1.5 hours ago", 5400),
        ("an hour ago", 3600),
        ("A day ago", 86_400),
        ("3 d", 3 * 86_400),
        ("one week ago", 7 * 86_400),
    ],
)
def test_an_age_is_counted_from_the_clock_of_the_one_who_asks(text, seconds):
    before = time.time_ns()
    asked = with_offset(text)
    after = time.time_ns()
    moment = read_moment(asked)
    assert moment == read_moment(asked)  # it stays the same, whenever it is read
    assert (
        before - seconds * 10**9 - 2000 <= moment.first_ns <= moment.last_ns <= after - seconds * 10**9 + 2000
    )


@pytest.mark.parametrize("stamp_ns", [NOON_NS, NOON_NS + 499, NOON_NS + 999_998_999, NOON_NS + 123_456_501])
def test_a_stamp_is_found_again_however_it_is_written(stamp_ns):
    then = datetime.fromtimestamp(stamp_ns / 1e9)
    for when in (
        stamp_ns,
        str(stamp_ns),
        float(stamp_ns) / 1e9,
        f"{stamp_ns / 1e9}",
        then.isoformat(),
        then.astimezone().isoformat(),
        time.strftime("%Y-%m-%dT%H:%M:%S", time.localtime(stamp_ns // 10**9)),
        f"{stamp_ns // 10**9}",
    ):
        moment = read_moment(with_offset(when))
        assert moment.first_ns <= stamp_ns <= moment.last_ns, when


def test_a_time_gets_the_local_offset_and_keeps_its_precision(monkeypatch):
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    time.tzset()
    try:
        assert with_offset("2026-03-01T12:00") == "2026-03-01T12:00+0900"
        assert with_offset("2026-03-01T12:00+01:00") == "2026-03-01T12:00+01:00"
        for when in ("2026-03-01", "2026-03-01T12", "2026-03-01T12:00", "2026-03-01 12:00:00.5"):
            assert read_moment(with_offset(when)) == read_moment(when)
    finally:
        monkeypatch.undo()
        time.tzset()


@pytest.mark.parametrize("when", [None, 7, 3.5, "7", "20260301", "1772368200.5", "tomorrow"])
def test_other_texts_are_unchanged(when):
    assert with_offset(when) == when


@pytest.mark.parametrize(
    "when",
    [
        "tomorrow",
        "in 2h",
        "ago",
        "yesterday ago",
        "9" * 30 + " days ago",
        "",
        "-1",
        "nan",
        "inf",
        "1e400",
        "2026-13-01",
        "now ",
        "-2026-03-01",
        math.inf,
        1e300,
    ],
)
def test_invalid_moments_are_rejected(when):
    with pytest.raises(
        errors.BadRequest, match="is neither a commit number nor a time like 2026-03-01T12:30"
    ):
        read_moment(when)


def test_moments_are_fields_of_messages_and_of_selectors():
    for payload in (b'{"name": "a", "as_of": 7}', b'{"name": "a", "as_of": "7"}'):
        assert read_moment(codec.decode(payload, commands.Get).as_of).commit == 7
    assert read_moment(codec.from_text({"name": "a", "as_of": "7"}, commands.Get).as_of).commit == 7
    assert codec.from_text({"since": "2026-03-01T12:00"}, commands.History).since == "2026-03-01T12:00"
    with pytest.raises(errors.BadRequest, match="as_of"):
        codec.decode(b'{"name": "a", "as_of": -1}', commands.Get)
