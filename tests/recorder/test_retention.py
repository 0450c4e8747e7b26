"""Which recordings are kept, and when a new one is started."""

from __future__ import annotations

from pathlib import Path

import pytest

from semmap.nodes.recorder.retention import File, Retention, recordings
from semmap.schemas.errors import BadRequest

DAY_S = 86400.0
NOW_S = 100 * DAY_S


def files(*ages_and_sizes):
    return [
        File(Path(f"{i}.rrd"), NOW_S - days * DAY_S, size) for i, (days, size) in enumerate(ages_and_sizes)
    ]


@pytest.mark.parametrize(
    ("text", "retention"),
    [
        ("7d", Retention(age_s=7 * 86400)),
        ("12h", Retention(age_s=12 * 3600)),
        ("500MB", Retention(size_bytes=500_000_000)),
        ("20GB", Retention(size_bytes=20_000_000_000)),
    ],
)
def test_an_age_or_a_size(text, retention):
    assert Retention.read(text) == retention


@pytest.mark.parametrize(
    "text", ["", "7", "d", "0d", "-1d", "7 d", "7w", "1.5GB", "7d7d", "9" * 20 + "d", "GB"]
)
def test_nothing_else(text):
    with pytest.raises(BadRequest, match="examples: 12h, 7d, 500MB, 20GB"):
        Retention.read(text)


def test_what_is_older_goes():
    old = files((1, 5), (8, 5), (6.9, 5), (30, 5))
    assert [f.path.stem for f in Retention(age_s=7 * 86400).surplus(old, old[0], NOW_S)] == ["3", "1"]


def test_the_oldest_go_until_the_rest_is_small_enough():
    current, *old = files((0, 40), (1, 30), (3, 30), (2, 30))
    assert [f.path.stem for f in Retention(size_bytes=100).surplus(old, current, NOW_S)] == ["2"]
    assert [f.path.stem for f in Retention(size_bytes=70).surplus(old, current, NOW_S)] == ["2", "3"]
    assert [f.path.stem for f in Retention(size_bytes=1).surplus(old, current, NOW_S)] == ["2", "3", "1"]


def test_without_a_limit_everything_is_kept():
    current, *old = files((0, 10**12), (1000, 10**12))
    assert Retention().surplus(old, current, NOW_S) == []
    assert not Retention().is_full(current, 0.0, NOW_S)


def test_another_file_is_begun_in_time():
    (current,) = files((0, 20))
    assert Retention(size_bytes=100).is_full(current, NOW_S, NOW_S)
    assert not Retention(size_bytes=200).is_full(current, 0.0, NOW_S)
    assert Retention(age_s=7 * 86400).is_full(current, NOW_S - 1.1 * DAY_S, NOW_S)
    assert not Retention(age_s=7 * 86400).is_full(current, NOW_S - 0.9 * DAY_S, NOW_S)


def test_recordings_are_those_of_the_folder(tmp_path):
    (tmp_path / "one.rrd").write_bytes(b"123")
    (tmp_path / "notes.txt").write_bytes(b"123")
    (found,) = recordings(tmp_path)
    assert (found.path.name, found.size_bytes) == ("one.rrd", 3)
