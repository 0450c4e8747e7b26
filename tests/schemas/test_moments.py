import time
from datetime import datetime

import pytest

from schemas import codec, commands, errors
from schemas.moments import Moment, read_moment, with_offset

NOON = datetime(2026, 3, 1, 12, 0).timestamp()


@pytest.mark.parametrize(
    ("when", "moment"),
    [
        (7, Moment(commit=7)),
        ("7", Moment(commit=7)),
        ("2026-03-01T12:00", Moment(stamp_ns=int(NOON) * 10**9)),
        ("2026-03-01 12:00:00.25", Moment(stamp_ns=int(NOON) * 10**9 + 250_000_000)),
        ("1970-01-12T13:46:40+00:00", Moment(stamp_ns=10**15)),
        (1_772_368_200, Moment(stamp_ns=1_772_368_200 * 10**9)),
        ("1772368200.5", Moment(stamp_ns=1_772_368_200_500_000_000)),
        (3.5, Moment(stamp_ns=3_500_000_000)),
    ],
)
def test_a_moment_is_a_commit_or_a_time(when, moment):
    assert read_moment(when) == moment


def test_a_time_gets_the_offset_of_whoever_writes_it(monkeypatch):
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    time.tzset()
    try:
        assert with_offset("2026-03-01T12:00") == "2026-03-01T12:00:00+09:00"
        assert with_offset("2026-03-01T12:00+01:00") == "2026-03-01T20:00:00+09:00"
    finally:
        monkeypatch.undo()
        time.tzset()


@pytest.mark.parametrize("when", [None, 7, 3.5, "7", "20260301", "1772368200.5", "yesterday"])
def test_what_is_no_time_of_day_stays(when):
    assert with_offset(when) == when


@pytest.mark.parametrize("when", ["yesterday", "-1", "nan", "inf", "1e400", "2026-13-01", "now "])
def test_what_is_no_moment_is_refused(when):
    with pytest.raises(
        errors.BadRequest, match="is neither a commit's number nor a time like 2026-03-01T12:30"
    ):
        read_moment(when)


def test_moments_are_fields_of_messages_and_of_selectors():
    for payload in (b'{"name": "a", "as_of": 7}', b'{"name": "a", "as_of": "7"}'):
        assert read_moment(codec.decode(payload, commands.Get).as_of).commit == 7
    assert read_moment(codec.from_text({"name": "a", "as_of": "7"}, commands.Get).as_of).commit == 7
    assert codec.from_text({"since": "2026-03-01T12:00"}, commands.History).since == "2026-03-01T12:00"
    with pytest.raises(errors.BadRequest, match="as_of"):
        codec.decode(b'{"name": "a", "as_of": -1}', commands.Get)
